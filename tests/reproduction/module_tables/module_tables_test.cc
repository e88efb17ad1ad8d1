// Oracle: scores of known content.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "reproduction/module_tables/pressure_section.h"
#include "reproduction/module_tables/regime_section.h"
#include "reproduction/module_tables/rls_section.h"

namespace sinew::reproduction {
namespace {

using acceptance::Breakage;

const report::Comparison& Line(const report::Section& section, const std::string& part) {
  const auto found =
      std::find_if(section.comparisons.begin(), section.comparisons.end(),
                   [&](const auto& line) { return line.name.find(part) != std::string::npos; });
  if (found == section.comparisons.end()) throw std::out_of_range(part);
  return *found;
}

acceptance::RegimeScore Perfect() {
  acceptance::RegimeScore score;
  score.samples = 1000;
  score.transitions = score.found = 10;
  return score;
}

TEST(RegimeSection, MarksWhatIsReached) {
  acceptance::RegimeGrid grid;
  grid.scores = {Perfect()};
  grid.setups = {{.done = true}};
  grid.unknowns = {{"slip", 1.0, 0.1}};
  const report::Section section = MakeRegimeSection(grid);
  report::CheckSection(section);
  ASSERT_FALSE(section.comparisons.empty());
  for (const report::Comparison& line : section.comparisons) EXPECT_EQ(line.met, true) << line.name;
}

TEST(RegimeSection, MarksEveryTargetThatIsMissed) {
  acceptance::RegimeGrid grid;
  grid.scores = {Perfect()};
  grid.scores[0].wrong = 6;
  grid.scores[0].found = 9;
  grid.scores[0].false_changes = grid.scores[0].unknown = 1;
  grid.setups = {{.done = false}};
  grid.unknowns = {{"slip", 0.99, 0.1}};
  for (const report::Comparison& line : MakeRegimeSection(grid).comparisons) {
    EXPECT_EQ(line.met, false) << line.name;
  }
}

TEST(RegimeSection, OneBadCaseIsNotHiddenByManyGoodOnes) {
  acceptance::RegimeGrid grid;
  grid.scores.assign(100, Perfect());
  grid.scores[50].wrong = 6;
  grid.scores[99].at.noise_rad = 0.0;  // its level is assessed by itself
  EXPECT_EQ(Line(MakeRegimeSection(grid), "right samples").met, false);
}

TEST(PressureSection, MarksWhatIsReachedAndWhatIsMissed) {
  acceptance::PressureCheck check;
  acceptance::HoldScore hold;
  hold.settled = true;
  hold.worst_bar = 0.04;
  hold.shortest_on_s = hold.shortest_off_s = std::numeric_limits<double>::infinity();
  check.holds = {hold};
  check.faults = {
      {Breakage::kSensorHigh, pneumatics::Fault::kSensor, 0.05, 4.0, true},
      {Breakage::kNothing, pneumatics::Fault::kNone, 0.0, 4.0, false},
  };
  report::Section section = MakePressureSection(check, {});
  report::CheckSection(section);
  for (const report::Comparison& line : section.comparisons) EXPECT_EQ(line.met, true) << line.name;

  check.holds[0].worst_bar = 0.06;
  check.holds[0].reversals = 10;
  check.holds[0].shortest_on_s = -0.1;
  check.holds[0].fault = pneumatics::Fault::kLeak;
  check.faults[0].safe = false;
  section = MakePressureSection(check, {});
  for (const report::Comparison& line : section.comparisons)
    EXPECT_EQ(line.met, false) << line.name;
}

TEST(PressureSection, AFaultOfAnotherNameIsMissed) {
  acceptance::PressureCheck check;
  check.faults = {{Breakage::kLeak, pneumatics::Fault::kSensor, 0.05, 4.0, true}};
  const report::Section section = MakePressureSection(check, {});
  EXPECT_EQ(section.comparisons.back().met, false);
}

TEST(RlsSection, MarksWhatIsReachedAndWhatIsMissed) {
  acceptance::BatchScore batch{
      .updates = 1, .readout_difference = 1e-12, .covariance_difference = 1e-12};
  acceptance::SoakScore soak;
  soak.updates = 10;
  soak.noise_Nm = 1.0;
  soak.smallest_eigenvalue = 0.1;
  soak.largest_eigenvalue = 1.0;
  acceptance::TimeScore time{.features = 76, .outputs = 12, .update_us = 1.7, .textbook_us = 3.0};
  report::Section section = MakeRlsSection(batch, soak, {time});
  report::CheckSection(section);
  for (const report::Comparison& line : section.comparisons) {
    EXPECT_TRUE(line.met.value_or(true)) << line.name;
  }
  batch.readout_difference = batch.covariance_difference = 1e-6;
  soak.largest_eigenvalue = 3.0;
  time.update_us = 1.9;
  for (const report::Comparison& line : MakeRlsSection(batch, soak, {time}).comparisons) {
    EXPECT_FALSE(line.met.value_or(false)) << line.name;
  }
}

}  // namespace
}  // namespace sinew::reproduction
