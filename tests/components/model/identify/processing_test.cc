#include "components/model/identify/processing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::identify {
namespace {

TEST(Processing, DerivativesOfASineAreItsClosedForm) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  const double w = 2.0 * M_PI * 0.5;
  for (Eigen::Index i = 0; i < run.size(); ++i)
    run.signals[types::Signal::kPosition][i] = std::sin(w * run.time_s[i]);
  const StateSet states = MakeStates({run}, model, SyntheticProcessing());
  ASSERT_EQ(states.segments.size(), 1u);
  const StateSegment& segment = states.segments[0];
  for (Eigen::Index i = 400; i < segment.size() - 400; i += 7) {
    const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
    EXPECT_NEAR(x.velocity_rad_s, w * std::cos(w * x.time_s), 1e-6 * w);
    EXPECT_NEAR(x.acceleration_rad_s2, -w * w * std::sin(w * x.time_s), 1e-6 * w * w);
    EXPECT_NEAR(x.jerk_rad_s3, -w * w * w * std::cos(w * x.time_s), 1e-5 * w * w * w);
  }
}

TEST(FromMotion, ARecordingThatWasLowPassedBeforeGoesThroughACommonFilterBelowIt) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  const ProcessingOptions as_measured = FromMotion({run}, model, 0.25);
  EXPECT_TRUE(as_measured.raw);
  EXPECT_DOUBLE_EQ(as_measured.parallel_cutoff_Hz, 100.0);  // none: half the rate
  constexpr double kEarlier_Hz = 10.0;
  Eigen::VectorXd& current = run.signals[types::Signal::kMotorCurrent];
  current = Smooth(current, 4, kEarlier_Hz, 200.0);
  const ProcessingOptions filtered = FromMotion({run}, model, 0.25);
  EXPECT_FALSE(filtered.raw);
  EXPECT_LT(filtered.parallel_cutoff_Hz, kEarlier_Hz);
  EXPECT_GT(filtered.parallel_cutoff_Hz, 0.2 * kEarlier_Hz);
}

// An efficiency counts as its share of the ideal gain, torque per volt as it is.
TEST(FromMotion, TheGainOfADriveIsTorquePerUnitOfItsSignal) {
  actuator::JointModel model = SyntheticModel();
  EXPECT_DOUBLE_EQ(NominalDriveGain(model), 0.8 * 50.0 * 0.02);
  model.constants.torque_constant_Nm_A = 0.0;
  model.constants.force_constant_N_V = 3.0;
  model.terms.front() = TermOf("drive_voltage", {0.7}, model.constants);
  EXPECT_DOUBLE_EQ(NominalDriveGain(model), 0.7);
}

TEST(Processing, RestReversalsBordersAndHolesAreNotUsed) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  for (Eigen::Index i = 4000; i < 5000; ++i)
    run.signals[types::Signal::kPosition][i] = run.signals[types::Signal::kPosition][4000];
  ProcessingOptions options = SyntheticProcessing();
  options.border_s = 1.0;
  const StateSet states = MakeStates({run}, model, options);
  const StateSegment& segment = states.segments[0];
  for (Eigen::Index i = 0; i < segment.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool edge = i < 200 || i >= segment.size() - 200;
    const bool gap = i > 4100 && i < 4900;
    const bool rests = std::abs(segment.samples[k].velocity_rad_s) < options.rest_velocity;
    EXPECT_FALSE(segment.usable[k] && (edge || gap || rests)) << i;
  }
  // The guard: nothing within 0.05 s of a slow sample.
  for (Eigen::Index i = 10; i + 10 < segment.size(); ++i) {
    if (!segment.at_rest[static_cast<std::size_t>(i)]) continue;
    for (Eigen::Index k = i - 10; k <= i + 10; ++k)
      EXPECT_FALSE(segment.usable[static_cast<std::size_t>(k)]);
  }
}

