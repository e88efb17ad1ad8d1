// The scorer on reports made by hand.
#include "bench/rigs/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "bench/rigs/drawn/random.h"

namespace sinew::rig_bank {
namespace {

using nlohmann::json;

json Truth(const std::string& kind, const std::string& effect = "", int rig = 1) {
  json effects = json::array();
  if (!effect.empty()) {
    effects.push_back({{"name", effect},
                       {"variable", "position_rad"},
                       {"class", {effect}},
                       {"size_reached", true},
                       {"identifiable", true},
                       {"absorbed_by_refit", effect == "payload"}});
  }
  return {{"case", "c"},
          {"rig", rig},
          {"kind", kind},
          {"excitation", "designed"},
          {"strength", "strong"},
          {"family", "linear"},
          {"fault", kind == "fault" ? "spikes" : ""},
          {"coloured_noise", true},
          {"effects", effects}};
}

json Report(const std::string& verdict, const std::vector<std::string>& names = {}) {
  json effects = json::array();
  for (const std::string& name : names)
    effects.push_back({{"name", name}, {"rivals", json::array()}});
  return {{"verdict", verdict},
          {"effects", effects},
          {"not_excited", json::array()},
          {"unexplained", {{"variable", nullptr}}},
          {"parameter_shift", json::array()}};
}

Figure FigureOf(const std::vector<Outcome>& outcomes, const std::string& name) {
  for (const Figure& figure : CountFigures(outcomes).shares) {
    if (figure.name == name) return figure;
  }
  throw std::invalid_argument(name);
}

TEST(Scorer, IntervalsAreThoseOfClopperAndPearson) {
  // Table values: 0 of 10 ends at 1 - 0.025^(1/10); 5 of 10 from the beta distribution.
  EXPECT_NEAR(ClopperPearson(0, 10).second, 1.0 - std::pow(0.025, 0.1), 1e-9);
  EXPECT_EQ(ClopperPearson(0, 10).first, 0.0);
  EXPECT_NEAR(ClopperPearson(5, 10).first, 0.18709, 1e-4);
  EXPECT_NEAR(ClopperPearson(5, 10).second, 0.81291, 1e-4);
  EXPECT_EQ(ClopperPearson(10, 10).second, 1.0);
  EXPECT_THROW(ClopperPearson(11, 10), std::invalid_argument);
}

TEST(Scorer, FirstNameItsClassRivalsAndShiftsAreRight) {
  EXPECT_TRUE(RightFirst(MakeOutcome(Truth("effect", "cogging"), Report("effect", {"cogging"}))));
  EXPECT_FALSE(RightClass(
      MakeOutcome(Truth("effect", "cogging"), Report("effect", {"stribeck", "cogging"}))));
  // One constant while moving.
  const Outcome same = MakeOutcome(Truth("effect", "current_offset"), Report("effect", {"offset"}));
  EXPECT_TRUE(RightClass(same));
  EXPECT_FALSE(RightFirst(same));
  json rivals = Report("effect", {"stribeck"});
  rivals["effects"][0]["rivals"] = {"cogging"};
  EXPECT_TRUE(RightClass(MakeOutcome(Truth("effect", "cogging"), rivals)));
  json shift = Report("none");
  shift["parameter_shift"] = json::array({{{"causes", {"payload"}}}});
  EXPECT_TRUE(RightClass(MakeOutcome(Truth("effect", "payload"), shift)));
  shift["parameter_shift"][0]["causes"] = {"cogging"};
  EXPECT_FALSE(RightClass(MakeOutcome(Truth("effect", "cogging"), shift)));
}

TEST(Scorer, ExtraNamesAreWrongAndRefutedOnesDoNotCount) {
  json report = Report("effect", {"cogging", "stribeck"});
  EXPECT_TRUE(WrongName(MakeOutcome(Truth("effect", "cogging"), report)));
  report["effects"][1]["confirmation"] = "refuted";
  EXPECT_FALSE(WrongName(MakeOutcome(Truth("effect", "cogging"), report)));
  report["effects"][1]["confirmation"] = "not_confirmed";
  EXPECT_TRUE(WrongName(MakeOutcome(Truth("effect", "cogging"), report)));
}

TEST(Scorer, SetsThatPromiseNinetyPercentAreHeldToIt) {
  const auto said = [](double own, double rival) {
    json report = Report("effect", {"stribeck"});
    report["effects"][0]["rivals"] = {"cogging"};
    report["effects"][0]["posterior"] = {{{"name", "stribeck"}, {"probability", own}},
                                         {{"name", "cogging"}, {"probability", rival}},
                                         {{"name", "spring"}, {"probability", 0.04}}};
    return report;
  };
  const std::vector<Outcome> outcomes = {
      MakeOutcome(Truth("effect", "cogging"), said(0.6, 0.36)),
      MakeOutcome(Truth("effect", "spring", 2), said(0.6, 0.36)),
      MakeOutcome(Truth("effect", "cogging", 3), said(0.5, 0.3)),
      MakeOutcome(Truth("effect", "stribeck", 4), Report("effect", {"stribeck"}))};
  EXPECT_NEAR(outcomes[0].found[0].probability, 0.96, 1e-12);
  EXPECT_NEAR(FromJson(ToJson(outcomes[0])).found[0].probability, 0.96, 1e-12);
  const Figure figure = FigureOf(outcomes, "sets printed at 90 % and more hold the truth");
  EXPECT_EQ(figure.hits(), 1);
  EXPECT_EQ(figure.trials(), 2);
}

TEST(Scorer, PlainRecordingsFaultsAndStopsAreCounted) {
  const std::vector<Outcome> outcomes = {
      MakeOutcome(Truth("plain"), Report("none")),
      MakeOutcome(Truth("plain", "", 2), Report("effect", {"stribeck"})),
      MakeOutcome(Truth("plain", "", 3), Report("data_fault")),
      MakeOutcome(Truth("plain", "", 4), json()),
      MakeOutcome(Truth("fault", "", 5), Report("data_fault")),
      MakeOutcome(Truth("fault", "", 6), Report("none")),
  };
  EXPECT_EQ(FigureOf(outcomes, "alarm on plain recordings").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "alarm on plain recordings").trials(), 4);
  EXPECT_EQ(FigureOf(outcomes, "verdict none on plain recordings").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "faults found").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "faults found").trials(), 2);
  EXPECT_EQ(FigureOf(outcomes, "false stops").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "no report").hits(), 1);
}

