#include "components/learn/rls/target.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/learn/esn/network.h"
#include "components/learn/rls/adapter.h"
#include "components/model/actuator/file/model_file.h"
#include "tests/support/allocations.h"

namespace sinew::rls {
namespace {

using esn::Signal;

constexpr double kPeriod_s = 1.0 / 240.0;
constexpr double kGear = 100.0;

actuator::RobotModel Rig() {
  return actuator::LoadRobotModel(SINEW_SOURCE_DIR "/robots/rig/model.yaml");
}

esn::Weights RigWeights() {
  esn::Hyperparameters hyper;
  hyper.neurons = 5;
  hyper.density = 0.5;
  esn::Weights weights = esn::MakeWeights(hyper, 4, 1);
  weights.period_s = kPeriod_s;
  weights.target = "drive_torque_Nm";
  weights.inputs = {{Signal::kChamberPressure, 0},
                    {Signal::kReferencePosition, 0},
                    {Signal::kReferenceVelocity, 0},
                    {Signal::kReferenceAcceleration, 0}};
  weights.input.offset << 3.0, 0.1, -0.2, 0.3;
  weights.input.scale << 1.0, 0.5, 1.5, 4.0;
  return weights;
}

// Position, velocity, acceleration of a sine.
struct Motion {
  double q, v, a;
};
Motion Sine(double amplitude, double frequency_Hz, double phase, double t) {
  const double w = 2.0 * std::numbers::pi * frequency_Hz;
  return {amplitude * std::sin(w * t + phase), amplitude * w * std::cos(w * t + phase),
          -amplitude * w * w * std::sin(w * t + phase)};
}
Motion ReferenceAt(double t) { return Sine(0.5, 0.4, 0.0, t); }
Motion MotionAt(double t) { return Sine(0.47, 0.4, -0.15, t); }  // lags behind and is too small

double Needed(const actuator::RobotModel& rig, const Motion& m, double pressure_bar) {
  esn::InverseDynamics inverse(rig, 0.05);
  esn::Frame frame;
  frame.Set(Signal::kReferencePosition, 0, m.q);
  frame.Set(Signal::kReferenceVelocity, 0, m.v);
  frame.Set(Signal::kReferenceAcceleration, 0, m.a);
  frame.Set(Signal::kChamberPressure, 0, pressure_bar);
  return inverse.Step(frame, kPeriod_s).torque_Nm[0];
}

// Plays the rig and what was published about it.
class Session {
 public:
  Session(const esn::Weights& weights, double unknown_Nm)
      : weights_(weights), unknown_Nm_(unknown_Nm) {
    features_ = Eigen::VectorXd::Zero(weights.feature_count());
  }
  TickData At(std::uint64_t tick) {
    const double t = static_cast<double>(tick) * kPeriod_s;
    const Motion r = ReferenceAt(t - kPeriod_s);  // of the tick before
    features_(0) = 1.0;
    const Eigen::Vector4d u(kPressure_bar, r.q, r.v, r.a);
    features_.segment(1, 4) = (u - weights_.input.offset).cwiseQuotient(weights_.input.scale);
    const Motion m = MotionAt(t);
    TickData data{.features = features_};
    data.tick = tick;
    data.period_s = kPeriod_s;
    data.usable = true;
    data.positions_valid = true;
    data.network = 1;
    data.position_rad[0] = m.q;
    data.motor_position_rad[0] = kGear * (m.q + 0.02);  // the play shifts it
    data.drive_torque_Nm[0] = Needed(rig_, m, kPressure_bar) + unknown_Nm_;
    data.measured.Set(Signal::kChamberPressure, 0, kPressure_bar);
    return data;
  }

  static constexpr double kPressure_bar = 3.5;

