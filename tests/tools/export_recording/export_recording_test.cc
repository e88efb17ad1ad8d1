// Recordings for other programs. tests/tools/python reads what `sinew export` writes, on all
// topics.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/sensors.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/cdr_json.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/file/ros_bag.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"
#include "tests/support/temporary_folder.h"
#include "tools/export_recording/npz.h"
#include "tools/export_recording/ros2_bag.h"
#include "tools/export_recording/ros2_messages.h"

namespace sinew::export_recording {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

// The messages as rosidl maps them to IDL (rosidl_adapter), written here by hand from the published
// .msg files: what another program would read the bag with.
constexpr const char* kRosIdl = R"(
module builtin_interfaces { module msg {
  @final struct Time { long sec; unsigned long nanosec; };
}; };
module std_msgs { module msg {
  @final struct Header { builtin_interfaces::msg::Time stamp; string frame_id; };
}; };
module geometry_msgs { module msg {
  @final struct Vector3 { double x; double y; double z; };
  @final struct Quaternion { double x; double y; double z; double w; };
  @final struct Wrench { Vector3 force; Vector3 torque; };
  @final struct WrenchStamped { std_msgs::msg::Header header; Wrench wrench; };
}; };
module sensor_msgs { module msg {
  @final struct JointState { std_msgs::msg::Header header; sequence<string> name;
    sequence<double> position; sequence<double> velocity; sequence<double> effort; };
  @final struct Imu { std_msgs::msg::Header header;
    geometry_msgs::msg::Quaternion orientation; double orientation_covariance[9];
    geometry_msgs::msg::Vector3 angular_velocity; double angular_velocity_covariance[9];
    geometry_msgs::msg::Vector3 linear_acceleration; double linear_acceleration_covariance[9]; };
}; };)";

constexpr std::int64_t kStart_ns = 1'700'000'000'250'000'000;

class Bag : public ::testing::Test {
 protected:
  template <class Message>
  void Add(const node::Topic<Message>& topic, Message message) {
    const node::TopicInfo& info = *node::FindTopic(topic.name);
    auto [channel, is_new] = channels_.try_emplace(info.name);
    if (is_new) {
      ASSERT_TRUE(recording::AddTopic({info.name, info.type_name, info.idl, info.idl_hash},
                                      &writer_, &channel->second)
                      .ok());
    }
    message.header.stamp_ns = stamp_ns_;
    node::Bytes bytes;
    ASSERT_TRUE(node::Encode(message, &bytes));
    const std::int64_t log_ns = log_ns_ > 0 ? log_ns_ : stamp_ns_ + 500;
    ASSERT_TRUE(writer_.WriteMessage(channel->second, log_ns, stamp_ns_, bytes).ok());
    stamp_ns_ += 1'000'000'000;
  }

  void SetUp() override { ASSERT_TRUE(writer_.Open().ok()); }

  RosBag Write(const RosNames& names = {}) {
    EXPECT_TRUE(writer_.Close().ok() && sink_.Close().ok());
    fs::create_directory(folder_.path() / "bag");
    return WriteRosBag(recording::ParseRecordingPath(path_), names, folder_.path() / "bag");
  }

  // Messages of the bag by topic.
  std::map<std::string, std::vector<ordered_json>> ReadBag() const {
    recording::FileSource source(folder_.path() / "bag" / "recording_0.mcap");
    const recording::McapReader reader(source);
    EXPECT_EQ(reader.profile(), "ros2");
    const recording::IdlSchema schema = recording::IdlSchema::Parse(kRosIdl);
    std::map<std::string, std::vector<ordered_json>> out;
    recording::McapMessages messages = reader.Messages();
    recording::McapMessage message;
    while (messages.Next(&message)) {
      const recording::McapChannel& channel = reader.channels().at(message.channel_id);
      std::string type = reader.SchemaOf(channel)->name;
      EXPECT_EQ(reader.SchemaOf(channel)->encoding, "ros2msg");
      for (std::size_t at = 0; (at = type.find('/')) != std::string::npos;) {
        type.replace(at, 1, "::");
      }
      out[channel.topic].push_back(recording::CdrToJson(schema.Struct(type), message.data));
    }
    return out;
  }

