#include "components/model/gate/gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "components/base/types/angle.h"
#include "components/model/gate/channels.h"
#include "components/model/gate/rules.h"
#include "tests/components/model/gate/plant.h"
#include "tests/components/model/gate/scene.h"

namespace sinew::gate {
namespace {

using types::Signal;

// Two recordings of the surrogate at 80 Hz; made once.
const scene::Recorded& Recorded() {
  static const scene::Recorded recorded = [] {
    scene::Scene scene;
    scene.seed = 31;
    scene.trains = 2;
    scene.seconds = 25.0;
    scene.held_out = false;
    return scene::Record(scene);
  }();
  return recorded;
}

std::string TextOf(const GateReport& report) {
  std::string out;
  for (const Fault& fault : report.faults) out += FormatFault(fault) + "\n";
  for (const Measurement& at : report.largest) {
    out += at.rule + " " + at.signal + " " + std::to_string(at.statistic) + "\n";
  }
  return out;
}

bool HasFault(const GateReport& report, const std::string& rule, const std::string& signal = "") {
  return std::any_of(report.faults.begin(), report.faults.end(), [&](const Fault& at) {
    return at.rule == rule && (signal.empty() || at.signal == signal);
  });
}

// Of the first finding of this name; empty: none.
std::string FindingText(const GateReport& report, const std::string& name) {
  for (const gate::Finding& at : report.findings) {
    if (at.name == name) return at.text;
  }
  return "";
}

Eigen::VectorXd Noise(Eigen::Index rows, double deviation, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, deviation);
  Eigen::VectorXd out(rows);
  for (double& value : out) value = normal(random);
  return out;
}

// A motion in closed form, 20 s at 200 Hz.
struct Motion {
  Eigen::ArrayXd t, q, v, a;
};

Motion TwoSines() {
  Motion out;
  out.t = Eigen::ArrayXd::LinSpaced(4000, 0.0, 19.995);
  out.q = 0.8 * (1.3 * out.t).sin() + 0.3 * (3.1 * out.t + 0.4).sin();
  out.v = 1.04 * (1.3 * out.t).cos() + 0.93 * (3.1 * out.t + 0.4).cos();
  out.a = -1.352 * (1.3 * out.t).sin() - 2.883 * (3.1 * out.t + 0.4).sin();
  return out;
}

// A joint with a torque sensor that reads to 1 mNm.
types::Run TorqueRun(const Motion& motion, const Eigen::ArrayXd& torque_Nm,
                     const std::string& name = "run") {
  types::Run run;
  run.name = name;
  run.time_s = motion.t.matrix();
  const Eigen::Index rows = run.size();
  run.signals[Signal::kPosition] = motion.q.matrix() + Noise(rows, 1e-6, 1);
  run.signals[Signal::kTorque] = torque_Nm.matrix() + Noise(rows, 1e-3, 2);
  return run;
}

// The torque sensor, exact, and terms of one parameter each.
actuator::JointModel SmallModel(const std::vector<std::pair<const char*, double>>& terms) {
  actuator::JointModel model;
  model.name = "joint";
  model.terms.push_back(actuator::MakeTerm("drive_torque", model.constants));
  model.terms.back().linear.front().fixed = true;
  for (const auto& [effect, value] : terms) {
    model.terms.push_back(actuator::MakeTerm(effect, model.constants));
    model.terms.back().linear.front().value = value;
  }
  return model;
}

class PlantedFault : public testing::TestWithParam<FaultKind> {};

TEST_P(PlantedFault, IsFoundByItsRuleWithReasonAndRemedy) {
  scene::Recorded recorded = Recorded();
  Plant(GetParam().name, 5, &recorded.train, &recorded.declared);
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(IsFound(GetParam(), report)) << TextOf(report);
  EXPECT_NE(report.stops(), GetParam().leaves_out) << TextOf(report);
  if (GetParam().leaves_out) return;
  const auto found = std::find_if(report.faults.begin(), report.faults.end(), [](const Fault& at) {
    const std::vector<std::string>& rules = GetParam().rules;
    return std::find(rules.begin(), rules.end(), at.rule) != rules.end();
  });
  ASSERT_NE(found, report.faults.end()) << TextOf(report);
  EXPECT_GT(found->statistic, found->limit);
  EXPECT_EQ(found->limit, FindRule(found->rule).limit);
  EXPECT_FALSE(found->reason.empty());
  EXPECT_FALSE(found->remedy.empty());
}

INSTANTIATE_TEST_SUITE_P(Every, PlantedFault, testing::ValuesIn(FaultKinds()),
                         [](const auto& param) { return param.param.name; });

TEST(Gate, EveryRuleIsExpectedByAPlantedFault) {
  for (const Rule& rule : Rules()) {
    // Below: the balance sees most of it first, and the surrogate's balance follows the angle in
    // other terms, too.
    if (rule.id == "recording_differs" || rule.id == "zero") continue;
    EXPECT_TRUE(std::any_of(FaultKinds().begin(), FaultKinds().end(), [&](const FaultKind& kind) {
      return std::find(kind.rules.begin(), kind.rules.end(), rule.id) != kind.rules.end();
    })) << rule.id;
  }
}

TEST(Gate, TheNoiseOfAJointAtRestIsNoWrappedAngle) {
  std::vector<types::Run> runs = Recorded().train;
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1e-4);
  for (types::Run& run : runs) {
    for (const Signal signal : {Signal::kPosition, Signal::kMotorPosition}) {
      for (double& value : run.signals.at(signal)) value = noise(random);
    }
  }
  for (const Fault& fault : ExamineData(runs, Recorded().declared).faults) {
    EXPECT_NE(fault.rule, "wrapped") << FormatFault(fault);
  }
}

