#pragma once
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace cosim {
/// A value of a YAML document, with where it stands and which of its keys were asked for.
struct Node {
  enum class Kind { empty, scalar, list, map };
  Kind kind = Kind::empty;
  std::string text = {};                                   ///< of a scalar
  std::vector<Node> items = {};                            ///< of a list
  std::vector<std::pair<std::string, Node>> entries = {};  ///< of a map, in the order of the file
  std::string where = {};                                  ///< "file:line", or "--set"
  mutable std::set<std::string, std::less<>> asked = {};   ///< keys that a reader knows: what a map may hold

  const Node* find(std::string_view key) const;
  Node* find(std::string_view key) { return const_cast<Node*>(std::as_const(*this).find(key)); }
  std::string summary() const;  ///< as it may stand in a message: the text of a scalar, "a list of 3", "a section"
};

/// @param name  of the file, for messages
/// @throws InputError "file:line: ..." on what is not one YAML document: syntax, duplicate keys, keys that are not plain text
Node parse_yaml(const std::string& text, const std::string& name);

/// The names most like `wrong`, as "did you mean a or b?", or all of them if none is near. Empty without names.
std::string suggestion(std::string_view wrong, const std::set<std::string, std::less<>>& names);
}  // namespace cosim