  // Times of a bag's messages, and the ticks that their positions name.
  std::vector<std::pair<std::int64_t, double>> TimesOfBag() const {
    recording::FileSource source(folder_.path() / "bag" / "recording_0.mcap");
    const recording::McapReader reader(source);
    const recording::IdlSchema schema = recording::IdlSchema::Parse(kRosIdl);
    const recording::CdrField tick(schema.Struct("sensor_msgs::msg::JointState"), "position[0]");
    recording::McapMessages messages = reader.Messages();
    recording::McapMessage message;
    std::vector<std::pair<std::int64_t, double>> times;
    while (messages.Next(&message)) {
      times.emplace_back(message.log_time_ns, tick.AsDouble(message.data));
    }
    return times;
  }
  // A state of that tick, which is its position.
  void AddTick(std::uint64_t session, std::uint64_t tick) {
    msg::JointState state;
    state.header.session_id = session;
    state.header.tick = tick;
    state.joint_count = 1;
    state.valid[0] = true;
    state.position_rad[0] = static_cast<double>(tick);
    Add(node::kJointState, state);
  }

  testing::TemporaryFolder folder_;
  fs::path path_ = folder_.path() / "run.mcap";
  std::int64_t stamp_ns_ = kStart_ns;  // of the next message
  std::int64_t log_ns_ = 0;            // of the next message; 0: 500 ns after its stamp

 private:
  recording::FileSink sink_{path_, recording::Existing::kReplace};
  recording::McapWriter writer_{sink_};
  std::map<std::string, recording::ChannelId> channels_;
};