TEST(Processing, InstantsAtWhichTeethTouchAgainAreNotUsed) {
  actuator::JointModel model = SyntheticModel();
  model.backlash_rad = 0.04;
  types::Run run = SyntheticRun(model, {.motor_position = true});
  // The teeth lie on one side, cross the play within 0.2 s at 20 s and back at 40 s.
  const auto gap = [](double t) {
    const double over =
        std::clamp((t - 20.0) / 0.2, 0.0, 1.0) - std::clamp((t - 40.0) / 0.2, 0.0, 1.0);
    return 0.02 * (2.0 * over - 1.0);
  };
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    run.signals[types::Signal::kMotorPosition][i] =
        model.constants.gear_ratio *
        (run.signals[types::Signal::kPosition][i] + gap(run.time_s[i]));
  }
  ProcessingOptions options = SyntheticProcessing();
  options.reversal_guard_s = 0.1;
  const StateSegment with = MakeStates({run}, model, options).segments[0];
  model.backlash_rad = 0.0;
  const StateSegment without = MakeStates({run}, model, options).segments[0];
  for (std::size_t i = 0; i < with.samples.size(); ++i) {
    const double t = with.samples[i].time_s;
    // The touch is where nine tenths of the half play are reached again, within the last 0.01 s.
    const bool touch = std::abs(t - 20.195) < 0.09 || std::abs(t - 40.195) < 0.09;
    const bool far = std::abs(t - 20.195) > 0.14 && std::abs(t - 40.195) > 0.14;
    if (touch) {
      EXPECT_FALSE(with.usable[i]) << t;
    }
    if (far) {
      EXPECT_EQ(with.usable[i], without.usable[i]) << t;
    }
  }
}

TEST(Processing, RowsAtWhichTeethHoldTheOutputOfALockedMotorAreNotUsed) {
  actuator::JointModel model = SyntheticModel();
  model.backlash_rad = 0.04;
  types::Run run = SyntheticRun(model, {.motor_position = true});
  const auto output = [](double t) {
    return std::clamp(0.022 * std::sin(2.0 * M_PI * 0.3 * t) + 0.002 * std::sin(9.0 * t), -0.02,
                      0.02);
  };
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    run.signals[types::Signal::kMotorPosition][i] = 0.0;
    run.signals[types::Signal::kPosition][i] = output(run.time_s[i]);
  }
  ProcessingOptions options = SyntheticProcessing();
  options.raw = true;
  options.rest_velocity = 1e-4;
  options.reversal_guard_s = 0.02;
  const StateSet states = MakeStates({run}, model, options);
  EXPECT_TRUE(states.locked);
  const StateSegment& segment = states.segments[0];
  int used = 0;
  for (std::size_t i = 0; i < segment.samples.size(); ++i) {
    const double share = std::abs(output(segment.samples[i].time_s)) / 0.02;
    EXPECT_FALSE(segment.usable[i] && share > 0.92) << segment.samples[i].time_s;
    used += segment.usable[i];
  }
  EXPECT_GT(used, static_cast<int>(segment.samples.size()) / 4);
}

// From place to place in a second, with rests of two, read by an encoder of 14 bits.
double PointToPoint(double t) {
  const auto move = static_cast<int>(t / 3.0);
  const double along = std::min(1.0, t - 3.0 * move);
  const double step = along * along * along * (10.0 + along * (6.0 * along - 15.0));
  return 0.6 * (move % 2 == 0 ? step : 1.0 - step);
}

