#include "components/model/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "components/model/report/errors.h"
#include "components/model/report/file/report_file.h"
#include "components/model/trace/close_loop.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

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
  out.report.held_out = {{"held_out.csv", "4567", 12000, 60.0}};
  out.report.processing = identify::SyntheticProcessing();
  out.report.findings = {{"rate", "sampled at 200 Hz", 200.0, "Hz"}};
  out.report.trace = std::move(loop.trace);
  out.pictures = MakePictures(out.report, *loop.train, *loop.held_out);
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
  for (const char* set : {"train", "held_out"}) {
    EXPECT_EQ(json[set]["unit"], "Nm");
    EXPECT_LT(json[set]["after"].get<double>(), json[set]["before"].get<double>());
    EXPECT_EQ(json[set]["after"], json[set]["after_rms"]);
  }
  EXPECT_TRUE(effect["in_model"].get<bool>());
  ASSERT_EQ(json["errors"].size(), 2u);
  EXPECT_EQ(json["errors"][1]["what"], "held_out");
  EXPECT_EQ(json["errors"][1]["declared"], json["held_out"]["declared_rms"]);
  EXPECT_EQ(json["errors"][1]["refitted"], json["held_out"]["before"]);
  EXPECT_EQ(json["errors"][1]["corrected"], json["held_out"]["after"]);
  EXPECT_TRUE(json["rises"].empty());
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
  EXPECT_EQ(json["held_out"]["before"], json["held_out"]["after"]);
  EXPECT_THAT(VerdictSentence(made.report), HasSubstr("No effect"));
}

// A report of figures that are set by hand: declared, refitted and corrected on held-out rows.
Report WithErrors(double declared, double refitted, double corrected) {
  Report report;
  report.trace.verdict = trace::Verdict::kNone;
  report.trace.nominal_held_out.rms = declared;
  report.trace.before_held_out.rms = refitted;
  report.trace.after_held_out.rms = corrected;
  return report;
}

TEST(Report, AnErrorThatRisesIsTheFirstSentence) {
  EXPECT_TRUE(Rises(WithErrors(3.0, 2.0, 2.0)).empty());
  EXPECT_THAT(VerdictSentence(WithErrors(3.0, 2.0, 2.0)), ::testing::StartsWith("No effect"));
  for (const Report& report : {WithErrors(3.0, 2.0, 2.5), WithErrors(1.5, 2.0, 1.75)}) {
    EXPECT_EQ(Rises(report).size(), 1u);
    EXPECT_THAT(VerdictSentence(report),
                ::testing::StartsWith("The refitted model raises an error: held-out recordings: " +
                                      ThreeErrors(Rises(report)[0]) + "."));
  }
  // What three digits do not show is no rise.
  EXPECT_TRUE(Rises(WithErrors(2.0, 2.0, 2.00001)).empty());
  // Training may pay for the held-out recordings.
  Report report = WithErrors(3.0, 2.0, 1.0);
  report.trace.after_train.rms = 1.0;
  EXPECT_TRUE(Rises(report).empty());
}

TEST(Report, ASimulationThatRisesOrDivergesIsReported) {
  Report report = WithErrors(3.0, 2.0, 1.0);
  const auto simulated = [&](double declared, double refitted, double corrected) {
    free_run::FreeRun run;
    for (const double rms : {declared, refitted, corrected}) run.models.push_back({.rms = rms});
    report.free_run.errors = run;
    return Rises(report);
  };
  EXPECT_TRUE(simulated(3.0, 2.0, 1.0).empty());
  EXPECT_EQ(simulated(3.0, 1.0, 2.0).size(), 1u);
  const double diverged = std::nan("");
  EXPECT_TRUE(simulated(diverged, 2.0, 1.0).empty());
  ASSERT_EQ(simulated(3.0, 2.0, diverged).size(), 1u);
  EXPECT_THAT(ThreeErrors(Rises(report)[0]), HasSubstr("diverged rad corrected"));
}

TEST(Report, AnEffectThatIsNotInTheModelIsReportedWithItsSize) {
  Made made = Make(true);
  trace::TraceResult& trace = made.report.trace;
  trace.effects[0].fitted = {actuator::PhysicalTerm(trace.corrected, trace.effects[0].term)};
  trace.effects[0].term = -1;
  const nlohmann::json json = nlohmann::json::parse(FormatJson(made.report));
  EXPECT_EQ(json["verdict"], "effect");
  EXPECT_FALSE(json["effects"][0]["in_model"].get<bool>());
  EXPECT_NEAR(json["effects"][0]["parameters"]["quadratic_Nm_s2_rad2"]["value"].get<double>(), 0.4,
              0.05);
  EXPECT_THAT(json["sentence"].get<std::string>(),
              HasSubstr("The training recordings support quadratic_viscous"));
  EXPECT_THAT(FormatHtml(made.report, {}, {}), HasSubstr("not in the model"));
}

TEST(Report, TheSmallestDetectableSizesAreReported) {
  Made made = Make(false);
  made.report.trace.detectable = {{.effect = "stribeck",
                                   .parameter = "stribeck_Nm",
                                   .unit = "Nm",
                                   .size = 0.0625,
                                   .share = 0.03,
                                   .shape = {{"stribeck_velocity_rad_s", 0.25}}}};
  const nlohmann::json json = nlohmann::json::parse(FormatJson(made.report))["detectable"];
  EXPECT_EQ(json["power"], 0.8);
  EXPECT_EQ(json["p_global"], trace::rules::kGlobalP.limit);
  EXPECT_EQ(json["explained_share"], trace::rules::kExplainedShare.limit);
  ASSERT_EQ(json["sizes"].size(), 1u);
  EXPECT_EQ(json["sizes"][0]["effect"], "stribeck");
  EXPECT_EQ(json["sizes"][0]["size"], 0.0625);
  EXPECT_EQ(json["sizes"][0]["unit"], "Nm");
  EXPECT_EQ(json["sizes"][0]["shape"]["stribeck_velocity_rad_s"], 0.25);
  const std::string html = FormatHtml(made.report, {}, {});
  EXPECT_THAT(html, HasSubstr("Smallest detectable sizes"));
  EXPECT_THAT(html, HasSubstr("stribeck_velocity_rad_s = 0.25"));
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
  EXPECT_THAT(html, HasSubstr("<th>declared</th><th>refitted</th><th>corrected</th>"));
  EXPECT_THAT(html, HasSubstr("Measured against model"));
  EXPECT_THAT(html, HasSubstr("Residual over time"));
  EXPECT_THAT(html, HasSubstr("Residual against"));
  EXPECT_THAT(html, HasSubstr("Candidates"));
  EXPECT_THAT(html, HasSubstr("Effects not excited by these recordings"));
  EXPECT_THAT(html, Not(HasSubstr("<script src")));
  EXPECT_THAT(html, Not(HasSubstr("<link")));
  EXPECT_THAT(html, Not(HasSubstr("<img src=\"http")));
}

TEST(Report, ABadPictureIsReportedWithGnuplotsWords) {
  EXPECT_THROW(DrawPictures({{"bad", "", "plot $nothing u 1:2\n"}}), std::runtime_error);
}

TEST(Report, NumbersForPeopleHaveFourDigits) {
  EXPECT_EQ(Short(3.14159265), "3.142");
  EXPECT_EQ(Short(0.0), "0");
}

}  // namespace
}  // namespace sinew::report
