// The recordings come from an integrator of its own (fourth-order Runge-Kutta) or from inverse
// dynamics, never from the plant under test.
#include "components/model/free_run/free_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "sim/plant/joint_body.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::free_run {
namespace {

using identify::SyntheticModel;
using identify::SyntheticProcessing;
using identify::SyntheticRun;
using identify::TermOf;
using types::Run;
using types::Signal;

constexpr double kInertia_kg_m2 = 0.02;
constexpr double kViscous_Nm_s_rad = 0.05;
constexpr double kGravity_Nm = 0.4;
constexpr double kGain_Nm_V = 0.1;
constexpr double kBackEmf_V_s_rad = 0.3;
constexpr double kServo_per_rad = 1.5;
constexpr double kSupply_V = 8.0;
constexpr double kRate_Hz = 200.0;

// A pendulum on a voltage drive with a proportional servo that puts a duty on the motor.
actuator::JointModel Pendulum() {
  actuator::JointModel model;
  model.name = "pendulum";
  model.constants.force_constant_N_V = kGain_Nm_V;
  model.constants.back_emf_V_s_rad = kBackEmf_V_s_rad;
  const auto add = [&](const std::string& effect, double value) {
    model.terms.push_back(TermOf(effect, {value}, model.constants));
  };
  add("drive_voltage", kGain_Nm_V);
  add("inertia", kInertia_kg_m2);
  add("viscous", kViscous_Nm_s_rad);
  add("gravity", kGravity_Nm);
  model.controller = actuator::Servo{.gain_per_rad = kServo_per_rad,
                                     .velocity_gain_s_rad = 0.0,
                                     .limit = 1.0,
                                     .share_of_supply = true};
  return model;
}

double Reference(double t) { return -1.2 + 0.8 * std::sin(2.0 * t) + 0.2 * std::sin(5.3 * t); }

// Supply 0 (the bridge is open) from off_s on.
Run Recorded(double duration_s, double off_s = 1e9) {
  const auto n = static_cast<Eigen::Index>(duration_s * kRate_Hz);
  Run run;
  run.name = "recorded";
  run.time_s.resize(n);
  Eigen::VectorXd q(n), u(n), reference(n), supply(n);
  double at[2] = {-1.2, 0.0};
  const int steps = 20;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / kRate_Hz;
    const double volts = t < off_s ? kSupply_V : 0.0;
    const double goal = Reference(t);
    const auto duty = [&](double position) {
      return std::clamp(kServo_per_rad * (goal - position), -1.0, 1.0);
    };
    run.time_s[i] = t;
    q[i] = at[0];
    u[i] = duty(at[0]) * volts;
    reference[i] = goal;
    supply[i] = volts;
    const auto rate = [&](const double* x, double* out) {
      const double winding = volts > 0.0 ? duty(x[0]) * volts - kBackEmf_V_s_rad * x[1] : 0.0;
      out[0] = x[1];
      out[1] = (kGain_Nm_V * winding - kViscous_Nm_s_rad * x[1] - kGravity_Nm * std::cos(x[0])) /
               kInertia_kg_m2;
    };
    const double h = 1.0 / kRate_Hz / steps;
    for (int k = 0; k < steps; ++k) {
      double k1[2], k2[2], k3[2], k4[2], x[2];
      rate(at, k1);
      for (int j = 0; j < 2; ++j) x[j] = at[j] + 0.5 * h * k1[j];
      rate(x, k2);
      for (int j = 0; j < 2; ++j) x[j] = at[j] + 0.5 * h * k2[j];
      rate(x, k3);
      for (int j = 0; j < 2; ++j) x[j] = at[j] + h * k3[j];
      rate(x, k4);
      for (int j = 0; j < 2; ++j) {
        at[j] += h / 6.0 * (k1[j] + 2.0 * k2[j] + 2.0 * k3[j] + k4[j]);
      }
    }
  }
  run.signals[Signal::kPosition] = q;
  run.signals[Signal::kDriveVoltage] = u;
  run.signals[Signal::kReferencePosition] = reference;
  run.signals[Signal::kSupplyVoltage] = supply;
  return run;
}

identify::ProcessingOptions Wide() {
  identify::ProcessingOptions options = SyntheticProcessing();
  options.state_cutoff_Hz = 40.0;
  return options;
}

actuator::JointModel Without(actuator::JointModel model, const std::string& effect) {
  model.terms.erase(model.terms.begin() + model.Find(effect));
  return model;
}

TEST(FreeRun, TheServoMovesTheTruthAsItWasRecorded) {
  const FreeRunResult result = Compare(
      {Recorded(8.0)}, {Without(Pendulum(), "viscous"), Pendulum()}, Wide(), plant::JointAlone());
  ASSERT_TRUE(result.errors.has_value()) << result.why_not;
  EXPECT_EQ(result.errors->method, Method::kClosedLoop);
  // The plant takes steps of 0.2 ms and starts from filtered states: a milliradian.
  EXPECT_LT(result.errors->models[1].mean_abs, 1e-3);
  EXPECT_GT(result.errors->models[0].mean_abs, 5e-3);
  EXPECT_EQ(result.errors->models[1].diverged, 0);
  ASSERT_EQ(result.traces.size(), 1u);
  EXPECT_EQ(result.traces[0].measured.size(), result.traces[0].simulated[1].size());
}