// A speed computed from an encoder whose counts come as evenly as the rows settles to the bit.
TEST(Gate, ASpeedThatStaysIsNotFrozenWhereTheAngleMovesByIt) {
  constexpr Eigen::Index kRows = 15;
  const auto stays = [&](double times) {
    std::vector<types::Run> runs = Recorded().train;
    types::Run& run = runs.front();
    const Eigen::VectorXd& q = run.At(Signal::kPosition);
    Eigen::VectorXd& v = run.signals[Signal::kVelocity];
    const auto quickest = [&](Eigen::Index i) { return v.segment(i, kRows).cwiseAbs().minCoeff(); };
    Eigen::Index first = 100;
    for (Eigen::Index i = first; i + kRows + 100 < run.size(); ++i) {
      if (quickest(i) > quickest(first)) first = i;
    }
    const Eigen::Index last = first + kRows - 1;
    v.segment(first, kRows)
        .setConstant(times * (q[last] - q[first]) / (run.time_s[last] - run.time_s[first]));
    const GateReport report = ExamineData(runs, Recorded().declared);
    return std::any_of(report.faults.begin(), report.faults.end(), [](const Fault& fault) {
      return fault.rule == "frozen" && fault.signal == "velocity";
    });
  };
  EXPECT_FALSE(stays(1.0));
  EXPECT_TRUE(stays(0.7));
}

// Two waves are clipped, the second by a bus whose voltage has fallen.
TEST(Gate, ADriveThatALimitHoldsIsNotFrozenWhereTheLimitMoves) {
  const Motion motion = TwoSines();
  const Eigen::ArrayXd limit = (motion.t < 9.0).select(10.0, Eigen::ArrayXd::Constant(4000, 9.5));
  Eigen::ArrayXd wanted = 6.0 * (2.1 * motion.t).sin() + Noise(4000, 2e-3, 9).array();
  for (const double peak_s : {3.740, 12.716}) {
    wanted += 5.0 * (-((motion.t - peak_s) / 1.5).square()).exp();
  }
  types::Run run = TorqueRun(motion, wanted);
  Eigen::VectorXd& torque = run.signals[Signal::kTorque];
  torque = torque.array().min(limit).max(-limit).matrix().eval();
  ASSERT_GT((torque.array() == 9.5).count(), 100);
  const GateReport report = ExamineData({run}, SmallModel({}));
  EXPECT_FALSE(HasFault(report, "frozen")) << TextOf(report);
  // Frozen on its way: it jumps to where it should be.
  torque.segment(1000, 60).setConstant(torque[1000]);
  EXPECT_TRUE(HasFault(ExamineData({run}, SmallModel({})), "frozen", "torque"));
}

