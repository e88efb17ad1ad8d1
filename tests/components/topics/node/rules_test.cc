// The tables of priorities and cut-offs: the order that they promise.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "components/topics/node/cut_off.h"
#include "components/topics/node/realtime.h"

namespace sinew::node {
namespace {

TEST(PriorityRules, AreGradedFromTheBusToTheAdaptation) {
  const char* const order[] = {"estop",  "can-bus", "can-bridge", "control", "reference",
                               "regime", "esn",     "pneumatics", "rls",     "a kind of a user's"};
  for (std::size_t i = 1; i < std::size(order); ++i) {
    EXPECT_GT(PriorityOf(order[i - 1]).priority, PriorityOf(order[i]).priority) << order[i];
  }
  for (const char* provider : {"world", "surrogate"}) {
    EXPECT_EQ(PriorityOf(provider).priority, PriorityOf("can-bridge").priority);
  }
  for (const char* observer : {"logger", "player", "residual", "performance"}) {
    EXPECT_EQ(PriorityOf(observer).priority, 0) << "SCHED_OTHER";
  }
}

TEST(PriorityRules, AStandInHasThePriorityOfItsRole) {
  const std::pair<const char*, const char*> stand_ins[] = {{"recorded-reference", "reference"},
                                                           {"regime-truth", "regime"},
                                                           {"inverse-dynamics", "esn"},
                                                           {"ideal-pressure", "pneumatics"},
                                                           {"frozen-readout", "rls"}};
  for (const auto& [stand_in, role] : stand_ins) {
    EXPECT_EQ(PriorityOf(stand_in).priority, PriorityOf(role).priority) << stand_in;
  }
}

TEST(PriorityRules, StayBelowTheInterruptThreadsOfTheKernel) {
  std::set<std::string_view> names;
  for (const PriorityRule& rule : PriorityRules()) {
    EXPECT_TRUE(names.insert(rule.component).second) << rule.component;
    EXPECT_LT(rule.priority, 50) << rule.component;
    EXPECT_FALSE(rule.reason.empty());
  }
  EXPECT_EQ(PriorityRules().back().component, "");
}

TEST(CpuRules, AllShareTheLastCoreButWhatStandsForHardware) {
  const int several[] = {0, 2, 5}, one[] = {3};
  for (const char* kind : {"can-bridge", "control", "rls", "a kind of a user's"}) {
    EXPECT_EQ(DefaultCpu(kind, several), 5) << kind;
    EXPECT_EQ(DefaultCpu(kind, one), 3) << kind;
  }
  for (const char* kind : {"can-bus", "virtual-axes"}) {
    EXPECT_EQ(DefaultCpu(kind, several), 2) << kind;
    EXPECT_EQ(DefaultCpu(kind, one), 3) << kind;
  }
}

TEST(CutOffRules, WhoIsAwaitedGivesUpBeforeThoseWhoWaitForHim) {
  constexpr double kStep = 0.1 - 1e-12;  // for computing and sending the answer
  const auto share = [](std::string_view component) { return CutOffOf(component).share; };
  for (const char* first : {"reference", "regime"}) {
    EXPECT_LE(share(first) + kStep, share("esn"));
  }
  EXPECT_LE(share("esn") + kStep, share("control"));
  EXPECT_LE(share("control") + kStep, kProviderCutOff);
  EXPECT_LE(share("another controller") + kStep, kProviderCutOff);
  EXPECT_LE(kProviderCutOff + kStep, share("rls")) << "it waits for control's command";
  EXPECT_LE(share("rls") + kStep, 1.0) << "its readout belongs to the next tick";
}

}  // namespace
}  // namespace sinew::node
