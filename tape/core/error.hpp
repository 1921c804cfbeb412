#pragma once
#include <stdexcept>
#include <string>

namespace tape {
/// Bad input by the user: file, scene, mesh, setting or snapshot. The program prints it and exits with 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// A setting whose value is out of its range.
class SettingsError : public InputError {
 public:
  /// @param key      in full, such as "contact.dhat"
  /// @param value    as the user wrote it
  /// @param allowed  range in words, with the unit
  SettingsError(const std::string& key, const std::string& value, const std::string& allowed)
      : InputError(key + " = " + value + ": allowed is " + allowed), path(key) {}
  std::string path;  ///< the key
};
/// What was asked for has no numerical answer, or none was found. The program prints it and exits with 1.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// The user wants it to end. The program exits with 130.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};
/// A broken invariant: our mistake, not the user's.
class CheckFailed : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};
}  // namespace tape

#define TAPE_CHECK_TEXT(x) #x
#define TAPE_CHECK_LINE(x) TAPE_CHECK_TEXT(x)
/// Invariant of host code, always on.
#define TAPE_CHECK(condition)                                                                          \
  do {                                                                                                 \
    if (!(condition)) throw tape::CheckFailed(__FILE__ ":" TAPE_CHECK_LINE(__LINE__) ": " #condition); \
  } while (false)