// A pause of 11 rows, too short for the smoothed speed to fall, with a computed torque.
TEST(Gate, WhatIsComputedFromARestingAngleIsNotFrozen) {
  constexpr Eigen::Index kPause = 1200, kRows = 10;
  const Eigen::VectorXd noise = Noise(4000, 1e-3, 7);
  const auto examined = [&](double creep_rad) {
    Motion motion = TwoSines();
    Eigen::ArrayXd torque(4000);
    for (Eigen::Index i = 0; i < 4000; ++i) {
      const Eigen::Index at = i <= kPause ? i : std::max(kPause, i - kRows);
      const double t = 0.005 * static_cast<double>(at);
      motion.q[i] = 0.8 * std::sin(1.57 * t) + creep_rad * static_cast<double>(i - at);
      torque[i] = 1.0 + 3.0 * std::sin(2.3 * t) + noise[at];
    }
    types::Run run = TorqueRun(motion, torque);
    run.signals[Signal::kPosition] = motion.q.matrix();
    run.signals[Signal::kTorque] = torque.matrix();
    return ExamineData({run}, SmallModel({}));
  };
  EXPECT_FALSE(HasFault(examined(0.0), "frozen", "torque")) << TextOf(examined(0.0));
  EXPECT_TRUE(HasFault(examined(0.003), "frozen", "torque"));
}

TEST(Gate, AHeldSpeedSaysNothingAboutUnits) {
  // The drive's ripple is what a thousandfold inertia would need, and a twentieth of the drive.
  const auto examined = [](double drive_Nm) {
    Motion motion = TwoSines();
    motion.q = motion.t + 0.02 * (1.57 * motion.t).sin();
    const Eigen::ArrayXd ripple = -0.02 * 1.57 * 1.57 * (1.57 * motion.t).sin();
    return ExamineData({TorqueRun(motion, drive_Nm + 10.0 * ripple)},
                       SmallModel({{"inertia", 0.01}, {"coulomb", drive_Nm}}));
  };
  EXPECT_FALSE(HasFault(examined(10.0), "units")) << TextOf(examined(10.0));
  EXPECT_TRUE(HasFault(examined(1.0), "units")) << TextOf(examined(1.0));
}

TEST(Gate, ReadingsOfRecordingsThatContradictEachOtherAreNoFault) {
  const Motion motion = TwoSines();
  const actuator::JointModel model =
      SmallModel({{"inertia", 0.05}, {"viscous", 0.3}, {"coulomb", 0.5}});
  const auto run = [&](double factor, const std::string& name) {
    types::Run out =
        TorqueRun(motion, 0.05 * motion.a + 0.3 * motion.v + 0.5 * motion.v.sign(), name);
    out.signals[Signal::kTorque] *= factor;
    return out;
  };
  const GateReport alike = ExamineData({run(1e3, "a"), run(1e3, "b")}, model);
  EXPECT_TRUE(HasFault(alike, "units", "torque")) << TextOf(alike);
  EXPECT_TRUE(HasFault(ExamineData({run(1e3, "a"), run(1.0, "b")}, model), "units", "torque"));
  const GateReport apart = ExamineData({run(1e3, "a"), run(1e-3, "b")}, model);
  EXPECT_FALSE(HasFault(apart, "units")) << TextOf(apart);
}

// Nearly every bench: the pendulum hangs at 0, the model's gravity is greatest there.
TEST(Gate, AnAngleWhoseZeroHangsNamesTheOffset) {
  const Motion motion = TwoSines();
  const actuator::JointModel model =
      SmallModel({{"inertia", 0.05}, {"viscous", 0.05}, {"gravity", 2.0}});
  const auto run = [&](double zero_rad) {
    Motion read = motion;
    read.q = motion.q + zero_rad;
    return TorqueRun(read, 0.05 * motion.a + 0.05 * motion.v + 2.0 * motion.q.sin());
  };
  const GateReport hanging = ExamineData({run(0.0)}, model);
  ASSERT_TRUE(HasFault(hanging, "zero", "position")) << TextOf(hanging);
  EXPECT_EQ(hanging.faults.size(), 1u) << TextOf(hanging);
  EXPECT_NE(hanging.faults[0].remedy.find("Add -1.571 rad (-90 degrees)"), std::string::npos)
      << hanging.faults[0].remedy;
  EXPECT_NE(hanging.faults[0].remedy.find("`offset`"), std::string::npos);
  EXPECT_TRUE(ExamineData({run(-0.5 * types::kPi)}, model).faults.empty());
  EXPECT_TRUE(HasFault(ExamineData({run(0.5 * types::kPi)}, model), "zero"));
  types::Run any_zero = run(0.0);
  any_zero.zero_unknown = {Signal::kPosition};
  EXPECT_FALSE(HasFault(ExamineData({any_zero}, model), "zero"));
}

