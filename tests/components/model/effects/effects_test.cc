// Laws that hold for every effect of the catalogue, and closed forms of single ones.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>

#include "components/model/effects/effect.h"

namespace sinew::effects {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

JointConstants RigConstants() {
  return {.gear_ratio = 100.0,
          .link_length_m = 0.3,
          .gravity_m_s2 = 9.81,
          .torque_constant_Nm_A = 0.0159155,
          .force_constant_N_V = 0.0,
          .pneumatic_torque_Nm_bar = 0.4,
          .pneumatic_stiffness_Nm_rad_bar = 3.0,
          .pneumatic_rest_rad = 0.2};
}

// Field of a sample by its name in EffectInfo::needs; nullptr: no such field.
double* Field(JointSample& x, const std::string& name) {
  if (name == "time_s") return &x.time_s;
  if (name == "position_rad") return &x.position_rad;
  if (name == "velocity_rad_s") return &x.velocity_rad_s;
  if (name == "acceleration_rad_s2") return &x.acceleration_rad_s2;
  if (name == "jerk_rad_s3") return &x.jerk_rad_s3;
  if (name == "snap_rad_s4") return &x.snap_rad_s4;
  if (name == "motor_position_rad") return &x.motor_position_rad;
  if (name == "motor_velocity_rad_s") return &x.motor_velocity_rad_s;
  if (name == "motor_acceleration_rad_s2") return &x.motor_acceleration_rad_s2;
  if (name == "drive_input") return &x.drive_input;
  if (name == "drive_rate") return &x.drive_rate;
  if (name == "pressure_bar") return &x.pressure_bar;
  if (name == "pressure_rate_bar_s") return &x.pressure_rate_bar_s;
  if (name == "load_force_N") return &x.load_force_N;
  if (name == "payload_kg") return &x.payload_kg;
  if (name == "temperature_degC") return &x.temperature_degC;
  if (name == "rigid_torque_Nm") return &x.rigid_torque_Nm;
  if (name == "volume_rate_1_s") return &x.volume_rate_1_s;
  if (name == "valve_flow_bar") return &x.valve_flow_bar;
  if (name == "valve_flow_rate_bar_s") return &x.valve_flow_rate_bar_s;
  if (name == "tooth_torque_Nm") return &x.tooth_torque_Nm;
  if (name == "tooth_side") return &x.tooth_side;
  return nullptr;
}

const std::vector<std::string>& AllFields() {
  static const std::vector<std::string> kFields = {"time_s",
                                                   "position_rad",
                                                   "velocity_rad_s",
                                                   "acceleration_rad_s2",
                                                   "jerk_rad_s3",
                                                   "snap_rad_s4",
                                                   "motor_position_rad",
                                                   "motor_velocity_rad_s",
                                                   "motor_acceleration_rad_s2",
                                                   "drive_input",
                                                   "drive_rate",
                                                   "pressure_bar",
                                                   "pressure_rate_bar_s",
                                                   "load_force_N",
                                                   "payload_kg",
                                                   "temperature_degC",
                                                   "rigid_torque_Nm",
                                                   "volume_rate_1_s",
                                                   "valve_flow_bar",
                                                   "valve_flow_rate_bar_s",
                                                   "tooth_torque_Nm",
                                                   "tooth_side"};
  return kFields;
}

std::vector<double> DefaultNonlinear(const Effect& effect) {
  std::vector<double> psi;
  for (const ParameterInfo& info : effect.info().nonlinear) psi.push_back(info.default_value);
  return psi;
}

struct Evaluator {
  explicit Evaluator(const Effect& of)
      : effect(of),
        psi(DefaultNonlinear(of)),
        memory(static_cast<std::size_t>(of.memory_size())),
        phi(of.info().linear.size()) {}

  const std::vector<double>& operator()(const JointSample& x) {
    effect.Regressors(x, psi, memory, phi);
    return phi;
  }

