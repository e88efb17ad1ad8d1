// Poses from recordings that are written here with the project's own topic types.
#include "sim/render/file/recorded_poses.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "sim/render/camera.h"
#include "tests/sim/render/biped_squat.h"
#include "tests/support/json_cdr.h"
#include "tests/support/temporary_folder.h"

namespace sinew::render {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

constexpr int kStateRate_Hz = 500;
constexpr double kShift_m = 0.7;  // of the recorded base
// The first state's stamp is an epoch time.
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

// A file of idl/ as one text: each file that it includes stands in place of its include.
std::string TopicIdl(const std::string& name) {
  const std::string folder = SINEW_SOURCE_DIR "/idl/";
  std::string text = config::ReadFile(folder + name);
  const std::string include = "#include \"";
  for (std::size_t at = text.find(include); at != std::string::npos; at = text.find(include)) {
    const std::size_t from = at + include.size(), to = text.find("\"\n", from);
    const std::string file = text.substr(from, to - from);
    text.replace(at, to + 2 - at, config::ReadFile(folder + file));
  }
  return text;
}

// The topic sim_body_truth as far as it is read.
constexpr const char* kBodyTruthIdl =
    "module sinew { module msg {\n"
    "enum Origin { ORIGIN_LIVE, ORIGIN_SIM, ORIGIN_REPLAY };\n"
    "@final struct Header { unsigned long long session_id; unsigned long long tick;\n"
    "  long long stamp_ns; Origin origin; };\n"
    "@final struct SimBodyTruth { Header header; double position_m[3];\n"
    "  double orientation_wxyz[4]; };\n"
    "}; };\n";

Json Header(int tick, int session) {
  return {{"session_id", session},
          {"tick", tick},
          {"stamp_ns", kStart_ns + std::int64_t{1'000'000'000} / kStateRate_Hz * tick}};
}

class RecordingFile {
 public:
  explicit RecordingFile(const std::filesystem::path& path)
      : sink_(path, recording::Existing::kReplace), writer_(sink_) {
    EXPECT_TRUE(writer_.Open().ok());
  }
  ~RecordingFile() {
    EXPECT_TRUE(writer_.Close().ok());
    EXPECT_TRUE(sink_.Close().ok());
  }

  std::function<void(const Json&)> AddTopic(const std::string& topic, const std::string& type,
                                            const std::string& idl) {
    recording::SchemaId schema{};
    recording::ChannelId channel{};
    EXPECT_TRUE(writer_.AddSchema(type, "omgidl", idl, &schema).ok());
    EXPECT_TRUE(writer_.AddChannel(schema, topic, "cdr", {}, &channel).ok());
    return [this, channel, type, idl](const Json& json) {
      const auto parsed = recording::IdlSchema::Parse(idl);
      const recording::Bytes bytes = recording::JsonToCdr(parsed.Struct(type), json);
      const std::int64_t stamp_ns = json["header"]["stamp_ns"];
      EXPECT_TRUE(writer_.WriteMessage(channel, stamp_ns, stamp_ns, bytes).ok());
    };
  }
  std::function<void(const Json&)> AddJointState() {
    return AddTopic("joint_state", "sinew::msg::JointState", TopicIdl("joint.idl"));
  }

 private:
  recording::FileSink sink_;
  recording::McapWriter writer_;
};

std::vector<double> DrivenJoints(const BipedSquat& squat, double time_s) {
  const RobotPose pose = squat.JointsAt(time_s);
  std::vector<double> out;
  std::size_t joint = 0;
  for (const arm::Body& body : squat.scene().chain.bodies) {
    if (!body.moves) continue;
    if (body.effort > 0.0) out.push_back(pose.joint_rad[joint]);
    ++joint;
  }
  return out;
}

// 1 s of the squat; a second session follows.
std::filesystem::path WriteSquat(const testing::TemporaryFolder& folder, const BipedSquat& squat,
                                 bool with_base) {
  const std::filesystem::path path = folder.path() / "squat.mcap";
  RecordingFile file(path);
  const auto write_joints = file.AddJointState();
  const auto write_base =
      with_base ? file.AddTopic("sim_body_truth", "sinew::msg::SimBodyTruth", kBodyTruthIdl)
                : std::function<void(const Json&)>();
  for (int tick = 0; tick <= kStateRate_Hz; ++tick) {
    const double time_s = static_cast<double>(tick) / kStateRate_Hz;
    if (write_base) {
      write_base({{"header", Header(tick, 1)},
                  {"position_m", {kShift_m, 0.0, kStandingHeight_m + squat.Height_m(time_s)}},
                  {"orientation_wxyz", {0.0, 0.0, 0.0, 1.0}}});  // half a turn about z
    }
    write_joints({{"header", Header(tick, 1)},
                  {"joint_count", 12},
                  {"position_rad", DrivenJoints(squat, time_s)}});
  }
  write_joints({{"header", Header(kStateRate_Hz + 1, 2)}, {"joint_count", 12}});
  return path;
}

TEST(RecordedPoses, AreThoseOfTheTimeOfEachFrame) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  const auto path = WriteSquat(folder, squat, false);
  const RecordedPoses recorded = ReadPoses(path, squat.scene(), {});
  EXPECT_FALSE(recorded.fixed_base);
  const std::vector<TimedPose>& poses = recorded.poses;
  ASSERT_EQ(poses.size(), 26u);  // 0 s and 1 s, and 24 between
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double time_s = 0.04 * static_cast<double>(i);
    EXPECT_NEAR(poses[i].time_s, time_s, 1e-12);
    const RobotPose expected = squat.At(time_s);
    for (std::size_t j = 0; j < expected.joint_rad.size(); ++j) {
      EXPECT_NEAR(poses[i].pose.joint_rad[j], expected.joint_rad[j], 1e-12);
    }
    EXPECT_TRUE(poses[i].pose.world_from_base.isApprox(expected.world_from_base, 1e-9));
  }
}

TEST(RecordedPoses, TheBaseIsTheRecordedOne) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  const auto path = WriteSquat(folder, squat, true);
  RecordedPosesOptions options;
  options.from_s = 0.5;
  options.to_s = 0.7;
  options.frames_per_s = 10;
  const std::vector<TimedPose> poses = ReadPoses(path, squat.scene(), options).poses;
  ASSERT_EQ(poses.size(), 3u);
  const Eigen::Isometry3d& base = poses[0].pose.world_from_base;
  EXPECT_NEAR(base.translation().x(), kShift_m, 1e-12);
  EXPECT_NEAR(base.translation().z(), kStandingHeight_m + squat.Height_m(0.5), 1e-12);
  EXPECT_LT((base.linear() * Eigen::Vector3d::UnitX() + Eigen::Vector3d::UnitX()).norm(), 1e-12);
}

TEST(RecordedPoses, AFixedBaseIsSoHighThatNoPostureReachesTheGround) {
  const Scene scene = LoadScene(SINEW_SOURCE_DIR "/robots/rig/rig.urdf");
  RobotPose pose = MountedPose(scene);
  for (double angle_rad = -3.2; angle_rad <= 3.2; angle_rad += 0.1) {
    pose.joint_rad.assign(pose.joint_rad.size(), angle_rad);
    pose.world_from_base.translation().z() = -3.0;
    EXPECT_FALSE(PlaceBase(scene, &pose));
    EXPECT_GE(Extent(scene, pose).min().z(), 0.0) << angle_rad;
    const Camera camera = CameraOf(scene, View::kThreeQuarter, true);
    const Eigen::Vector2d seen = Project(camera, 960, 720, Extent(scene, pose).center());
    EXPECT_GT(seen.minCoeff(), 0.0);
    EXPECT_LT(seen.y(), 720.0);
  }
}

TEST(RecordedPoses, RefusalsNameTheFileAndWhatIsMissing) {
  const testing::TemporaryFolder folder;
  const BipedSquat squat;
  const auto error_of = [](const std::filesystem::path& path, const Scene& scene,
                           const RecordedPosesOptions& options = {}) -> std::string {
    try {
      (void)ReadPoses(path, scene, options);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no error";
  };
  const auto squat_file = WriteSquat(folder, squat, false);
  const Scene rig = LoadScene(SINEW_SOURCE_DIR "/robots/rig/rig.urdf");
  EXPECT_THAT(error_of(squat_file, rig), HasSubstr("squat.mcap: joint_state has 12 joints"));
  RecordedPosesOptions late;
  late.from_s = 60.0;
  EXPECT_THAT(error_of(squat_file, squat.scene(), late), HasSubstr("it ends at 1.0"));
  const auto empty = folder.path() / "empty.mcap";
  { RecordingFile file(empty); }
  EXPECT_THAT(error_of(empty, rig), HasSubstr("empty.mcap: no joint_state"));
  { RecordingFile(empty).AddJointState(); }
  EXPECT_THAT(error_of(empty, rig), HasSubstr("empty.mcap: joint_state has no message"));
  const auto text = folder.Write("text.mcap", "no recording");
  EXPECT_THAT(error_of(text, rig), HasSubstr("text.mcap: "));
}

}  // namespace
}  // namespace sinew::render
