// Results as JSON, tables and pictures: every trial and pressure is where it belongs.
#include "tools/tune_robot/tune_section.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "components/model/report/file/section_file.h"
#include "tools/tune_robot/tune_file.h"

namespace sinew::tune {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

GainTrial SectionTrial(int stage, int number, double proportional, double mse_rad2,
                       std::optional<double> fell_at_s = std::nullopt) {
  GainTrial trial{.stage = stage, .number = number, .name = stage == 0 ? "published" : ""};
  trial.pid.proportional_Nm_rad = proportional;
  trial.pid.integral_Nm_rad_s = 3.0;
  trial.pid.derivative_Nm_s_rad = 2.0;
  trial.score.emplace();
  trial.score->mse_rad2 = mse_rad2;
  trial.score->fell_at_s = fell_at_s;
  return trial;
}

GainSearchResult SomeSearch() {
  GainSearchResult result;
  result.trials = {SectionTrial(0, 0, 60.0, 0.01, 1.5), SectionTrial(1, 0, 30.0, 0.02, 0.5),
                   SectionTrial(1, 1, 300.0, 2e-4),     SectionTrial(1, 2, 200.0, 4e-4),
                   SectionTrial(2, 0, 330.0, 1e-4),     SectionTrial(2, 1, 280.0, 3e-4)};
  result.best = result.trials[4];
  return result;
}

// Lines of a data block of a gnuplot script.
long PointsOf(const std::string& script, const std::string& block) {
  const std::string begin = "$" + block + " << EOD\n";
  const std::size_t from = script.find(begin);
  EXPECT_NE(from, std::string::npos) << block;
  const std::size_t first = from + begin.size();
  const std::size_t end = script.find("EOD\n", first);
  return std::count(script.begin() + static_cast<std::ptrdiff_t>(first),
                    script.begin() + static_cast<std::ptrdiff_t>(end), '\n');
}

TEST(TuneSection, TheSearchNamesTheBestAndWhenTheOthersFell) {
  const nlohmann::ordered_json json = GainJson(SomeSearch());
  EXPECT_EQ(json.at("trials"), 6);
  EXPECT_EQ(json.at("stood"), 4);
  EXPECT_EQ(json.at("fell"), 1);
  EXPECT_EQ(json.at("best").at("proportional_Nm_rad"), 330.0);
  EXPECT_EQ(json.at("best").at("mse_rad2"), 1e-4);
  EXPECT_EQ(json.at("compared").at("published").at("fell_at_s"), 1.5);
  EXPECT_TRUE(json.at("compared").at("published").at("mse_rad2").is_null());
  const report::Section section = GainSection(SomeSearch(), 1.0);
  ASSERT_EQ(section.tables.size(), 1u);
  ASSERT_EQ(section.tables[0].rows.size(), 2u);
  EXPECT_EQ(section.tables[0].rows[0][4], "falls after 1.5 s");
  EXPECT_THAT(section.tables[0].rows[1][4], StartsWith("MSE "));
  EXPECT_NO_THROW(report::CheckSection(section));
}

TEST(TuneSection, ThePicturesShowEveryTrialOfTheirStage) {
  const std::vector<report::Picture> pictures = GainPictures(SomeSearch());
  ASSERT_EQ(pictures.size(), 2u);
  EXPECT_EQ(PointsOf(pictures[0].script, "stand"), 2);
  EXPECT_EQ(PointsOf(pictures[0].script, "fall"), 1);
  EXPECT_EQ(PointsOf(pictures[1].script, "trials"), 2);
  for (const std::string& svg : report::DrawPictures(pictures)) EXPECT_THAT(svg, HasSubstr("svg"));
  // All fell: the first picture alone, still one that gnuplot draws.
  GainSearchResult none;
  none.trials = {SectionTrial(1, 0, 30.0, 0.02, 0.5)};
  const std::vector<report::Picture> fallen = GainPictures(none);
  ASSERT_EQ(fallen.size(), 1u);
  EXPECT_NO_THROW((void)report::DrawPictures(fallen));
}

TEST(TuneSection, ThePressuresHaveTheirEnergiesAndTheLargerPeakOfBothLegs) {
  const PressureSweepConfig config =
      LoadPressureSweep(SINEW_SOURCE_DIR "/robots/biped/tune_pressure.yaml");
  std::vector<PressurePoint> points(3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) points[i].pressure_bar = 2.0 * static_cast<double>(i);
    points[i].trial.performance.drawn_J = 100.0 - 10.0 * static_cast<double>(i);
    points[i].trial.peak_torque_Nm[3] = 10.0;
    points[i].trial.peak_torque_Nm[9] = 12.0;
  }
  points[2].trial.score.fell_at_s = 2.5;
  const nlohmann::ordered_json json = PressureJson(config, points);
  EXPECT_EQ(json.at("best_pressure_bar"), 2.0);
  EXPECT_EQ(json.at("rigid").at("electrical_J"), 100.0);
  ASSERT_EQ(json.at("pressures").size(), 2u);
  EXPECT_EQ(json.at("pressures")[1].at("fell_at_s"), 2.5);
  EXPECT_TRUE(json.at("pressures")[1].at("mse_rad2").is_null());
  EXPECT_EQ(json.at("pressures")[0].at("joints").at("right_knee").at("peak_torque_Nm"), 12.0);
  const report::Section section = PressureSection(config, points, 1.0);
  ASSERT_EQ(section.tables.size(), 1u);
  const report::Table& table = section.tables[0];
  const auto knee = std::find(table.header.begin(), table.header.end(), "peak knee, N m");
  ASSERT_NE(knee, table.header.end());
  EXPECT_EQ(table.rows[1][static_cast<std::size_t>(knee - table.header.begin())], "12");
  EXPECT_EQ(table.rows[2][1], "falls after 2.5 s");
  ASSERT_EQ(section.pictures.size(), 2u);
  EXPECT_EQ(PointsOf(section.pictures[0].script, "d1"), 1) << "not the one that fell";
  EXPECT_NO_THROW((void)report::DrawPictures(section.pictures));
}

}  // namespace
}  // namespace sinew::tune
