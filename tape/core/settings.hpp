#pragma once
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

#include "tape/core/error.hpp"
#include "tape/core/types.hpp"

namespace tape {
/// Interval of allowed values; NaN is never inside.
struct Range {
  Real low = -std::numeric_limits<Real>::infinity();
  Real high = std::numeric_limits<Real>::infinity();
  bool open_low = false;   ///< `low` itself is excluded
  bool open_high = false;  ///< `high` itself is excluded
  static constexpr Range any() { return {}; }
  static constexpr Range positive() { return {.low = 0, .open_low = true}; }
  static constexpr Range non_negative() { return {.low = 0}; }
  static constexpr Range closed(Real low, Real high) { return {.low = low, .high = high}; }
  static constexpr Range above(Real low, Real high) { return {.low = low, .high = high, .open_low = true}; }
  bool contains(Real value) const {
    if (!std::isfinite(value)) return false;
    return (open_low ? value > low : value >= low) && (open_high ? value < high : value <= high);
  }
  std::string text() const;  ///< "(0, 1]", "> 0", "any finite number"
};

/// Shortest text that reads back as the same number.
std::string to_text(Real value);

/// An enum that stands in a settings struct names its values by `constexpr auto enum_names(E)`, an array of string_view.
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E e) {
  enum_names(e).size();
};

template <NamedEnum E>
std::string to_text(E value) {
  return std::string(enum_names(value)[static_cast<std::size_t>(value)]);
}

/// What `fields` of a settings struct calls for each of its members.
struct FieldVisitor {  // named, because nvcc refuses lambdas in concepts
  template <class V>
  void operator()(const char*, V&, const char*, Range, const char*) const {}
};

/// A settings struct is plain: default on each member, and one list
///   template <class F> void fields(F&& f) { f("dhat", dhat, "m", Range::positive(), "activation distance"); }
/// of name, member, unit ("" if none), range and meaning. Reading, checking, printing and help all follow from it.
/// Members may be Real, int, bool, std::string, Vec3 or a NamedEnum; the range holds for numbers (each component).
template <class T>
concept Settings = requires(T t, const FieldVisitor& visitor) {
  t.fields(visitor);
};

/// @throws SettingsError naming `path`.`field` for the first number outside its range
template <Settings T>
void require_valid(const T& settings, const std::string& path) {
  T copy = settings;
  copy.fields([&](const char* name, auto& value, const char* unit, Range range, const char*) {
    using V = std::remove_cvref_t<decltype(value)>;
    const auto fail = [&](const std::string& text) {
      throw SettingsError(path + "." + name, text, range.text() + (*unit ? std::string(" ") + unit : ""));
    };
    if constexpr (std::is_same_v<V, Real> || std::is_same_v<V, int>) {
      if (!range.contains(static_cast<Real>(value))) fail(to_text(static_cast<Real>(value)));
    } else if constexpr (std::is_same_v<V, Vec3>) {
      for (Real c : value)
        if (!range.contains(c)) fail("[" + to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z()) + "]");
    }
  });
}
}  // namespace tape