TEST(Gate, ADriveThatIsAMagnitudeHasNoSign) {
  const Motion motion = TwoSines();
  const actuator::JointModel model =
      SmallModel({{"inertia", 0.02}, {"viscous", 1.0}, {"coulomb", 1.0}});
  types::Run run = TorqueRun(motion, 0.02 * motion.a + motion.v + motion.v.sign());
  EXPECT_TRUE(ExamineData({run}, model).faults.empty());
  Eigen::VectorXd& torque = run.signals[Signal::kTorque];
  torque = torque.cwiseAbs().eval();
  const GateReport report = ExamineData({run}, model);
  ASSERT_TRUE(HasFault(report, "drive_sign", "torque")) << TextOf(report);
  EXPECT_NE(report.faults[0].reason.find("magnitude"), std::string::npos);
}

TEST(Gate, ARegisterWhoseSignBitCountsIsWrapped) {
  const Motion motion = TwoSines();
  const actuator::JointModel model = SmallModel({{"inertia", 0.01}, {"viscous", 1.0}});
  types::Run run = TorqueRun(motion, 0.01 * motion.a + motion.v);
  Eigen::VectorXd& torque = run.signals[Signal::kTorque];
  const Eigen::VectorXd read = (1e3 * torque.array()).round() * 1e-3;
  torque = read;
  EXPECT_TRUE(ExamineData({run}, model).faults.empty());
  for (const bool complement : {false, true}) {
    for (Eigen::Index i = 0; i < read.size(); ++i) {
      if (!(read[i] < 0.0)) continue;
      torque[i] = complement ? 65.536 + read[i] : 32.768 - read[i];
    }
    const GateReport report = ExamineData({run}, model);
    EXPECT_TRUE(HasFault(report, "wrapped", "torque")) << complement << TextOf(report);
    EXPECT_EQ(report.faults.size(), 1u) << TextOf(report);
  }
  // On in one direction, off in the other: two groups, but no sizes.
  const Eigen::VectorXd noise = Noise(4000, 1e-2, 8).cwiseAbs();
  torque = (motion.v > 0.0).select(noise.array() + 5.0, noise.array()).matrix();
  EXPECT_FALSE(HasFault(ExamineData({run}, model), "wrapped"));
}

TEST(Gate, ALinearJointNeedsNoLeverAndNoGravity) {
  actuator::JointModel axis = SmallModel({{"load_force", 1.0}, {"declared_payload", 1.0}});
  axis.kind = types::JointKind::kPrismatic;
  axis.constants.link_length_m = 1.0;
  axis.constants.gravity_m_s2 = 0.0;
  EXPECT_TRUE(ExamineData({}, axis).faults.empty());
}

TEST(Gate, ASoundRecordingHasNoFaultAndItsRate) {
  const GateReport report = ExamineData(Recorded().train, Recorded().declared);
  EXPECT_TRUE(report.faults.empty()) << TextOf(report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().name, "rate");
  EXPECT_NEAR(report.findings.front().value, 80.0, 1.0);
}

TEST(Gate, EachRateIsNamedWithItsRecordings) {
  const auto rate_of = [](const std::vector<double>& periods_s) {
    std::vector<types::Run> runs;
    for (const double period_s : periods_s) {
      types::Run run;
      run.name = "run_" + std::to_string(runs.size() + 1);
      run.time_s = Eigen::VectorXd::LinSpaced(1000, 0.0, 999.0 * period_s);
      run.signals[Signal::kPosition] = (2.0 * run.time_s.array()).sin();
      runs.push_back(std::move(run));
    }
    return ExamineData(runs, actuator::JointModel{}).findings.front();
  };
  EXPECT_EQ(rate_of({0.002, 0.002, 0.003}).text,
            "sampled at 500 Hz (run_1, run_2) and 333.3 Hz (run_3)");
  EXPECT_EQ(rate_of({0.002, 0.002003}).text, "sampled at 500 Hz");
  EXPECT_NEAR(rate_of({0.002, 0.003}).value, 0.5 * (500.0 + 1000.0 / 3.0), 0.1);
}

