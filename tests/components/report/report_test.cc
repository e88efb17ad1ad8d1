#include "components/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "components/report/file/report_file.h"
#include "components/trace/close_loop.h"
#include "tests/components/identify/synthetic.h"

namespace sinew::report {
namespace {

using identify::SyntheticModel;
using identify::SyntheticRun;
using ::testing::HasSubstr;
using ::testing::Not;

struct Made {
  Report report;
  std::vector<Picture> pictures;
};

// With or without an effect that nobody declared.
Made Make(bool effect) {
  actuator::JointModel truth = SyntheticModel();
  if (effect) {
    truth.terms.push_back(identify::TermOf("quadratic_viscous", {0.4}, truth.constants));
  }
  const actuator::JointModel model = SyntheticModel();
  trace::LoopResult loop =
      trace::CloseLoop({SyntheticRun(truth, {.seed = 1, .noise_A = 0.05})},
                       {SyntheticRun(truth, {.seed = 2, .noise_A = 0.05})}, model, 0.25, {});
  Made out;
  out.report.robot = "a <robot>";
  out.report.model_file = "model.yaml";
  out.report.train = {{"train.csv", "0123", 12000, 60.0}};
  out.report.sealed = {{"sealed.csv", "4567", 12000, 60.0}};
  out.report.processing = identify::SyntheticProcessing();
  out.report.findings = {{"rate", "sampled at 200 Hz", 200.0, "Hz"}};
  out.report.trace = std::move(loop.trace);
  out.pictures = MakePictures(out.report, *loop.train, *loop.sealed);
  return out;
}

TEST(Report, JsonHoldsWhatProgramsAskFor) {
  const Made made = Make(true);
  const nlohmann::json json = nlohmann::json::parse(FormatJson(made.report));
  EXPECT_EQ(json["verdict"], "effect");
  ASSERT_EQ(json["effects"].size(), 1u);
  const nlohmann::json& effect = json["effects"][0];
  EXPECT_EQ(effect["name"], "quadratic_viscous");
  EXPECT_EQ(effect["balance"], "M");
  EXPECT_TRUE(effect["rivals"].is_array());
  EXPECT_NEAR(effect["parameters"]["quadratic_Nm_s2_rad2"]["value"].get<double>(), 0.4, 0.05);
  EXPECT_GT(effect["parameters"]["quadratic_Nm_s2_rad2"]["half_width_95"].get<double>(), 0.0);
  EXPECT_GT(effect["gain"].get<double>(), 0.1);
  EXPECT_LT(effect["p"].get<double>(), 0.01);
  for (const char* set : {"train", "sealed"}) {
    EXPECT_EQ(json[set]["unit"], "Nm");
    EXPECT_LT(json[set]["after"].get<double>(), json[set]["before"].get<double>());
    EXPECT_EQ(json[set]["after"], json[set]["after_rms"]);
  }
  for (const char* key :
       {"not_excited", "unexplained", "parameter_shift", "base_parameters", "findings", "rounds"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_FALSE(json.contains("as_published"));
}

TEST(Report, WithoutAnEffectTheVerdictIsNone) {
  const Made made = Make(false);
  const nlohmann::json json = nlohmann::json::parse(FormatJson(made.report));
  EXPECT_EQ(json["verdict"], "none");
  EXPECT_TRUE(json["effects"].empty());
  EXPECT_EQ(json["sealed"]["before"], json["sealed"]["after"]);
  EXPECT_THAT(VerdictSentence(made.report), HasSubstr("No effect"));
}

TEST(Report, ThePageStandsAlone) {
  const Made made = Make(true);
  const std::vector<std::string> svgs = DrawPictures(made.pictures);
  ASSERT_EQ(svgs.size(), made.pictures.size());
  for (const std::string& svg : svgs) {
    EXPECT_THAT(svg, ::testing::StartsWith("<svg"));
    EXPECT_THAT(svg, HasSubstr("</svg>"));
  }
  const std::string html = FormatHtml(made.report, made.pictures, svgs);
  EXPECT_THAT(html, HasSubstr("quadratic_viscous"));
  EXPECT_THAT(html, HasSubstr("a &lt;robot&gt;"));
  EXPECT_THAT(html, HasSubstr("Measured against model"));
  EXPECT_THAT(html, HasSubstr("Residual over time"));
  EXPECT_THAT(html, HasSubstr("Residual against"));
  EXPECT_THAT(html, HasSubstr("Candidates"));
  EXPECT_THAT(html, HasSubstr("What could not be seen"));
  EXPECT_THAT(html, Not(HasSubstr("<script src")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("<img src=\"http")));
}

TEST(Report, ABadPictureIsToldWithGnuplotsWords) {
  EXPECT_THROW(DrawPictures({{"bad", "", "plot $nothing u 1:2\n"}}), std::runtime_error);
}

TEST(Report, NumbersForPeopleHaveFourDigits) {
  EXPECT_EQ(Short(3.14159265), "3.142");
  EXPECT_EQ(Short(0.0), "0");
}

}  // namespace
}  // namespace sinew::report
