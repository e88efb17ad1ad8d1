#include "sim/surrogate/experiment.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "sim/surrogate/excitation.h"

namespace sinew::surrogate {
namespace {

std::vector<LogRow> Record(std::uint64_t seed, double seconds, const TruthFunction& truth = {},
                           const std::vector<EffectSpec>& effects = {}) {
  RigParameters rig;
  rig.seed = seed;
  rig.effects = effects;
  const Excitation excitation({.duration_s = seconds, .seed = seed});
  rig.pneumatics.initial_pressure_bar = excitation.initial_pressure_bar();
  return RunExperiment(rig, {.duration_s = seconds, .seed = seed}, excitation, truth);
}

TEST(Experiment, RowsComeAtEightyHertzWithJitterAndALittleLoss) {
  const std::vector<LogRow> rows = Record(1, 60.0);
  EXPECT_GT(rows.size(), 4800u * 98 / 100);
  EXPECT_LT(rows.size(), 4800u);
  double sum2 = 0.0;
  int counted = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double gap_s = rows[i].time_s - rows[i - 1].time_s;
    ASSERT_GT(gap_s, 0.0);
    if (gap_s > 0.02) continue;  // a lost row
    sum2 += (gap_s - 0.0125) * (gap_s - 0.0125);
    ++counted;
  }
  // Two instants and two stamps make a gap's error.
  EXPECT_NEAR(std::sqrt(sum2 / counted), std::sqrt(2.0) * std::hypot(4e-4 * 0.71, 1e-4), 2e-4);
}

TEST(Experiment, RowsComeAtTwoHundredAndFortyHertzWhenEveryCycleIsLogged) {
  const std::vector<LogRow> rows =
      RunExperiment(RigParameters{}, {.duration_s = 20.0, .log_every = 1, .seed = 2},
                    [](double, const provider::PlantSensors&, provider::PlantCommand*,
                       provider::Disturbance*) {});
  EXPECT_NEAR(static_cast<double>(rows.size()), 4800.0 * (1.0 - 0.004), 20.0);
  for (std::size_t i = 1; i < rows.size(); ++i) ASSERT_GT(rows[i].time_s, rows[i - 1].time_s);
}

TEST(Experiment, SameSeedGivesTheSameRowsAndAnotherOneAnotherPlan) {
  const std::vector<LogRow> a = Record(3, 10.0), b = Record(3, 10.0), c = Record(4, 10.0);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].time_s, b[i].time_s);
    ASSERT_EQ(a[i].output_angle_rad, b[i].output_angle_rad);
    ASSERT_EQ(a[i].motor_current_A, b[i].motor_current_A);
  }
  double largest_rad = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), c.size()); ++i) {
    largest_rad = std::max(largest_rad, std::abs(a[i].output_angle_rad - c[i].output_angle_rad));
  }
  EXPECT_GT(largest_rad, 0.1);
}

TEST(Experiment, RefusesOptionsWithoutMeaning) {
  const CommandFunction nothing = [](double, const provider::PlantSensors&, provider::PlantCommand*,
                                     provider::Disturbance*) {};
  EXPECT_THROW(RunExperiment(RigParameters{}, {.duration_s = 0.0}, nothing), std::invalid_argument);
  EXPECT_THROW(RunExperiment(RigParameters{}, {.log_every = 0}, nothing), std::invalid_argument);
  EXPECT_THROW(RunExperiment(RigParameters{}, {.lost_share = 1.0}, nothing), std::invalid_argument);
}

TEST(Excitation, KeepsInsideItsLimitsAndMovesEverything) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Excitation excitation({.duration_s = 90.0, .seed = seed});
    double largest_rad = 0.0, largest_rad_s = 0.0, largest_N = 0.0;
    for (double t = 0.0; t < 90.0; t += 1.0 / 240.0) {
      largest_rad = std::max(largest_rad, std::abs(excitation.Reference_rad(t)));
      largest_rad_s = std::max(largest_rad_s, 1e3 * std::abs(excitation.Reference_rad(t + 1e-3) -
                                                             excitation.Reference_rad(t)));
      largest_N = std::max(largest_N, std::abs(excitation.Hand_N(t)));
    }
    EXPECT_LT(largest_rad, 1.0) << seed;
    EXPECT_GT(largest_rad, 0.4) << seed;
    EXPECT_GT(largest_rad_s, 0.8) << seed;
    EXPECT_LT(largest_rad_s, 8.0) << seed;
    EXPECT_GT(largest_N, 3.0) << seed;
  }
}