TEST(Gate, AClockThatWasSetBackOrForwardIsAFinding) {
  const GateReport plain = ExamineData(Recorded().train, Recorded().declared);
  EXPECT_EQ(FindingText(plain, "clock_set_back"), "");
  EXPECT_EQ(FindingText(plain, "clock_set_forward"), "");
  scene::Recorded recorded = Recorded();
  types::Run& run = recorded.train.front();
  run.clock_set_back_s = 0.25;
  // Where it moves fast, an hour later.
  const Eigen::VectorXd& q = run.At(Signal::kPosition);
  Eigen::Index at = 10;
  for (Eigen::Index i = 10; i + 10 < run.size(); ++i) {
    if (std::abs(q[i] - q[i - 1]) > std::abs(q[at] - q[at - 1])) at = i;
  }
  run.time_s.tail(run.size() - at).array() += 3600.0;
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_EQ(FindingText(report, "clock_set_back"),
            "the clock of the recording was set back by 0.25 s; rows are in the order of their "
            "ticks, and time goes on");
  EXPECT_TRUE(FindingText(report, "clock_set_forward")
                  .starts_with("the clock of the recording was set forward by 3600"))
      << FindingText(report, "clock_set_forward");
  EXPECT_EQ(FindingText(report, "lost_rows"), FindingText(plain, "lost_rows"));
  // Rows that are lost there are no clock.
  recorded.train.front() = Recorded().train.front();
  types::Run& cut = recorded.train.front();
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < 40; ++i) rows.push_back(at + i);
  cut = WithoutRows(recorded.train, {{.run = 0, .signal = "position", .rows = rows}}).front();
  const GateReport lost = ExamineData(recorded.train, recorded.declared);
  EXPECT_EQ(FindingText(lost, "clock_set_forward"), "");
  const auto count = [](const GateReport& of) {
    return std::stoi("0" + FindingText(of, "lost_rows"));
  };
  EXPECT_EQ(count(lost), count(plain) + 40);
}

TEST(Gate, TemperatureInKelvinHundredthsInOneRecordingDiffersFromTheOthers) {
  scene::Recorded recorded = Recorded();
  recorded.train.back().signals[Signal::kTemperature] *= 100.0;
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(std::any_of(report.faults.begin(), report.faults.end(), [](const Fault& at) {
    return at.rule == "recording_differs" && at.signal == "temperature";
  })) << TextOf(report);
}

TEST(Gate, AnAcceptedFaultIsListedAndDoesNotStop) {
  scene::Recorded recorded = Recorded();
  Plant("spike_current", 5, &recorded.train, &recorded.declared);
  const GateReport report = ExamineData(recorded.train, recorded.declared, {.accepted = {"spike"}});
  ASSERT_EQ(report.faults.size(), 1u) << TextOf(report);
  EXPECT_TRUE(report.faults.front().accepted);
  EXPECT_FALSE(report.stops());
}

TEST(Gate, AnAcceptedFaultThatIsNoRuleIsRefused) {
  EXPECT_THROW(ExamineData(Recorded().train, Recorded().declared, {.accepted = {"noise"}}),
               std::invalid_argument);
}

TEST(Gate, TheRowOfASpikeIsLeftOutAndNamed) {
  scene::Recorded recorded = Recorded();
  types::Run& run = recorded.train.back();
  run.content_hash = "as recorded";
  Eigen::VectorXd& current = run.signals[Signal::kMotorCurrent];
  current[400] += 2.0 * (current.maxCoeff() - current.minCoeff());
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(report.faults.empty()) << TextOf(report);
  ASSERT_EQ(report.left_out.size(), 1u);
  EXPECT_EQ(report.left_out[0].run, 1u);
  EXPECT_EQ(report.left_out[0].signal, "motor_current");
  EXPECT_EQ(report.left_out[0].rows, std::vector<Eigen::Index>{400});
  EXPECT_EQ(FindingText(report, kLeftOutRows),
            "row 400 of motor_current in " + run.name + " stands alone: left out");

  const std::vector<types::Run> left = WithoutRows(recorded.train, report.left_out);
  EXPECT_EQ(left[0].size(), recorded.train[0].size());
  ASSERT_EQ(left[1].size(), run.size() - 1);
  EXPECT_EQ(left[1].time_s[399], run.time_s[399]);
  EXPECT_EQ(left[1].time_s[400], run.time_s[401]);
  EXPECT_EQ(left[1].At(Signal::kMotorCurrent)[400], current[401]);
  EXPECT_EQ(left[1].content_hash, "as recorded");
  EXPECT_THROW(WithoutRows({}, report.left_out), std::out_of_range);

  // The row that is missing now is none that the recording lost.
  EXPECT_EQ(FindingText(report, "lost_rows"),
            FindingText(ExamineData(Recorded().train, Recorded().declared), "lost_rows"));
}