TEST(Scorer, SpikesWhoseRowsAreLeftOutAreFound) {
  json report = Report("none");
  report["findings"] = json::array({{{"name", "left_out_rows"}, {"text", "row 3"}}});
  const Outcome found = MakeOutcome(Truth("fault"), report);
  EXPECT_TRUE(FromJson(ToJson(found)).rows_left_out);
  EXPECT_EQ(FigureOf({found}, "faults found").hits(), 1);
  EXPECT_EQ(FigureOf({MakeOutcome(Truth("plain"), report)}, "false stops").hits(), 0);
}

TEST(Scorer, OutsideEffectsAreAbstainedFromOrTheirVariableNamed) {
  json report = Report("unexplained");
  report["unexplained"]["variable"] = "position_rad";
  const std::vector<Outcome> outcomes = {
      MakeOutcome(Truth("outside", "cable_drag"), report),
      MakeOutcome(Truth("outside", "cable_drag"), Report("none")),
      MakeOutcome(Truth("outside", "cable_drag"), Report("effect", {"gear_eccentricity"}))};
  EXPECT_EQ(FigureOf(outcomes, "outside: abstains").hits(), 2);
  EXPECT_EQ(FigureOf(outcomes, "outside: names the variable").hits(), 1);
}

TEST(Scorer, UnidentifiableCasesAreLeftOutAndCountedAsHidden) {
  json truth = Truth("effect", "cogging");
  truth["effects"][0]["identifiable"] = false;
  json report = Report("none");
  report["not_excited"] = {"cogging"};
  const std::vector<Outcome> outcomes = {MakeOutcome(truth, report),
                                         MakeOutcome(Truth("effect", "cogging"), report)};
  EXPECT_EQ(FigureOf(outcomes, "right class, strong, designed").trials(), 1);
  EXPECT_EQ(FigureOf(outcomes, "hidden: reported as not excited").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "hidden: reported as not excited").trials(), 1);
  EXPECT_EQ(FigureOf(outcomes, "identifiable, listed as not excited").hits(), 1);
  EXPECT_EQ(FigureOf(outcomes, "excluded: strong designed, too small or not identifiable").hits(),
            1);
}

