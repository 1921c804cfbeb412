#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <memory>
#include <set>
#include <string>

#include "tape/core/execution.hpp"
#include "tape/math/rotation.hpp"
#include "tape/model/primitives.hpp"
#include "tests/support/simulation.hpp"
using namespace tape;

namespace {
#ifdef TAPE_CUDA_LIBRARY
std::string without_spaces(std::string text) {
  std::erase(text, ' ');
  return text;
}
/// Demangled names of all symbols of a library.
std::string symbols_of(const std::string& library) {
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(("nm -C " + library + " 2>/dev/null").c_str(), "r"), pclose);
  std::string all;
  std::array<char, 4096> part;
  while (std::fgets(part.data(), part.size(), pipe.get()) != nullptr) all += part.data();
  return without_spaces(all);
}
#endif
constexpr LinearKind kSolvers[] = {LinearKind::cholesky, LinearKind::pcg_jacobi, LinearKind::pcg_two_level};  // those that CUDA offers

/// A scene with strips, driven, dynamic and linked bodies, grips, friction and the three laws of adhesion.
test::Simulation all_at_once(LinearKind linear, Backend backend) {
  auto setup = test::strip_setup(test::flat_strip(0.04, 3, Vec3(-0.02, 0, 3e-4)));
  setup.linear.linear = linear;
  setup.newton.hessian = linear == LinearKind::cholesky ? HessianMode::exact : HessianMode::projected;
  setup.newton.stop = linear == LinearKind::cholesky ? StopRule::velocity : StopRule::work;
  test::add_body(setup, "table", box_mesh(Vec3(0.1, 0.06, 0.01)), Motion::fixed, Vec3(0, 0, -0.005));
  test::add_body(setup, "box", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::dynamic, Vec3(-0.012, 0, 0.0056)).material = 2;
  test::add_body(setup, "lid", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::dynamic, Vec3(0.005, 0, 0.0056)).material = 3;
  test::add_body(setup, "pusher", box_mesh(Vec3(0.01, 0.01, 0.01)), Motion::driven, Vec3(0, 0.03, 0.006)).velocity = Vec3(0, -0.1, 0);
  test::add_body(setup, "link", box_mesh(Vec3(0.006, 0.01, 0.01)), Motion::linked, Vec3(0.015, 0, 0.0056)).material = 2;
  setup.scene.articulations = {{"robot", {"link"}, 6}};
  Grip grip;
  grip.name = "pull";
  grip.what = {.object = "tape", .vertices = {0, 1, 2, 3}, .points = {}};
  setup.scene.grips.push_back(grip);
  for (const char* name : {"steel", "wood", "glass"}) setup.scene.materials.push_back({name, 0.5});
  setup.scene.bodies[0].material = 1;
  for (const auto& [material, law] : {std::pair{1, AdhesionLaw::per_pair}, {2, AdhesionLaw::bond}, {3, AdhesionLaw::per_area}}) {
    setup.scene.adhesives.push_back({0, material, {law, {{true, true}, {true, true}}, {.beta0 = 1}, {.reach = 1}, {.floor = 0}}});
  }
  test::Simulation simulation(setup, backend);
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(6, 6);
  simulation.exchange.articulations = {{Eigen::VectorXd::Zero(6), one, {one}}};
  return simulation;
}

/// What five steps of it launch with all solvers, both Hessians and stop rules, a start that is not finite, and the forces for pictures.
std::set<std::string> launched_kernels() {
  for (const LinearKind linear : kSolvers) {
    test::Simulation simulation = all_at_once(linear, Backend::cpu);
    record_launches(true);
    simulation.check_intersections = false;  // runs on the CPU's threads and is no part of a step
    for (int k = 0; k < 5; ++k) simulation.step();
    EXPECT_TRUE(simulation.broken.empty()) << simulation.broken.front();
    for (const AdhesionReport& interface : simulation.report().adhesion) EXPECT_GT(interface.live, 0);
    EXPECT_FALSE(simulation.contact_force().empty());
    simulation.state().v[0].x() = std::numeric_limits<Real>::quiet_NaN();
    EXPECT_FALSE(simulation.step().ok);
    record_launches(false);
  }
  return recorded_launches();
}
}  // namespace

/// The CPU launches a kernel by the name tape::on_cpu::X; then the CUDA library must hold a launch of tape::on_cuda::X. Names without a
/// side, like tape::Dot, are those of functors that both sides share: the library must hold a launch of them too.
TEST(CudaKernels, EveryKernelThatAStepLaunchesExistsForCuda) {
  const std::set<std::string> launched = launched_kernels();
  EXPECT_GT(launched.size(), 30u);
#ifdef TAPE_CUDA_LIBRARY
  const std::string symbols = symbols_of(TAPE_CUDA_LIBRARY);
  ASSERT_NE(symbols.find("tape::on_cuda::detail::run<"), std::string::npos) << "no kernels at all in " << TAPE_CUDA_LIBRARY;
  for (std::string name : launched) {
    for (std::size_t at; (at = name.find("on_cpu")) != std::string::npos;) name.replace(at, 6, "on_cuda");
    name = without_spaces(name);
    const bool there =
        symbols.find("detail::run<" + name + ">(int," + name) != std::string::npos || symbols.find("," + name + ",") != std::string::npos;
    EXPECT_TRUE(there) << name << " is launched on the CPU and has no CUDA instantiation";
  }
  EXPECT_EQ(symbols.find("detail::run<tape::on_cuda::NoSuchKernel>"), std::string::npos);
#else
  GTEST_SKIP() << "this build has no CUDA back end";
#endif
}

/// To what Newton's stop and the order of sums leave open: 1e-3 m/s for 0.01 s, five times.
TEST(CudaKernels, StepsAreThoseOfTheCpu) {
  if (!cuda_available()) GTEST_SKIP() << "no CUDA device answers, or this build has no CUDA";
  for (const LinearKind linear : kSolvers) {
    test::Simulation cpu = all_at_once(linear, Backend::cpu), cuda = all_at_once(linear, Backend::cuda);
    for (int k = 0; k < 5; ++k) cpu.step(), cuda.step();
    EXPECT_TRUE(cuda.broken.empty()) << cuda.broken.front();
    for (std::size_t v = 0; v < cpu.state().x.size(); ++v)
      EXPECT_LT((cpu.state().x[v] - cuda.state().x[v]).norm(), 5e-5) << "vertex " << v << ", " << to_text(linear);
    for (std::size_t b = 0; b < cpu.state().bodies.size(); ++b)
      EXPECT_LT((cpu.state().bodies[b].pose.position - cuda.state().bodies[b].pose.position).norm(), 5e-5) << "body " << b;
    for (std::size_t i = 0; i < cpu.report().adhesion.size(); ++i)
      EXPECT_EQ(cpu.report().adhesion[i].live, cuda.report().adhesion[i].live) << "interface " << i;
  }
}
