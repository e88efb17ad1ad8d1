// Files of the bank: the same number makes the same bytes; what is written is what docs/formats.md
// says.
#include "bench/rigs/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::rig_bank {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using namespace rigs;

Rig Short(std::uint64_t number) {
  Rig rig = DrawRig(number);
  rig.rows = static_cast<int>(12.0 * rig.rate_Hz);
  return rig;
}

TEST(Files, TheSameNumberMakesTheSameBytesAndAnotherNumberOthers) {
  auto bytes = [](std::uint64_t number) {
    const Rig rig = Short(number);
    Case what = DrawCases(rig)[1];
    const Sizer sizer(rig, what.excitation);
    what.effects.resize(1);
    const CaseFiles files = MakeCase(rig, what, sizer);
    return CsvOf(rig, files.recordings[0]) + ModelOf(rig, "") + MapOf(rig) +
           TruthOf(rig, files).dump();
  };
  const std::string once = bytes(3);
  EXPECT_EQ(once, bytes(3));
  EXPECT_NE(once, bytes(9));
}

TEST(Files, LostRowsAreLeftOutAndStampsRise) {
  Rig rig = Short(3);
  rig.lost_rows = 0.02;
  rig.stamp_jitter = 0.03;
  const auto rows = Simulate(rig, {}, Motion(rig, Excitation::kTask, 0));
  const auto readings = ReadWithNoise(rig, rows, 0);
  EXPECT_LT(readings.size(), rows.size());
  EXPECT_GT(readings.size(), rows.size() * 95 / 100);
  for (std::size_t i = 1; i < readings.size(); ++i) {
    ASSERT_GT(readings[i].time_s, readings[i - 1].time_s);
  }
}

TEST(Files, ModelAndMapDeclareTheHardwareOfEveryFamily) {
  for (std::uint64_t number = 1; number <= 60; ++number) {
    const Rig rig = DrawRig(number);
    const std::string model = ModelOf(rig, ""), map = MapOf(rig);
    EXPECT_THAT(model, HasSubstr("schema: sinew-model/1"));
    EXPECT_THAT(model, HasSubstr(rig.linear ? "kind: linear" : "kind: rotary"));
    EXPECT_EQ(model.find("drive_current") != std::string::npos, rig.drive == Drive::kCurrent);
    EXPECT_EQ(map.find("motor_current") != std::string::npos, rig.drive == Drive::kCurrent);
    EXPECT_EQ(map.find("chamber_pressure") != std::string::npos, rig.pressure);
    EXPECT_EQ(model.find("load_force") != std::string::npos, rig.load_cell);
    EXPECT_EQ(map.find("temperature") != std::string::npos, rig.temperature);
    EXPECT_EQ(model.find("encoder_difference") != std::string::npos, rig.kinematic);
    EXPECT_THAT(ModelOf(rig, "missing_gear_ratio"), Not(HasSubstr("gear_ratio")));
  }
}

TEST(Files, NominalValuesAreFiveToFifteenPercentOffUnlessExact) {
  for (std::uint64_t number = 1; number <= 60; ++number) {
    for (const Term& term : Declare(DrawRig(number))) {
      for (const Parameter& p : term.parameters) {
        if (p.fixed || p.truth == 0.0) {
          EXPECT_EQ(p.nominal, p.truth) << term.effect;
          continue;
        }
        const double off = std::abs(p.nominal / p.truth - 1.0);
        if (term.effect == "gas_compression") continue;  // nominal is 1, the truth is off
        EXPECT_LE(off, 0.15 + 1e-12) << term.effect;
        EXPECT_GE(off, std::min(0.05, p.tolerance / 3.0) - 1e-12) << term.effect;
      }
    }
  }
}

TEST(Files, PlantedFaultsSpoilTheRowsTheyName) {
  for (std::uint64_t number = 1; number <= 12; ++number) {
    const Rig rig = Short(number);
    std::vector<std::vector<Reading>> clean;
    for (int i = 0; i < kRecordings; ++i) {
      clean.push_back(
          ReadWithNoise(rig, Simulate(rig, {}, Motion(rig, Excitation::kDesigned, i)), i));
    }
    for (const std::string& fault : FaultsOf(rig)) {
      auto spoilt = clean;
      const auto where = PlantFault(rig, fault, spoilt);
      if (fault == "missing_gear_ratio") continue;
      ASSERT_FALSE(where.empty()) << fault;
      bool changed = false;
      for (const FaultRows& rows : where) {
        for (int i = 0; i < kRecordings; ++i) {
          if (rows.recording != RecordingName(i)) continue;
          for (int k = rows.first; k <= rows.last; ++k) {
            const auto& a = clean[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
            const auto& b = spoilt[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
            changed = changed || a.position != b.position || a.drive != b.drive ||
                      a.motor_rad != b.motor_rad;
          }
        }
      }
      EXPECT_TRUE(changed) << fault;
    }
  }
}

}  // namespace
}  // namespace sinew::rig_bank
