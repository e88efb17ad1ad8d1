#include "components/model/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "components/model/report/errors.h"
#include "components/model/report/file/report_file.h"
#include "components/model/report/file/section_file.h"
#include "components/model/trace/close_loop.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::report {
namespace {

using identify::SyntheticModel;
using identify::SyntheticRun;
using ::testing::AllOf;
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
  out.report.gate.findings = {{"rate", "sampled at 200 Hz", 200.0, "Hz"}};
  out.report.trace = std::move(loop.trace);
  out.pictures = MakePictures(out.report, *loop.train, *loop.held_out);
  return out;
}

TEST(Report, JsonHoldsWhatProgramsAskFor) {
  const Made made = Make(true);
  const nlohmann::json json = ReportJson(made.report);
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
    EXPECT_LT(json[set]["corrected_rms"].get<double>(), json[set]["refitted_rms"].get<double>());
  }
  EXPECT_TRUE(effect["in_model"].get<bool>());
  EXPECT_EQ(json["outcome"], "effect");
  EXPECT_TRUE(json["open"].empty());
  EXPECT_THAT(json["sentence"].get<std::string>(),
              ::testing::StartsWith("quadratic_viscous (" + EffectTitle("quadratic_viscous") +
                                    "): quadratic_Nm_s2_rad2 = "));
  EXPECT_GT(json["rows"]["used"].get<int>(), 1000);
  ASSERT_EQ(json["errors"].size(), 2u);
  EXPECT_EQ(json["errors"][1]["what"], "held_out");
  EXPECT_EQ(json["errors"][1]["declared"], json["held_out"]["declared_rms"]);
  EXPECT_EQ(json["errors"][1]["refitted"], json["held_out"]["refitted_rms"]);
  EXPECT_EQ(json["errors"][1]["corrected"], json["held_out"]["corrected_rms"]);
  EXPECT_TRUE(json["rises"].empty());
  for (const char* key :
       {"not_excited", "unexplained", "parameter_shift", "base_parameters", "findings", "rounds"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_FALSE(json.contains("as_published"));
}

TEST(Report, WithoutAnEffectTheVerdictIsNone) {
  const Made made = Make(false);
  const nlohmann::json json = ReportJson(made.report);
  EXPECT_EQ(json["verdict"], "none");
  EXPECT_TRUE(json["effects"].empty());
  EXPECT_EQ(json["held_out"]["refitted_rms"], json["held_out"]["corrected_rms"]);
  EXPECT_THAT(VerdictSentence(made.report), HasSubstr("Nothing beyond the noise"));
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

TEST(Report, AnErrorThatRisesIsReportedWithWhatRaisesIt) {
  EXPECT_TRUE(Rises(WithErrors(3.0, 2.0, 2.0)).empty());
  EXPECT_THAT(VerdictSentence(WithErrors(3.0, 2.0, 2.0)), ::testing::StartsWith("No effect"));
  const Report by_effect = WithErrors(3.0, 2.0, 2.5);
  EXPECT_THAT(VerdictSentence(by_effect),
              HasSubstr("The added effect raises an error: held-out recordings: " +
                        ThreeErrors(Rises(by_effect)[0]) + "."));
  const Report by_refit = WithErrors(1.5, 2.0, 1.75);
  ASSERT_EQ(Rises(by_refit).size(), 1u);
  EXPECT_THAT(VerdictSentence(by_refit),
              HasSubstr("The refit of the declared terms raises an error: held-out recordings: "));
  EXPECT_THAT(VerdictSentence(by_refit), Not(HasSubstr("added effect")));
  // A rise of less than a hundredth is none.
  EXPECT_TRUE(Rises(WithErrors(2.0, 2.0, 2.01)).empty());
  EXPECT_EQ(Rises(WithErrors(2.0, 2.0, 2.03)).size(), 1u);
  // Training may pay for the held-out recordings.
  Report report = WithErrors(3.0, 2.0, 1.0);
  report.trace.after_train.rms = 1.0;
  EXPECT_TRUE(Rises(report).empty());
}

TEST(Report, NothingIsSaidOnlyWhereTheNoiseIsAllThatIsLeft) {
  Report report = WithErrors(3.0, 2.0, 2.0);
  EXPECT_EQ(OutcomeWord(report), "not_detectable");
  report.trace.noise_floor_rms = 0.5;
  report.trace.before_held_out.percent = 46.0;
  EXPECT_EQ(OutcomeWord(report), "not_detectable");
  EXPECT_THAT(VerdictSentence(report), AllOf(HasSubstr("46 % of the drive"),
                                             HasSubstr("the noise of the sensors is 0.5 Nm")));
  report.trace.noise_floor_rms = 1.9;
  EXPECT_EQ(OutcomeWord(report), "nothing");
  EXPECT_THAT(VerdictSentence(report), ::testing::StartsWith("Nothing beyond the noise"));
  EXPECT_THAT(FormatHtml(MakePage(report, {})), HasSubstr("class=\"verdict nothing\""));
}

TEST(Report, WhatOnlyTrainingShowsIsReportedWithItsRule) {
  Report report = WithErrors(3.0, 2.0, 2.0);
  report.trace.verdict = trace::Verdict::kUnexplained;
  trace::FoundEffect effect;
  effect.name = "quadratic_viscous";
  effect.fitted = {identify::TermOf("quadratic_viscous", {0.4}, {})};
  effect.gain_share = 0.62;
  effect.held_out_before = 2.0;
  effect.held_out_after = 2.62;
  effect.refusal = trace::InForce{}.RefusedBy(trace::rules::kRaises, 1.31);
  report.trace.refuted = {effect};
  EXPECT_EQ(OutcomeWord(report), "training_only");
  EXPECT_THAT(
      VerdictSentence(report),
      AllOf(::testing::StartsWith("Found in training, not in the held-out recordings: "
                                  "quadratic_viscous takes 62 % of the training misfit"),
            HasSubstr("the held-out error rises by 31.0 %; rule raises: 1.31, limit 1.01")));
  EXPECT_THAT(NextExperiment(report), HasSubstr("without a restart"));
  const nlohmann::json json = ReportJson(report);
  EXPECT_EQ(json["verdict"], "unexplained");
  EXPECT_EQ(json["outcome"], "training_only");
  EXPECT_EQ(json["refuted"][0]["refused"]["rule"], "raises");
  EXPECT_EQ(json["refuted"][0]["refused"]["value"], 1.31);
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

TEST(Report, AnOpenEffectIsReportedWithItsSizeApartFromThoseOfTheModel) {
  Made made = Make(true);
  trace::TraceResult& trace = made.report.trace;
  trace.effects[0].fitted = {actuator::PhysicalTerm(trace.corrected, trace.effects[0].term)};
  trace.effects[0].term = -1;
  trace.open = std::move(trace.effects);
  trace.effects.clear();
  trace.verdict = trace::Verdict::kUnexplained;
  const nlohmann::json json = ReportJson(made.report);
  EXPECT_EQ(json["verdict"], "unexplained");
  EXPECT_EQ(json["outcome"], "open");
  EXPECT_TRUE(json["effects"].empty());
  EXPECT_FALSE(json["open"][0]["in_model"].get<bool>());
  EXPECT_NEAR(json["open"][0]["parameters"]["quadratic_Nm_s2_rad2"]["value"].get<double>(), 0.4,
              0.05);
  EXPECT_THAT(json["sentence"].get<std::string>(),
              HasSubstr("Open, and not in the model: quadratic_viscous"));
  EXPECT_THAT(FormatHtml(MakePage(made.report, {})), HasSubstr("Not in the model"));
}

TEST(Report, TheSmallestDetectableSizesAreReported) {
  Made made = Make(false);
  made.report.trace.detectable = {{.effect = "stribeck",
                                   .parameter = "stribeck_Nm",
                                   .unit = "Nm",
                                   .size = 0.0625,
                                   .share = 0.03,
                                   .shape = {{"stribeck_velocity_rad_s", 0.25}}}};
  const nlohmann::json json = ReportJson(made.report)["detectable"];
  EXPECT_EQ(json["power"], 0.8);
  EXPECT_EQ(json["p_global"], trace::rules::kGlobalP.limit);
  EXPECT_EQ(json["explained_share"], trace::rules::kExplainedShare.limit);
  ASSERT_EQ(json["sizes"].size(), 1u);
  EXPECT_EQ(json["sizes"][0]["effect"], "stribeck");
  EXPECT_EQ(json["sizes"][0]["size"], 0.0625);
  EXPECT_EQ(json["sizes"][0]["unit"], "Nm");
  EXPECT_EQ(json["sizes"][0]["shape"]["stribeck_velocity_rad_s"], 0.25);
  const std::string html = FormatHtml(MakePage(made.report, {}));
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
  const std::string html = DrawnHtml(MakePage(made.report, made.pictures));
  EXPECT_THAT(html, HasSubstr("quadratic_viscous"));
  EXPECT_THAT(html, HasSubstr("a &lt;robot&gt;"));
  EXPECT_THAT(html, HasSubstr(">declared</abbr></th><th><abbr "));  // what it means stands there
  EXPECT_THAT(html, HasSubstr("<a href=\"#Effects-found\">Effects found</a>"));
  EXPECT_THAT(html, HasSubstr("data-panel=\"residual, Nm\" data-name=\"corrected\""));
  EXPECT_THAT(html, HasSubstr("Measured against model"));
  EXPECT_THAT(html, HasSubstr("Residual over time"));
  EXPECT_THAT(html, HasSubstr("Residual against"));
  EXPECT_THAT(html, HasSubstr("Candidates"));
  EXPECT_THAT(html, HasSubstr("Not excited by these recordings"));
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