TEST(Scorer, IntervalsByRigAreWiderWhereCasesOfARigAreAlike) {
  Figure alike{"", false, {}}, apart{"", false, {}};
  for (int rig = 0; rig < 10; ++rig) alike.by_rig[rig] = {rig % 2 * 10, 10};
  for (int rig = 0; rig < 100; ++rig) apart.by_rig[rig] = {rig % 2, 1};
  const auto wide = alike.ClusteredInterval(), narrow = apart.ClusteredInterval();
  EXPECT_GT(wide.second - wide.first, 2.0 * (narrow.second - narrow.first));
}

TEST(Scorer, OutcomesSurviveTheirLineOfJson) {
  json report = Report("effect", {"cogging"});
  report["p_global"] = 0.25;
  const Outcome one = MakeOutcome(Truth("effect", "cogging"), report);
  const Outcome two = FromJson(json::parse(ToJson(one).dump()));
  EXPECT_EQ(ToJson(two), ToJson(one));
  EXPECT_EQ(two.p_global, 0.25);
  EXPECT_FALSE(TableOf(CountFigures({two})).empty());
}

// Names that are right with the probability that the line makes of the printed p.
std::vector<Outcome> NamesOnALine(double offset, double slope, int count) {
  std::vector<Outcome> out;
  rigs::Random random(7, 0);
  for (int k = 0; k < count; ++k) {
    const double z = random.Uniform(-2.0, 3.0), q = 1.0 / (1.0 + std::exp(-offset - slope * z));
    json report = Report("effect", {random.Uniform() < q ? "cogging" : "stribeck"});
    report["effects"][0]["score"] = {{"p", 1.0 / (1.0 + std::exp(-z))}};
    out.push_back(MakeOutcome(Truth("effect", "cogging"), report));
  }
  return out;
}

TEST(Scorer, ReliabilityCountsNamesByTheirP) {
  json report = Report("effect", {"cogging"});
  report["effects"][0]["score"] = {{"p", 0.97}};
  report["open"] = json::array({{{"name", "stribeck"}, {"score", {{"p", 0.55}}}}});
  const std::string text = ReliabilityOf(
      {MakeOutcome(Truth("effect", "cogging"), report), MakeOutcome(Truth("fault"), report)});
  EXPECT_NE(text.find("p 50 to 60 %         mean p  55.0 %, right    0 of    1"), std::string::npos)
      << text;
  EXPECT_NE(text.find("named, p over 95 %   mean p  97.0 %, right    1 of    1"), std::string::npos)
      << text;
}

TEST(Scorer, CalibrationFindsTheLineOfTheOdds) {
  const Calibration line = Calibrate(NamesOnALine(0.8, 1.7, 20000));
  EXPECT_EQ(line.names, 20000);
  EXPECT_NEAR(line.offset, 0.8, 0.1);
  EXPECT_NEAR(line.slope, 1.7, 0.1);
  // All right: the line is not vertical.
  const Calibration all = Calibrate(NamesOnALine(50.0, 0.0, 30));
  EXPECT_TRUE(std::isfinite(all.offset) && std::isfinite(all.slope));
}

TEST(Scorer, PValuesThatAreUniformAreNearTheDiagonal) {
  std::vector<Outcome> outcomes;
  for (int i = 0; i < 100; ++i) {
    json report = Report("none");
    report["p_global"] = (i + 0.5) / 100.0;
    outcomes.push_back(MakeOutcome(Truth("plain"), report));
  }
  const Figures figures = CountFigures(outcomes);
  EXPECT_EQ(figures.p_count, 100);
  EXPECT_NEAR(figures.p_ks, 0.005, 1e-12);
}

}  // namespace
}  // namespace sinew::rig_bank
