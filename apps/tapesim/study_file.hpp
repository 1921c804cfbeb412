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
  Real angle = 0;  ///< [rad] of contact (capstan) or of the peel (kendall)
  /// with `finest`: key of a figure; "state" for the largest distance of middle lines [m]; "hub_path" for the RMS distance [m] of the hub
  /// of a roll over the run, beside hub_range_deg
  std::string measure;
  std::vector<std::size_t> of_each{};  ///< with `finest`: places of keys in the grid; runs that differ there are not compared
  /// With a figure: what a run may be off by, relative to the finest one; for each value of the key at `each` of the grid the
  /// fastest run that is no farther off is named. 0: not asked.
  Real within = 0;
  std::size_t each = 0;
  /// Key of the figure that runs are told by; empty: none.
  std::string figure() const { return kind != Kind::finest || measure == "state" ? "" : measure == "hub_path" ? "hub_range_deg" : measure; }
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
