#include "cosim/scene/node.hpp"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <sstream>

#include "tape/core/error.hpp"

namespace cosim {
namespace {
using tape::InputError;
constexpr std::size_t kMaxNodes = 100'000;  // aliases of aliases would grow without bound
constexpr std::size_t kMaxDepth = 64;

/// Builds the tree from the parser's events, which know the line of everything.
class Builder : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& name) : name_(name) {}
  Node root;

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add({.where = where(mark)}, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& value) override {
    add({.kind = Node::Kind::scalar, .text = value, .where = where(mark)}, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto it = anchored_.find(anchor);
    if (it == anchored_.end()) throw InputError(where(mark) + ": an alias inside the value it names");
    nodes_ += count(it->second) - 1;
    add(it->second, 0);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open({.kind = Node::Kind::list, .where = where(mark)}, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, YAML::EmitterStyle::value) override {
    open({.kind = Node::Kind::map, .where = where(mark)}, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    Node node;
    YAML::anchor_t anchor;
    std::string key, key_where;
    bool has_key = false;
  };
  std::string where(const YAML::Mark& mark) const { return name_ + ":" + std::to_string(mark.line + 1); }
  void open(Node node, YAML::anchor_t anchor) {
    if (levels_.size() >= kMaxDepth) throw InputError(node.where + ": nested too deeply");
    levels_.push_back({std::move(node), anchor, {}, {}});
  }
  void close() {
    Level level = std::move(levels_.back());
    levels_.pop_back();
    add(std::move(level.node), level.anchor);
  }
  static std::size_t count(const Node& node) {
    std::size_t n = 1;
    for (const Node& item : node.items) n += count(item);
    for (const auto& [key, value] : node.entries) n += count(value);
    return n;
  }
  void add(Node node, YAML::anchor_t anchor) {
    if (++nodes_ > kMaxNodes) throw InputError(node.where + ": the document is too large");
    if (anchor) anchored_[anchor] = node;
    if (levels_.empty()) {
      root = std::move(node);
      return;
    }
    Level& level = levels_.back();
    if (level.node.kind == Node::Kind::list) {
      level.node.items.push_back(std::move(node));
    } else if (!level.has_key) {
      if (node.kind != Node::Kind::scalar) throw InputError(node.where + ": a key must be plain text, not " + node.summary());
      if (const Node* first = level.node.find(node.text))
        throw InputError(node.where + ": " + node.text + ": duplicate key, first at " + first->where);
      level.key = node.text, level.key_where = node.where, level.has_key = true;
    } else {
      if (node.kind != Node::Kind::scalar) node.where = level.key_where;  // a section stands where its name does, not one line below
      level.node.entries.emplace_back(std::move(level.key), std::move(node));
      level.has_key = false;
    }
  }
  std::string name_;
  std::vector<Level> levels_;
  std::map<YAML::anchor_t, Node> anchored_;
  std::size_t nodes_ = 0;
};

/// Letters to insert, remove or replace, to make one word the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0u);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replace = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, replace});
    }
  }
  return row.back();
}
}  // namespace

const Node* Node::find(std::string_view key) const {
  for (const auto& [name, value] : entries)
    if (name == key) return &value;
  return nullptr;
}

std::string Node::summary() const {
  switch (kind) {
    case Kind::empty:
      return "nothing";
    case Kind::scalar:
      return text.size() > 60 ? text.substr(0, 60) + "..." : text;
    case Kind::list: {
      std::string all = "[";
      for (const Node& item : items) all += (all.size() > 1 ? ", " : "") + item.summary();
      return all.size() <= 60 ? all + "]" : "a list of " + std::to_string(items.size());
    }
    default:
      return "a section";
  }
}

Node parse_yaml(const std::string& text, const std::string& name) {
  std::istringstream stream(text);
  Builder builder(name);
  try {
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return {.where = name + ":1"};
    Builder rest(name);
    if (parser.HandleNextDocument(rest)) throw InputError(rest.root.where + ": a second document; a file holds one");
  } catch (const YAML::Exception& e) {
    throw InputError(name + ":" + std::to_string(e.mark.line + 1) + ": not valid YAML: " + e.msg);
  }
  return std::move(builder.root);
}

std::string suggestion(std::string_view wrong, const std::set<std::string, std::less<>>& names) {
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& name : names)
    if (const std::size_t d = edit_distance(wrong, name); d <= std::max<std::size_t>(2, name.size() / 3)) near.emplace_back(d, name);
  std::sort(near.begin(), near.end());
  std::string text = near.empty() ? "" : "did you mean ";
  for (std::size_t i = 0; i < std::min<std::size_t>(near.size(), 3); ++i) text += (i ? " or " : "") + near[i].second;
  if (!near.empty()) return text + "?";
  for (const std::string& name : names) text += (text.empty() ? "allowed: " : ", ") + name;
  return text;
}
}  // namespace cosim