std::vector<LogRow> RecordKind(ExcitationKind kind, double seconds) {
  RigParameters rig;
  const Excitation excitation({.kind = kind, .duration_s = seconds, .seed = 2});
  excitation.Prepare(&rig);
  return RunExperiment(rig, {.duration_s = seconds, .seed = 2}, excitation);
}

TEST(Excitation, InSeaTheLinkPlaysInsideTheLockedGearUntilTheChamberIsTooWeak) {
  const std::vector<LogRow> rows = RecordKind(ExcitationKind::kSea, 100.0);
  double last_return_bar = 6.0;
  int swings = 0;
  bool low = false;
  for (const LogRow& row : rows) {
    ASSERT_NEAR(row.motor_angle_rad, 0.0, 0.005);
    ASSERT_LT(std::abs(row.output_angle_rad), 0.5 * 0.0465 + 0.003);
    if (row.output_angle_rad < -0.02) low = true;
    if (low && row.output_angle_rad > 0.02) {
      low = false;
      ++swings;
      last_return_bar = row.chamber_pressure_bar;
    }
  }
  EXPECT_GT(swings, 50);
  EXPECT_NEAR(last_return_bar, 2.4, 0.25);
}

TEST(Excitation, InPeaTheLinkSwingsBetweenUprightAndHangingInContact) {
  const std::vector<LogRow> rows = RecordKind(ExcitationKind::kPea, 40.0);
  int cycles = 0, outside = 0;
  bool low = false;
  for (const LogRow& row : rows) {
    if (row.output_angle_rad < -1.35) low = true;
    if (low && row.output_angle_rad > 1.3) {
      low = false;
      ++cycles;
    }
    outside += std::abs(row.motor_angle_rad / 100.0 - row.output_angle_rad) > 0.5 * 0.0464 - 5e-4;
  }
  EXPECT_GE(cycles, 9);
  EXPECT_GT(outside, static_cast<int>(rows.size()) * 9 / 10);
}

TEST(Excitation, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(ParseExcitation("shake"), std::invalid_argument);
  EXPECT_THROW(Excitation({.duration_s = -1.0}), std::invalid_argument);
  EXPECT_EQ(ParseExcitation("task"), ExcitationKind::kTask);
}

