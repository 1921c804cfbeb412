#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cosim/run/summary.hpp"

namespace tape::tapesim {
/// What a run of a grid took, and how it went.
struct RunCost {
  Real seconds = 0;  ///< of the clock
  cosim::Distribution step_ms{};
  Real newton = 0;  ///< iterations per step
  int unmet = 0;    ///< conditions
  std::string failure{};
  void take(const cosim::RunSummary& summary);
};

/// Keeps what finished runs have come to in a file, so that a grid of them goes on where it was interrupted.
class RunStore {
 public:
  using Json = nlohmann::json;
  explicit RunStore(std::filesystem::path file) : file_(std::move(file)) {}
  /// @param key  of all that decides the outcome of a run
  /// @param read  from Json; what it throws means that the entry is damaged: as if it were not there
  template <class Read>
  bool find(const std::string& key, Read&& read) const {
    const std::optional<Json> kept = find(key);
    if (!kept) return false;
    try {
      read(*kept);
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }
  void keep(const std::string& key, const Json& run) const;
  static void write(const RunCost& cost, Json& run);
  /// @throws nlohmann::json::exception where something is missing
  static void read(const Json& run, RunCost& cost);

 private:
  std::optional<Json> find(const std::string& key) const;
  std::filesystem::path file_;
};
}  // namespace tape::tapesim
