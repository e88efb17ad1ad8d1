#include "bench/rigs/planting.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "bench/rigs/drawn/forces.h"
#include "tests/support/temporary_folder.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// The first rig that has the effect.
rigs::Rig RigWith(const std::string& name) {
  for (std::uint64_t number = 1; number < 100; ++number) {
    const rigs::Rig rig = rigs::DrawRig(number);
    for (const std::string& possible : rigs::EffectsOf(rig, rigs::Kind::kCatalogue)) {
      if (possible == name) return rig;
    }
  }
  throw std::logic_error(name + ": no rig has it");
}

json Entry(const std::string& effect, double size, json shape = json::object()) {
  return {{"effect", effect}, {"balance", "M"}, {"size", size}, {"shape", std::move(shape)}};
}

double Current(const rigs::Rig& rig) {
  return rig.drive == rigs::Drive::kCommand ? 10.0 : rig.current_limit_A;
}

TEST(PlantedEffect, HasTheSizeThatTheReportStates) {
  const auto effect =
      PlantedEffect(RigWith("load_dependent_friction"), Entry("load_dependent_friction", 0.07));
  ASSERT_TRUE(effect.has_value());
  EXPECT_DOUBLE_EQ(effect->size, 0.07);
}

TEST(PlantedEffect, SaturatesAsMuchPerSquaredAmpereAsStated) {
  const rigs::Rig rig = RigWith("torque_constant_saturation");
  const double limit = Current(rig), per_square = 0.1 / (limit * limit);
  const auto effect = PlantedEffect(rig, Entry("torque_constant_saturation", per_square));
  ASSERT_TRUE(effect.has_value());
  rigs::Undeclared u;
  u.saturation = effect->size;
  const double current = 0.05 * limit;  // so small that further terms of the series do not show
  const double lost = 1.0 - rigs::Saturated(u, current, limit) / current;
  EXPECT_NEAR(lost, per_square * current * current, 1e-3 * lost);
}

TEST(PlantedEffect, TakesTheShapeThatShowsBest) {
  const auto effect = PlantedEffect(RigWith("stribeck"),
                                    Entry("stribeck", 1e-3, {{"stribeck_velocity_rad_s", 0.3}}));
  ASSERT_TRUE(effect.has_value());
  EXPECT_DOUBLE_EQ(effect->shape[0], 0.3);
}

TEST(PlantedEffect, IsNoneWhereTheGeneratorMeansSomethingElse) {
  EXPECT_FALSE(PlantedEffect(RigWith("cogging"), Entry("cogging", 0.1)).has_value());
  // Another balance than that in which the generator shows it.
  json other = Entry("transport_delay", 0.001);
  other["balance"] = "K";
  EXPECT_FALSE(PlantedEffect(RigWith("transport_delay"), other).has_value());
  // Larger than plausible.
  EXPECT_FALSE(
      PlantedEffect(RigWith("transport_delay"), Entry("transport_delay", 10.0)).has_value());
}

TEST(PlantedEffect, IsNoneOnARigThatCannotHaveIt) {
  for (std::uint64_t number = 1; number < 100; ++number) {
    const rigs::Rig rig = rigs::DrawRig(number);
    if (rig.load_cell) continue;
    EXPECT_FALSE(PlantedEffect(rig, Entry("load_cell_gain", 0.1)).has_value());
    return;
  }
  FAIL() << "every rig has a load cell";
}

class Trials : public ::testing::Test {
 protected:
  void Case(const std::string& name, const std::string& kind, const json& sizes) {
    const int rig = static_cast<int>(RigWith("load_dependent_friction").number);
    for (const fs::path& folder : {cases(), reports()}) fs::create_directories(folder / name);
    std::ofstream(cases() / name / "truth.json")
        << json{{"kind", kind}, {"excitation", "designed"}, {"rig", rig}};
    std::ofstream(reports() / name / "report.json") << json{{"detectable", json{{"sizes", sizes}}}};
  }
  fs::path cases() const { return folder_.path() / "cases"; }
  fs::path reports() const { return folder_.path() / "reports"; }
  testing::TemporaryFolder folder_;
};

TEST_F(Trials, EffectsThatWerePlantedLeastComeFirst) {
  const json friction = Entry("load_dependent_friction", 0.05);
  Case("1-plain", "plain",
       json::array({friction, Entry("direction_dependent_coulomb", 1e-6), friction}));
  Case("2-plain", "plain", json::array({friction}));
  Case("3-effect", "effect", json::array({friction}));  // already has one
  const auto draw = [&](int count) {
    std::multiset<std::string> out;
    for (const Trial& trial : DrawTrials(cases(), reports(), count)) {
      out.insert(trial.plain + " " + trial.effect.name);
    }
    return out;
  };
  const std::multiset<std::string> two = {"1-plain direction_dependent_coulomb",
                                          "1-plain load_dependent_friction"};
  EXPECT_EQ(draw(2), two);
  std::multiset<std::string> all = two;
  all.insert("2-plain load_dependent_friction");
  EXPECT_EQ(draw(100), all);
}

TEST(NoiseOfTheLog, IsAnotherOneOnAnotherDrawAndSmallerByItsShare) {
  rigs::Rig rig = rigs::DrawRig(1);
  rig.rows = 300;
  rig.lost_rows = 0.0;
  const rigs::Run run = rigs::Play(rig, {}, rigs::Excitation::kDesigned, 1);
  const std::vector<rigs::Reading> exact = rigs::ReadExactly(rig, run.rows[0]);
  const auto error = [&](std::uint64_t draw, double share) {
    rigs::Rig other = rig;
    other.noise_draw = draw;
    other.noise_share = share;
    const std::vector<rigs::Reading> read = rigs::ReadWithNoise(other, run.rows[0], 0);
    std::vector<double> out;
    for (std::size_t i = 0; i < read.size(); ++i) out.push_back(read[i].drive - exact[i].drive);
    return out;
  };
  const auto rms = [](const std::vector<double>& x) {
    double squares = 0.0;
    for (const double value : x) squares += value * value;
    return std::sqrt(squares / static_cast<double>(x.size()));
  };
  EXPECT_NE(error(0, 1.0), error(1, 1.0));
  EXPECT_NEAR(rms(error(0, 0.1)) / rms(error(0, 1.0)), 0.1, 0.01);
}

}  // namespace
}  // namespace sinew::rig_bank