TEST(Gate, ManySpikesOfAChannelAreAFault) {
  scene::Recorded recorded = Recorded();
  Eigen::VectorXd& current = recorded.train.front().signals[Signal::kMotorCurrent];
  const double far = 2.0 * Range(current);
  for (Eigen::Index k = 0; k < 10; ++k) current[100 + 150 * k] += far;
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  ASSERT_EQ(report.faults.size(), 1u) << TextOf(report);
  EXPECT_EQ(report.faults.front().rule, "spike");
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_NE(FormatFault(report.faults.front()).find("--accept-fault spike"), std::string::npos);
}

TEST(Gate, RowsOfLaterFaultsAreThoseOfTheRecording) {
  scene::Recorded recorded = Recorded();
  Plant("frozen_position", 5, &recorded.train, &recorded.declared);
  const Fault frozen = ExamineData(recorded.train, recorded.declared).faults.at(0);
  for (types::Run& run : recorded.train) {
    Eigen::VectorXd& current = run.signals[Signal::kMotorCurrent];
    current[30] += 2.0 * Range(current);
  }
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_EQ(report.left_out.size(), 2u);
  ASSERT_FALSE(report.faults.empty()) << TextOf(report);
  EXPECT_EQ(report.faults.front().rule, frozen.rule);
  EXPECT_EQ(report.faults.front().first_row, frozen.first_row);
  EXPECT_EQ(report.faults.front().last_row, frozen.last_row);
}

TEST(Gate, ASpikeInTheFirstAndInTheLastRowIsSeen) {
  types::Run run = TorqueRun(TwoSines(), (2.0 * TwoSines().t).sin());
  Eigen::VectorXd& torque = run.signals[Signal::kTorque];
  const Eigen::Index last = run.size() - 1;
  for (const Eigen::Index row : {Eigen::Index{0}, last}) torque[row] += 10.0;
  const GateReport report = ExamineData({run}, SmallModel({}));
  ASSERT_EQ(report.left_out.size(), 1u) << TextOf(report);
  EXPECT_EQ(report.left_out[0].rows, (std::vector<Eigen::Index>{0, last}));
  EXPECT_TRUE(report.faults.empty()) << TextOf(report);
  // An angle, too, whose jump there does not show that it stays.
  run.signals[Signal::kPosition][last] += 10.0;
  EXPECT_TRUE(ExamineData({run}, SmallModel({})).faults.empty());
}

// A controller that stops a motion gives the drive a jolt: the motion answers in that very row.
TEST(Gate, ASpikeThatTheMotionAnswersIsKept) {
  constexpr Eigen::Index kRow = 812;
  Motion motion = TwoSines();
  const auto examined = [&] {
    types::Run run = TorqueRun(motion, (2.0 * motion.t).sin());
    run.signals[Signal::kTorque][kRow] += 10.0;
    return ExamineData({run}, SmallModel({}));
  };
  EXPECT_EQ(examined().left_out.size(), 1u);
  ASSERT_GT(std::abs(motion.v[kRow]), 0.2);
  motion.q.tail(motion.q.size() - kRow).setConstant(motion.q[kRow]);
  const GateReport report = examined();
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_FALSE(HasFault(report, "spike", "torque")) << TextOf(report);
  EXPECT_NE(FindingText(report, "jumps").find("row 812"), std::string::npos) << TextOf(report);
  EXPECT_NE(FindingText(report, "jumps").find("slope of position"), std::string::npos);
}

