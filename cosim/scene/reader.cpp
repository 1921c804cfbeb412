#include "cosim/scene/reader.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace cosim {
namespace {
std::string allowed(Range range, const std::string& unit) {
  const bool names_unit = !unit.empty() && unit != "1";
  return " (allowed: " + range.text() + (names_unit ? " " + unit : "") + ")";
}
std::string joined(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::optional<Real> parse_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  Real value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return std::numeric_limits<Real>::infinity();
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}
}  // namespace

void Reader::fail(const std::string& reason) const {
  const bool has_value = exists() && !is_map();
  throw tape::InputError(where_ + ": " + (path_.empty() ? "" : path_ + (has_value ? " = " + node_->summary() : "") + ": ") + reason);
}

Reader Reader::operator[](std::string_view key) const {
  if (!exists()) return {nullptr, joined(path_, key), where_};
  if (!is_map()) fail("must be a section with keys such as " + std::string(key));
  node_->asked.emplace(key);
  const Node* child = node_->find(key);
  return {child, joined(path_, key), child ? child->where : node_->where};
}

std::vector<std::string> Reader::keys() const {
  if (!exists()) return {};
  if (!is_map()) fail("must be a section of names");
  std::vector<std::string> names;
  for (const auto& [name, value] : node_->entries) names.push_back(name), node_->asked.insert(name);
  return names;
}

std::vector<Reader> Reader::items() const {
  if (!exists()) return {};
  if (!is_list()) fail("must be a list");
  std::vector<Reader> all;
  for (std::size_t i = 0; i < node_->items.size(); ++i)
    all.emplace_back(&node_->items[i], joined(path_, std::to_string(i)), node_->items[i].where);
  return all;
}

const Node& Reader::scalar(const std::string& wanted) const {
  if (!exists()) fail("missing; must be " + wanted);
  if (node_->kind != Node::Kind::scalar) fail("must be " + wanted);
  return *node_;
}

Real Reader::number(Range range, const char* unit) const {
  const std::optional<Real> value = parse_number(scalar("a number" + allowed(range, unit)).text);
  if (!value) fail("not a number" + allowed(range, unit));
  if (!range.contains(*value)) fail("out of range" + allowed(range, unit));
  return *value;
}

int Reader::integer(Range range, const char* unit) const {
  constexpr Real kLimit = std::numeric_limits<int>::max();
  range.low = std::max(range.low, -kLimit), range.high = std::min(range.high, kLimit);
  const Real value = number(range, unit);
  if (value != std::floor(value)) fail("not a whole number" + allowed(range, unit));
  return static_cast<int>(value);
}

bool Reader::flag() const {
  const std::string& text = scalar("on or off").text;
  for (const char* yes : {"on", "true", "yes"})
    if (text == yes) return true;
  for (const char* no : {"off", "false", "no"})
    if (text == no) return false;
  fail("neither on nor off");
}

std::string Reader::text() const {
  const std::string& text = scalar("a name").text;
  if (text.empty()) fail("must not be empty");
  return text;
}

std::vector<Real> Reader::numbers(std::size_t count, Range range, const char* unit) const {
  const std::string wanted = "must be a list of " + std::to_string(count) + " numbers" + allowed(range, unit);
  if (!exists()) fail("missing; " + wanted);
  if (!is_list() || node_->items.size() != count) fail(wanted);
  std::vector<Real> values;
  for (const Reader& item : items()) values.push_back(item.number(range, unit));
  return values;
}

Vec3 Reader::vector(Range range, const char* unit) const { return Vec3(numbers(3, range, unit).data()); }

std::vector<std::string> Reader::texts() const {
  std::vector<std::string> all;
  for (const Reader& item : items()) all.push_back(item.text());
  return all;
}

void Reader::require_known() const {
  if (!node_) return;
  for (const auto& [name, value] : node_->entries) {
    const Reader child(&value, joined(path_, name), value.where);
    if (!node_->asked.contains(name)) {
      const std::string help = suggestion(name, node_->asked);
      child.fail("unknown key" + (help.empty() ? "" : "; " + help));
    }
    child.require_known();
  }
  if (is_list())
    for (const Reader& item : items()) item.require_known();
}

std::size_t choose(const Reader& reader, const std::vector<std::string>& names) { return choose(reader, reader.text(), names); }

std::size_t choose(const Reader& reader, const std::string& text, const std::vector<std::string>& names) {
  if (names.empty()) reader.fail("unknown; there is none of its kind in this scene");
  const auto it = std::find(names.begin(), names.end(), text);
  if (it != names.end()) return static_cast<std::size_t>(it - names.begin());
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  const std::string near = suggestion(text, {names.begin(), names.end()});
  reader.fail("unknown" + (near.starts_with("did") ? "; " + near : "") + " (allowed: " + all + ")");
}
}  // namespace cosim
