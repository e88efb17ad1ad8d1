// Oracle: the surrogate's truth, and scores of known content.
#include "tools/acceptance/regime_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace sinew::check {
namespace {

const report::Comparison& Line(const report::Section& section, const std::string& part) {
  const auto found =
      std::find_if(section.comparisons.begin(), section.comparisons.end(),
                   [&](const auto& line) { return line.name.find(part) != std::string::npos; });
  if (found == section.comparisons.end()) throw std::out_of_range(part);
  return *found;
}

RegimeScore Perfect() {
  RegimeScore score;
  score.samples = 1000;
  score.transitions = score.found = 10;
  return score;
}

TEST(RegimeGrid, ADetectorThatKnowsTheNoiseIsRightInAHandsPushes) {
  const RegimeScore score =
      RunRegimeCase({.motion = Motion::kHand, .speed_rad_s = 2.0, .seconds = 6.0, .seed = 3});
  EXPECT_EQ(score.samples, 6 * 240);
  EXPECT_GE(score.transitions, 10) << "two transitions a push, two pushes a second";
  EXPECT_GE(score.right_share(), 0.995) << score.wrong << " wrong";
  EXPECT_EQ(score.unknown, 0);
  EXPECT_EQ(score.made_up, 0);
}

TEST(RegimeGrid, ASetupWithAnOffsetEncoderFindsTheContact) {
  const SetupScore score = RunSetupCase({.pressure_bar = 4.5, .offset_rad = 0.017, .seed = 2});
  ASSERT_TRUE(score.done) << regime::TroubleText(score.trouble);
  EXPECT_LT(std::abs(score.error_rad), 3.84e-4) << "a count of 14 bits";
}

TEST(RegimeGrid, WithoutPressureASetupEndsInTrouble) {
  const SetupScore score = RunSetupCase({.pressure_bar = 1.0, .seed = 2});
  EXPECT_FALSE(score.done);
  EXPECT_NE(score.trouble, regime::Trouble::kNone);
}

TEST(RegimeSection, TellsWhatIsReached) {
  RegimeGrid grid;
  grid.scores = {Perfect()};
  grid.setups = {{.done = true}};
  grid.unknowns = {{"slip", 1.0, 0.1}};
  const report::Section section = MakeRegimeSection(grid);
  report::CheckSection(section);
  for (const report::Comparison& line : section.comparisons) EXPECT_EQ(line.met, true) << line.name;
}

TEST(RegimeSection, TellsEveryTargetThatIsMissed) {
  RegimeGrid grid;
  grid.scores = {Perfect()};
  grid.scores[0].wrong = 6;
  grid.scores[0].found = 9;
  grid.scores[0].made_up = grid.scores[0].unknown = 1;
  grid.setups = {{.done = false}};
  grid.unknowns = {{"slip", 0.99, 0.1}};
  for (const report::Comparison& line : MakeRegimeSection(grid).comparisons) {
    EXPECT_EQ(line.met, false) << line.name;
  }
}

TEST(RegimeSection, OneBadCaseIsNotHiddenByManyGoodOnes) {
  RegimeGrid grid;
  grid.scores.assign(100, Perfect());
  grid.scores[50].wrong = 6;
  grid.scores[99].at.noise_rad = 0.0;  // its level is assessed by itself
  EXPECT_EQ(Line(MakeRegimeSection(grid), "right samples").met, false);
}

}  // namespace
}  // namespace sinew::check