TEST(Gate, ASpikeBesideAJumpOfAnotherChannelIsKept) {
  constexpr Eigen::Index kRow = 812;
  types::Run run = TorqueRun(TwoSines(), (2.0 * TwoSines().t).sin());
  run.signals[Signal::kTorque][kRow] += 10.0;
  Eigen::VectorXd& load = run.signals[Signal::kLoadForce];
  load = Noise(run.size(), 1e-2, 5);
  EXPECT_EQ(ExamineData({run}, SmallModel({})).left_out.size(), 1u);
  load.tail(run.size() - kRow).array() += 50.0;
  const GateReport report = ExamineData({run}, SmallModel({}));
  EXPECT_TRUE(report.left_out.empty());
  EXPECT_NE(FindingText(report, "jumps").find("load_force jumps"), std::string::npos);
}

// Statistics are ratios: the same recording in other units, declared in them, gives the same.
TEST(Gate, OtherUnitsOfTheCurrentGiveTheSameStatistics) {
  scene::Recorded recorded = Recorded();
  const GateReport before = ExamineData(recorded.train, recorded.declared);
  for (types::Run& run : recorded.train) run.signals[Signal::kMotorCurrent] *= 1000.0;
  recorded.declared.constants.torque_constant_Nm_A /= 1000.0;
  for (actuator::Term& term : recorded.declared.terms) {
    const std::string name = term.effect->info().name;
    const auto declared = term;
    term.effect =
        effects::MakeEffect(name, recorded.declared.constants, declared.effect->info().balance);
  }
  const GateReport after = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(after.faults.empty()) << TextOf(after);
  ASSERT_EQ(before.largest.size(), after.largest.size());
  for (std::size_t i = 0; i < before.largest.size(); ++i) {
    EXPECT_NEAR(before.largest[i].statistic, after.largest[i].statistic,
                1e-6 * (1.0 + before.largest[i].statistic))
        << before.largest[i].rule;
  }
}

// What happens on a sound rig and has to pass: findings and the tracer's business.
TEST(Gate, ALateVelocityAWrongGainAndSaturationAreNoFaults) {
  scene::Recorded recorded = Recorded();
  for (types::Run& run : recorded.train) {
    Eigen::VectorXd& current = run.signals[Signal::kMotorCurrent];
    current *= 1.25;
    const double limit = 0.6 * current.cwiseAbs().maxCoeff();
    current = current.cwiseMin(limit).cwiseMax(-limit).eval();
    Eigen::VectorXd& v = run.signals[Signal::kVelocity];
    v.tail(v.size() - 2) = v.head(v.size() - 2).eval();
  }
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(report.faults.empty()) << TextOf(report);
  const auto has = [&](const std::string& name) {
    return std::any_of(report.findings.begin(), report.findings.end(),
                       [&](const gate::Finding& at) { return at.name == name; });
  };
  EXPECT_TRUE(has("saturation"));
  EXPECT_TRUE(has("lag_velocity"));
}

TEST(Gate, AMissingConstantNamesTheLineToAdd) {
  scene::Recorded recorded = Recorded();
  recorded.declared.constants.torque_constant_Nm_A = 0.0;
  const GateReport report = ExamineData({}, recorded.declared);
  ASSERT_EQ(report.faults.size(), 1u) << TextOf(report);
  EXPECT_NE(report.faults.front().remedy.find("torque_constant_Nm_A:"), std::string::npos);
}

TEST(Gate, ARecordingOfFewRowsIsNotAssessed) {
  types::Run run;
  run.name = "short";
  run.time_s = Eigen::VectorXd::LinSpaced(3, 0.0, 0.2);
  run.signals[Signal::kPosition] = Eigen::VectorXd::Zero(3);
  run.signals[Signal::kMotorCurrent] = Eigen::VectorXd::Ones(3);
  EXPECT_TRUE(ExamineData({run}, Recorded().declared).faults.empty());
  EXPECT_TRUE(ExamineData({}, Recorded().declared).faults.empty());
}

TEST(Gate, ChannelsOfAnotherLengthAreRefused) {
  types::Run run;
  run.time_s = Eigen::VectorXd::LinSpaced(3, 0.0, 0.2);
  run.signals[Signal::kPosition] = Eigen::VectorXd::Zero(2);
  EXPECT_THROW(ExamineData({run}, Recorded().declared), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::gate
