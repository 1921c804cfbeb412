#pragma once
#include "cosim/roll/settled_roll.hpp"

namespace cosim {
/// How the rolls of a scene get to rest.
struct RollOptions {
  std::filesystem::path asset = {};  ///< file that the scene names; empty: the store, or winding
  bool wind = true;                  ///< false: rolls that are not in the store stay as they are wound
  SettleParams settle = {};
};
/// Puts settled rolls in the place of all rolls of a setup that adhesion holds together. What was wound is kept in cache_folder(), under a
/// hash of its settings and of this program.
/// @throws InputError if the asset does not fit; as settle_roll
void settle_rolls(Setup& setup, const RollOptions& options);
}  // namespace cosim
