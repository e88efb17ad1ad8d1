#include "components/model/gate/gate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

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

class PlantedFault : public testing::TestWithParam<FaultKind> {};

TEST_P(PlantedFault, IsFoundByItsRuleWithReasonAndRemedy) {
  scene::Recorded recorded = Recorded();
  Plant(GetParam().name, 5, &recorded.train, &recorded.declared);
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  EXPECT_TRUE(report.stops());
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
    if (rule.id == "recording_differs") continue;  // below: the balance sees most of it first
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

TEST(Gate, ASoundRecordingHasNoFaultAndItsRate) {
  const GateReport report = ExamineData(Recorded().train, Recorded().declared);
  EXPECT_TRUE(report.faults.empty()) << TextOf(report);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.front().name, "rate");
  EXPECT_NEAR(report.findings.front().value, 80.0, 1.0);
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

TEST(Gate, ASpikeIsReportedWithItsRow) {
  scene::Recorded recorded = Recorded();
  Eigen::VectorXd& current = recorded.train.front().signals[Signal::kMotorCurrent];
  current[400] += 2.0 * (current.maxCoeff() - current.minCoeff());
  const GateReport report = ExamineData(recorded.train, recorded.declared);
  ASSERT_EQ(report.faults.size(), 1u) << TextOf(report);
  EXPECT_EQ(report.faults.front().first_row, 400);
  EXPECT_EQ(report.faults.front().signal, "motor_current");
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
                       [&](const identify::Finding& at) { return at.name == name; });
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
