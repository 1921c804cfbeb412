#pragma once
#include "tape/cutting/kerf.hpp"
#include "tape/cutting/pressure.hpp"
#include "tape/cutting/project.hpp"

namespace tape {
/// All settings of cutting.
struct CuttingParams {
  TriggerParams trigger;
  Kerf kerf;
  KerfParams mesh;
  ProjectParams project;
  template <class F>
  void fields(F&& f) {
    trigger.fields(f), kerf.fields(f), mesh.fields(f), project.fields(f);
  }
};
}  // namespace tape
