#include "components/model/trace/candidates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "components/model/trace/curves.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::MakeDesign;
using identify::SyntheticModel;
using identify::SyntheticRun;

bool Has(const CandidateSet& set, const std::string& name) {
  return std::any_of(set.candidates.begin(), set.candidates.end(),
                     [&](const Candidate& candidate) { return candidate.name() == name; });
}

bool Missing(const CandidateSet& set, const std::string& name) {
  return std::any_of(set.untestable.begin(), set.untestable.end(),
                     [&](const Untestable& each) { return each.effect == name; });
}

TEST(Candidates, WhatTheModelHoldsAndDrivesAreNone) {
  const auto design =
      MakeDesign({SyntheticRun(SyntheticModel(), {.duration_s = 10.0})}, SyntheticModel());
  const CandidateSet set = MakeCandidates(design, SyntheticModel(), {});
  EXPECT_FALSE(Has(set, "viscous"));
  EXPECT_FALSE(Has(set, "drive_current"));
  EXPECT_FALSE(Has(set, "drive_voltage"));
  EXPECT_TRUE(Has(set, "stribeck"));
  EXPECT_TRUE(Has(set, "quadratic_viscous"));
}

bool Stated(const CandidateSet& set, const std::string& name) {
  return std::any_of(set.candidates.begin(), set.candidates.end(), [&](const Candidate& candidate) {
    return candidate.name() == name && candidate.stated;
  });
}

TEST(Candidates, WhatADeclaredTermStatesAlreadyIsNoCause) {
  actuator::JointModel model = SyntheticModel();
  const auto design =
      MakeDesign({SyntheticRun(model, {.duration_s = 10.0, .motor_position = true})}, model);
  const CandidateSet set = MakeCandidates(design, model, {});
  for (const char* stated :
       {"rotor_inertia", "link_inertia", "motor_viscous", "spring", "offset"}) {
    EXPECT_TRUE(Stated(set, stated)) << stated;
  }
  EXPECT_FALSE(Stated(set, "stribeck"));
  std::erase_if(model.terms, [](const actuator::Term& term) {
    const std::string name = term.effect->info().name;
    return name == "gravity" || name == "viscous";
  });
  const CandidateSet without = MakeCandidates(design, model, {});
  for (const char* missing : {"gravity", "viscous", "motor_viscous", "spring"}) {
    EXPECT_TRUE(Has(without, missing)) << missing;
    EXPECT_FALSE(Stated(without, missing)) << missing;
  }
}

// Both torques of a gear are measured: what hangs on its link is in neither, and a sensor has no
// winding.
TEST(Candidates, BetweenTwoTorqueSensorsNothingHangs) {
  actuator::JointModel model = SyntheticModel();
  const auto design = MakeDesign({SyntheticRun(model, {.duration_s = 10.0})}, model);
  std::erase_if(model.terms, [](const actuator::Term& term) {
    const std::string name = term.effect->info().name;
    return name == "gravity" || name == "drive_current" || name == "load_force";
  });
  model.terms.push_back(identify::TermOf("drive_torque", {1.0}, model.constants));
  EXPECT_FALSE(Stated(MakeCandidates(design, model, {}), "gravity"));
  EXPECT_TRUE(Missing(MakeCandidates(design, model, {}), "torque_constant_saturation"));
  EXPECT_TRUE(std::ranges::any_of(EventCandidates(model, {}), [](const Candidate& candidate) {
    return candidate.name() == "payload_step";
  }));
  model.terms.push_back(identify::TermOf("load_force", {1.0}, model.constants));
  EXPECT_TRUE(Stated(MakeCandidates(design, model, {}), "gravity"));
  EXPECT_TRUE(Stated(MakeCandidates(design, model, {}), "payload"));
  EXPECT_FALSE(std::ranges::any_of(EventCandidates(model, {}), [](const Candidate& candidate) {
    return candidate.name() == "payload_step";
  }));
}

TEST(Candidates, AnEffectThatWasTakenOutIsNotSearchedFor) {
  const auto design =
      MakeDesign({SyntheticRun(SyntheticModel(), {.duration_s = 10.0})}, SyntheticModel());
  ASSERT_TRUE(Has(MakeCandidates(design, SyntheticModel(), {}), "stribeck"));
  const InForce without{.without_effects = {"stribeck"}};
  EXPECT_FALSE(Has(MakeCandidates(design, SyntheticModel(), without), "stribeck"));
}

