#include "components/robot/performance/file/performance_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace sinew::performance {
namespace {

using ::testing::HasSubstr;

const std::string kBipedFolder = SINEW_SOURCE_DIR "/robots/biped/";

PerformanceConfig ParsePerformance(const std::string& text) {
  return config::Read<PerformanceConfig>(config::Section::Parse(
      "schema: sinew-performance/1\n" + text, kBipedFolder + "given.yaml", "sinew-performance/1"));
}

TEST(PerformanceFile, TheShippedOnesAreOfTheirRobots) {
  for (const char* name : {"performance.yaml", "performance_stand.yaml"}) {
    PerformanceConfig biped = LoadPerformance(kBipedFolder + name);
    ASSERT_EQ(biped.robot.joints.size(), 12u);
    EXPECT_EQ(biped.joint_names[3], "left_knee");
    EXPECT_FALSE(biped.linear[3]);
    EXPECT_EQ(biped.robot.joints[3].motor.gear_ratio, 100.0);
    EXPECT_EQ(biped.robot.joints[2].motor.gear_ratio, 80.0);
    EXPECT_EQ(biped.robot.joints[3].window_s, kWindow_s);
    EXPECT_NEAR(biped.robot.mass_kg.value(), 17.1, 1e-6);
  }
  const PerformanceConfig rig = LoadPerformance(SINEW_SOURCE_DIR "/robots/rig/performance.yaml");
  EXPECT_EQ(rig.robot.joints.size(), 1u);
  EXPECT_FALSE(rig.robot.mass_kg.has_value());
}

// (5.6) and Table 3.1: 0.38 m between the highest and the lowest point of the squat; what the legs
// weigh stays lower than the base.
TEST(PerformanceFile, TheBipedsCentreRisesByALargePartOfTheSquat) {
  PerformanceConfig biped = LoadPerformance(kBipedFolder + "performance.yaml");
  std::vector<double> top(12, 0.0), bottom(12, 0.0);
  for (const std::size_t leg : {0u, 6u}) {
    top[leg + 2] = -0.264287975, top[leg + 3] = 0.547359903, top[leg + 4] = -0.283071929;
    bottom[leg + 2] = -1.187032127, bottom[leg + 3] = 2.627020958, bottom[leg + 4] = -1.439988831;
  }
  const double rise_m = biped.height->Of(top) - biped.height->Of(bottom);
  EXPECT_GT(rise_m, 0.5 * 0.38);
  EXPECT_LT(rise_m, 0.38);
}

TEST(PerformanceFile, LeavesOutWhatIsNotGiven) {
  const PerformanceConfig config = ParsePerformance("model: model.yaml\nwindow_s: 2\n");
  EXPECT_EQ(config.robot.joints[0].window_s, 2.0);
  EXPECT_EQ(config.robot.joints[0].motor.copper_resistance_Ohm, 0.0);
  EXPECT_FALSE(config.height.has_value());
}

TEST(PerformanceFile, ReportsAnErrorInOneLine) {
  const struct {
    const char* text;
    const char* says;
  } kCases[] = {
      {"window_s: 1.5\n", "model"},
      {"model: no_such.yaml\n", "no_such.yaml"},
      {"model: model.yaml\nwindow_ms: 1500\n", "window_ms"},
      {"model: model.yaml\nwindow_s: 0.001\n", "window_s"},
      {"model: model.yaml\nwindow_s: .nan\n", "window_s"},
      {"model: model.yaml\ncopper_resistance_Ohm: [0.1, 0.1]\n", "one for each of 12"},
      {"model: model.yaml\nlifting: {urdf: no.urdf}\n", "no.urdf"},
      {"model: model.yaml\nlifting: {urdf: ../rig/rig.urdf}\n", "left_hip_yaw"},
      {"model: model.yaml\nlifting: {urdf: biped.urdf, on_ground: [paw]}\n", "paw"},
      {"model: model.yaml\nlifting: {urdf: biped.urdf, band_m: 0}\n", "band_m"},
  };
  for (const auto& c : kCases) {
    try {
      static_cast<void>(ParsePerformance(c.text));
      ADD_FAILURE() << "accepted: " << c.text;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.says)) << c.text;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace sinew::performance
