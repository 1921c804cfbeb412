#include "tape/effects/effects.inl"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/support/derivatives.hpp"
#include "tests/support/effect_world.hpp"
using namespace tape;
using namespace tape::test;

namespace {
/// Step of the differences, small against the length [m] or angle over which an effect changes.
template <class T>
constexpr Real difference_step() {
  if constexpr (std::is_same_v<T, Barrier>) return 1e-8;
  if constexpr (std::is_same_v<T, Friction>) return 5e-10;  // the slope of f0 has a bend at slip 0
  if constexpr (std::is_same_v<T, Cohesion> || std::is_same_v<T, CohesiveZone> || std::is_same_v<T, Bonds>) return 1e-8;
  if constexpr (std::is_same_v<T, AxleTorque>) return 1e-7;
  if constexpr (acts_on_blocks<T>) return 1e-4;
  return 1e-6;
}

template <class T>
class EachEffect : public testing::Test {
 public:
  /// f(world, term, i) for all elements of three worlds.
  template <class F>
  void for_each_element(const F& f) {
    for (unsigned seed : {1u, 2u, 3u}) {
      const EffectWorld world(seed);
      const Built<T> built(world);
      ASSERT_GT(built.count(), 0);
      for (int i = 0; i < built.count(); ++i) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", element " << i);
        f(world, built.term, i);
      }
    }
  }
};

template <class Tuple>
struct TypesOf;
template <class... T>
struct TypesOf<std::tuple<T...>> {
  using type = testing::Types<T...>;
};
struct EffectName {
  template <class T>
  static std::string GetName(int) {
    return std::string(T::name);
  }
};
TYPED_TEST_SUITE(EachEffect, TypesOf<Effects>::type, EffectName);
}  // namespace

TYPED_TEST(EachEffect, TheGradientIsTheSlopeOfTheEnergy) {
  constexpr Real kStep = difference_step<TypeParam>();
  this->for_each_element([](const EffectWorld& world, const TypeParam& term, int i) {
    const Element<TypeParam> e(world, term, i);
    const Eigen::VectorXd g = e.gradient(e.rest());
    const Eigen::VectorXd slope = test::slope([&](const Eigen::VectorXd& q) { return e.energy(q); }, e.rest(), kStep);
    const Real roundoff = 1e-14 * std::abs(e.energy(e.rest())) / kStep;
    EXPECT_LE((g - slope).norm(), 1e-6 * g.norm() + roundoff) << g.transpose() << "\n" << slope.transpose();
  });
}

TYPED_TEST(EachEffect, TheExactHessianIsTheSlopeOfTheGradientAndSymmetric) {
  constexpr Real kStep = difference_step<TypeParam>();
  this->for_each_element([](const EffectWorld& world, const TypeParam& term, int i) {
    const Element<TypeParam> e(world, term, i);
    const Eigen::MatrixXd h = e.hessian(HessianMode::exact);
    const Eigen::MatrixXd slope = jacobian([&](const Eigen::VectorXd& q) { return e.gradient(q); }, e.rest(), kStep);
    const Real roundoff = 1e-13 * e.gradient(e.rest()).norm() / kStep;
    EXPECT_LE((h - h.transpose()).norm(), 1e-11 * h.norm());
    // Rotations do not commute: the slope of the gradient carries half its skew matrix besides the Hessian.
    const Eigen::MatrixXd symmetric = 0.5 * (slope + slope.transpose());
    EXPECT_LE((h - (acts_on_blocks<TypeParam> ? symmetric : slope)).norm(), 1e-6 * h.norm() + roundoff);
  });
}

TYPED_TEST(EachEffect, TheProjectedHessianIsPositiveSemidefiniteAndSymmetric) {
  this->for_each_element([](const EffectWorld& world, const TypeParam& term, int i) {
    const Element<TypeParam> e(world, term, i);
    const Eigen::MatrixXd h = e.hessian(HessianMode::projected);
    EXPECT_LE((h - h.transpose()).norm(), 1e-13 * h.norm());
    EXPECT_GE(smallest_eigenvalue(h), -1e-12 * h.norm());
  });
}