TEST(FreeRun, AnOpenBridgeNeitherDrivesNorBrakes) {
  const FreeRunResult result =
      Compare({Recorded(8.0, 3.0)}, {Pendulum(), Pendulum()}, Wide(), plant::JointAlone());
  ASSERT_TRUE(result.errors.has_value());
  EXPECT_LT(result.errors->models[1].rms, 5e-3);  // swings for 5 s on
  // With the winding closed it would be braked by its back-EMF.
  actuator::JointModel braked = Pendulum();
  for (actuator::Term& term : braked.terms) {
    if (term.effect->info().name == "viscous") {
      term.linear[0].value += kGain_Nm_V * kBackEmf_V_s_rad;
    }
  }
  EXPECT_GT(Compare({Recorded(8.0, 3.0)}, {braked, Pendulum()}, Wide(), plant::JointAlone())
                .errors->models[0]
                .rms,
            0.015);
}

TEST(FreeRun, TheGainOfTheServoIsReadFromTheRecording) {
  actuator::JointModel unknown = Pendulum();
  unknown.controller->gain_per_rad = 0.0;
  const FreeRunResult result =
      Compare({Recorded(8.0)}, {unknown, unknown}, Wide(), plant::JointAlone());
  ASSERT_TRUE(result.errors.has_value());
  EXPECT_NEAR(result.errors->models[1].runs[0].servo_gain, kServo_per_rad, 0.01 * kServo_per_rad);
}

TEST(FreeRun, WithoutAServoTheRecordedDriveMovesItForHalfASecondAtATime) {
  const actuator::JointModel truth = SyntheticModel();
  actuator::JointModel heavy = truth;
  heavy.terms[4].linear[0].value *= 1.3;  // gravity
  const types::Run run = SyntheticRun(truth, {.duration_s = 20.0, .noise_A = 0.0});
  const FreeRunResult result =
      Compare({run}, {heavy, truth}, SyntheticProcessing(), plant::JointAlone());
  ASSERT_TRUE(result.errors.has_value()) << result.why_not;
  EXPECT_EQ(result.errors->method, Method::kHorizons);
  EXPECT_EQ(result.errors->models[1].runs[0].pieces, 40);
  // Stick-slip at reversals and the held drive leave a milliradian; 0.45 Nm / 0.3 kg m^2 over half
  // a second leave up to 0.19 rad.
  EXPECT_LT(result.errors->models[1].rms, 2e-3);
  EXPECT_GT(result.errors->models[0].rms, 0.02);
  EXPECT_EQ(result.errors->models[0].diverged + result.errors->models[1].diverged, 0);
}

TEST(FreeRun, AModelThatRunsAwayForTheMostPartHasNoErrorAndTakesNoneFromTheOthers) {
  const actuator::JointModel truth = SyntheticModel();
  actuator::JointModel light = truth, heavy = truth;
  light.terms[1].linear[0].value *= 0.05;  // inertia
  light.terms[0].linear[0].value *= 8.0;   // efficiency
  heavy.terms[1].linear[0].value *= 1.3;
  const types::Run run = SyntheticRun(truth, {.duration_s = 20.0, .noise_A = 0.0});
  const FreeRunResult three =
      Compare({run}, {light, heavy, truth}, SyntheticProcessing(), plant::JointAlone());
  ASSERT_TRUE(three.errors.has_value()) << three.why_not;
  EXPECT_GT(2 * three.errors->models[0].diverged, three.errors->models[0].pieces);
  EXPECT_FALSE(std::isfinite(three.errors->models[0].rms));
  const FreeRunResult two =
      Compare({run}, {heavy, truth}, SyntheticProcessing(), plant::JointAlone());
  ASSERT_TRUE(two.errors.has_value()) << two.why_not;
  EXPECT_DOUBLE_EQ(three.errors->models[1].rms, two.errors->models[0].rms);
  EXPECT_DOUBLE_EQ(three.errors->models[2].rms, two.errors->models[1].rms);
  EXPECT_GT(two.errors->models[0].rms, two.errors->models[1].rms);
}

TEST(FreeRun, PartsJoinToTheErrorOverAllSamples) {
  const actuator::JointModel truth = SyntheticModel();
  actuator::JointModel heavy = truth;
  heavy.terms[1].linear[0].value *= 1.3;  // inertia
  const types::Run a = SyntheticRun(truth, {.duration_s = 20.0, .seed = 1});
  const types::Run b = SyntheticRun(truth, {.duration_s = 10.0, .seed = 2});
  const auto compare = [&](const std::vector<types::Run>& runs) {
    return Compare(runs, {heavy, truth}, SyntheticProcessing(), plant::JointAlone());
  };
  const FreeRunResult joined = Join({compare({a}), compare({b})}), whole = compare({a, b});
  ASSERT_TRUE(joined.errors.has_value());
  for (const std::size_t model : {0u, 1u}) {
    EXPECT_NEAR(joined.errors->models[model].rms, whole.errors->models[model].rms, 1e-12);
    EXPECT_NEAR(joined.errors->models[model].mean_abs, whole.errors->models[model].mean_abs, 1e-12);
    EXPECT_EQ(joined.errors->models[model].pieces, whole.errors->models[model].pieces);
  }
  FreeRunResult none;
  none.why_not = "no inertia";
  EXPECT_EQ(Join({compare({a}), none}).why_not, "no inertia");
}

TEST(FreeRun, AModelWithoutInertiaSaysWhyItCannotRun) {
  actuator::JointModel still = Without(SyntheticModel(), "inertia");
  const types::Run run = SyntheticRun(SyntheticModel(), {.duration_s = 20.0});
  const FreeRunResult result =
      Compare({run}, {still, still}, SyntheticProcessing(), plant::JointAlone());
  EXPECT_FALSE(result.errors.has_value());
  EXPECT_NE(result.why_not.find("inertia"), std::string::npos) << result.why_not;
}

}  // namespace
}  // namespace sinew::free_run