// The declared balance in integral form over windows of 0.1 s, from the truth: no sensor, no
// filter.
struct DeclaredFit {
  Eigen::VectorXd parameter;  // eta, Jm, Jl, B, Tc, Tg, K, k1
  double spread_Nm = 0.0;
};
DeclaredFit FitDeclared(const std::vector<EffectSpec>& effects) {
  std::vector<RigTruth> truth;
  const Excitation plan({.duration_s = 60.0, .seed = 5});
  RigParameters rig;
  rig.effects = effects;
  rig.pneumatics.initial_pressure_bar = plan.initial_pressure_bar();
  std::vector<double> hand_N;
  RunExperiment(
      rig, {.duration_s = 60.0, .jitter_s = 0.0, .seed = 5},
      [&](double t, const provider::PlantSensors& sensors, provider::PlantCommand* command,
          provider::Disturbance* disturbance) {
        plan(t, sensors, command, disturbance);
        hand_N.push_back(disturbance->hand_force_N[0]);
      },
      [&](const RigTruth& t) { truth.push_back(t); });
  constexpr int kWindow = 24;
  constexpr double kCycle_s = 1.0 / 240.0;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> right;
  for (std::size_t start = 1; start + kWindow < truth.size(); start += kWindow) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(8);
    double load_Nm = 0.0;
    double slowest_rad_s = 1.0;
    bool touching = true;
    for (std::size_t i = start; i < start + kWindow; ++i) {
      const RigTruth& t = truth[i];
      // Trapezoid; the current steps at the start of a cycle and settles as a lag of 1 ms.
      const auto mean = [&](auto value) { return 0.5 * (value(truth[i - 1]) + value(t)); };
      row(0) += 100.0 * 0.0159155 * (t.iq_A + (truth[i - 1].iq_A - t.iq_A) * 1e-3 / kCycle_s);
      row(3) -= mean([](const RigTruth& s) { return s.motor_velocity_rad_s / 100.0; });
      row(4) -= t.output_velocity_rad_s > 0.0 ? 1.0 : -1.0;
      row(5) -= mean([](const RigTruth& s) { return std::cos(s.output_angle_rad); });
      row(6) += mean([](const RigTruth& s) { return s.chamber_pressure_bar; });
      row(7) -= mean([](const RigTruth& s) { return s.chamber_pressure_bar * s.output_angle_rad; });
      load_Nm += 0.3 * hand_N[i];
      slowest_rad_s = std::min(slowest_rad_s, std::abs(t.output_velocity_rad_s));
      touching = touching && t.contact == truth[start].contact && t.contact != 0;
    }
    if (slowest_rad_s < 0.03 || !touching) continue;
    row *= kCycle_s;
    const RigTruth& from = truth[start - 1];
    const RigTruth& to = truth[start + kWindow - 1];
    row(1) = -(to.motor_velocity_rad_s - from.motor_velocity_rad_s) / 100.0;
    row(2) = -(to.output_velocity_rad_s - from.output_velocity_rad_s);
    rows.push_back(row / (kWindow * kCycle_s));
    right.push_back(load_Nm / kWindow);
  }
  Eigen::MatrixXd x(static_cast<Eigen::Index>(rows.size()), 8);
  Eigen::VectorXd y(x.rows());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    x.row(static_cast<Eigen::Index>(i)) = rows[i];
    y(static_cast<Eigen::Index>(i)) = right[i];
  }
  DeclaredFit fit;
  fit.parameter = x.colPivHouseholderQr().solve(y);
  // Spread by the median: a window may hide a tooth impact between two samples of the contact.
  std::vector<double> size(static_cast<std::size_t>(y.size()));
  Eigen::VectorXd::Map(size.data(), y.size()) = (y - x * fit.parameter).cwiseAbs();
  std::nth_element(size.begin(), size.begin() + y.size() / 2, size.end());
  fit.spread_Nm = 1.4826 * size[size.size() / 2];
  return fit;
}

TEST(Experiment, TheDeclaredModelDescribesTheEffectFreeRigBelowTheNoiseOfItsSensors) {
  const DeclaredFit fit = FitDeclared({});
  // Sensors leave about 0.02 N·m after a 10 Hz filter; a quarter of it is no effect.
  EXPECT_LT(fit.spread_Nm, 0.005);
  EXPECT_NEAR(fit.parameter(0), 0.77, 0.01);
  EXPECT_NEAR(fit.parameter(1) + fit.parameter(2), 0.134, 0.002);
  EXPECT_NEAR(fit.parameter(3), 0.31, 0.01);
  EXPECT_NEAR(fit.parameter(4), 0.225, 0.005);
  EXPECT_NEAR(fit.parameter(5), 0.58, 0.01);
  EXPECT_NEAR(fit.parameter(6), 0.3587, 0.005);
}

TEST(Experiment, ExtraTorqueIsLeftByTheDeclaredModelAndWhatLooksLikeAParameterIsTakenUp) {
  const double without_Nm = FitDeclared({}).spread_Nm;
  const auto with_Nm = [](const std::string& name) {
    return FitDeclared({*ParseEffect(name)}).spread_Nm;
  };
  for (const std::string name :
       {"stribeck", "direction_dependent_viscous", "cogging", "seal_hysteresis",
        "quadratic_viscous", "load_dependent_friction", "drive_efficiency_direction", "presliding",
        "cable_drag", "bad_tooth"}) {
    // Windows of 0.1 s hold several periods of the cogging at most speeds.
    EXPECT_GT(with_Nm(name), (name == "cogging" ? 1.8 : 4.5) * without_Nm) << name;
  }
  for (const std::string name : {"payload", "torque_constant_gain", "link_inertia"}) {
    EXPECT_LT(with_Nm(name), 2.0 * without_Nm) << name;
  }
  // Nothing but a sensor is wrong: what really happens fits as before, but for another motion.
  for (const std::string name : {"load_cell_gain", "encoder_eccentricity", "slipping_magnet"}) {
    EXPECT_LT(with_Nm(name), 1.2 * without_Nm) << name;
  }
}

}  // namespace
}  // namespace sinew::surrogate
