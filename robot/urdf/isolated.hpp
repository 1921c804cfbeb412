#pragma once
#include <functional>
#include <optional>
#include <string>

namespace robot {
/// Runs `work` in a child process and returns what it returns: code of others that bad input may crash does so without harm.
/// @param seconds    of wall time, then it is ended
/// @param megabytes  of memory that it may take beyond what this process holds
/// @return nothing if it crashed, threw, or ran out of time or memory
/// @throws InputError where no child can be made
std::optional<std::string> run_isolated(const std::function<std::string()>& work, unsigned seconds, std::size_t megabytes);
}  // namespace robot