  const Effect& effect;
  std::vector<double> psi, memory, phi;
};

JointSample RandomSample(std::mt19937& random) {
  std::normal_distribution<double> normal;
  JointSample x;
  for (const std::string& field : AllFields()) *Field(x, field) = normal(random);
  x.pressure_bar = 3.0 + std::abs(x.pressure_bar);
  x.temperature_degC = 40.0 + 5.0 * x.temperature_degC;
  x.motor_position_rad *= 50.0;
  return x;
}

class EveryEffect : public ::testing::TestWithParam<EffectForm> {
 protected:
  std::unique_ptr<Effect> effect_ = MakeEffect(GetParam().name, RigConstants(), GetParam().balance);
};

TEST_P(EveryEffect, IsDescribedWholly) {
  const EffectInfo& info = effect_->info();
  EXPECT_EQ(info.name, GetParam().name);
  EXPECT_EQ(info.balance, GetParam().balance);
  EXPECT_FALSE(info.title.empty());
  EXPECT_FALSE(info.formula.empty());
  EXPECT_FALSE(info.source.empty());
  EXPECT_FALSE(info.signature.empty());
  EXPECT_FALSE(info.variable.empty());
  ASSERT_FALSE(info.linear.empty());
  EXPECT_LE(info.linear.size(), static_cast<std::size_t>(kMaxParameters));
  EXPECT_LE(info.nonlinear.size(), static_cast<std::size_t>(kMaxParameters));
  EXPECT_LE(effect_->memory_size(), kMaxParameters);
  JointSample x;
  for (const std::string& need : info.needs) EXPECT_NE(Field(x, need), nullptr) << need;
  const std::vector<std::string> names = EffectNames();
  for (const std::string& other : info.confounders) {
    EXPECT_THAT(names, ::testing::Contains(other));
    EXPECT_NE(other, info.name);
  }
  EXPECT_EQ(info.confounders.empty(), info.separating_excitation.empty());
}

TEST_P(EveryEffect, HasParametersInRangeAndGridsForNonlinearOnes) {
  std::set<std::string> names;
  for (const ParameterInfo& p : effect_->info().linear) {
    EXPECT_LT(p.lower, p.upper) << p.name;
    EXPECT_GE(p.default_value, p.lower) << p.name;
    EXPECT_LE(p.default_value, p.upper) << p.name;
    EXPECT_FALSE(p.meaning.empty()) << p.name;
    EXPECT_TRUE(p.grid.empty()) << p.name;
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
  }
  for (const ParameterInfo& p : effect_->info().nonlinear) {
    EXPECT_FALSE(p.grid.empty()) << p.name;
    EXPECT_TRUE(std::is_sorted(p.grid.begin(), p.grid.end())) << p.name;
    EXPECT_GE(p.grid.front(), p.lower) << p.name;
    EXPECT_LE(p.grid.back(), p.upper) << p.name;
    EXPECT_GE(p.default_value, p.lower) << p.name;
    EXPECT_LE(p.default_value, p.upper) << p.name;
    EXPECT_TRUE(names.insert(p.name).second) << p.name;
  }
}

// What least squares can separate: over random states no column of an effect is a combination of
// its others. The smallest singular value of the scaled columns is far above rounding.
TEST_P(EveryEffect, HasColumnsThatLeastSquaresCanSeparate) {
  std::mt19937 random(7);
  const Effect& effect = *effect_;
  Evaluator evaluate(effect);
  const auto columns = static_cast<Eigen::Index>(effect.info().linear.size());
  constexpr Eigen::Index kRows = 500;
  Eigen::MatrixXd regressors(kRows, columns);
  JointSample x = RandomSample(random);
  effect.ResetMemory(x, evaluate.psi, evaluate.memory);
  for (Eigen::Index k = 0; k < kRows; ++k) {
    x = RandomSample(random);
    x.position_rad *= 0.1;
    x.valve_open = k % 3 == 0;  // what a valve lets in is remembered, the rest is not assessed
    effect.Advance(x, 1e-3, evaluate.psi, evaluate.memory);
    x.valve_open = false;
    const std::vector<double>& phi = evaluate(x);
    for (Eigen::Index i = 0; i < columns; ++i) {
      regressors(k, i) = phi[static_cast<std::size_t>(i)];
    }
  }
  const Eigen::VectorXd size = regressors.colwise().norm();
  ASSERT_GT(size.minCoeff(), 0.0) << "a column that is zero everywhere";
  const Eigen::MatrixXd scaled = regressors * size.cwiseInverse().asDiagonal();
  EXPECT_GT(scaled.jacobiSvd().singularValues().minCoeff(), 1e-3);
}

TEST_P(EveryEffect, ReadsWhatItNeedsAndNothingElse) {
  std::mt19937 random(3);
  Evaluator evaluate(*effect_);
  std::vector<std::string> needs = effect_->info().needs;
  for (const std::string& field : effect_->info().may_read) needs.push_back(field);
  for (const std::string& field : AllFields()) {
    const bool needed = std::find(needs.begin(), needs.end(), field) != needs.end();
    bool changed = false;
    for (int trial = 0; trial < 20; ++trial) {
      JointSample x = RandomSample(random);
      effect_->ResetMemory(x, evaluate.psi, evaluate.memory);
      // A stroke first, so that memory is not at rest; the valve may be open for it.
      x.position_rad += 0.01;
      x.valve_open = trial % 4 < 2;
      effect_->Advance(x, 1e-3, evaluate.psi, evaluate.memory);
      const std::vector<double> memory_before = evaluate.memory;
      const auto a_step_on = [&] {
        evaluate.memory = memory_before;
        effect_->Advance(x, 1e-3, evaluate.psi, evaluate.memory);
        const bool open = std::exchange(x.valve_open, false);
        const std::vector<double> phi = evaluate(x);
        x.valve_open = open;
        return phi;
      };
      const std::vector<double> before = a_step_on();
      *Field(x, field) = trial % 2 == 0 ? 0.0 : -1.3 * *Field(x, field) + 0.1;
      changed |= a_step_on() != before;
    }
    EXPECT_EQ(changed, needed) << field;
  }
}

TEST_P(EveryEffect, AnswersNonFiniteInputWithNonFiniteOutput) {
  std::mt19937 random(5);
  for (const std::string& need : effect_->info().needs) {
    for (const double bad : {kNaN, std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
      Evaluator evaluate(*effect_);
      JointSample x = RandomSample(random);
      effect_->ResetMemory(x, evaluate.psi, evaluate.memory);
      *Field(x, need) = bad;
      effect_->Advance(x, 1e-3, evaluate.psi, evaluate.memory);
      const std::vector<double>& phi = evaluate(x);
      EXPECT_TRUE(std::any_of(phi.begin(), phi.end(), [](double v) { return !std::isfinite(v); }))
          << need << " = " << bad;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect, ::testing::ValuesIn(EffectForms()),
                         [](const auto& which) {
                           return which.param.name + "_" +
                                  std::string(BalanceName(which.param.balance));
                         });

TEST(EffectForms, AreDifferentAndTheFirstOfANameIsTheDefault) {
  std::set<std::pair<std::string, Balance>> seen;
  std::set<std::string> names;
  for (const EffectForm& form : EffectForms()) {
    EXPECT_TRUE(seen.insert({form.name, form.balance}).second) << form.name;
    if (names.insert(form.name).second) {
      EXPECT_EQ(MakeEffect(form.name, RigConstants())->info().balance, form.balance) << form.name;
    }
  }
  EXPECT_EQ(names.size(), EffectNames().size());
  EXPECT_EQ(MakeEffect("gear_compliance", {}, Balance::kKinematic)->info().balance,
            Balance::kKinematic);
  EXPECT_THROW(MakeEffect("coulomb", {}, Balance::kKinematic), std::invalid_argument);
}

// Effects whose torque never adds energy for non-negative parameters.
class FrictionEffect : public ::testing::TestWithParam<std::string> {};

TEST_P(FrictionEffect, NeverAddsEnergyAndIsZeroAtZeroVelocity) {
  const auto effect = MakeEffect(GetParam(), RigConstants());
  Evaluator evaluate(*effect);
  std::mt19937 random(11);
  for (int i = 0; i < 1000; ++i) {
    JointSample x = RandomSample(random);
    x.motor_velocity_rad_s = 100.0 * x.velocity_rad_s;
    for (const double phi : evaluate(x)) EXPECT_LE(phi * x.velocity_rad_s, 0.0);
    x.velocity_rad_s = x.motor_velocity_rad_s = 0.0;
    for (const double phi : evaluate(x)) EXPECT_EQ(phi, 0.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, FrictionEffect,
                         ::testing::Values("viscous", "motor_viscous", "coulomb", "stribeck",
                                           "quadratic_viscous", "load_dependent_friction",
                                           "pressure_dependent_friction"),
                         [](const auto& which) { return which.param; });

class EvenEffect : public ::testing::TestWithParam<std::string> {};

TEST_P(EvenEffect, IsTheSameInBothDirectionsAndZeroAtRest) {
  const auto effect = MakeEffect(GetParam(), RigConstants());
  Evaluator evaluate(*effect);
  JointSample up, down, rest;
  up.velocity_rad_s = 0.4;
  down.velocity_rad_s = -0.4;
  EXPECT_EQ(evaluate(up)[0], evaluate(down)[0]);
  EXPECT_LT(evaluate(up)[0], 0.0);
  EXPECT_EQ(evaluate(rest)[0], 0.0);
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EvenEffect,
                         ::testing::Values("direction_dependent_viscous",
                                           "direction_dependent_quadratic_viscous",
                                           "direction_dependent_coulomb"),
                         [](const auto& which) { return which.param; });

TEST(Stribeck, FallsToOneOverEAtItsVelocity) {
  const auto effect = MakeEffect("stribeck", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.velocity_rad_s = evaluate.psi[0];
  EXPECT_DOUBLE_EQ(evaluate(x)[0], -std::exp(-1.0));
}

TEST(SealHysteresis, ClosesItsLoopAndLosesEnergyInIt) {
  const auto effect = MakeEffect("seal_hysteresis", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.pressure_bar = 4.0;
  effect->ResetMemory(x, evaluate.psi, evaluate.memory);
  constexpr int kSamplesPerCycle = 4000;
  double end_of_cycle[6] = {};
  double work = 0.0;
  for (int cycle = 0; cycle < 6; ++cycle) {
    work = 0.0;
    for (int k = 1; k <= kSamplesPerCycle; ++k) {
      const double before = x.position_rad;
      x.position_rad = 0.1 * std::sin(2.0 * M_PI * k / kSamplesPerCycle);
      effect->Advance(x, 1e-3, evaluate.psi, evaluate.memory);
      work += evaluate(x)[0] * (x.position_rad - before);
      ASSERT_LE(std::abs(evaluate.memory[0]), 1.0);
    }
    end_of_cycle[cycle] = evaluate.memory[0];
  }
  // The first cycle starts from z = 0; afterwards the loop repeats to rounding (exp(-0.4 / 0.03) =
  // 2e-6).
  EXPECT_NEAR(end_of_cycle[5], end_of_cycle[4], 1e-9);
  EXPECT_LT(work, 0.0);
}

TEST(SealHysteresis, FollowsTheDahlEquation) {
  const auto effect = MakeEffect("seal_hysteresis", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.pressure_bar = 1.0;
  effect->ResetMemory(x, evaluate.psi, evaluate.memory);
  const double xs = evaluate.psi[0];
  x.position_rad = 0.5 * xs;
  effect->Advance(x, 1.0, evaluate.psi, evaluate.memory);
  EXPECT_DOUBLE_EQ(evaluate.memory[0], 1.0 - std::exp(-0.5));
  // One stroke or a hundred of the same sum: the closed form composes.
  std::vector<double> whole = evaluate.memory;
  for (int i = 1; i <= 100; ++i) {
    x.position_rad = 0.5 * xs - 0.01 * i * xs;
    effect->Advance(x, 1.0, evaluate.psi, evaluate.memory);
  }
  effect->Advance(x, 1.0, evaluate.psi, whole);
  EXPECT_NEAR(evaluate.memory[0], whole[0], 1e-12);
}

TEST(Presliding, ReplacesTheStepOfCoulombFrictionByDahlsCurve) {
  const auto presliding = MakeEffect("presliding", RigConstants());
  const auto coulomb = MakeEffect("coulomb", RigConstants());
  Evaluator evaluate(*presliding), evaluate_coulomb(*coulomb);
  JointSample x;
  x.velocity_rad_s = 0.1;
  presliding->ResetMemory(x, evaluate.psi, evaluate.memory);
  const double xs = evaluate.psi[0];
  double before = 0.0;
  for (int i = 1; i <= 50; ++i) {
    x.position_rad = 0.1 * i * xs;
    presliding->Advance(x, 1e-3, evaluate.psi, evaluate.memory);
    const double friction = evaluate(x)[0] + evaluate_coulomb(x)[0];
    EXPECT_NEAR(friction, -(1.0 - std::exp(-0.1 * i)), 1e-12);
    EXPECT_LT(friction, before);
    before = friction;
  }
}

TEST(PayloadStep, IsAPayloadFromItsStartOn) {
  const auto step = MakeEffect("payload_step", RigConstants());
  const auto payload = MakeEffect("payload", RigConstants());
  Evaluator evaluate_step(*step), evaluate_payload(*payload);
  evaluate_step.psi[0] = 12.0;
  JointSample x;
  x.position_rad = 0.4;
  x.acceleration_rad_s2 = -2.0;
  x.time_s = 11.999;
  EXPECT_EQ(evaluate_step(x)[0], 0.0);
  x.time_s = 12.0;
  EXPECT_EQ(evaluate_step(x)[0], evaluate_payload(x)[0]);
}

TEST(ExternalBump, PeaksInItsMiddleAndIsOverAtItsEnd) {
  const auto effect = MakeEffect("external_bump", RigConstants());
  Evaluator evaluate(*effect);
  evaluate.psi = {3.0, 0.5};
  JointSample x;
  x.time_s = 3.25;
  EXPECT_NEAR(evaluate(x)[0], 1.0, 1e-12);
  for (const double outside : {2.9, 3.0, 3.5, 3.6, 4.0}) {
    x.time_s = outside;
    EXPECT_NEAR(evaluate(x)[0], 0.0, 1e-12) << outside;
  }
}

TEST(LoadCellMisalignment, AForceThatKeepsItsDirectionHasTheArmOfTheCosine) {
  const auto effect = MakeEffect("load_cell_misalignment", RigConstants());
  const auto declared = MakeEffect("load_force", RigConstants());
  Evaluator evaluate(*effect), evaluate_declared(*declared);
  JointSample x;
  x.load_force_N = 7.0;
  x.position_rad = 0.6;
  // F l cos(q - d) = cos d (F l - F l (1 - cos q)) + sin d F l sin q.
  const double tilt = 0.2;
  const double torque =
      std::cos(tilt) * (evaluate_declared(x)[0] - evaluate(x)[1]) + std::sin(tilt) * evaluate(x)[0];
  EXPECT_NEAR(torque, -7.0 * 0.3 * std::cos(0.6 - tilt), 1e-12);
}

TEST(StiffnessCollapse, IsGoneAtHighPressureAndTakesTheWholeTorqueAtLow) {
  const auto effect = MakeEffect("stiffness_collapse", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.position_rad = 0.5;
  x.pressure_bar = 1e-3;
  const double torque_Nm = x.pressure_bar * TorquePerBar(RigConstants(), x.position_rad);
  EXPECT_NEAR(evaluate(x)[0] / torque_Nm, -1.0, 2e-3);
  x.pressure_bar = 20.0;
  EXPECT_LT(std::abs(evaluate(x)[0]), 1e-8);
}

// What a sensor misreads is what the model's own torque changes by, also where it turns its sign.
TEST(PressureErrors, AreTheChangeOfTheDeclaredTorque) {
  const effects::JointConstants c = RigConstants();
  const auto torque_Nm = [&](double pressure_bar, double q) {
    return c.pneumatic_torque_Nm_bar * pressure_bar -
           c.pneumatic_stiffness_Nm_rad_bar * pressure_bar * (q - c.pneumatic_rest_rad);
  };
  for (const double q : {-0.4, 0.2, 0.33, 0.6}) {
    JointSample x;
    x.position_rad = q;
    x.pressure_bar = 2.5;
    x.pressure_rate_bar_s = -4.0;
    const double offset_bar = 0.1, gain = 0.05, lag_s = 0.02;
    EXPECT_NEAR(offset_bar * Evaluator(*MakeEffect("pressure_offset", c))(x)[0],
                torque_Nm(2.5 - offset_bar, q) - torque_Nm(2.5, q), 1e-12);
    EXPECT_NEAR(gain * Evaluator(*MakeEffect("pressure_gain", c))(x)[0],
                torque_Nm(2.5 * (1.0 - gain), q) - torque_Nm(2.5, q), 1e-12);
    EXPECT_NEAR(lag_s * Evaluator(*MakeEffect("pressure_lag", c))(x)[0],
                torque_Nm(2.5 - 4.0 * lag_s, q) - torque_Nm(2.5, q), 1e-12);
  }
}

TEST(DriveEfficiencyDirection, ActsOnlyWhileTheLoadDrivesTheMotor) {
  const auto effect = MakeEffect("drive_efficiency_direction", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.drive_input = 2.0;
  x.velocity_rad_s = 1.0;
  EXPECT_EQ(evaluate(x)[0], 0.0);
  x.velocity_rad_s = -1.0;
  EXPECT_DOUBLE_EQ(evaluate(x)[0], 100.0 * 0.0159155 * 2.0);
}

TEST(Cogging, RepeatsAfterOneOrderOfAMotorTurn) {
  const auto effect = MakeEffect("cogging", RigConstants());
  Evaluator evaluate(*effect);
  JointSample x;
  x.motor_position_rad = 0.7;
  const std::vector<double> before = evaluate(x);
  x.motor_position_rad += 2.0 * M_PI / evaluate.psi[0];
  EXPECT_NEAR(evaluate(x)[0], before[0], 1e-12);
  EXPECT_NEAR(evaluate(x)[1], before[1], 1e-12);
}

TEST(Spring, RestsAtItsRestAngleAndKeepsItsEnergyInACycle) {
  const auto effect = MakeEffect("spring", RigConstants());
  Evaluator evaluate(*effect);
  constexpr double kStiffness = 3.0, kRest = 0.4;
  const auto torque = [&](double position) {
    JointSample x;
    x.position_rad = position;
    const std::vector<double>& phi = evaluate(x);
    return kStiffness * phi[0] + kStiffness * kRest * phi[1];
  };
  EXPECT_DOUBLE_EQ(torque(kRest), 0.0);
  EXPECT_DOUBLE_EQ(torque(kRest + 0.5), -1.5);
  double work = 0.0;
  constexpr int kSteps = 1000;
  for (int k = 0; k < kSteps; ++k) {
    const double a = std::sin(2.0 * M_PI * k / kSteps);
    const double b = std::sin(2.0 * M_PI * (k + 1) / kSteps);
    work += 0.5 * (torque(a) + torque(b)) * (b - a);
  }
  EXPECT_NEAR(work, 0.0, 1e-12);
}

TEST(Payload, EqualsADeclaredPayloadOfTheSameMass) {
  const auto hidden = MakeEffect("payload", RigConstants());
  const auto declared = MakeEffect("declared_payload", RigConstants());
  Evaluator evaluate_hidden(*hidden), evaluate_declared(*declared);
  std::mt19937 random(2);
  JointSample x = RandomSample(random);
  x.payload_kg = 0.5;
  EXPECT_DOUBLE_EQ(0.5 * evaluate_hidden(x)[0], evaluate_declared(x)[0]);
}

// A drive input sin(w t) that acts T late: first order of the difference. Error bound (w T)^2 / 2.
TEST(TransportDelay, IsTheFirstOrderOfALateDrive) {
  const auto effect = MakeEffect("transport_delay", RigConstants());
  const std::vector<double> no_span = {0.0};
  std::vector<double> memory(static_cast<std::size_t>(effect->memory_size()));
  constexpr double kOmega = 10.0, kDelay = 1e-3, kGain = 1.59155;
  for (double t = 0.0; t < 1.0; t += 0.01) {
    JointSample x;
    x.drive_rate = kOmega * std::cos(kOmega * t);
    effect->Advance(x, 0.01, no_span, memory);
    double phi = 0.0;
    effect->Regressors(x, no_span, memory, {&phi, 1});
    const double late = kGain * std::sin(kOmega * (t - kDelay));
    const double modelled = kGain * std::sin(kOmega * t) + kDelay * phi;
    EXPECT_NEAR(modelled, late, kGain * 0.5 * kOmega * kDelay * kOmega * kDelay);
  }
}

// A step of the drive that acts late: its torque is that of the delayed step, except for the width
// of the delay itself.
TEST(TransportDelay, WithASpanIsTheDelayedDriveBeyondItsFirstOrder) {
  const auto effect = MakeEffect("transport_delay", RigConstants());
  constexpr double kDelay = 0.02, kStep = 1e-4, kGain = 1.59155, kOmega = 60.0;
  const std::vector<double> psi = {kDelay};
  std::vector<double> memory(static_cast<std::size_t>(effect->memory_size()));
  JointSample x;
  double phi = 0.0, worst = 0.0, first_order = 0.0;
  for (double t = 0.0; t < 1.0; t += kStep) {
    x.drive_rate = kOmega * std::cos(kOmega * t);
    if (t == 0.0) {
      effect->ResetMemory(x, psi, memory);
    } else {
      effect->Advance(x, kStep, psi, memory);
    }
    if (t < 5.0 * kDelay) continue;  // settled
    effect->Regressors(x, psi, memory, {&phi, 1});
    const double late = kGain * std::sin(kOmega * (t - kDelay));
    const double now = kGain * std::sin(kOmega * t);
    worst = std::max(worst, std::abs(now + kDelay * phi - late));
    first_order = std::max(first_order, std::abs(now - kDelay * kGain * x.drive_rate - late));
  }
  // |(1 + s T / 4)^-4 - exp(-s T)| at s T = 1.2 j, and the first order's.
  EXPECT_LT(worst, 0.2 * kGain);
  EXPECT_GT(first_order, 0.6 * kGain);
}

TEST(UnitSuffix, GivesTheYamlSuffixForBothKinds) {
  struct Row {
    Dimension dimension;
    const char* rotary;
    const char* linear;
  };
  const Row rows[] = {
      {Dimension::kNone, "", ""},
      {Dimension::kTorque, "Nm", "N"},
      {Dimension::kViscous, "Nm_s_rad", "N_s_m"},
      {Dimension::kQuadraticViscous, "Nm_s2_rad2", "N_s2_m2"},
      {Dimension::kInertia, "kg_m2", "kg"},
      {Dimension::kAngle, "rad", "m"},
      {Dimension::kVelocity, "rad_s", "m_s"},
      {Dimension::kFrequency, "Hz", "Hz"},
      {Dimension::kTime, "s", "s"},
      {Dimension::kMass, "kg", "kg"},
      {Dimension::kTorquePerBar, "Nm_bar", "N_bar"},
      {Dimension::kStiffness, "Nm_rad", "N_m"},
      {Dimension::kStiffnessPerBar, "Nm_rad_bar", "N_m_bar"},
      {Dimension::kTorquePerKelvin, "Nm_K", "N_K"},
      {Dimension::kTorquePerAmpere, "Nm_A", "N_A"},
      {Dimension::kTorquePerVolt, "Nm_V", "N_V"},
      {Dimension::kInertiaTime, "kg_m2_s", "kg_s"},
      {Dimension::kPressure, "bar", "bar"},
      {Dimension::kTemperature, "degC", "degC"},
      {Dimension::kLength, "m", "m"},
      {Dimension::kPerTorque, "per_Nm", "per_N"},
      {Dimension::kCurrent, "A", "A"},
      {Dimension::kPerCurrentSquared, "per_A2", "per_A2"},
      {Dimension::kViscousPerKelvin, "Nm_s_rad_K", "N_s_m_K"},
      {Dimension::kInertiaTimeSquared, "kg_m2_s2", "kg_s2"},
      {Dimension::kAnglePerTorque, "rad_Nm", "m_N"},
      {Dimension::kRate, "1_s", "1_s"},
  };
  for (const Row& row : rows) {
    EXPECT_EQ(UnitSuffix(row.dimension, types::JointKind::kRevolute), row.rotary);
    EXPECT_EQ(UnitSuffix(row.dimension, types::JointKind::kPrismatic), row.linear);
  }
}

TEST(MakeEffect, NamesTheKnownEffectsWhenThereIsNone) {
  try {
    MakeEffect("strybeck", {});
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("'strybeck'"));
    for (const std::string& name : EffectNames()) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
    }
  }
}

}  // namespace
}  // namespace sinew::effects