 private:
  actuator::RobotModel rig_ = Rig();
  esn::Weights weights_;
  double unknown_Nm_;
  Eigen::VectorXd features_;
};

TEST(TargetEquation, AsksForTheTorqueOfTheReferenceWhateverTheMotionWas) {
  const actuator::RobotModel rig = Rig();
  for (const bool motor : {true, false}) {
    for (const double unknown_Nm : {0.0, 0.3}) {
      const esn::Weights weights = RigWeights();
      TargetConfig config;
      config.motion_from_motor = motor;
      TargetEquation equation(config, rig, std::nullopt, weights);
      Session session(weights, unknown_Nm);
      double worst = 0.0;
      double without = 0.0;
      int samples = 0;
      for (std::uint64_t tick = 0; tick < 1200; ++tick) {
        const TickData data = session.At(tick);
        const auto sample = equation.Push(data);
        ASSERT_EQ(sample.has_value(), tick >= 16u);
        if (!sample) continue;
        const double c_s = static_cast<double>(tick - 8) * kPeriod_s;
        const Motion motion = MotionAt(c_s);
        if (std::abs(motion.v) < 0.1) continue;  // the parabola rounds dry friction's turn
        const double needed_Nm =
            Needed(rig, ReferenceAt(c_s - kPeriod_s), Session::kPressure_bar) + unknown_Nm;
        worst = std::max(worst, std::abs(sample->target_Nm(0) - needed_Nm));
        without = std::max(without, std::abs(Needed(rig, motion, Session::kPressure_bar) +
                                             unknown_Nm - needed_Nm));
        ++samples;
      }
      EXPECT_GT(samples, 900);
      // The parabola's bias at 0.4 Hz over 71 ms: 0.1 % of velocity and acceleration.
      EXPECT_LT(worst, 5e-3) << motor << unknown_Nm;
      EXPECT_GT(without, 0.5);
    }
  }
}

TEST(TargetEquation, WithoutCarryingOverTheTargetIsTheMeasuredTorqueAtOnce) {
  const esn::Weights weights = RigWeights();
  TargetConfig config;
  config.carry_over = false;
  TargetEquation equation(config, Rig(), std::nullopt, weights);
  Session session(weights, 0.0);
  for (std::uint64_t tick = 0; tick < 50; ++tick) {
    const TickData data = session.At(tick);
    const auto sample = equation.Push(data);
    ASSERT_TRUE(sample.has_value());
    EXPECT_EQ(sample->target_Nm(0), data.drive_torque_Nm[0]);
    EXPECT_EQ(Eigen::VectorXd(sample->features), Eigen::VectorXd(data.features));
    EXPECT_EQ(sample->network, 1);
  }
}

TEST(TargetEquation, LearnsNothingFromHolesLostPositionsAndClippedReferences) {
  const esn::Weights weights = RigWeights();
  TargetEquation equation(TargetConfig{}, Rig(), std::nullopt, weights);
  Session session(weights, 0.0);
  std::uint64_t tick = 0;
  const auto ticks_until_sample = [&](auto change) {
    TickData first = session.At(++tick);
    Eigen::VectorXd features = first.features;
    change(first, features);
    const TickData changed{first.tick,
                           first.period_s,
                           first.usable,
                           first.positions_valid,
                           first.network,
                           features,
                           first.position_rad,
                           first.motor_position_rad,
                           first.drive_torque_Nm,
                           first.measured};
    tick = first.tick;
    int missing = 0;
    bool now = equation.Push(changed).has_value();
    while (!now || missing == 0) {
      if (!now) ++missing;
      if (missing > 100) return missing;
      now = equation.Push(session.At(++tick)).has_value();
      if (now && missing == 0 && tick > first.tick + 20) break;
    }
    return missing;
  };
  for (int i = 0; i < 30; ++i) (void)equation.Push(session.At(++tick));
  EXPECT_EQ(ticks_until_sample([](TickData&, Eigen::VectorXd&) {}), 0);
  EXPECT_EQ(ticks_until_sample([](TickData& d, Eigen::VectorXd&) { d.tick += 1; }), 16);
  EXPECT_EQ(ticks_until_sample([](TickData& d, Eigen::VectorXd&) { d.positions_valid = false; }),
            17);
  EXPECT_EQ(ticks_until_sample([](TickData& d, Eigen::VectorXd&) { d.usable = false; }), 1);
  EXPECT_EQ(ticks_until_sample([](TickData& d, Eigen::VectorXd&) { d.network = 0; }), 1);
  EXPECT_EQ(ticks_until_sample([](TickData&, Eigen::VectorXd& f) { f(3) = 6.0; }), 1);
  EXPECT_EQ(ticks_until_sample(
                [](TickData& d, Eigen::VectorXd&) { d.motor_position_rad[0] = std::nan(""); }),
            17);
}

// An axis of twice the inertia that the model declares, followed by PD and a feed-forward that is
// learnt. Returns the error at the end, rms in rad.
double TrackingError(double* before) {
  actuator::RobotModel model = Rig();
  actuator::JointModel& joint = model.joints[0];
  std::erase_if(joint.terms, [](const actuator::Term& term) {
    const std::string& name = term.effect->info().name;
    return name != "drive_current" && name != "rotor_inertia" && name != "motor_viscous";
  });
  const double inertia = 2.0 * joint.Parameter("rotor_inertia", "rotor_inertia");
  const double viscous = joint.Parameter("motor_viscous", "viscous");

  esn::Hyperparameters hyper;
  hyper.neurons = 20;
  hyper.leak = 0.5;
  esn::Weights weights = esn::MakeWeights(hyper, 3, 1);
  weights.period_s = kPeriod_s;
  weights.target = "drive_torque_Nm";
  weights.inputs = {{Signal::kReferencePosition, 0},
                    {Signal::kReferenceVelocity, 0},
                    {Signal::kReferenceAcceleration, 0}};
  weights.input.scale << 0.5, 1.0, 4.0;
  weights.input.offset.setZero();
  // The offline readout is the declared model: linear in the inputs.
  weights.readout(0, 2) = viscous * 1.0;
  weights.readout(0, 3) = 0.5 * inertia * 4.0;
  esn::Network network(weights);
  TargetEquation equation(TargetConfig{}, model, std::nullopt, weights);
  AdapterConfig config;
  config.rls.forgetting = 0.999;
  config.rls.prior_precision = 1.0;
  config.rls.initial_innovation = 0.2;
  Adapter adapter(config, std::nullopt, weights.readout);

  constexpr int kSubSteps = 20;
  double q = 0.0;
  double v = 0.5 * 2.0 * std::numbers::pi * 0.4;
  double torque_Nm = 0.0;
  Eigen::VectorXd features = Eigen::VectorXd::Zero(weights.feature_count());
  double sum = 0.0;
  double first_sum = 0.0;
  constexpr std::uint64_t kTicks = 240 * 40;
  for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
    TickData data{.features = features};
    data.tick = tick;
    data.period_s = kPeriod_s;
    data.usable = tick > 0;
    data.positions_valid = true;
    data.network = 1;
    data.position_rad[0] = q;
    data.motor_position_rad[0] = kGear * q;
    data.drive_torque_Nm[0] = torque_Nm;
    if (const auto sample = equation.Push(data)) {
      (void)adapter.Step({.armed = true,
                          .usable = true,
                          .fastest_velocity_rad_s = 1.0,
                          .period_s = kPeriod_s,
                          .network = 1,
                          .features = sample->features,
                          .target_Nm = sample->target_Nm});
    }
    // Learning begins after the first 10 s.
    if (tick > 2400) {
      EXPECT_TRUE(network.SetReadout(Eigen::MatrixXd(adapter.estimator(1).readout())));
    }
    const Motion r = ReferenceAt(static_cast<double>(tick) * kPeriod_s);
    EXPECT_EQ(network.Step(Eigen::Vector3d(r.q, r.v, r.a)), esn::StepStatus::kOk);
    features = network.features();
    // The rig's PID without its integral.
    torque_Nm =
        std::clamp(network.prediction()(0) + 12.0 * (r.q - q) + 1.0 * (r.v - v), -30.0, 30.0);
    for (int i = 0; i < kSubSteps; ++i) {
      v += (torque_Nm - viscous * v) / inertia * kPeriod_s / kSubSteps;
      q += v * kPeriod_s / kSubSteps;
    }
    const double error = ReferenceAt(static_cast<double>(tick + 1) * kPeriod_s).q - q;
    if (tick >= 1200 && tick < 2400) first_sum += error * error;
    if (tick >= kTicks - 2400) sum += error * error;
  }
  *before = std::sqrt(first_sum / 1200);
  return std::sqrt(sum / 2400);
}

TEST(TargetEquation, MakesLearningInTheLoopSettle) {
  double before = 0.0;
  const double after = TrackingError(&before);
  EXPECT_GT(before, 0.01);
  EXPECT_LT(after, 0.25 * before);
}

TEST(TargetEquation, PushTakesNoMemory) {
  const esn::Weights weights = RigWeights();
  TargetEquation equation(TargetConfig{}, Rig(), weights, weights);
  Session session(weights, 0.0);
  TickData data = session.At(0);
  long taken = 0;
  bool any = false;
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    data.tick = tick;
    const long before = test::Allocations();
    any = equation.Push(data).has_value() || any;
    taken += test::Allocations() - before;
  }
  EXPECT_EQ(taken, 0);
  EXPECT_TRUE(any);
}

