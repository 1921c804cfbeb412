#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cosim/scene/node.hpp"
#include "tape/core/settings.hpp"
#include "tape/core/types.hpp"

namespace cosim {
using tape::Mat3;
using tape::Pose;
using tape::Range;
using tape::Real;
using tape::Settings;
using tape::Vec3;

/// One place in a scene file, there or not, with its path for messages. Every message is
/// "file:line: path = value: reason (allowed: range unit)". Keys that are asked for become known; SceneFile refuses all others.
class Reader {
 public:
  /// @param node  null: not in the file. @param where  of what it is missing from
  Reader(const Node* node, std::string path, std::string where) : node_(node), path_(std::move(path)), where_(std::move(where)) {}

  bool exists() const { return node_ && node_->kind != Node::Kind::empty; }
  explicit operator bool() const { return exists(); }
  const std::string& path() const { return path_; }
  const std::string& where() const { return where_; }  ///< "file:line" of the value, or of what it is missing from

  /// A key of this section. @throws InputError if this is there and is no section
  Reader operator[](std::string_view key) const;
  std::vector<std::string> keys() const;  ///< of this section, in the order of the file; all become known
  std::vector<Reader> items() const;      ///< of this list; empty if it is not there
  bool is_list() const { return exists() && node_->kind == Node::Kind::list; }
  bool is_map() const { return exists() && node_->kind == Node::Kind::map; }

  // Values. @throws InputError if it is missing, of another type or out of range
  Real number(Range range, const char* unit) const;
  int integer(Range range, const char* unit = "") const;
  bool flag() const;
  std::string text() const;
  std::vector<Real> numbers(std::size_t count, Range range, const char* unit) const;
  Vec3 vector(Range range, const char* unit) const;
  std::vector<std::string> texts() const;
  template <tape::NamedEnum E>
  E choice() const;
  Real number_or(Real fallback, Range range, const char* unit) const { return exists() ? number(range, unit) : fallback; }
  int integer_or(int fallback, Range range) const { return exists() ? integer(range) : fallback; }
  bool flag_or(bool fallback) const { return exists() ? flag() : fallback; }
  std::string text_or(const std::string& fallback) const { return exists() ? text() : fallback; }
  Vec3 vector_or(const Vec3& fallback, Range range, const char* unit) const { return exists() ? vector(range, unit) : fallback; }

  /// Every field of a settings struct that is in this section; the others keep their value.
  template <Settings T>
  void read(T& settings) const;

  /// @throws InputError "file:line: path = value: reason"
  [[noreturn]] void fail(const std::string& reason) const;
  /// @throws InputError if this section holds a key that nobody asked for, with the names that come near
  void require_known() const;

 private:
  const Node& scalar(const std::string& wanted) const;
  const Node* node_;
  std::string path_, where_;
};

/// A name out of a list. @return its position @throws InputError with the names that come near
std::size_t choose(const Reader& reader, const std::vector<std::string>& names);
/// The same where `text` is the part of the value that names something.
std::size_t choose(const Reader& reader, const std::string& text, const std::vector<std::string>& names);

template <tape::NamedEnum E>
E Reader::choice() const {
  const auto names = enum_names(E{});
  return static_cast<E>(choose(*this, {names.begin(), names.end()}));
}

template <Settings T>
void Reader::read(T& settings) const {
  settings.fields([&](const char* name, auto& value, const char* unit, Range range, const char*) {
    const Reader field = (*this)[name];
    if (!field) return;
    using V = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<V, Real>) {
      value = field.number(range, unit);
    } else if constexpr (std::is_same_v<V, int>) {
      value = field.integer(range, unit);
    } else if constexpr (std::is_same_v<V, bool>) {
      value = field.flag();
    } else if constexpr (std::is_same_v<V, std::string>) {
      value = field.text();
    } else if constexpr (std::is_same_v<V, Vec3>) {
      value = field.vector(range, unit);
    } else {
      value = field.choice<V>();
    }
  });
}
}  // namespace cosim
