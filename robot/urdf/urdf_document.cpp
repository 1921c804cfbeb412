#include "robot/urdf/urdf_document.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "robot/model/robot_model.hpp"

namespace robot {
namespace {
using tinyxml2::XMLElement;

/// What stands in the attributes of an element: so many numbers.
struct NumberRule {
  std::string_view element, attribute;
  std::size_t count;
  enum class Range { any, not_negative, positive, not_zero, place } range = Range::any;
};
using enum NumberRule::Range;
constexpr NumberRule kNumbers[] = {
    {"origin", "xyz", 3, place},
    {"origin", "rpy", 3},
    {"axis", "xyz", 3},
    {"mass", "value", 1, positive},
    {"inertia", "ixx", 1},
    {"inertia", "ixy", 1},
    {"inertia", "ixz", 1},
    {"inertia", "iyy", 1},
    {"inertia", "iyz", 1},
    {"inertia", "izz", 1},
    {"limit", "lower", 1},
    {"limit", "upper", 1},
    {"limit", "effort", 1, not_negative},
    {"limit", "velocity", 1, not_negative},
    {"dynamics", "damping", 1, not_negative},
    {"dynamics", "friction", 1, not_negative},
    {"mimic", "multiplier", 1},
    {"mimic", "offset", 1},
    {"box", "size", 3, positive},
    {"cylinder", "radius", 1, positive},
    {"cylinder", "length", 1, positive},
    {"sphere", "radius", 1, positive},
    {"mesh", "scale", 3, not_zero},
};

/// What is read of an element: its attributes, and the elements in it.
struct Reading {
  std::set<std::string_view> attributes, children;
};
const std::map<std::string_view, Reading> kReadings = {
    {"link", {{"name"}, {"inertial", "visual", "collision"}}},
    {"joint", {{"name", "type"}, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"}}},
    {"inertial", {{}, {"origin", "mass", "inertia"}}},
    {"visual", {{"name"}, {"origin", "geometry", "material"}}},
    {"collision", {{"name"}, {"origin", "geometry"}}},
    {"geometry", {{}, {"box", "cylinder", "sphere", "mesh"}}},
    {"material", {{"name"}, {"color", "texture"}}},
    {"texture", {{"filename"}, {}}},
    {"color", {{"rgba"}, {}}},
    {"origin", {{"xyz", "rpy"}, {}}},
    {"mass", {{"value"}, {}}},
    {"inertia", {{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}}},
    {"parent", {{"link"}, {}}},
    {"child", {{"link"}, {}}},
    {"axis", {{"xyz"}, {}}},
    {"limit", {{"lower", "upper", "effort", "velocity"}, {}}},
    {"dynamics", {{"damping", "friction"}, {}}},
    {"mimic", {{"joint", "multiplier", "offset"}, {}}},
    {"box", {{"size"}, {}}},
    {"cylinder", {{"radius", "length"}, {}}},
    {"sphere", {{"radius"}, {}}},
    {"mesh", {{"filename", "scale"}, {}}},
};

const char* range_text(NumberRule::Range range) {
  switch (range) {
    case not_negative:
      return ">= 0";
    case positive:
      return "> 0";
    case not_zero:
      return "a finite number other than 0";
    case place:
      return "-10000 to 10000";
    case any:
      break;
  }
  return "a finite number";
}

bool contains(NumberRule::Range range, Real value) {
  switch (range) {
    case not_negative:
      return std::isfinite(value) && value >= 0;
    case positive:
      return std::isfinite(value) && value > 0;
    case not_zero:
      return std::isfinite(value) && value != 0;
    case place:
      return std::fabs(value) <= 1e4;
    case any:
      break;
  }
  return std::isfinite(value);
}

/// Nothing if a word is no number.
std::optional<std::vector<Real>> numbers(const char* text) {
  std::vector<Real> values;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    const char *begin = word.data() + (word.front() == '+' ? 1 : 0), *end = word.data() + word.size();
    if (const auto [stop, error] = std::from_chars(begin, end, values.emplace_back()); error != std::errc() || stop != end) return {};
  }
  return values;
}

std::string_view text_of(const XMLElement& element, const char* attribute) {
  const char* text = element.Attribute(attribute);
  return text ? text : "";
}

/// Attribute of a child; empty if either is missing.
std::string child_text(const XMLElement& element, const char* child, const char* attribute) {
  const XMLElement* found = element.FirstChildElement(child);
  return found ? std::string(text_of(*found, attribute)) : "";
}

template <class Visit>
void each_child(XMLElement& parent, const char* tag, Visit&& visit) {
  for (XMLElement *e = parent.FirstChildElement(tag), *next = nullptr; e; e = next) {
    next = e->NextSiblingElement(tag);  // the visit may delete e
    visit(*e);
  }
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file.string()) { load(); }

  UrdfDocument read() {
    check_names();
    for (const char* tag : {"link", "joint", "material"}) each_child(*robot_, tag, [&](XMLElement& e) { refuse_xacro(e); });
    each_child(*robot_, "joint", [&](XMLElement& joint) { check_type(joint); });
    for (const char* tag : {"link", "joint"})
      each_child(*robot_, tag, [&](XMLElement& e) { look_for_unread(e, std::string(text_of(e, "name"))); });
    for (const auto& [what, owners] : unread_)
      document_.notes.push_back(
          fmt::format("not read: {}, in {}{}", what, owners[0], owners.size() > 1 ? fmt::format(" and {} more", owners.size() - 1) : ""));
    check_tree();
    drop_empty_inertials();
    complete_inertias();
    each_child(*robot_, "joint", [&](XMLElement& joint) { complete_joint(joint); });
    for (const char* tag : {"link", "joint", "material"}) each_child(*robot_, tag, [&](XMLElement& e) { check_numbers(e); });
    each_child(*robot_, "joint", [&](XMLElement& joint) { check_motion(joint); });
    drop_bad_materials();
    tinyxml2::XMLPrinter printer;
    xml_.Print(&printer);
    document_.text = printer.CStr();
    return std::move(document_);
  }

 private:
  [[noreturn]] void fail(const XMLElement& at, const std::string& reason) const {
    const XMLElement* owner = &at;
    while (owner->Parent() != robot_ && owner != robot_) owner = owner->Parent()->ToElement();
    std::string place = fmt::format("{}:{}: {} '{}'", file_, at.GetLineNum(), owner->Name(), text_of(*owner, "name"));
    if (owner != &at) place += fmt::format(", {}", at.Name());
    throw InputError(place + ": " + reason);
  }

  void load() {
    if (const auto error = xml_.LoadFile(file_.c_str()); error == tinyxml2::XML_ERROR_FILE_NOT_FOUND)
      throw InputError(file_ + ": there is no such file");
    else if (error != tinyxml2::XML_SUCCESS)
      throw InputError(fmt::format("{}:{}: not well-formed XML: {}", file_, xml_.ErrorLineNum(), xml_.ErrorStr()));
    robot_ = xml_.FirstChildElement("robot");
    if (!robot_) throw InputError(file_ + ": no URDF file: it has no element <robot>");
    for (XMLElement* e = robot_->FirstChildElement(); e; e = e->NextSiblingElement()) refuse_macro(*e);
  }

  void refuse_macro(const XMLElement& element) const {
    if (std::string_view(element.Name()).starts_with("xacro:"))
      fail(element, fmt::format("<{}> is a xacro macro; expand the file by xacro first", element.Name()));
  }

  void refuse_xacro(const XMLElement& element) const {
    refuse_macro(element);
    for (const auto* a = element.FirstAttribute(); a; a = a->Next())
      if (const std::string_view value = a->Value(); value.find("${") != value.npos || value.find("$(") != value.npos)
        fail(element, fmt::format("{} = \"{}\" is left from xacro; expand the file by xacro first", a->Name(), value));
    for (const XMLElement* e = element.FirstChildElement(); e; e = e->NextSiblingElement()) refuse_xacro(*e);
  }

  void check_names() {
    for (const char* tag : {"link", "joint"}) {
      std::map<std::string, int> lines;
      each_child(*robot_, tag, [&](XMLElement& e) {
        const std::string name(text_of(e, "name"));
        if (name.empty()) fail(e, "it has no name");
        if (const auto [first, is_new] = lines.emplace(name, e.GetLineNum()); !is_new)
          fail(e, fmt::format("the name is taken by the {} in line {}", tag, first->second));
      });
      if (lines.empty() && std::string_view(tag) == "link") throw InputError(file_ + ": the robot has no link");
    }
  }

  /// A slip of the pen, or another program's.
  void look_for_unread(const XMLElement& element, const std::string& owner) {
    const Reading& reading = kReadings.at(element.Name());
    for (const auto* a = element.FirstAttribute(); a; a = a->Next())
      if (!reading.attributes.contains(a->Name())) unread_[fmt::format("attribute {} of <{}>", a->Name(), element.Name())].push_back(owner);
    for (const XMLElement* e = element.FirstChildElement(); e; e = e->NextSiblingElement())
      if (reading.children.contains(e->Name()))
        look_for_unread(*e, owner);
      else
        unread_[fmt::format("<{}> of <{}>", e->Name(), element.Name())].push_back(owner);
  }

  void check_type(XMLElement& joint) {
    const std::string_view type = text_of(joint, "type");
    if (type == "fixed")
      for (const char* tag : {"axis", "limit", "dynamics", "mimic"}) each_child(joint, tag, [&](XMLElement& e) { joint.DeleteChild(&e); });
    else if (type != "revolute" && type != "continuous" && type != "prismatic")
      fail(joint, fmt::format("type = \"{}\": allowed is fixed, revolute, continuous, prismatic", type));
    document_.joints.emplace_back(text_of(joint, "name"));
  }

  /// Every link but one hangs on one joint, and from there it goes up to the root.
  void check_tree() {
    std::map<std::string, const XMLElement*> joint_above;  // of each link
    each_child(*robot_, "link", [&](XMLElement& link) { joint_above[std::string(text_of(link, "name"))] = nullptr; });
    each_child(*robot_, "joint", [&](XMLElement& joint) {
      for (const char* end : {"parent", "child"})
        if (const std::string link = child_text(joint, end, "link"); !joint_above.contains(link))
          fail(joint, fmt::format("its {} is \"{}\": there is no such link", end, link));
      const XMLElement*& above = joint_above[child_text(joint, "child", "link")];
      if (above)
        fail(joint, fmt::format("its child '{}' hangs on joint '{}' already; a link has one parent", child_text(joint, "child", "link"),
                                text_of(*above, "name")));
      above = &joint;
    });
    std::vector<std::string> roots;
    for (const auto& [link, above] : joint_above)
      if (!above) roots.push_back(link);
    if (roots.size() > 1)
      throw InputError(fmt::format("{}: more than one root: links '{}' hang on no joint", file_, fmt::join(roots, "', '")));
    for (const auto& [link, above] : joint_above) {
      std::set<std::string> passed;
      const XMLElement* joint = above;
      for (std::string at = link; joint; joint = joint_above.at(at)) {
        if (!passed.insert(at).second) fail(*joint, fmt::format("it closes a loop through link '{}'; allowed is a tree", at));
        at = child_text(*joint, "parent", "link");
      }
    }
  }

  /// Of the root and of links on fixed joints: frames without a body are often written so.
  void drop_empty_inertials() {
    std::set<std::string> moving;
    each_child(*robot_, "joint", [&](XMLElement& joint) {
      if (text_of(joint, "type") != "fixed") moving.insert(child_text(joint, "child", "link"));
    });
    each_child(*robot_, "link", [&](XMLElement& link) {
      XMLElement* inertial = link.FirstChildElement("inertial");
      if (!inertial || moving.contains(std::string(text_of(link, "name")))) return;
      for (const char* tag : {"mass", "inertia"})
        if (const XMLElement* e = inertial->FirstChildElement(tag))
          for (const auto* a = e->FirstAttribute(); a; a = a->Next())
            if (a->DoubleValue() != 0) return;
      link.DeleteChild(inertial);
    });
  }

  /// Off-diagonal terms that are left out are 0.
  void complete_inertias() {
    each_child(*robot_, "link", [&](XMLElement& link) {
      each_child(link, "inertial", [&](XMLElement& inertial) {
        each_child(inertial, "inertia", [&](XMLElement& inertia) {
          for (const char* term : {"ixy", "ixz", "iyz"})
            if (!inertia.Attribute(term)) inertia.SetAttribute(term, "0");
        });
      });
    });
  }

  /// An axis without numbers is x; a limit that is infinite is none.
  void complete_joint(XMLElement& joint) {
    each_child(joint, "axis", [&](XMLElement& axis) {
      if (!axis.Attribute("xyz")) axis.SetAttribute("xyz", "1 0 0");
    });
    each_child(joint, "limit", [&](XMLElement& limit) {
      for (const char* quantity : {"effort", "velocity"})
        if (const auto value = numbers(std::string(text_of(limit, quantity)).c_str());
            value && value->size() == 1 && std::isinf(value->front()))
          limit.SetAttribute(quantity, "0");
    });
  }

  void check_numbers(XMLElement& element) {
    for (const NumberRule& rule : kNumbers) {
      const char* attribute = rule.attribute.data();
      const char* text = element.Name() == rule.element ? element.Attribute(attribute) : nullptr;
      if (!text) continue;
      const auto values = numbers(text);
      const bool good = values && values->size() == rule.count &&
                        std::all_of(values->begin(), values->end(), [&](Real value) { return contains(rule.range, value); });
      const std::string count = rule.count == 1 ? "" : fmt::format("{} numbers, each ", rule.count);
      if (!good) fail(element, fmt::format("{} = \"{}\": allowed is {}{}", attribute, text, count, range_text(rule.range)));
      element.SetAttribute(attribute, fmt::format("{}", fmt::join(*values, " ")).c_str());
    }
    for (XMLElement* e = element.FirstChildElement(); e; e = e->NextSiblingElement()) check_numbers(*e);
  }

  void check_motion(XMLElement& joint) {
    const std::string_view type = text_of(joint, "type");
    if (type == "fixed") return;
    if (const XMLElement* axis = joint.FirstChildElement("axis"); axis && axis->Attribute("xyz"))
      if (const auto xyz = numbers(axis->Attribute("xyz")); std::count(xyz->begin(), xyz->end(), 0) == 3)
        fail(*axis, "xyz = \"0 0 0\": allowed is an axis of any length but 0");
    XMLElement* limit = joint.FirstChildElement("limit");
    const bool bounded = type != "continuous";
    if (!limit && bounded) fail(joint, fmt::format("a {} joint needs a <limit>", type));
    if (limit && bounded && limit->DoubleAttribute("lower") > limit->DoubleAttribute("upper"))
      fail(*limit, fmt::format("lower = {} is above upper = {}: allowed is lower <= upper", limit->DoubleAttribute("lower"),
                               limit->DoubleAttribute("upper")));
    if (limit && bounded && limit->DoubleAttribute("lower") == limit->DoubleAttribute("upper"))
      document_.notes.push_back(
          fmt::format("joint {} cannot move: lower and upper limit are {}", text_of(joint, "name"), limit->DoubleAttribute("lower")));
    for (const char* quantity : {"effort", "velocity"})
      if (!limit || limit->DoubleAttribute(quantity) == 0) {
        if (limit) limit->SetAttribute(quantity, "0");  // urdfdom insists on it
        document_.unlimited.push_back(fmt::format("{} of {}", quantity, text_of(joint, "name")));
      }
  }

  /// Those that nothing defines, and those whose colour is none: urdfdom refuses robots for them.
  void drop_bad_materials() {
    const auto coloured = [](const XMLElement& color) {
      const auto rgba = numbers(text_of(color, "rgba").data());
      return rgba && rgba->size() == 4 && std::ranges::all_of(*rgba, [](Real value) { return value >= 0 && value <= 1; });
    };
    const auto defined = [&](XMLElement& m) {
      if (!m.Attribute("name")) m.SetAttribute("name", "");
      const XMLElement* color = m.FirstChildElement("color");
      return color ? coloured(*color) : m.FirstChildElement("texture") != nullptr;
    };
    std::set<std::string_view> names;
    each_child(*robot_, "material", [&](XMLElement& m) {
      if (!defined(m) || !names.insert(text_of(m, "name")).second) robot_->DeleteChild(&m);
    });
    each_child(*robot_, "link", [&](XMLElement& link) {
      each_child(link, "visual", [&](XMLElement& visual) {
        each_child(visual, "material", [&](XMLElement& m) {
          if (defined(m))
            names.insert(text_of(m, "name"));
          else if (m.FirstChildElement() || !names.contains(text_of(m, "name")))
            visual.DeleteChild(&m);
        });
      });
    });
  }

  std::string file_;
  tinyxml2::XMLDocument xml_;
  XMLElement* robot_ = nullptr;
  UrdfDocument document_;
  std::map<std::string, std::vector<std::string>> unread_;  // by whom it is owned
};
}  // namespace

UrdfDocument read_document(const std::filesystem::path& file) { return Reader(file).read(); }
}  // namespace robot