TEST(TargetEquation, NamesWhatIsMissing) {
  const auto message = [](auto change) {
    TargetConfig config;
    esn::Weights weights = RigWeights();
    change(config, weights);
    try {
      TargetEquation(config, Rig(), std::nullopt, weights);
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  using C = TargetConfig;
  using W = esn::Weights;
  EXPECT_EQ(message([](C&, W&) {}), "accepted");
  EXPECT_THAT(
      message([](C&, W& w) {
        w.inputs[3] = {Signal::kTemperature, 0};
      }),
      testing::StartsWith(
          "pea: no input reference_acceleration_rad_s2 of joint 0, which carry_over needs"));
  EXPECT_EQ(message([](C& c, W& w) {
              w.inputs[3] = {Signal::kTemperature, 0};
              c.carry_over = false;
            }),
            "accepted");
  EXPECT_THAT(message([](C& c, W&) { c.half_window_ticks = 0; }),
              testing::StartsWith("half_window_ticks: 0"));
  EXPECT_THAT(message([](C& c, W&) { c.smoothing_rad_s = 0.0; }),
              testing::StartsWith("smoothing_rad_s: 0"));
  EXPECT_THAT(message([](C&, W& w) { w.readout = Eigen::MatrixXd::Zero(2, w.feature_count()); }),
              testing::HasSubstr("2 outputs, expected at most"));
  EXPECT_THROW(TargetEquation(TargetConfig{}, Rig(), std::nullopt, std::nullopt),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::rls
