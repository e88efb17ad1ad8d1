#include "reproduction/network_tables/search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace sinew::reproduction {
namespace {

using ::testing::HasSubstr;

SearchOptions Small() {
  SearchOptions options;
  options.random = true;
  options.points = 4;
  options.duration_s = 15.0;
  return options;
}

TEST(Search, TheGridIsThePublishedOne) {
  const std::vector<SearchPoint> points = PlanSearch({});
  ASSERT_EQ(points.size(), 1000U);
  EXPECT_EQ(points.front().neurons, 100);
  EXPECT_EQ(points.back().neurons, 550);
  EXPECT_DOUBLE_EQ(points.front().spectral_radius, 0.75);
  EXPECT_DOUBLE_EQ(points.back().spectral_radius, 1.25);
  EXPECT_DOUBLE_EQ(points.front().leak, 0.05);
  EXPECT_DOUBLE_EQ(points.back().leak, 0.15);
}

TEST(Search, GoesOnWhereItWasStoppedAndEndsTheSame) {
  const SearchOptions options = Small();
  std::vector<SearchPoint> all = PlanSearch(options);
  RunSearch(options, &all, {}, {});
  ASSERT_NE(Best(all), nullptr);

  // Stopped after two points: only these stand in the file.
  std::vector<SearchPoint> two = all;
  two[2] = PlanSearch(options)[2];
  two[3] = PlanSearch(options)[3];
  std::vector<SearchPoint> resumed = PlanSearch(options);
  ResumeSearch(options, FormatSearch(options, two), "search.csv", &resumed);
  EXPECT_TRUE(resumed[0].done());
  EXPECT_FALSE(resumed[2].done());
  int saved = 0;
  RunSearch(options, &resumed, {}, [&] { ++saved; });
  EXPECT_GE(saved, 1);
  EXPECT_EQ(FormatSearch(options, resumed), FormatSearch(options, all));
  for (std::size_t k = 2; k < 4; ++k) EXPECT_EQ(resumed[k].test_mse, all[k].test_mse);
}

TEST(Search, AFileOfOtherOptionsOrABrokenOneIsRefusedWithItsLine) {
  const SearchOptions options = Small();
  std::vector<SearchPoint> points = PlanSearch(options);
  const auto message = [&](const std::string& text) -> std::string {
    try {
      ResumeSearch(options, text, "search.csv", &points);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  const std::string empty = FormatSearch(options, points);
  EXPECT_EQ(message(empty), "");
  SearchOptions other = options;
  other.seed = 9;
  EXPECT_THAT(message(FormatSearch(other, points)), HasSubstr("search.csv:1: a search of other"));
  EXPECT_THAT(message(empty + "100,0.5\n"), HasSubstr("search.csv:3"));
  EXPECT_THAT(message(empty + "7,0.5,0.5,0.1,0.1\n"), HasSubstr("does not have"));
}

TEST(Search, ThePictureHoldsEveryPoint) {
  std::vector<SearchPoint> points = PlanSearch({.steps = 2});
  for (SearchPoint& point : points) point.validation_mse = point.test_mse = 0.1;
  points[3].validation_mse = 0.05;
  const report::Picture picture = SearchPicture(points);
  EXPECT_THAT(picture.script, HasSubstr("splot"));
  EXPECT_THAT(picture.caption, HasSubstr("N = 100"));
  EXPECT_EQ(Best(points), &points[3]);
}

}  // namespace
}  // namespace sinew::reproduction