TEST_F(Bag, HasJointsByNameAndNothingForALostOne) {
  msg::JointState state;
  state.joint_count = 2;
  state.position_rad[0] = 0.5;
  state.velocity_rad_s[0] = -0.25;
  state.torque_Nm[0] = 3.0;
  state.position_rad[1] = 9.0;  // the last known value
  state.valid[0] = true;
  Add(node::kJointState, state);
  const RosBag written = Write({{"hip", "knee"}, {}, "imu"});
  ASSERT_EQ(written.topics.size(), 1u);
  EXPECT_EQ(written.topics[0].messages, 1u);
  const ordered_json message = ReadBag().at("/joint_states").at(0);
  EXPECT_EQ(message["header"]["stamp"]["sec"], 1'700'000'000);
  EXPECT_EQ(message["header"]["stamp"]["nanosec"], 250'000'000);
  EXPECT_EQ(message["name"], ordered_json({"hip", "knee"}));
  EXPECT_EQ(message["position"], ordered_json({0.5, "NaN"}));
  EXPECT_EQ(message["velocity"], ordered_json({-0.25, "NaN"}));
  EXPECT_EQ(message["effort"], ordered_json({3.0, "NaN"}));
}

// By the reader of bags: RosTable.
TEST_F(Bag, IsReadBackBitByBit) {
  msg::JointState state;
  state.joint_count = 2;
  state.valid.fill(true);
  msg::Imu imu;
  imu.valid = true;
  msg::FootForce feet;
  feet.valid[5] = true;
  constexpr int kMessages = 4;
  for (int i = 0; i < kMessages; ++i) {
    state.position_rad = {1.0 / (i + 3), -2.0 / (i + 3)};
    state.torque_Nm = {7.0 / (i + 3), i == 2 ? NAN : 1.0};
    imu.orientation_wxyz = {0.1 * i, 0.2 * i, 0.3 * i, 0.4 * i};
    imu.angular_velocity_rad_s = {1.1 * i, 1.2 * i, 1.3 * i};
    imu.acceleration_m_s2 = {2.1 * i, 2.2 * i, 2.3 * i};
    feet.force_N[5] = 3.1 * i;
    Add(node::kJointState, state);
    Add(node::kImu, imu);
    Add(node::kFootForce, feet);
  }
  Write({{"hip", "left/knee"}, {}, "imu"});
  std::vector<std::string> notes;
  const recording::RosTable table = recording::ReadRosBag(folder_.path() / "bag", &notes);
  EXPECT_THAT(notes, ElementsAre());
  const std::string force = "/foot_force/left_1/";
  const recording::CsvTable joints =
      table.Read({"/joint_states/header/stamp", "/joint_states/left/knee/position",
                  "/joint_states/left/knee/effort"},
                 0, 1);
  EXPECT_THAT(joints.lines, ElementsAre(1, 2, 4)) << "message 3 has a torque that is no number";
  EXPECT_EQ(joints.values[0][1], static_cast<double>(kStart_ns + 3'000'000'000) / 1e9);
  EXPECT_EQ(joints.values[1][2], -2.0 / 6);
  const recording::CsvTable rates =
      table.Read({"/imu/data/header/stamp", "/imu/data/orientation/w", "/imu/data/orientation/z",
                  "/imu/data/angular_velocity/x", "/imu/data/angular_velocity/z",
                  "/imu/data/linear_acceleration/y"},
                 1, 1);
  EXPECT_THAT(rates.lines, ElementsAre(2, 3, 4));
  const recording::CsvTable forces = table.Read(
      {force + "header/stamp", force + "wrench/force/z", force + "wrench/torque/z"}, 0, 1);
  for (Eigen::Index row = 0; row < 3; ++row) {
    const double i = static_cast<double>(row + 1);
    EXPECT_EQ(rates.values[1][row], 0.1 * i);
    EXPECT_EQ(rates.values[2][row], 0.4 * i);
    EXPECT_EQ(rates.values[3][row], 1.1 * i);
    EXPECT_EQ(rates.values[4][row], 1.3 * i);
    EXPECT_EQ(rates.values[5][row], 2.2 * i);
    EXPECT_EQ(forces.values[1][row + 1], 3.1 * i);
    EXPECT_EQ(forces.values[2][row + 1], 0.0);
  }
}

TEST_F(Bag, OfMoreJointsThanTheModelNamesIsRefused) {
  msg::JointState state;
  state.joint_count = 2;
  Add(node::kJointState, state);
  try {
    Write({{"hip"}, {}, "imu"});
    FAIL() << "a joint without a name was written";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.mcap: 2 joints, the model names 1"));
  }
}

TEST_F(Bag, HasTheImuWithItsQuaternionInTheOrderOfRos) {
  msg::Imu imu;
  imu.orientation_wxyz = {0.5, -0.5, 0.25, 0.125};
  imu.angular_velocity_rad_s = {1.0, 2.0, 3.0};
  imu.acceleration_m_s2 = {4.0, 5.0, 6.0};
  imu.valid = true;
  Add(node::kImu, imu);
  imu.valid = false;
  Add(node::kImu, imu);
  Write({{}, {}, "torso"});
  const auto topics = ReadBag();
  ASSERT_EQ(topics.at("/imu/data").size(), 1u) << "a lost sample became a message";
  const ordered_json& message = topics.at("/imu/data")[0];
  EXPECT_EQ(message["header"]["frame_id"], "torso");
  EXPECT_EQ(message["orientation"],
            ordered_json({{"x", -0.5}, {"y", 0.25}, {"z", 0.125}, {"w", 0.5}}));
  EXPECT_EQ(message["angular_velocity"], ordered_json({{"x", 1.0}, {"y", 2.0}, {"z", 3.0}}));
  EXPECT_EQ(message["linear_acceleration"], ordered_json({{"x", 4.0}, {"y", 5.0}, {"z", 6.0}}));
  for (const char* part : {"orientation", "angular_velocity", "linear_acceleration"}) {
    EXPECT_EQ(message[std::string(part) + "_covariance"], ordered_json(std::vector<double>(9)));
  }
}

TEST_F(Bag, HasAWrenchPerFootSensorInItsFrame) {
  msg::FootForce feet;
  for (std::size_t i = 0; i < 8; ++i) feet.force_N[i] = 10.0 * static_cast<double>(i);
  feet.valid.fill(true);
  feet.valid[2] = false;
  Add(node::kFootForce, feet);
  RosNames names;
  names.force_frames[5] = "left_heel";
  const RosBag written = Write(names);
  EXPECT_EQ(written.topics.size(), 7u);
  const auto topics = ReadBag();
  EXPECT_EQ(topics.count("/foot_force/right_2"), 0u);
  const ordered_json& heel = topics.at("/foot_force/left_1").at(0);
  EXPECT_EQ(heel["header"]["frame_id"], "left_heel");
  EXPECT_EQ(heel["wrench"]["force"], ordered_json({{"x", 0.0}, {"y", 0.0}, {"z", 50.0}}));
  EXPECT_EQ(heel["wrench"]["torque"], ordered_json({{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}));
  EXPECT_EQ(topics.at("/foot_force/right_3").at(0)["header"]["frame_id"], "foot_force_3");
}

TEST_F(Bag, IsDescribedByItsMetadata) {
  msg::JointState state;
  state.joint_count = 1;
  for (int i = 0; i < 3; ++i) Add(node::kJointState, state);
  Add(node::kJointCommand, msg::JointCommand());
  const RosBag written = Write();
  EXPECT_THAT(written.left_out, ElementsAre("joint_command"));
  std::ifstream file(folder_.path() / "bag" / "metadata.yaml");
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_THAT(text, HasSubstr("nanoseconds_since_epoch: 1700000000250000500\n"));
  EXPECT_THAT(text, HasSubstr("  duration:\n    nanoseconds: 2000000000\n"));
  EXPECT_THAT(text, HasSubstr("        name: /joint_states\n"
                              "        type: sensor_msgs/msg/JointState\n"
                              "        serialization_format: cdr\n"));
  EXPECT_THAT(text, HasSubstr("      message_count: 3\n"));
}

TEST_F(Bag, OfLockstepPlaysAsFastAsTheRobotMoved) {
  for (std::uint64_t session = 1; session <= 2; ++session) {
    stamp_ns_ = 0;
    for (std::uint64_t tick = 0; tick < 3; ++tick) {
      log_ns_ = kStart_ns + static_cast<std::int64_t>(1000 * (10 * session + tick));
      AddTick(session, tick);
    }
  }
  Write();
  EXPECT_THAT(TimesOfBag(), ElementsAre(Pair(0, 0.0), Pair(1'000'000'000, 1.0),
                                        Pair(2'000'000'000, 2.0), Pair(2'000'000'000, 0.0),
                                        Pair(3'000'000'000, 1.0), Pair(4'000'000'000, 2.0)));
}

TEST_F(Bag, GoesOnWhereTheClockWasSetBack) {
  for (std::uint64_t tick = 0; tick < 6; ++tick) {
    if (tick == 3) stamp_ns_ -= 2'500'000'000;
    AddTick(1, tick);
  }
  Write();
  const auto times = TimesOfBag();
  ASSERT_EQ(times.size(), 6u);
  for (std::size_t i = 0; i < times.size(); ++i) {
    EXPECT_EQ(times[i].first, kStart_ns + 500 + 1'000'000'000 * static_cast<std::int64_t>(i));
    EXPECT_EQ(times[i].second, static_cast<double>(i));
  }
}

TEST_F(Bag, OfARecordingWithoutItsTopicsIsRefused) {
  Add(node::kJointCommand, msg::JointCommand());
  try {
    Write();
    FAIL() << "an empty bag was written";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("run.mcap: no message that a bag can have"));
  }
}

TEST(RosDefinition, HasEveryTypeThatItRefersTo) {
  for (const char* type : {kRosJointState, kRosImu, kRosWrenchStamped}) {
    const std::string text = RosDefinition(type);
    EXPECT_THAT(text, HasSubstr("\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\n")) << type;
    EXPECT_THAT(text, HasSubstr("\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"));
    EXPECT_THAT(text, HasSubstr(std::string(80, '=') + "\nMSG: "));
  }
  EXPECT_THAT(RosDefinition(kRosWrenchStamped), HasSubstr("\nMSG: geometry_msgs/Vector3\n"));
  EXPECT_THROW(RosDefinition("std_msgs/msg/String"), std::invalid_argument);
}

TEST(NpyHeader, IsAlignedAndNamesTypeAndShape) {
  for (const std::vector<std::size_t>& shape :
       {std::vector<std::size_t>{0}, {3}, {14400, 12}, {5, 2, 7}}) {
    const std::string header = NpyHeader("<f8", shape);
    EXPECT_EQ(header.size() % 64, 0u);
    EXPECT_EQ(header.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const std::size_t size =
        static_cast<unsigned char>(header[8]) + 256u * static_cast<unsigned char>(header[9]);
    EXPECT_EQ(size + 10, header.size());
    EXPECT_EQ(header.back(), '\n');
  }
  EXPECT_THAT(NpyHeader("<f8", {14400, 12}),
              HasSubstr("{'descr': '<f8', 'fortran_order': False, 'shape': (14400,12,), }"));
}

TEST(NpzWriter, LeavesNothingBehindWhenItCannotWrite) {
  const testing::TemporaryFolder folder;
  EXPECT_THROW(NpzWriter(folder.path() / "missing" / "run.npz"), std::runtime_error);
  { NpzWriter writer(folder.path() / "run.npz"); }
  EXPECT_TRUE(fs::is_empty(folder.path())) << "without Commit there is no file";
}

}  // namespace
}  // namespace sinew::export_recording
