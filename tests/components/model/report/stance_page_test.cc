// Sentences, page and JSON of close-loop on a robot that stands on two feet.
#include "components/model/report/stance_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "components/model/report/file/report_file.h"

namespace sinew::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

stance_fit::StanceEffect FourKilograms() {
  stance_fit::StanceEffect effect;
  effect.name = "payload";
  effect.place = "base";
  stance_fit::PlacedPayload payload;
  payload.link_name = "base";
  payload.rigid_with = {"base", "torso"};
  payload.mass_kg = 3.95;
  payload.mass_half_width_95 = 0.25;
  payload.place_m = {0.031, -0.022, 0.09};
  payload.place_half_width_95 = {0.009, 0.011, 0.4};
  payload.excited = {true, true, false};
  effect.payload = payload;
  effect.posterior = {{"payload of base", 0.97}, {"payload of left_foot", 0.03}};
  effect.confirmation = {trace::ConfirmationVerdict::kConfirmed, 1.01, 0.9, 1.12, 12};
  effect.in_model = true;
  return effect;
}

stance_fit::StanceEffect AnkleFriction() {
  stance_fit::StanceEffect effect;
  effect.name = "coulomb";
  effect.place = "left_ankle_pitch";
  effect.term = actuator::MakeTerm("coulomb", {});
  effect.term->linear[0].value = 1.5;
  effect.term->linear[0].half_width_95 = 0.11;
  return effect;
}

StanceReport WithResult(const stance_fit::StanceFitResult& result) {
  StanceReport report;
  report.robot = "biped";
  report.model_file = "robots/biped/model.yaml";
  report.train = {{"a.mcap", "12ab", 3600, 15.0}};
  report.held_out = {{"b<.mcap", "34cd", 3600, 15.0}};
  report.result = result;
  return report;
}

stance_fit::StanceFitResult Found() {
  stance_fit::StanceFitResult result;
  result.verdict = trace::Verdict::kEffect;
  result.p_global = 0.001;
  result.effects = {FourKilograms()};
  result.held_out_before = {1.0, 2.0, 39.5, 9.0, {0.5, 0.25}};
  result.held_out_after = {0.5, 0.75, 5.5, 1.25, {0.4, 0.2}};
  result.train_before = result.held_out_before;
  result.train_after = result.held_out_after;
  result.moving_joints = {"left_knee", "right_knee"};
  result.not_excited = {{"place of the payload along z of base", "it hardly turns"}};
  return result;
}

TEST(StancePage, TheSentenceHasMassAndPlaceWithTheirIntervalsAndWhatIsNotExcited) {
  const std::string sentence = VerdictSentence(WithResult(Found()));
  EXPECT_THAT(sentence, HasSubstr("3.95 +- 0.25 kg at x 31 +- 9 mm, y -22 +- 11 mm"));
  EXPECT_THAT(sentence, HasSubstr("not excited: z"));
  EXPECT_THAT(sentence, Not(HasSubstr("90")));
}

TEST(StancePage, FrictionIsNamedWithJointKeyAndInterval) {
  EXPECT_EQ(StanceEffectText(AnkleFriction()),
            "coulomb of left_ankle_pitch: coulomb_Nm = 1.5 +- 0.11");
}

TEST(StancePage, SaysNoEffectWhenNothingIsFound) {
  stance_fit::StanceFitResult result = Found();
  result.verdict = trace::Verdict::kNone;
  result.effects.clear();
  EXPECT_THAT(VerdictSentence(WithResult(result)), HasSubstr("No effect"));
}

TEST(StancePage, AnEffectThatIsNotConfirmedIsNotInTheModel) {
  stance_fit::StanceFitResult result = Found();
  result.effects = {AnkleFriction()};
  const std::string sentence = VerdictSentence(WithResult(result));
  EXPECT_THAT(sentence, HasSubstr("Nothing was confirmed"));
  EXPECT_THAT(sentence, HasSubstr("coulomb of left_ankle_pitch"));
}

TEST(StancePage, TooLittleDataIsSaidAndHasNoErrors) {
  stance_fit::StanceFitResult result;
  result.verdict = trace::Verdict::kTooLittleData;
  result.too_little = "the recordings have 3 blocks";
  const StanceReport report = WithResult(result);
  EXPECT_THAT(VerdictSentence(report), HasSubstr("3 blocks"));
  const std::string page = FormatHtml(MakePage(report));
  EXPECT_THAT(page, HasSubstr("3 blocks"));
  EXPECT_THAT(page, Not(HasSubstr("<h2>Errors</h2>")));
  const nlohmann::json json = ReportJson(report);
  EXPECT_EQ(json.at("verdict"), "too_little_data");
  EXPECT_FALSE(json.contains("errors"));
}

