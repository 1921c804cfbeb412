#include "apps/tapesim/settings_list.hpp"

#include "apps/movie/params.hpp"
#include "apps/report/table.hpp"
#include "apps/tapesim/scene_input.hpp"
#include "cosim/exchange/robots.hpp"
#include "cosim/run/run_log.hpp"
#include "tape/step/world.hpp"

namespace tape::tapesim {
namespace {
template <class V>
std::string default_text(const V& value) {
  if constexpr (NamedEnum<V>)
    return to_text(value);
  else if constexpr (std::is_same_v<V, bool>)
    return value ? "true" : "false";
  else if constexpr (std::is_same_v<V, std::string>)
    return value;
  else if constexpr (std::is_same_v<V, Vec3>)
    return "[" + to_text(value.x()) + ", " + to_text(value.y()) + ", " + to_text(value.z()) + "]";
  else
    return to_text(static_cast<Real>(value));
}

template <class V>
std::string allowed_text(Range range) {
  if constexpr (NamedEnum<V>) {
    std::string names;
    for (std::string_view name : enum_names(V{})) names += (names.empty() ? "" : ", ") + std::string(name);
    return names;
  } else if constexpr (std::is_same_v<V, bool>) {
    return "true, false";
  } else {
    return range.text();
  }
}

template <Settings T>
void add(report::Table& table, const std::string& section, T settings = {}) {
  settings.fields([&](const char* name, auto& value, const char* unit, Range range, const char* meaning) {
    using V = std::remove_cvref_t<decltype(value)>;
    table.rows.push_back({section + "." + name, default_text(value), unit, allowed_text<V>(range), meaning});
  });
}
}  // namespace

std::string settings_text() {
  report::Table table{{"key", "default", "unit", "allowed", "meaning"}, {}};
  add<TimeParams>(table, "time");
  add<StripParams>(table, "strip");
  add<WindingParams>(table, "roll");
  add<Core>(table, "roll.core");
  add<Film>(table, "film");
  add<Material>(table, "materials.NAME");
  add<PairCohesion>(table, "interfaces.N (per_pair)");
  add<AreaCohesion>(table, "interfaces.N (per_area)");
  add<BondLaw>(table, "interfaces.N (bond)");
  add<ClusterParams>(table, "cluster");
  add<AxleParams>(table, "axles.N");
  add<ContactParams>(table, "contact");
  add<CuttingParams>(table, "cutting");
  add<NewtonParams>(table, "solver");
  add<LinearParams>(table, "solver");
  for_each_effect([&]<class T>(std::type_identity<T>) { add<typename T::Params>(table, std::string(T::name)); });
  add<cosim::ExchangeParams>(table, "exchange");
  add<cosim::RecordParams>(table, "record");
  add<EpisodeParams>(table, "record");
  add<movie::ViewParams>(table, "video");
  add<video::VideoSettings>(table, "video");
  add<render::LookAtSettings>(table, "camera");
  add<render::PinholeSettings>(table, "camera");
  add<movie::InsetParams>(table, "camera.inset");
  return report::to_text(table);
}
}  // namespace tape::tapesim
