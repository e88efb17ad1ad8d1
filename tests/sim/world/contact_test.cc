// The law of contact against closed forms.
#include "sim/world/contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace sinew::world {
namespace {

const Eigen::Vector3d kAtRest = Eigen::Vector3d::Zero();

TEST(Contact, SinksUnderTheStaticLoadAsDeclared) {
  GroundConfig config;
  config.height_m = 0.7;
  const GroundLaw law(config);
  const Eigen::Vector3d point(0.1, 0.2, 0.7 - config.static_sink_m);
  EXPECT_NEAR(law.Force(point, kAtRest, {}).force.normal_N, config.static_load_N, 1e-9);
  EXPECT_TRUE(law.Force(point, kAtRest, {}).memory.touches);
}

TEST(Contact, IsNothingAboveTheGroundAndNeverPulls) {
  const GroundLaw law(GroundConfig{});
  const ContactMemory touched{.anchor_m = {0.0, 0.0}, .touches = true};
  const GroundLaw::Result above = law.Force({0.0, 0.0, 1e-9}, {1.0, 0.0, -5.0}, touched);
  EXPECT_EQ(above.force.normal_N, 0.0);
  EXPECT_EQ(above.force.tangential_N.norm(), 0.0);
  EXPECT_FALSE(above.memory.touches);
  // Leaving fast: the damping would exceed the spring.
  const GroundLaw::Result leaving = law.Force({1e-3, 0.0, -1e-3}, {0.0, 0.0, 10.0}, touched);
  EXPECT_EQ(leaving.force.normal_N, 0.0);
  EXPECT_EQ(leaving.force.tangential_N.norm(), 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(law.Force({0.0, 0.0, nan}, kAtRest, touched).force.normal_N, 0.0);
}

// A mass without weight that hits the ground at the declared speed, by small steps.
TEST(Contact, ReturnsTheDeclaredRestitutionWhateverTheMass) {
  for (const double restitution : {0.05, 0.3, 0.6, 0.95}) {
    for (const double mass_kg : {0.1, 20.0}) {
      GroundConfig config;
      config.restitution = restitution;
      const GroundLaw law(config);
      const double step_s = 1e-4 * std::sqrt(mass_kg / law.stiffness_N_m());
      double z = 0.0, v = -config.impact_speed_m_s;
      z += step_s * v;
      while (z < 0.0) {
        // Explicit midpoint rule: errors of 1e-8 of the speed.
        const double half_z = z + 0.5 * step_s * v;
        const double half_v =
            v + 0.5 * step_s * law.Force({0.0, 0.0, z}, {0.0, 0.0, v}, {}).force.normal_N / mass_kg;
        const double a =
            law.Force({0.0, 0.0, half_z}, {0.0, 0.0, half_v}, {}).force.normal_N / mass_kg;
        z += step_s * half_v;
        v += step_s * a;
      }
      EXPECT_NEAR(v / config.impact_speed_m_s, restitution, 2e-4) << mass_kg;
    }
  }
}

TEST(Contact, TheDampingSolvesTheEquationOfRestitution) {
  // Below 0.03 the root is within rounding of 1/e.
  for (const double e : {0.1, 0.5, 0.9, 0.999}) {
    const double x = DampingOfRestitution(e);
    EXPECT_GT(x, 0.0);
    EXPECT_LT(x, 1.0 / e);
    EXPECT_NEAR((1.0 + e) * x, std::log1p(x) - std::log1p(-e * x), 1e-6 * (1.0 + x)) << e;
  }
  // Nearly elastic: x = 3/2 (1 - e), the first term of Hunt and Crossley's.
  EXPECT_NEAR(DampingOfRestitution(0.999) / 1.5e-3, 1.0, 2e-3);
}

TEST(Contact, TheBristleHoldsBelowTheLimitAndSlidesAtIt) {
  GroundConfig config;
  config.friction = 0.5;
  const GroundLaw law(config);
  const double depth = config.static_sink_m;
  const double limit = config.friction * config.static_load_N;
  const double reach = limit / law.tangential_stiffness_N_m();
  const ContactMemory memory = law.Force({1.0, 2.0, -depth}, kAtRest, {}).memory;
  EXPECT_EQ(memory.anchor_m, Eigen::Vector2d(1.0, 2.0));
  const GroundLaw::Result held = law.Force({1.0 + 0.9 * reach, 2.0, -depth}, kAtRest, memory);
  EXPECT_NEAR(held.force.tangential_N.x(), -0.9 * limit, 1e-9);
  EXPECT_LT((held.memory.anchor_m - memory.anchor_m).norm(), 1e-15);
  const GroundLaw::Result slid =
      law.Force({1.0, 2.0 - 5.0 * reach, -depth}, {0.0, -1.0, 0.0}, memory);
  EXPECT_NEAR(slid.force.tangential_N.y(), limit, 1e-9);
  EXPECT_NEAR(slid.memory.anchor_m.y(), 2.0 - 4.0 * reach, 1e-12);
}

// By a difference of the forces, which are linear in the velocity where they are not cut off.
TEST(Contact, ItsDampingIsHowTheForceFallsWithTheVelocity) {
  const GroundLaw law(GroundConfig{});
  const ContactMemory held{.anchor_m = {0.0, 0.0}, .touches = true};
  const Eigen::Vector3d at(0.0, 0.0, -1e-3), velocity(0.01, -0.02, 0.03);
  const GroundLaw::Result slow = law.Force(at, velocity, held);
  const GroundLaw::Result fast = law.Force(at, 1.5 * velocity, held);
  const Eigen::Vector2d along = slow.force.tangential_N - fast.force.tangential_N;
  EXPECT_NEAR(along.x(), slow.tangential_damping_N_s_m * 0.005, 1e-9);
  EXPECT_NEAR(along.y(), slow.tangential_damping_N_s_m * -0.01, 1e-9);
  EXPECT_NEAR(slow.force.normal_N - fast.force.normal_N, slow.normal_damping_N_s_m * 0.015, 1e-9);
  EXPECT_GT(slow.normal_damping_N_s_m, 0.0);
  // None where it slides, where it would pull, and above the ground.
  const GroundLaw::Result slides = law.Force(at, {5.0, 0.0, 0.0}, held);
  EXPECT_EQ(slides.tangential_damping_N_s_m, 0.0);
  EXPECT_GT(slides.normal_damping_N_s_m, 0.0);
  for (const GroundLaw::Result& none :
       {law.Force(at, {0.0, 0.0, 10.0}, held), law.Force({0.0, 0.0, 1e-6}, velocity, held)}) {
    EXPECT_EQ(none.normal_damping_N_s_m, 0.0);
    EXPECT_EQ(none.tangential_damping_N_s_m, 0.0);
  }
}

TEST(Contact, RefusesWhatNoGroundHas) {
  const auto refuses = [](double GroundConfig::*field, double value) {
    GroundConfig config;
    config.*field = value;
    EXPECT_THROW(GroundLaw{config}, std::invalid_argument) << value;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses(&GroundConfig::height_m, nan);
  refuses(&GroundConfig::friction, -0.1);
  refuses(&GroundConfig::static_load_N, 0.0);
  refuses(&GroundConfig::static_sink_m, -1e-3);
  refuses(&GroundConfig::restitution, 0.0);
  refuses(&GroundConfig::restitution, 1.0);
  refuses(&GroundConfig::impact_speed_m_s, nan);
  refuses(&GroundConfig::tangential_damping_ratio, -1.0);
}

}  // namespace
}  // namespace sinew::world