TEST(StancePage, ThePageHasEveryRowOfTheBalanceBeforeAndAfterAndEscapesNames) {
  const StanceReport report = WithResult(Found());
  const std::string page = FormatHtml(MakePage(report));
  EXPECT_THAT(page, HasSubstr("vertical force</td><td>39.5</td><td>5.5</td>"));
  EXPECT_THAT(page, HasSubstr("torque of right_knee</td><td>0.25</td><td>0.2</td>"));
  EXPECT_THAT(page, HasSubstr("moves with base, torso"));
  EXPECT_THAT(page, HasSubstr("b&lt;.mcap"));
  EXPECT_THAT(page, Not(HasSubstr("b<.mcap")));
}

TEST(StancePage, TheJsonHasThePayloadAndTheErrors) {
  const nlohmann::json json = ReportJson(WithResult(Found()));
  EXPECT_EQ(json.at("verdict"), "effect");
  const nlohmann::json& effect = json.at("effects").at(0);
  EXPECT_EQ(effect.at("payload").at("mass_kg"), 3.95);
  EXPECT_EQ(effect.at("payload").at("position_excited"), nlohmann::json({true, true, false}));
  EXPECT_EQ(effect.at("confirmation").at("verdict"), "confirmed");
  const nlohmann::json& held_out = json.at("errors").at("held_out");
  EXPECT_EQ(held_out.at("force_z_N").at("declared"), 39.5);
  EXPECT_EQ(held_out.at("force_z_N").at("corrected"), 5.5);
  EXPECT_EQ(held_out.at("left_knee").at("corrected"), 0.4);
}

// A joint whose coulomb friction is declared as 1.6 +- 0.48 Nm.
actuator::RobotModel HipOf(double coulomb_Nm) {
  actuator::RobotModel robot;
  actuator::JointModel joint;
  joint.name = "left_hip_pitch";
  joint.terms.push_back(actuator::MakeTerm("coulomb", {}));
  joint.terms.back().linear[0].value = coulomb_Nm;
  joint.terms.back().linear[0].tolerance = 0.3;
  robot.joints.push_back(joint);
  return robot;
}

TEST(StancePage, ListsDeclaredValuesThatTheRefitMovedFarBeyondTheirTolerance) {
  stance_fit::StanceFitResult result = Found();
  result.corrected = HipOf(4.0);
  StanceReport report = WithResult(result);
  report.declared = HipOf(1.6);
  const std::vector<StanceShift> shifts = StanceShifts(report);
  ASSERT_EQ(shifts.size(), 1u);
  EXPECT_EQ(shifts[0].parameter, "coulomb.coulomb_Nm of left_hip_pitch");
  EXPECT_NEAR(shifts[0].tolerances, 5.0, 1e-12);
  EXPECT_THAT(FormatHtml(MakePage(report)), HasSubstr("Absorbed by refitting"));
  report.result.corrected = HipOf(2.0);
  EXPECT_TRUE(StanceShifts(report).empty());
}

std::vector<Picture> PicturesOf(const stance_fit::StanceFitResult& result) {
  std::vector<Picture> out;
  for (const Section& section : MakePage(WithResult(result)).sections) {
    out.insert(out.end(), section.pictures.begin(), section.pictures.end());
  }
  return out;
}

TEST(StancePage, PicturesShowTheHeldOutRowsAndThereAreNoneWithout) {
  stance_fit::StanceFitResult result = Found();
  EXPECT_TRUE(PicturesOf(result).empty());
  result.held_out.time_s = Eigen::VectorXd::LinSpaced(3, 0.0, 1.0);
  result.held_out.before = Eigen::MatrixXd::Constant(3, 3, 7.25);
  result.held_out.after = Eigen::MatrixXd::Constant(3, 3, 0.125);
  const std::vector<Picture> pictures = PicturesOf(result);
  ASSERT_EQ(pictures.size(), 3u);
  EXPECT_THAT(pictures.front().script, HasSubstr("0.5 7.25"));
  EXPECT_THAT(pictures.front().script, HasSubstr("0.5 0.125"));
}

}  // namespace
}  // namespace sinew::report
