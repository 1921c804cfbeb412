#include "robot/urdf/srdf.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <set>

#include "robot/model/robot_model.hpp"

namespace robot {
std::vector<std::pair<std::string, std::string>> read_disabled_collisions(const std::filesystem::path& file,
                                                                          const std::vector<std::string>& links) {
  tinyxml2::XMLDocument xml;
  if (xml.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS)
    throw InputError(fmt::format("{}:{}: cannot be read as SRDF: {}", file.string(), xml.ErrorLineNum(), xml.ErrorStr()));
  const auto* robot = xml.FirstChildElement("robot");
  if (!robot) throw InputError(file.string() + ": no SRDF file: it has no element <robot>");
  std::set<std::pair<std::string, std::string>> pairs;
  const auto each = [&](const char* tag, std::initializer_list<const char*> attributes, const auto& visit) {
    for (const auto* e = robot->FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) {
      std::vector<std::string> names;
      for (const char* attribute : attributes) {
        const char* name = e->Attribute(attribute);
        if (!name)
          throw InputError(fmt::format("{}:{}: <{}> needs {}", file.string(), e->GetLineNum(), tag, fmt::join(attributes, " and ")));
        names.emplace_back(name);
      }
      visit(names);
    }
  };
  each("disable_default_collisions", {"link"}, [&](const auto& names) {
    for (const std::string& other : links)
      if (other != names[0]) pairs.insert(std::minmax(names[0], other));
  });
  each("enable_collisions", {"link1", "link2"}, [&](const auto& names) { pairs.erase(std::minmax(names[0], names[1])); });
  each("disable_collisions", {"link1", "link2"}, [&](const auto& names) { pairs.insert(std::minmax(names[0], names[1])); });
  return {pairs.begin(), pairs.end()};
}
}  // namespace robot