TEST(FromMotion, AMotionThatRestsMostOfTheTimeKeepsRowsOfItsStrokesAlone) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  const double count = 2.0 * M_PI / 16384.0;
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    run.signals[types::Signal::kPosition][i] =
        count * std::round(PointToPoint(run.time_s[i]) / count);
  }
  const ProcessingOptions options = FromMotion({run}, model, 0.25);
  // Slower than a few hundredths of a stroke's speed is rest, and so is what is below the counts.
  EXPECT_GT(options.rest_velocity, 0.01);
  EXPECT_GT(options.doubtful_velocity, 1.99 * count * options.state_cutoff_Hz);
  const StateSet states = MakeStates({run}, model, options);
  const StateSegment& segment = states.segments[0];
  int used = 0;
  for (std::size_t i = 0; i < segment.samples.size(); ++i) {
    used += segment.usable[i];
    EXPECT_FALSE(segment.usable[i] && std::fmod(segment.samples[i].time_s, 3.0) > 1.0)
        << segment.samples[i].time_s;
  }
  // A third of the time moves, and guards leave a third of that.
  EXPECT_GT(used, static_cast<int>(segment.samples.size()) / 12);
}

TEST(Processing, AnUnloadedLoadCellIsReplacedByItsMean) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  EXPECT_FALSE(MakeDesign({run}, model).states().silent_load);
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0.4, 0.05);
  for (double& force : run.signals[types::Signal::kLoadForce]) force = noise(random);
  const Design design = MakeDesign({run}, model);
  EXPECT_TRUE(design.states().silent_load);
  for (const effects::JointSample& x : design.states().segments[0].samples) {
    // The mean of 12000 rows.
    ASSERT_NEAR(x.load_force_N, 0.4, 5.0 * 0.05 / std::sqrt(12000.0));
  }
}

TEST(Processing, NoiseIsEstimatedFromASlowSignal) {
  const actuator::JointModel model = SyntheticModel();
  const Design design = MakeDesign({SyntheticRun(model, {})}, model);
  const auto slow = [](const effects::JointSample& x) { return x.position_rad; };
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto noise = [&](const effects::JointSample&) { return normal(random); };
  EXPECT_LT(design.NoiseShare(slow), 1e-3);
  // Estimated from the scatter at the full rate, against the power that passes the filter.
  EXPECT_GT(design.NoiseShare(noise), 0.7);
  EXPECT_EQ(design.NoiseShare([](const effects::JointSample&) { return 0.0; }), 1.0);
}

TEST(Processing, AShortStopIsNoSlowMotion) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {});
  constexpr double kPeriod_s = 2.0, kStop_s = 0.05, kSpeed = 2.0;
  const auto velocity = [&](double t) {
    const double from_stop = std::remainder(t - 1.0, kPeriod_s) / kStop_s;
    return -kSpeed * (1.0 - std::exp(-from_stop * from_stop));
  };
  double position = 0.0;
  for (Eigen::Index i = 1; i < run.size(); ++i) {
    constexpr int kSteps = 20;
    const double step_s = (run.time_s[i] - run.time_s[i - 1]) / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      position += step_s * velocity(run.time_s[i - 1] + (k + 0.5) * step_s);
    }
    run.signals[types::Signal::kPosition][i] = position;
  }
  ProcessingOptions options = SyntheticProcessing();
  options.state_cutoff_Hz = 20.0;
  options.slow_cutoff_Hz = options.state_cutoff_Hz / 6.0;
  options.doubtful_velocity = 0.3;
  const StateSet states = MakeStates({run}, model, options);
  for (const effects::JointSample& x : states.segments[0].samples) {
    if (x.time_s < 4.0 || std::abs(std::remainder(x.time_s - 1.0, kPeriod_s)) > 0.004) continue;
    EXPECT_LT(std::abs(x.velocity_rad_s), options.doubtful_velocity) << x.time_s;
  }
}

TEST(Processing, SettleDistanceKeepsPreslidingOut) {
  const actuator::JointModel model = SyntheticModel();
  const types::Run run = SyntheticRun(model, {});
  ProcessingOptions options = SyntheticProcessing();
  options.settle_distance = 0.05;
  const StateSegment segment = MakeStates({run}, model, options).segments[0];
  double covered = 0.0;
  for (std::size_t i = 0; i < segment.samples.size(); ++i) {
    covered = segment.at_rest[i]
                  ? 0.0
                  : covered + std::abs(segment.samples[i].velocity_rad_s) * segment.period_s;
    EXPECT_FALSE(segment.usable[i] && covered < 0.05) << i;
  }
}

