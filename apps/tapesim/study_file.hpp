#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "tape/core/types.hpp"

namespace tape::tapesim {
/// What runs of a study are measured against.
struct Reference {
  enum class Kind { heavy_elastica, capstan, kendall, finest };
  Kind kind = Kind::finest;
  Real angle = 0;                      ///< [rad] of contact (capstan) or of the peel (kendall)
  std::string measure;                 ///< with `finest`: key of a figure, or "state" for the largest distance of middle lines [m]
  std::vector<std::size_t> of_each{};  ///< with `finest`: places of keys in the grid; runs that differ there are not compared
};

/// One scene over a grid of settings.
struct Study {
  std::string name;
  std::filesystem::path scene;
  std::vector<std::string> overrides;                                  ///< for every run: key=value
  std::vector<std::pair<std::string, std::vector<std::string>>> grid;  ///< key, values from coarse to fine
  Reference reference;

  /// Values of every combination, the last key fastest; the last one is the finest.
  std::vector<std::vector<std::string>> combinations() const;
};
/// @throws InputError "file:line: key = value: reason"
Study load_study(const std::filesystem::path& file, const std::vector<std::string>& more_overrides);
}  // namespace tape::tapesim
