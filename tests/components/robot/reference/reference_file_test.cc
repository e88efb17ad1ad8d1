#include "components/robot/reference/file/reference_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

namespace sinew::reference {
namespace {

using ::testing::HasSubstr;

LoadedReference Parse(const std::string& text) {
  return config::Read<LoadedReference>(config::Section::Parse("schema: sinew-reference/1\n" + text,
                                                              "ref.yaml", "sinew-reference/1"));
}

std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(Parse(text));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

const char kSine[] = R"(joints:
  - kind: sine
    amplitude_rad: 0.5236
    frequency_Hz: 0.4
    duration_s: 10
)";

TEST(ReferenceFile, ReadsTheBenchmarkSine) {
  const LoadedReference loaded = Parse(kSine);
  ASSERT_EQ(loaded.config.joints.size(), 1u);
  EXPECT_NEAR(loaded.config.joints[0].trajectory->At(0.625).position_rad, 0.5236, 1e-12);
  EXPECT_EQ(loaded.config.joints[0].trajectory->duration_s(), 10.0);
  EXPECT_TRUE(loaded.notes.empty());
}

TEST(ReferenceFile, ReadsADesignedExcitationThatIsContinuous) {
  const LoadedReference loaded = Parse(R"(start: operator
start_delay_s: 0.5
joints:
  - kind: sequence
    start_rad: 0.1
    pieces:
      - {kind: hold, duration_s: 1}
      - {kind: multisine, amplitude_rad: 0.4, lowest_frequency_Hz: 0.1, highest_frequency_Hz: 2, period_s: 20, duration_s: 10, seed: 3}
      - {kind: move, to_rad: -0.2, speed_rad_s: 0.5}
      - {kind: ramps, amplitude_rad: 0.3, speed_rad_s: 0.05, cycles: 2}
      - {kind: chirp, amplitude_rad: 0.2, duration_s: 20}
      - {kind: sine, amplitude_rad: 0.2, frequency_Hz: 1, duration_s: 5, fade_s: 0.5}
    limits: {position_lower_rad: -1, position_upper_rad: 1, velocity_rad_s: 8, acceleration_rad_s2: 80}
)");
  EXPECT_EQ(loaded.config.start, StartRule::kOperator);
  const Trajectory& t = *loaded.config.joints[0].trajectory;
  double before = t.At(0.0).position_rad;
  for (double s = 0.0; s < t.duration_s(); s += 1e-3) {
    ASSERT_NEAR(t.At(s).position_rad, before, 0.01) << s;
    before = t.At(s).position_rad;
  }
  EXPECT_NEAR(t.At(t.duration_s()).position_rad, -0.2, 1e-9);
}

TEST(ReferenceFile, DrawsInWhatPassesTheLimitsOnlyWhenAllowed) {
  const std::string limits = "    limits: {velocity_rad_s: 0.5, when_exceeded: scale}\n";
  const LoadedReference loaded = Parse(kSine + limits);
  ASSERT_EQ(loaded.notes.size(), 1u);
  EXPECT_NEAR(loaded.config.joints[0].trajectory->At(0.0).velocity_rad_s, 0.5, 1e-9);
  EXPECT_THAT(ErrorOf(kSine + std::string("    limits: {velocity_rad_s: 0.5}\n")),
              HasSubstr("ref.yaml:7: key 'joints[0].limits': the trajectory asks for"));
}

TEST(ReferenceFile, ALinearJointCarriesMetresInItsKeys) {
  EXPECT_NO_THROW(
      Parse("joints: [{joint: linear, kind: sine, amplitude_m: 0.1, frequency_Hz: 0.5}]\n"));
  EXPECT_THAT(
      ErrorOf("joints: [{joint: linear, kind: sine, amplitude_rad: 0.1, frequency_Hz: 0.5}]\n"),
      HasSubstr("amplitude_m"));
}

TEST(ReferenceFile, ReportsAnErrorInOneLine) {
  const struct {
    const char* text;
    const char* says;
  } kCases[] = {
      {"joints: []\n", "expected 1 to 12"},
      {"joints: [{kind: zigzag}]\n", "kind"},
      {"joints: [{kind: sine, amplitude_deg: 30, frequency_Hz: 1}]\n", "amplitude_rad"},
      {"joints: [{kind: sine, amplitude_rad: .nan, frequency_Hz: 1}]\n", "amplitude_rad"},
      {"joints: [{kind: sine, amplitude_rad: 1, frequency_Hz: 0}]\n", "frequency_Hz"},
      {"joints: [{kind: sine, amplitude_rad: 1, frequency_Hz: 1, speed: 2}]\n", "speed"},
      {"start: sometimes\njoints: [{kind: hold}]\n", "start"},
      {"joints: [{kind: sequence, pieces: []}]\n", "pieces"},
      {"joints: [{kind: multisine, amplitude_rad: 1, lowest_frequency_Hz: 2, highest_frequency_Hz: "
       "1, period_s: 9}]\n",
       "lines"},
      {"joints: [{kind: file, path: absent.csv}]\n", "absent.csv"},
      {"joints: [{kind: hold, limits: {position_lower_rad: 1, position_upper_rad: 0}}]\n", "lower"},
      {"joints: [{kind: hold, center_rad: 2, limits: {position_upper_rad: 0}}]\n", "outside"},
  };
  for (const auto& c : kCases) {
    const std::string error = ErrorOf(c.text);
    EXPECT_THAT(error, HasSubstr(c.says)) << c.text;
    EXPECT_THAT(error, HasSubstr("ref.yaml")) << c.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

class CsvFile : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text) const {
    const std::filesystem::path path =
        std::filesystem::path(::testing::TempDir()) /
        ("reference_file_test_" + std::to_string(::getpid()) + ".csv");
    std::ofstream(path) << text;
    return path;
  }
  std::string ErrorOfCsv(const std::string& text) const {
    try {
      static_cast<void>(ReadTrajectoryCsv(Write(text), "time_s", "position_rad"));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  }
};

TEST_F(CsvFile, IsReadByColumnName) {
  const CsvTrajectory csv = ReadTrajectoryCsv(
      Write("other,position_rad,time_s\r\n9, 0.5,0\r\n9,0.6, 0.1\r\n"), "time_s", "position_rad");
  EXPECT_EQ(csv.position_rad, (std::vector<double>{0.5, 0.6}));
  EXPECT_EQ(csv.time_s, (std::vector<double>{0.0, 0.1}));
}

TEST_F(CsvFile, ErrorsNameLineAndColumn) {
  EXPECT_THAT(ErrorOfCsv("time_s,position_deg\n0,0\n"), HasSubstr(":1: no column 'position_rad'"));
  EXPECT_THAT(ErrorOfCsv("time_s,position_rad\n0,0\n1,x\n"),
              HasSubstr(":3: column 'position_rad'"));
  EXPECT_THAT(ErrorOfCsv("time_s,position_rad\n0,0\n1,nan\n"), HasSubstr("finite"));
  EXPECT_THAT(ErrorOfCsv("time_s,position_rad\n0,0\n0,1\n"), HasSubstr("does not rise"));
  EXPECT_THAT(ErrorOfCsv("time_s,position_rad\n0,0\n1\n"), HasSubstr("1 columns"));
  EXPECT_THAT(ErrorOfCsv("time_s,position_rad\n0,0\n"), HasSubstr("two or more"));
  EXPECT_THAT(ErrorOfCsv(""), HasSubstr("two or more"));
}

}  // namespace
}  // namespace sinew::reference
