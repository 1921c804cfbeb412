#include "cosim/roll/roll_store.hpp"

#include <optional>

#include "cosim/run/cache_folder.hpp"
#include "cosim/run/new_file.hpp"
#include "tape/core/error.hpp"
#include "tape/core/hash.hpp"

namespace cosim {
namespace {
std::filesystem::path file_of(const std::string& settings) {
  Hash hash = program_hash();
  hash.add(settings);
  return cache_folder() / ("roll-" + hash.text() + ".h5");
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