TYPED_TEST(EachEffect, TheProjectedHessianIsTheSumOfItsSquaresWhereItHasThem) {
  constexpr int kSize = 3 * stencil_size<TypeParam>;
  using Vector = VecN<kSize>;
  using Matrix = MatN<kSize, kSize>;
  const auto add = [](Matrix& sum) { return [&](Real c, const Vector& g) { sum += c * g * g.transpose(); }; };
  Matrix unused;
  if constexpr (requires(const TypeParam& term, const StateView& s) { term.squares(s, 0, add(unused)); }) {
    int found = 0;
    this->for_each_element([&](const EffectWorld& world, const TypeParam& term, int i) {
      Matrix sum = Matrix::Zero();
      if (!term.squares(world.view(), i, add(sum))) return;
      const Matrix h = term.hessian(world.view(), i, HessianMode::projected);
      EXPECT_LE((sum - h).norm(), 1e-12 * h.norm());
      ++found;
    });
    EXPECT_GT(found, 0);
  } else {
    GTEST_SKIP() << "of another form";
  }
}

TYPED_TEST(EachEffect, AStateMovedAsAWholeHasTheSameEnergyUnlessItFalls) {
  if constexpr (std::is_same_v<TypeParam, Gravity>) GTEST_SKIP() << "the one effect with a direction of its own";
  const Pose by{rotation_exp(Vec3(0.4, -1.1, 0.7)), Vec3(0.02, -0.01, 0.03)};
  this->for_each_element([&](const EffectWorld& world, const TypeParam& term, int i) {
    EffectWorld moved = world;
    moved.move(by);
    Built<TypeParam> built(moved);
    const Real energy = term.energy(world.view(), i);
    EXPECT_NEAR(built.term.energy(moved.view(), i), energy, 1e-9 * std::abs(energy) + 1e-22);
  });
}

TYPED_TEST(EachEffect, InternalForcesHaveNoSumAndNoTorque) {
  if constexpr (std::is_same_v<TypeParam, Membrane> || std::is_same_v<TypeParam, Bending> || std::is_same_v<TypeParam, Barrier> ||
                std::is_same_v<TypeParam, Friction> || std::is_same_v<TypeParam, Cohesion> || std::is_same_v<TypeParam, CohesiveZone> ||
                std::is_same_v<TypeParam, Bonds> || std::is_same_v<TypeParam, Axle> || std::is_same_v<TypeParam, AxleTorque>) {
    this->for_each_element([](const EffectWorld& world, const TypeParam& term, int i) {
      const Element<TypeParam> e(world, term, i);
      const Eigen::VectorXd g = e.gradient(e.rest());
      Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
      Real lever = 0;
      for (std::size_t k = 0; k < e.ids().size(); ++k) {
        const Vec3 f = g.segment<3>(3 * static_cast<Eigen::Index>(k));
        const Vec3 arm = world.x[static_cast<std::size_t>(e.ids()[k])] - world.x[static_cast<std::size_t>(e.ids()[0])];
        force += f;
        torque += arm.cross(f);
        lever = std::max(lever, arm.norm());
      }
      EXPECT_LE(force.norm(), 1e-11 * g.norm());
      EXPECT_LE(torque.norm(), 1e-11 * g.norm() * lever);
    });
  } else {
    GTEST_SKIP() << "acts from outside, or against the start of the step";
  }
}

TYPED_TEST(EachEffect, TheFlatSheetWhereTheStepStartedIsFinite) {
  EffectWorld world(4);
  world.x = world.x_start = world.x_tilde = world.assembly.x;
  world.body = world.body_target;
  const Built<TypeParam> built(world);
  for (int i = 0; i < built.count(); ++i) {
    EXPECT_TRUE(std::isfinite(built.term.energy(world.view(), i)));
    EXPECT_TRUE(built.term.gradient(world.view(), i).allFinite());
    for (HessianMode mode : {HessianMode::exact, HessianMode::projected})
      EXPECT_TRUE(built.term.hessian(world.view(), i, mode).allFinite()) << "element " << i;
  }
}

TEST(EffectsList, NamesAreDistinctAndAnEmptySceneNeedsNone) {
  std::map<std::string_view, int> seen;
  for_each_effect([&]<class T>(std::type_identity<T>) {
    ++seen[T::name];
    Scene scene;
    scene.gravity.setZero();
    EXPECT_EQ(T::needed(scene, {}), "") << T::name;
  });
  EXPECT_EQ(seen.size(), std::tuple_size_v<Effects>);
}