TEST(Candidates, EffectsWithoutTheirSignalAreNamed) {
  const auto design =
      MakeDesign({SyntheticRun(SyntheticModel(), {.duration_s = 10.0})}, SyntheticModel());
  const CandidateSet set = MakeCandidates(design, SyntheticModel(), {});
  EXPECT_TRUE(Missing(set, "seal_hysteresis"));
  EXPECT_FALSE(Has(set, "seal_hysteresis"));
}

TEST(Candidates, GridsAreAllCombinations) {
  effects::EffectInfo info;
  EXPECT_EQ(GridOf(info), (std::vector<std::vector<double>>{{}}));
  info.nonlinear.push_back({.name = "a", .default_value = 5.0, .grid = {1.0, 2.0}});
  info.nonlinear.push_back({.name = "b", .default_value = 5.0});
  EXPECT_EQ(GridOf(info), (std::vector<std::vector<double>>{{1.0, 5.0}, {2.0, 5.0}}));
}

TEST(Candidates, ASlidingLengthOfAFewCountsIsNone) {
  actuator::JointModel model = SyntheticModel();
  const std::vector<types::Run> runs = {SyntheticRun(model, {.duration_s = 10.0})};
  const identify::ProcessingOptions options = identify::FromMotion(runs, model, 0.25);
  const identify::Design design(identify::MakeStates(runs, model, options), options);
  const auto shortest = [&] {
    double least = 1e9;
    const auto presliding = effects::MakeEffect("presliding", model.constants);
    for (const auto& psi : GridFor(design, model.constants, presliding->info())) {
      least = std::min(least, psi.front());
    }
    return least;
  };
  model.constants.encoder_counts_per_turn = 0.0;
  const double undeclared = shortest();
  model.constants.encoder_counts_per_turn = 1024.0;
  EXPECT_GE(shortest(), 8.0 * 2.0 * M_PI / 1024.0);
  EXPECT_LT(undeclared, shortest());
  model.constants.encoder_counts_per_turn = 1e6;
  EXPECT_DOUBLE_EQ(shortest(), undeclared);
}

// Whatever else was not the same in two recordings would be called temperature.
TEST(Candidates, ATemperaturePerRecordingNeedsOneThatComesTwice) {
  const actuator::JointModel model = SyntheticModel();
  const auto testable = [&](const std::vector<double>& temperatures_degC, double warms_degC) {
    std::vector<types::Run> runs;
    for (const double at : temperatures_degC) {
      types::Run& run = runs.emplace_back(SyntheticRun(model, {.duration_s = 10.0}));
      run.signals[types::Signal::kTemperature] =
          Eigen::VectorXd::LinSpaced(run.size(), at, at + warms_degC);
    }
    const auto design = MakeDesign(runs, model);
    const CandidateSet set = MakeCandidates(design, model, {});
    EXPECT_NE(Has(set, "temperature_friction"), Missing(set, "temperature_friction"));
    const std::vector<Curve> curves = FreeCurves(design, effects::Balance::kMotion);
    const bool curve = std::any_of(curves.begin(), curves.end(), [](const Curve& each) {
      return each.variable == "temperature_degC";
    });
    EXPECT_TRUE(curve ? Has(set, "temperature_friction") : true);
    return Has(set, "temperature_friction");
  };
  EXPECT_FALSE(testable({20.0, 25.0}, 0.5));
  EXPECT_FALSE(testable({20.0, 22.5, 25.0}, 0.5));
  EXPECT_TRUE(testable({20.0, 25.0}, 4.0)) << "it warms up";
  EXPECT_TRUE(testable({20.0, 25.0, 20.2}, 0.5)) << "one comes twice";
  EXPECT_TRUE(testable({20.0, 21.0, 22.0, 23.0, 24.0, 25.0}, 0.1)) << "a study of six";
}

TEST(Candidates, LinearJointsHaveNoAngles) {
  actuator::JointModel model = SyntheticModel();
  model.kind = types::JointKind::kPrismatic;
  model.terms.erase(model.terms.begin() + 4);  // gravity
  types::Run run = SyntheticRun(SyntheticModel(), {.duration_s = 10.0});
  run.kind = types::JointKind::kPrismatic;
  const CandidateSet set = MakeCandidates(MakeDesign({run}, model), model, {});
  EXPECT_FALSE(Has(set, "gravity"));
  EXPECT_FALSE(Has(set, "payload"));
  EXPECT_FALSE(Has(set, "gear_eccentricity"));
}

}  // namespace
}  // namespace sinew::trace
