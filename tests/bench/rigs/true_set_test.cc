#include "bench/rigs/true_set.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Words = std::vector<std::string>;
using Counts = std::pair<int, int>;

json ParameterWith(double value, double half_width) {
  return {{"value", value},
          {"half_width_95", half_width},
          {"interval_95", {value - half_width, value + half_width}}};
}

json ReportWith(const json& after, double motion_error = 1.0) {
  return {{"base_parameters", {{"after", after}}}, {"held_out", {{"corrected_rms", motion_error}}}};
}

json TruthWith(const std::string& kind, const Words& effects, const std::string& balance = "M") {
  json list = json::array();
  for (const std::string& name : effects) list.push_back({{"name", name}, {"balance", balance}});
  return {{"kind", kind}, {"effects", list}, {"rig", 7}, {"true_parameters", json::object()}};
}

TEST(TrueSetOptions, GiveWhatIsThere) {
  EXPECT_EQ(TrueSetOptions(TruthWith("plain", {})), (Words{"--effect", "none"}));
  EXPECT_EQ(TrueSetOptions(TruthWith("pair", {"stribeck", "cogging"})),
            (Words{"--effect", "stribeck", "--effect", "cogging"}));
  EXPECT_TRUE(TrueSetOptions(TruthWith("outside", {"bad_tooth"})).empty());
  EXPECT_EQ(EachEffect("--without-effect", TruthWith("effect", {"stribeck"})),
            (Words{"--without-effect", "stribeck"}));
  EXPECT_TRUE(EachEffect("--without-effect", TruthWith("plain", {})).empty());
  EXPECT_TRUE(TrueSetOptions(TruthWith("fault", {})).empty());
}

TEST(Coverage, CountsParametersThatHaveAnInterval) {
  const json own = {{"inertia.inertia", ParameterWith(2.0, 0.5)},
                    {"viscous.viscous", ParameterWith(1.0, 0.1)},
                    {"drive.gain", {{"value", 1.0}, {"known", true}}}};
  const json quiet = {{"inertia.inertia", ParameterWith(2.4, 0.1)},
                      {"viscous.viscous", ParameterWith(1.2, 0.1)},
                      {"drive.gain", {{"value", 1.0}, {"known", true}}}};
  EXPECT_EQ(CountHeld(ReportWith(own), ReportWith(quiet)), (Counts{1, 2}));
}

TEST(Coverage, ComparesNoModelsOfOtherTerms) {
  const json own = {{"inertia.inertia", ParameterWith(2.0, 0.5)}};
  const json other = {{"stribeck.stribeck", ParameterWith(2.0, 0.5)}};
  EXPECT_EQ(CountHeld(ReportWith(own), ReportWith(other)), (Counts{0, 0}));
  EXPECT_EQ(CountHeld(json(), ReportWith(own)), (Counts{0, 0}));
}

TEST(Coverage, OfTheGeneratorTakesItsDeclaredParameters) {
  json truth = TruthWith("plain", {});
  truth["true_parameters"]["inertia"]["inertia"] = {{"true", 2.6}};
  const json own = {{"inertia.inertia", ParameterWith(2.0, 0.5)}};
  EXPECT_EQ(CountHeldOfGenerator(ReportWith(own), truth), (Counts{0, 1}));
}

TEST(ErrorRatio, IsThatOfTheEffectsBalance) {
  json found = ReportWith(json::object(), 3.0), given = ReportWith(json::object(), 2.0);
  const auto encoders = [](double rms) {
    json out = json::array();
    out.push_back({{"balance", "K"}, {"held_out", {{"corrected_rms", rms}}}});
    return out;
  };
  found["balances"] = encoders(5.0);
  given["balances"] = encoders(4.0);
  EXPECT_DOUBLE_EQ(ErrorRatio(found, given, TruthWith("effect", {"stribeck"})), 1.5);
  EXPECT_DOUBLE_EQ(ErrorRatio(found, given, TruthWith("effect", {"backlash_width"}, "K")), 1.25);
  EXPECT_TRUE(
      std::isnan(ErrorRatio(json{{"verdict", "data_fault"}}, given, TruthWith("plain", {}))));
}

TEST(CompareWithTrueSets, ReadsTheFoldersOfTheCases) {
  const testing::TemporaryFolder folder;
  const auto write = [&](const char* where, const char* file, const json& text) {
    fs::create_directories(folder.path() / where / "a");
    std::ofstream(folder.path() / where / "a" / file) << text;
  };
  const json after = {{"inertia.inertia", ParameterWith(2.0, 0.5)}};
  write("cases", "truth.json", TruthWith("plain", {}));
  write("found", "report.json", ReportWith(after, 1.1));
  write("given", "report.json", ReportWith(after, 1.0));
  write("quiet", "report.json", ReportWith({{"inertia.inertia", ParameterWith(3.0, 0.1)}}));
  const TrueSetFigures figures =
      CompareWithTrueSets(folder.path() / "cases", folder.path() / "found", folder.path() / "given",
                          folder.path() / "quiet");
  ASSERT_EQ(figures.ratios.size(), 1u);
  EXPECT_NEAR(figures.ratios[0], 1.1, 1e-12);
  EXPECT_EQ(figures.shares[0].trials(), 1);
  EXPECT_EQ(figures.shares[0].hits(), 0);
  EXPECT_NE(TableOf(figures).find("median 1.100"), std::string::npos);
}

}  // namespace
}  // namespace sinew::rig_bank
