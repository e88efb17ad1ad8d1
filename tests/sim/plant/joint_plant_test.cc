#include "sim/plant/joint_plant.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

#include "components/base/types/control_mode.h"
#include "sim/plant/single_joint.h"

namespace {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace sinew::plant {
namespace {

constexpr double kDt_s = 1e-4;

using actuator::JointModel;

void Set(JointModel& model, const char* effect, double value) {
  model.terms.push_back(actuator::MakeTerm(effect, model.constants));
  model.terms.back().linear[0].value = value;
}

JointModel Empty() {
  JointModel model;
  model.name = "joint";
  model.constants = {.gear_ratio = 100.0,
                     .link_length_m = 0.3,
                     .gravity_m_s2 = 9.81,
                     .torque_constant_Nm_A = 0.0159155,
                     .force_constant_N_V = 0.0};
  return model;
}

// The rig without friction.
JointModel Frictionless(double play_rad) {
  JointModel model = Empty();
  model.backlash_rad = play_rad;
  Set(model, "drive_current", 0.77);
  Set(model, "rotor_inertia", 0.11);
  Set(model, "link_inertia", 0.02);
  Set(model, "gravity", 0.6);
  return model;
}

JointModel Rig(double play_rad) {
  JointModel model = Frictionless(play_rad);
  Set(model, "declared_payload", 1.0);
  Set(model, "motor_viscous", 0.3);
  Set(model, "coulomb", 0.2);
  Set(model, "pneumatic_torque", 0.36);
  Set(model, "pneumatic_stiffness", 4.0);
  model.terms.back().nonlinear[0].value = 0.16;
  Set(model, "load_force", 1.0);
  return model;
}

double Energy(const SingleJoint& joint, double gravity_torque_Nm) {
  return 0.5 * joint.inertia_kg_m2() * joint.velocity_rad_s() * joint.velocity_rad_s() +
         gravity_torque_Nm * std::sin(joint.position_rad()) + joint.plant().stored_energy_J();
}

TEST(JointPlant, SwingsWithThePeriodOfAPendulum) {
  SingleJoint joint(Frictionless(0.0), {});
  joint.Reset(-M_PI / 2.0 + 0.01);
  double last_crossing = -1.0, period = 0.0;
  for (long k = 0; k < 100000; ++k) {
    const double before = joint.position_rad() + M_PI / 2.0;
    joint.Step(kDt_s);
    const double after = joint.position_rad() + M_PI / 2.0;
    if (before < 0.0 && after >= 0.0) {
      const double t = (static_cast<double>(k) + before / (before - after)) * kDt_s;
      if (last_crossing >= 0.0) period = t - last_crossing;
      last_crossing = t;
    }
  }
  // Small amplitude 0.01 rad: relative error of the closed form 0.01^2 / 16 = 6e-6; the step adds
  // (w dt)^2 / 24 = 2e-9.
  EXPECT_NEAR(period, 2.0 * M_PI * std::sqrt(0.13 / 0.6), 1e-5 * period);
}

TEST(JointPlant, KeepsItsEnergyWithoutFriction) {
  SingleJoint joint(Frictionless(0.0), {});
  joint.Reset(0.3);
  joint.Step(kDt_s);
  const double start = Energy(joint, 0.6);
  double worst = 0.0;
  for (long k = 0; k < 600000; ++k) {
    joint.Step(kDt_s);
    worst = std::max(worst, std::abs(Energy(joint, 0.6) - start));
  }
  // Second order and symmetric: bounded by about Tg (w dt)^2, w = 2.1 rad/s; no drift over a
  // minute.
  EXPECT_LT(worst, 1e-6);
}

TEST(JointPlant, KeepsItsEnergyThroughElasticTeeth) {
  JointPlantConfig config;
  config.contact_damping_ratio = 0.0;
  SingleJoint joint(Frictionless(0.0464), config);
  joint.Reset(0.0);
  joint.Step(kDt_s);
  const double start = Energy(joint, 0.6);
  double worst = 0.0;
  for (long k = 0; k < 200000; ++k) {
    joint.Step(kDt_s);
    worst = std::max(worst, std::abs(Energy(joint, 0.6) - start));
  }
  // Teeth open and close hundreds of times; each switch between two steps errs by up to
  // k (v dt)^2 / 2 = 1e-4 J at 1 rad/s, of either sign. 1 % of the 1.2 J that are exchanged.
  EXPECT_LT(worst, 0.012);
}

TEST(JointPlant, OnlyLosesEnergyByFriction) {
  for (const double play : {0.0, 0.0464}) {
    JointModel model = Frictionless(play);
    Set(model, "motor_viscous", 0.05);
    Set(model, "coulomb", 0.02);
    Set(model, "stribeck", 0.05);
    Set(model, "quadratic_viscous", 0.02);
    SingleJoint joint(model, {});
    joint.Reset(0.4);
    joint.Step(kDt_s);
    double energy = Energy(joint, 0.6);
    const double start = energy;
    double lowest = energy;
    for (long k = 0; k < 100000; ++k) {
      joint.Step(kDt_s);
      energy = Energy(joint, 0.6);
      // With teeth: the error of a switch, see above. Without: that of the integrator.
      EXPECT_LE(energy, lowest + (play > 0.0 ? 2e-3 : 1e-6)) << k;
      lowest = std::min(lowest, energy);
    }
    EXPECT_LT(energy, start - 0.5);
  }
}

TEST(JointPlant, MovesTheMotorThroughThePlayBeforeTheLink) {
  constexpr double kPlay = 2.66 * M_PI / 180.0;
  JointModel model = Empty();
  model.backlash_rad = kPlay;
  Set(model, "drive_current", 1.0);
  Set(model, "rotor_inertia", 0.11);
  Set(model, "link_inertia", 0.02);
  Set(model, "motor_viscous", 0.3);
  Set(model, "coulomb", 0.2);
  SingleJoint joint(model, {});
  joint.Reset(0.0);
  // Push up until the link moves, then down until it moves back: the difference is the whole play.
  const auto gap_when_the_link_moves = [&](double torque_Nm) {
    joint.plant().SetCommand({.mode = types::ControlMode::kIdle});
    for (int k = 0; k < 20000; ++k) joint.Step(kDt_s);
    EXPECT_EQ(joint.velocity_rad_s(), 0.0);
    const double rest = joint.position_rad();
    joint.plant().SetCommand(
        {.mode = types::ControlMode::kTorque, .motor_torque_Nm = torque_Nm / 100.0});
    for (int k = 0; k < 100000 && joint.position_rad() == rest; ++k) joint.Step(kDt_s);
    return joint.plant().motor_position_rad() / 100.0 - rest;
  };
  const double up = gap_when_the_link_moves(0.25);
  const double down = gap_when_the_link_moves(-0.25);
  // 0.2 Nm of friction wind up teeth of 2e4 Nm/rad by 1e-5 rad; the impact by some more.
  EXPECT_NEAR(up - down, kPlay, 1e-3 * 0.5);
  EXPECT_NEAR(up, 0.5 * kPlay, 1e-3 * 0.5);
}

TEST(JointPlant, StandsExactlyStillUnderBreakaway) {
  for (const double play : {0.0, 0.0464}) {
    JointModel model = Empty();
    model.backlash_rad = play;
    Set(model, "drive_current", 1.0);
    Set(model, "rotor_inertia", 0.11);
    Set(model, "link_inertia", 0.02);
    Set(model, "motor_viscous", 0.3);
    Set(model, "coulomb", 0.2);
    Set(model, "stribeck", 1.0);
    SingleJoint joint(model, {});
    joint.Reset(0.1);
    // The gap closes gently first: an impact at full torque would break the link loose.
    for (int k = 0; k < 40000; ++k) {
      const double torque_Nm = k < 30000 ? 5e-5 : 5e-5 + (0.0119 - 5e-5) * (k - 30000) / 9999.0;
      joint.plant().SetCommand({.mode = types::ControlMode::kTorque, .motor_torque_Nm = torque_Nm});
      joint.Step(kDt_s);
    }
    for (int k = 0; k < 100000; ++k) {
      joint.Step(kDt_s);
      ASSERT_EQ(joint.position_rad(), 0.1);
      ASSERT_EQ(joint.velocity_rad_s(), 0.0);
    }
    joint.plant().SetCommand({.mode = types::ControlMode::kTorque, .motor_torque_Nm = 0.0121});
    for (int k = 0; k < 1000; ++k) joint.Step(kDt_s);
    EXPECT_GT(joint.position_rad(), 0.1);
  }
}

// What a term does to the simulation is what its regressors say: at every step that slides, the
// balance of the same model is zero, and least squares gives the term's parameters back.
class TermInSimulation : public ::testing::TestWithParam<const char*> {};

TEST_P(TermInSimulation, IsGivenBackByRegression) {
  for (const double play : {0.0, 0.0464}) {
    JointModel model = Rig(play);
    Set(model, GetParam(), 0.05);
    actuator::RemakeEffects(&model);
    actuator::Term& added = model.terms.back();
    for (std::size_t i = 1; i < added.linear.size(); ++i) added.linear[i].value = 0.03;
    if (std::string(GetParam()) == "torque_constant_saturation") added.linear[0].value = 1e-3;
    SingleJoint joint(model, {});
    joint.Reset(-0.4);
    const auto parameters = static_cast<Eigen::Index>(added.linear.size());
    std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
    effects::JointSample x;
    x.position_rad = -0.4;
    model.ResetMemory(x, memory);
    const std::vector<double> psi = actuator::NonlinearValues(added);
    std::vector<double> phi(added.linear.size());
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(parameters, parameters);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(parameters);
    double worst = 0.0;
    long used = 0;
    for (long k = 0; k < 30000; ++k) {
      const double t = static_cast<double>(k) * kDt_s;
      joint.plant().SetCommand(
          {.mode = types::ControlMode::kTorque,
           .motor_torque_Nm = 0.02 * std::sin(5.0 * t) + 0.012 * std::sin(17.0 * t)});
      const double payload_kg = k % 2000 < 1000 ? 0.3 : 0.1;
      joint.plant().SetLoad(0.5 * std::sin(3.0 * t), payload_kg);
      x.pressure_bar = 3.0 + std::sin(2.0 * t);
      x.pressure_rate_bar_s = 2.0 * std::cos(2.0 * t);
      joint.plant().SetPressure(x.pressure_bar, x.pressure_rate_bar_s);
      joint.plant().SetMotorTemperature(25.0 + 3.0 * t);
      const double q0 = joint.position_rad(), v0 = joint.velocity_rad_s();
      const double m0 = joint.plant().motor_position_rad(),
                   w0 = joint.plant().motor_velocity_rad_s();
      joint.Step(kDt_s);
      // The step's forces act at half its motion, with the velocities of its start.
      x.position_rad = q0 + 0.5 * kDt_s * v0;
      x.motor_position_rad = m0 + 0.5 * kDt_s * w0;
      x.velocity_rad_s = v0;
      x.motor_velocity_rad_s = w0;
      x.acceleration_rad_s2 = joint.acceleration_rad_s2();
      x.motor_acceleration_rad_s2 = (joint.plant().motor_velocity_rad_s() - w0) / kDt_s;
      x.drive_input = joint.plant().drive_input();
      x.load_force_N = 0.5 * std::sin(3.0 * t);
      x.payload_kg = payload_kg;
      x.temperature_degC = 25.0 + 3.0 * t;
      const bool slides = v0 * joint.velocity_rad_s() > 0.0 &&
                          (play == 0.0 || w0 * joint.plant().motor_velocity_rad_s() > 0.0);
      if (slides) {
        ++used;
        const double residual = model.Residual(x, memory);
        worst = std::max(worst, std::abs(residual));
        const auto part = std::span<const double>(memory).last(
            static_cast<std::size_t>(added.effect->memory_size()));
        added.effect->Regressors(x, psi, part, phi);
        double with = 0.0;
        for (std::size_t i = 0; i < phi.size(); ++i) with += added.linear[i].value * phi[i];
        for (Eigen::Index i = 0; i < parameters; ++i) {
          for (Eigen::Index j = 0; j < parameters; ++j) {
            normal(i, j) += phi[static_cast<std::size_t>(i)] * phi[static_cast<std::size_t>(j)];
          }
          right[i] += phi[static_cast<std::size_t>(i)] * (with - residual);
        }
      }
      x.position_rad = joint.position_rad();
      model.Advance(x, kDt_s, memory);
    }
    EXPECT_GT(used, 20000);
    // Velocity differences over 1e-4 s of numbers around 1: rounding 1e-12; motor side 100 times
    // that.
    EXPECT_LT(worst, 1e-9) << "play " << play;
    const Eigen::VectorXd found = normal.ldlt().solve(right);
    for (Eigen::Index i = 0; i < parameters; ++i) {
      EXPECT_NEAR(found[i], added.linear[static_cast<std::size_t>(i)].value, 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, TermInSimulation,
                         ::testing::Values("viscous", "offset", "stribeck", "quadratic_viscous",
                                           "direction_dependent_viscous",
                                           "direction_dependent_quadratic_viscous",
                                           "direction_dependent_coulomb", "load_dependent_friction",
                                           "drive_efficiency_direction", "temperature_friction",
                                           "pressure_dependent_friction", "seal_hysteresis",
                                           "cogging", "gear_eccentricity", "payload",
                                           "gravity_phase", "current_offset",
                                           "torque_constant_gain", "torque_constant_saturation",
                                           "pressure_gain", "pressure_offset", "pressure_lag"),
                         [](const auto& which) { return std::string(which.param); });

// Jerk and snap terms: a forced oscillation well below the filter obeys the model's own frequency
// response.
TEST(JointPlant, AnswersASineAsItsElasticTermsSay) {
  struct Case {
    const char* effect;
    double value;
  };
  for (const Case& c : {Case{"elastic_joint", 2e-4}, Case{"elastic_joint", -2e-4},
                        Case{"gear_compliance", 2e-6}, Case{"gear_compliance", -2e-6}}) {
    JointModel model = Empty();
    Set(model, "drive_current", 1.0);
    Set(model, "inertia", 0.1);
    Set(model, "viscous", 0.5);
    Set(model, c.effect, c.value);
    SingleJoint joint(model, {});
    joint.Reset(0.0);
    constexpr double kOmega = 20.0;
    double cosine = 0.0, sine = 0.0;
    const long settle = std::lround(3.0 / kDt_s),
               whole = std::lround(10.0 * 2.0 * M_PI / kOmega / kDt_s);
    for (long k = 0; k < settle + whole; ++k) {
      const double t = (static_cast<double>(k) + 0.5) * kDt_s;
      joint.plant().SetCommand(
          {.mode = types::ControlMode::kTorque, .motor_torque_Nm = 0.01 * std::cos(kOmega * t)});
      joint.Step(kDt_s);
      if (k < settle) continue;
      const double end = t + 0.5 * kDt_s;
      cosine += 2.0 / static_cast<double>(whole) * joint.velocity_rad_s() * std::cos(kOmega * end);
      sine += 2.0 / static_cast<double>(whole) * joint.velocity_rad_s() * std::sin(kOmega * end);
    }
    // 1 = (J i w + B + c (i w)^2 or d (i w)^3) V, torque amplitude 1 Nm.
    const bool jerk = std::string(c.effect) == "elastic_joint";
    const double real = 0.5 - (jerk ? c.value * kOmega * kOmega : 0.0);
    const double imaginary = 0.1 * kOmega - (jerk ? 0.0 : c.value * kOmega * kOmega * kOmega);
    const double size = real * real + imaginary * imaginary;
    // Tolerance: the filter turns the term by w tau (twice for snap), where tau is 1 ms or, for
    // negative terms, what stability needs; 2e-4 for the step and the sampling of whole periods.
    const double tau = std::max(1e-3, c.value > 0.0 ? 0.0
                                      : jerk        ? -20.0 * c.value
                                                    : std::sqrt(-40.0 * c.value));
    const double turned = (jerk ? 1.0 : 2.0) * kOmega * tau;
    ASSERT_LT(turned, 0.5);
    const double term = std::abs(c.value) * kOmega * kOmega * (jerk ? 1.0 : kOmega) / size;
    EXPECT_NEAR(cosine, real / size, turned * term + 2e-4) << c.effect << c.value;
    EXPECT_NEAR(sine, imaginary / size, turned * term + 2e-4) << c.effect << c.value;
  }
}

// 0.04 of 0.1 kg m2 on a spring: 0.06 a + 0.04 p'' = torque, p'' = w^2 (q - p) + 2 z w (v - p').
TEST(JointPlant, MovesALinkOnASpringAsTwoMasses) {
  JointModel model = Empty();
  Set(model, "drive_current", 1.0);
  Set(model, "inertia", 0.1);
  Set(model, "flexible_link", 0.04);
  SingleJoint joint(model, {});
  joint.Reset(0.0);
  const double w = 2.0 * M_PI * 10.0;
  const double z = 0.05;
  double q = 0.0, v = 0.0, p = 0.0, u = 0.0;
  double largest = 0.0;
  double apart = 0.0;
  for (long k = 0; k < 40000; ++k) {
    const double t = (static_cast<double>(k) + 0.5) * kDt_s;
    const double torque = 0.01 * std::cos(30.0 * t);
    joint.plant().SetCommand({.mode = types::ControlMode::kTorque, .motor_torque_Nm = torque});
    joint.Step(kDt_s);
    constexpr int kParts = 10;
    for (int i = 0; i < kParts; ++i) {
      const double h = kDt_s / kParts;
      const double spring = 0.04 * (w * w * (p - q) + 2.0 * z * w * (u - v));
      const double ratio = model.constants.gear_ratio;
      v += h * (ratio * torque + spring) / 0.06;
      u -= h * spring / 0.04;
      q += h * v;
      p += h * u;
    }
    largest = std::max(largest, std::abs(v));
    apart = std::max(apart, std::abs(v - joint.velocity_rad_s()));
  }
  EXPECT_GT(largest, 1e-3);
  EXPECT_LT(apart, 0.03 * largest);
}

TEST(JointPlant, DelaysTheDriveByTheTransportDelay) {
  JointModel model = Empty();
  Set(model, "drive_current", 0.8);
  Set(model, "inertia", 0.1);
  Set(model, "transport_delay", 0.8 * 2e-3);
  SingleJoint joint(model, {});
  // A ramp of torque: velocity lags the undelayed one by J^-1 * slope * (t T - T^2).
  double t = 0.0;
  for (long k = 0; k < 10000; ++k) {
    joint.plant().SetCommand(
        {.mode = types::ControlMode::kTorque, .motor_torque_Nm = 0.01 * t / 0.8});
    joint.Step(kDt_s);
    t += kDt_s;
  }
  const double undelayed = 0.5 * t * t / 0.1;
  EXPECT_NEAR(undelayed - joint.velocity_rad_s(), (t * 2e-3 - 4e-6) / 0.1, 6e-4);
}

TEST(JointPlant, HoldsAPositionAgainstGravity) {
  for (const double play : {0.0, 0.0464}) {
    SingleJoint joint(Rig(play), {});
    joint.Reset(-1.0);
    joint.plant().SetCommand({.mode = types::ControlMode::kPosition, .position_rad = 0.3});
    for (int k = 0; k < 50000; ++k) joint.Step(kDt_s);
    EXPECT_NEAR(joint.plant().motor_position_rad(), 30.0, 0.01);
    EXPECT_NEAR(joint.position_rad(), 0.3, 0.5 * play + 1e-3);
  }
}

TEST(JointPlant, FollowsAVelocity) {
  SingleJoint joint(Rig(0.0464), {});
  joint.Reset(-1.0);
  joint.plant().SetCommand({.mode = types::ControlMode::kVelocity, .velocity_rad_s = 0.5});
  for (int k = 0; k < 20000; ++k) joint.Step(kDt_s);
  EXPECT_NEAR(joint.plant().motor_velocity_rad_s(), 50.0, 0.5);
}

TEST(JointPlant, LimitsTheMotorTorque) {
  JointModel model = Rig(0.0);
  model.motor_torque_limit_Nm = 0.398;
  SingleJoint joint(model, {});
  joint.plant().SetCommand({.mode = types::ControlMode::kTorque, .motor_torque_Nm = 5.0});
  joint.Step(kDt_s);
  EXPECT_NEAR(joint.plant().drive_input(), 0.398 / 0.0159155, 1e-9);
}

TEST(JointPlant, TakesANonFiniteCommandAsIdle) {
  SingleJoint joint(Rig(0.0464), {});
  joint.plant().SetCommand({.mode = types::ControlMode::kTorque,
                            .motor_torque_Nm = std::numeric_limits<double>::quiet_NaN()});
  for (int k = 0; k < 100; ++k) joint.Step(kDt_s);
  EXPECT_EQ(joint.plant().drive_input(), 0.0);
  EXPECT_TRUE(std::isfinite(joint.position_rad()));
}

TEST(JointPlant, StaysFiniteAndAllocatesNothingInALongRun) {
  JointModel model = Rig(0.0464);
  for (const char* effect : {"stribeck", "seal_hysteresis", "cogging", "load_dependent_friction"}) {
    Set(model, effect, 0.05);
  }
  SingleJoint joint(model, {});
  joint.plant().SetPressure(4.0, 0.0);
  const long before = allocations;
  for (long k = 0; k < 1000000; ++k) {
    joint.plant().SetCommand(
        {.mode = types::ControlMode::kTorque,
         .motor_torque_Nm = 0.05 * std::sin(3.0 * static_cast<double>(k) * kDt_s)});
    joint.Step(kDt_s);
  }
  EXPECT_EQ(allocations - before, 0);
  EXPECT_LT(std::abs(joint.position_rad()), 10.0);
}

TEST(JointPlant, RefusesWhatCannotBe) {
  JointModel no_rotor = Empty();
  no_rotor.backlash_rad = 0.04;
  Set(no_rotor, "drive_current", 1.0);
  Set(no_rotor, "link_inertia", 0.02);
  EXPECT_THROW(JointPlant(no_rotor, {}), std::invalid_argument);
  JointModel no_link = Empty();
  Set(no_link, "drive_current", 1.0);
  EXPECT_THROW(SingleJoint(no_link, {}), std::invalid_argument);
  JointPlantConfig config;
  config.position_gain_1_s = -1.0;
  EXPECT_THROW(JointPlant(Rig(0.0), config), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::plant
