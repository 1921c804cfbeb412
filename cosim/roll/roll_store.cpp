#include "cosim/roll/roll_store.hpp"

#include <cstdlib>
#include <fstream>
#include <optional>

#include "cosim/run/new_file.hpp"
#include "tape/core/error.hpp"
#include "tape/core/hash.hpp"

namespace cosim {
namespace {
/// Of the program that runs: another build may settle rolls otherwise.
const Hash& program_hash() {
  static const Hash hash = [] {
    std::ifstream file("/proc/self/exe", std::ios::binary);
    Hash h;
    for (char block[1 << 16]; file.read(block, sizeof block) || file.gcount() > 0;) h.add(block, static_cast<std::size_t>(file.gcount()));
    return h;
  }();
  return hash;
}

std::filesystem::path file_of(const std::string& settings) {
  Hash hash = program_hash();
  hash.add(settings.data(), settings.size());
  return roll_store() / ("roll-" + hash.text() + ".h5");
}

/// A file of the store that cannot be read is as good as none.
std::optional<SettledRoll> stored(const std::filesystem::path& file, const Setup& alone) {
  if (!std::filesystem::exists(file)) return {};
  try {
    return load_roll(file, alone);
  } catch (const InputError&) {
    return {};
  }
}

/// Without room for it the next run winds again.
void keep(const std::filesystem::path& file, const SettledRoll& roll) {
  try {
    make_folder(file.parent_path());
    save_roll(file, roll);
  } catch (const InputError&) {
  }
}
}  // namespace

std::filesystem::path roll_store() {
  const auto variable = [](const char* name) {
    const char* value = std::getenv(name);
    return std::filesystem::path(value ? value : "");
  };
  if (auto folder = variable("TAPE_CACHE"); !folder.empty()) return folder;
  if (auto folder = variable("XDG_CACHE_HOME"); !folder.empty()) return folder / "tape";
  if (auto folder = variable("HOME"); !folder.empty()) return folder / ".cache" / "tape";
  return std::filesystem::temp_directory_path() / "tape";
}

void settle_rolls(Setup& setup, const RollOptions& options) {
  for (std::size_t s = 0; s < setup.scene.strips.size(); ++s) {
    if (!holds_together(setup, s)) {
      if (setup.scene.strips[s].winding && !options.asset.empty())
        throw InputError("roll.asset = " + options.asset.string() +
                         ": the tape of this roll does not adhere to itself, so that it starts as wound");
      continue;
    }
    const Setup alone = roll_alone(setup, s);
    if (!options.asset.empty()) {
      place_roll(load_roll(options.asset, alone), s, setup);
      continue;
    }
    const std::filesystem::path file = file_of(roll_settings(alone));
    std::optional<SettledRoll> roll = stored(file, alone);
    if (!roll && options.wind) keep(file, roll.emplace(settle_roll(alone, options.settle)));
    if (roll) place_roll(*roll, s, setup);
  }
}
}  // namespace cosim
