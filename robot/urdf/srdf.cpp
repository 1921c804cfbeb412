#include "robot/urdf/srdf.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include "robot/model/robot_model.hpp"

namespace robot {
std::vector<std::pair<std::string, std::string>> read_disabled_collisions(const std::filesystem::path& file) {
  tinyxml2::XMLDocument xml;
  if (xml.LoadFile(file.c_str()) != tinyxml2::XML_SUCCESS)
    throw InputError(fmt::format("{}:{}: cannot be read as SRDF: {}", file.string(), xml.ErrorLineNum(), xml.ErrorStr()));
  const auto* robot = xml.FirstChildElement("robot");
  if (!robot) throw InputError(file.string() + ": no SRDF file: it has no element <robot>");
  std::vector<std::pair<std::string, std::string>> pairs;
  for (const auto* e = robot->FirstChildElement("disable_collisions"); e; e = e->NextSiblingElement("disable_collisions")) {
    const char *a = e->Attribute("link1"), *b = e->Attribute("link2");
    if (!a || !b) throw InputError(fmt::format("{}:{}: <disable_collisions> needs link1 and link2", file.string(), e->GetLineNum()));
    pairs.emplace_back(a, b);
  }
  return pairs;
}
}  // namespace robot