TEST(Processing, TheDriveOfAModelIsNamed) {
  actuator::JointModel model = SyntheticModel();
  EXPECT_EQ(DriveSignal(model), types::Signal::kMotorCurrent);
  model.terms[0] = actuator::MakeTerm("drive_voltage", model.constants);
  EXPECT_EQ(DriveSignal(model), types::Signal::kDriveVoltage);
  model.terms.push_back(actuator::MakeTerm("drive_current", model.constants));
  EXPECT_THROW(DriveSignal(model), std::invalid_argument);
  model.terms.clear();
  EXPECT_THROW(DriveSignal(model), std::invalid_argument);
}

TEST(Processing, MissingSignalsAndWrongKindsAreRefused) {
  const actuator::JointModel model = SyntheticModel();
  types::Run run = SyntheticRun(model, {.duration_s = 5.0});
  types::Run no_current = run;
  no_current.signals.erase(types::Signal::kMotorCurrent);
  EXPECT_THROW(MakeStates({no_current}, model, SyntheticProcessing()), std::invalid_argument);
  types::Run no_position = run;
  no_position.signals.erase(types::Signal::kPosition);
  EXPECT_THROW(MakeStates({no_position}, model, SyntheticProcessing()), std::invalid_argument);
  types::Run no_force = run;
  no_force.signals.erase(types::Signal::kLoadForce);  // a term of the model reads it
  EXPECT_THROW(MakeStates({no_force}, model, SyntheticProcessing()), std::invalid_argument);
  types::Run linear = run;
  linear.kind = types::JointKind::kPrismatic;
  EXPECT_THROW(MakeStates({linear}, model, SyntheticProcessing()), std::invalid_argument);
  EXPECT_THROW(MakeStates({}, model, SyntheticProcessing()), std::invalid_argument);
}

TEST(Processing, OnlyWhatEveryRecordingHasCounts) {
  actuator::JointModel model = SyntheticModel();
  model.terms.pop_back();  // no term reads the load cell
  types::Run with = SyntheticRun(model, {.duration_s = 5.0});
  types::Run without = with;
  without.signals.erase(types::Signal::kLoadForce);
  EXPECT_EQ(MakeStates({with}, model, SyntheticProcessing()).measured.count("load_force_N"), 1u);
  EXPECT_EQ(
      MakeStates({with, without}, model, SyntheticProcessing()).measured.count("load_force_N"), 0u);
  // A rigid gear gives the motor's velocity, free play does not.
  EXPECT_EQ(MakeStates({with}, model, SyntheticProcessing()).measured.count("motor_velocity_rad_s"),
            1u);
  actuator::JointModel loose = model;
  loose.backlash_rad = 0.04;
  EXPECT_EQ(MakeStates({with}, loose, SyntheticProcessing()).measured.count("motor_velocity_rad_s"),
            0u);
}

TEST(Processing, OptionsLeftOpenComeFromTheData) {
  const types::Run run = SyntheticRun(SyntheticModel(), {});
  const ProcessingOptions options = Resolve({}, {run});
  EXPECT_GT(options.state_cutoff_Hz, 1.5);  // above the motion
  EXPECT_LE(options.state_cutoff_Hz, 50.0);
  EXPECT_DOUBLE_EQ(options.parallel_cutoff_Hz, 0.25 * options.state_cutoff_Hz);
  EXPECT_GT(options.rest_velocity, 0.0);
  EXPECT_DOUBLE_EQ(Resolve(SyntheticProcessing(), {run}).state_cutoff_Hz, 30.0);
}

}  // namespace
}  // namespace sinew::identify
