// How large effects are expected on a machine, and what counts behind two low-passes.
#include "components/model/trace/machine_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "components/model/trace/problem.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;

struct Recorded {
  actuator::JointModel model;
  Design design;
};

// A machine `stronger` times as strong: the same motion.
Recorded Record(double stronger, double narrower = 1.0) {
  actuator::JointModel model = identify::SyntheticModel();
  model.constants.torque_constant_Nm_A *= stronger;
  for (actuator::Term& term : model.terms) {
    const std::string& name = term.effect->info().name;
    if (name == "drive_current" || name == "load_force") continue;
    term.linear[0].value *= stronger;
  }
  actuator::RemakeEffects(&model);
  const std::vector<types::Run> runs = {
      identify::SyntheticRun(model, {.rate_Hz = 100.0, .seed = 1, .noise_A = 0.05})};
  identify::ProcessingOptions options = identify::FromMotion(runs, model, 0.25);
  options.state_cutoff_Hz *= narrower;
  return {model, Design(identify::MakeStates(runs, model, options), options)};
}

MachineSize SizeOf(const Recorded& recorded) {
  return SizeOf(recorded.design, MakeUsedRows(recorded.design, kFewestRowsPerBlock),
                recorded.model);
}

double Expected(const std::string& effect, const Recorded& recorded) {
  const auto made = effects::MakeEffect(effect, recorded.model.constants);
  return ExpectedSize(made->info().linear[0], SizeOf(recorded), recorded.model.constants);
}

TEST(MachineSize, IsThatOfTheDeclaredTermsAndOfTheMotion) {
  const MachineSize size = SizeOf(Record(1.0));
  EXPECT_DOUBLE_EQ(size.friction, 0.4);
  EXPECT_DOUBLE_EQ(size.inertia, 0.3);
  EXPECT_DOUBLE_EQ(size.viscous, 0.5);
  EXPECT_DOUBLE_EQ(size.gravity, 1.5);
  EXPECT_GT(size.drive_rms, 1.0);
  EXPECT_GT(size.drive_peak, size.drive_rms);
  EXPECT_GT(size.quick, 1.0);
  EXPECT_EQ(size.pressure_bar, 0.0);
}

TEST(MachineSize, WhatIsNotDeclaredFollowsFromTheMotion) {
  Recorded recorded = Record(1.0);
  const MachineSize declared = SizeOf(recorded);
  std::erase_if(recorded.model.terms, [](const actuator::Term& term) {
    return term.effect->info().name == "coulomb" || term.effect->info().name == "viscous";
  });
  const MachineSize size = SizeOf(recorded);
  EXPECT_DOUBLE_EQ(size.friction, 0.1 * declared.drive_rms);
  EXPECT_DOUBLE_EQ(size.viscous * size.quick, size.friction);
}

TEST(MachineSize, TenTimesAsStrongAMachineHasTenTimesAsLargeTorquesAndTheSameRatios) {
  const Recorded weak = Record(1.0), strong = Record(10.0);
  for (const char* effect : {"stribeck", "direction_dependent_coulomb", "quadratic_viscous",
                             "flexible_link", "elastic_joint", "payload"}) {
    EXPECT_NEAR(Expected(effect, strong) / Expected(effect, weak), 10.0, 1e-6) << effect;
  }
  for (const char* effect : {"load_dependent_friction", "load_cell_gain", "current_offset"}) {
    EXPECT_NEAR(Expected(effect, strong), Expected(effect, weak), 1e-9) << effect;
  }
}

TEST(CompareBands, WhatComesFromRatesCountsNoMoreThanBehindTheOtherLowPass) {
  Recorded wide = Record(1.0), narrow = Record(1.0, 0.6);
  const LikelihoodFit base = EstimateLikelihood(&wide.design, wide.model, {});
  const Problem alone = MakeProblem(wide.design, base.likelihood, wide.model, base.fit);
  Problem problem = MakeProblem(wide.design, base.likelihood, wide.model, base.fit);
  CompareBands(&narrow.design, wide.model, &problem);
  Recorded again = Record(1.0, 0.6);
  const LikelihoodFit there_fit = EstimateLikelihood(&again.design, again.model, {});
  const Problem there = MakeProblem(again.design, there_fit.likelihood, again.model, there_fit.fit);
  std::map<std::string, double> best;
  for (std::size_t h = 0; h < there.hypotheses().size(); ++h) {
    double& net = best[there.hypotheses()[h].name];
    net = std::max(net, FitSet(there.choices(), {h}).net);
  }
  int rates = 0;
  for (std::size_t h = 0; h < problem.hypotheses().size(); ++h) {
    const double net = FitSet(problem.choices(), {h}).net;
    const double before = FitSet(alone.choices(), {h}).net;
    const Hypothesis& hypothesis = problem.hypotheses()[h];
    if (!hypothesis.follows_rates()) {
      EXPECT_EQ(net, before) << hypothesis.name;
      continue;
    }
    ++rates;
    EXPECT_NEAR(net, std::min(before, best[hypothesis.name]), 1e-6) << hypothesis.name;
  }
  EXPECT_GT(rates, 3);
}

}  // namespace
}  // namespace sinew::trace
