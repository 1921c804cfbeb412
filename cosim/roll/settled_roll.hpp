#pragma once
#include <filesystem>
#include <string>

#include "tape/step/settle.hpp"

namespace cosim {
using namespace tape;

/// Whether strip `strip` of a scene is a roll that adhesion holds together: only such a roll can settle.
bool holds_together(const Setup& setup, std::size_t strip);

/// The roll that strip `strip` is, and nothing else: strip 0 and its hub, body 0, which is fixed; at the origin, without gravity; its
/// interfaces engage fully at once.
Setup roll_alone(const Setup& setup, std::size_t strip);

/// A roll at rest.
struct SettledRoll {
  World world;  ///< of roll_alone
  State state;
  SettleReport report;
};
/// Winds a roll and lets it come to rest. Bonds are made from the gaps of the roll that cohesion has settled, and settle again.
/// @param alone  of roll_alone
/// @throws NumericalError if it does not come to rest, Interrupted if params.go_on said so
SettledRoll settle_roll(const Setup& alone, const SettleParams& params);

/// Everything that decides how a roll settles, one setting a line.
std::string roll_settings(const Setup& alone);

/// A roll asset is a snapshot of the roll alone, with its settings. Positions and what adheres are kept to the bit.
void save_roll(const std::filesystem::path& file, const SettledRoll& roll);
/// @throws InputError if the file is no asset, or one of a roll with other settings, naming the first that differs
SettledRoll load_roll(const std::filesystem::path& file, const Setup& alone);

/// Puts a settled roll in the place of strip `strip`.
void place_roll(const SettledRoll& roll, std::size_t strip, Setup& setup);
}  // namespace cosim
