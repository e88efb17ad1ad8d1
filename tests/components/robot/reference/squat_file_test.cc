#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>

#include "components/robot/reference/file/reference_file.h"

namespace sinew::reference {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kBiped = SINEW_SOURCE_DIR "/robots/biped/";

std::string ShippedFile(const std::string& name) {
  std::ifstream in(kBiped + name);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Of the benchmark file with one text replaced by another.
std::string SquatFileError(const std::string& from, const std::string& to) {
  std::string text = ShippedFile("reference_benchmark.yaml");
  text.replace(text.find(from), from.size(), to);
  try {
    static_cast<void>(config::Read<LoadedReference>(
        config::Section::Parse(text, kBiped + "changed.yaml", "sinew-reference/1")));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

Extremes JointExtremes(const LoadedReference& loaded, std::size_t joint) {
  return Measure(*loaded.config.joints[joint].trajectory, 1.0);
}

TEST(SquatFile, LoadsTheShippedSquatsForTwelveJoints) {
  for (const auto& [name, duration_s] : {std::pair{"reference_benchmark.yaml", 10.0},
                                         {"reference_six.yaml", 30.0},
                                         {"reference_chirp.yaml", 200.0}}) {
    const LoadedReference loaded = LoadReference(kBiped + name);
    ASSERT_EQ(loaded.config.joints.size(), 12u) << name;
    ASSERT_EQ(loaded.joint_names.size(), 12u);
    EXPECT_EQ(loaded.joint_names[0], "left_hip_yaw");
    EXPECT_EQ(loaded.joint_names[9], "right_knee");
    for (std::size_t j = 0; j < 12; ++j) {
      const GeneratorConfig& joint = loaded.config.joints[j];
      EXPECT_EQ(joint.trajectory->duration_s(), duration_s);
      const Extremes e = JointExtremes(loaded, j);
      const bool moves = j % 6 >= 2 && j % 6 <= 4;
      EXPECT_EQ(e.velocity_rad_s > 0.0, moves) << loaded.joint_names[j];
      EXPECT_LE(e.velocity_rad_s, joint.limits.velocity_rad_s);
      EXPECT_LE(e.acceleration_rad_s2, joint.limits.acceleration_rad_s2);
    }
  }
}

// The table in docs/participants/reference.md.
TEST(SquatFile, TheKneesFiguresAreThoseOfTheDocument) {
  constexpr double kPrinted = 0.006;  // of the last digit printed, and the grid
  const auto expect = [](const char* name, const Extremes& printed) {
    const Extremes e = JointExtremes(LoadReference(kBiped + name), 3);
    EXPECT_NEAR(e.position_lower_rad, printed.position_lower_rad, kPrinted) << name;
    EXPECT_NEAR(e.position_upper_rad, printed.position_upper_rad, kPrinted) << name;
    EXPECT_NEAR(e.velocity_rad_s, printed.velocity_rad_s, kPrinted) << name;
    EXPECT_NEAR(e.acceleration_rad_s2, printed.acceleration_rad_s2, 10.0 * kPrinted) << name;
  };
  expect("reference_benchmark.yaml", {0.55, 2.63, 1.25, 4.13});
  expect("reference_six.yaml", {0.55, 2.63, 1.25, 4.13});
  expect("reference_chirp.yaml", {0.55, 2.57, 3.00, 21.0});
}

TEST(SquatFile, BothLegsMoveAlikeAndKeepTheSoleFlat) {
  const LoadedReference loaded = LoadReference(kBiped + "reference_benchmark.yaml");
  for (double t = 0.0; t <= 10.0; t += 0.1) {
    double sum = 0.0;
    for (std::size_t j = 2; j <= 4; ++j) {
      const Point left = loaded.config.joints[j].trajectory->At(t);
      const Point right = loaded.config.joints[j + 6].trajectory->At(t);
      EXPECT_EQ(left.position_rad, right.position_rad);
      EXPECT_EQ(left.velocity_rad_s, right.velocity_rad_s);
      sum += left.position_rad;
    }
    EXPECT_NEAR(sum, 0.0, 1e-12);
  }
}

// From straight legs onto the squat and to rest again: the generator's soft start and stop.
TEST(SquatFile, TheSoftStartKeepsTheSoleFlatAndTheLimits) {
  const LoadedReference loaded = LoadReference(kBiped + "reference_chirp.yaml");
  std::vector<Generator> joints;
  double soft_start_s = 0.0;
  for (const std::size_t j : {2u, 3u, 4u}) {
    joints.emplace_back(loaded.config.joints[j]);
    joints.back().Start(0.0);
    soft_start_s = std::max(soft_start_s, joints.back().soft_start_s());
  }
  for (Generator& joint : joints) joint.LengthenSoftStart(soft_start_s);
  for (double t = 0.0; t < soft_start_s + 3.0; t += 1e-3) {
    double sum = 0.0;
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const Point p = joints[j].At(t);
      const Limits& limits = loaded.config.joints[j + 2].limits;
      sum += p.position_rad;
      ASSERT_LE(std::abs(p.velocity_rad_s), limits.velocity_rad_s);
      ASSERT_LE(std::abs(p.acceleration_rad_s2), limits.acceleration_rad_s2);
      ASSERT_GE(p.position_rad, limits.position_lower_rad);
    }
    ASSERT_NEAR(sum, 0.0, 1e-12) << t;
  }
}

TEST(SquatFile, TheChirpReportsHowItsAmplitudeIsLimited) {
  const LoadedReference loaded = LoadReference(kBiped + "reference_chirp.yaml");
  ASSERT_EQ(loaded.notes.size(), 1u);
  EXPECT_THAT(loaded.notes[0], HasSubstr("amplitude 0.19 m, drawn in to"));
  EXPECT_THAT(LoadReference(kBiped + "reference_six.yaml").notes, IsEmpty());
}

TEST(SquatFile, APassedLimitIsAnErrorWithJointLimitAndLargestValue) {
  EXPECT_THAT(
      SquatFileError("velocity_rad_s: 2", "velocity_rad_s: 0.5"),
      AllOf(HasSubstr("changed.yaml:"), HasSubstr("key 'squat.limits'"),
            HasSubstr("joint 'left_hip_pitch': velocity reaches"), HasSubstr("limit 0.5 rad/s")));
  EXPECT_THAT(SquatFileError("acceleration_rad_s2: 10", "acceleration_rad_s2: 1"),
              HasSubstr("joint 'left_hip_pitch': acceleration reaches"));
  EXPECT_THAT(SquatFileError("depth_m: 0.4", "depth_m: 0.45"),
              HasSubstr("joint 'left_knee': position reaches"));
}

TEST(SquatFile, BadSectionsAreErrorsInOneLine) {
  EXPECT_THAT(SquatFileError("depth_m: 0.4", "depth_m: 0.53"), HasSubstr("does not reach"));
  EXPECT_THAT(SquatFileError("depth_m: 0.4", "depth_m: 0.01"), HasSubstr("margin < depth"));
  EXPECT_THAT(SquatFileError("kind: benchmark", "kind: jump"), HasSubstr("benchmark"));
  EXPECT_THAT(SquatFileError("biped.urdf", "../rig/rig.urdf"),
              HasSubstr("joint 'left_hip_yaw': no moving joint"));
  EXPECT_THAT(SquatFileError("biped.urdf", "no.urdf"), HasSubstr("no.urdf"));
  EXPECT_THAT(SquatFileError("  soft_stop_s", "  soft_end_s"), HasSubstr("soft_end_s"));
  EXPECT_THAT(SquatFileError("squat:", "joints: [{kind: hold}]\nsquat:"),
              HasSubstr("expected one of them"));
  EXPECT_THAT(SquatFileError("  limits: {", "  limits: {jerk_rad_s3: 1, "), HasSubstr("jerk"));
}

}  // namespace
}  // namespace sinew::reference
