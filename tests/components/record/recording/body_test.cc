// Forces of the feet and IMU of a recording, written message by message as the logger writes them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "components/record/recording/body_builder.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "idl/embedded_idl.h"
#include "tests/support/memory_io.h"

namespace sinew::recording {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 4'000'000;

// A recording of some of the topics, a message a tick.
class BodyFile {
 public:
  explicit BodyFile(const std::set<std::string>& topics = {"joint_state", "foot_force", "imu"}) {
    EXPECT_TRUE(writer_.Open().ok());
    for (const auto& [topic, name] :
         {std::pair{"joint_state", "JointState"}, std::pair{"foot_force", "FootForce"},
          std::pair{"imu", "Imu"}}) {
      if (topics.contains(topic)) AddTopicOf(topic, std::string("sinew::msg::") + name);
    }
  }

  // Puts what is in the fields into all topics; `without` gets no message.
  void Write(std::uint64_t session, std::int64_t tick, const std::string& without = "") {
    for (auto& [topic, entry] : topics_) {
      if (topic == without) continue;
      Set(topic, "header.session_id", static_cast<double>(session));
      Set(topic, "header.tick", static_cast<double>(tick));
      Set(topic, "header.stamp_ns", static_cast<double>(tick * kPeriod_ns));
      EXPECT_TRUE(
          writer_.WriteMessage(entry.channel, tick * kPeriod_ns, tick * kPeriod_ns, entry.message)
              .ok());
    }
  }

  void Set(const std::string& topic, const std::string& field, double value) {
    Entry& entry = topics_.at(topic);
    CdrField(entry.idl->Struct(entry.type), field).Set(entry.message, value);
  }

  BodyRun Read() {
    EXPECT_TRUE(writer_.Close().ok());
    MemorySource source(sink_.bytes());
    return BodyOfRecording(McapReader(source), "squat.mcap");
  }
  std::string ErrorOf() {
    try {
      Read();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  }

 private:
  struct Entry {
    std::shared_ptr<IdlSchema> idl;
    std::string type;
    ChannelId channel{};
    Bytes message;
  };

  void AddTopicOf(const std::string& topic, const std::string& type) {
    for (const idl::EmbeddedType& embedded : idl::EmbeddedTypes()) {
      if (embedded.type_name != type) continue;
      Entry& entry = topics_[topic];
      entry.type = type;
      entry.idl = std::make_shared<IdlSchema>(IdlSchema::Parse(std::string(embedded.text)));
      entry.message = ZeroCdr(entry.idl->Struct(type));
      EXPECT_TRUE(AddTopic({topic, type, std::string(embedded.text), std::string(embedded.hash)},
                           &writer_, &entry.channel)
                      .ok());
    }
    if (topic == "foot_force") {
      for (int i = 0; i < kFootSensors; ++i) {
        Set(topic, "valid[" + std::to_string(i) + "]", 1.0);
        Set(topic, "force_N[" + std::to_string(i) + "]", 10.0 + i);
      }
    }
    if (topic == "imu") {
      Set(topic, "valid", 1.0);
      Set(topic, "orientation_wxyz[0]", 0.6);
      Set(topic, "orientation_wxyz[3]", 0.8);
      Set(topic, "angular_velocity_rad_s[1]", -0.5);
    }
  }

  MemorySink sink_;
  McapWriter writer_{sink_};
  std::map<std::string, Entry> topics_;
};

TEST(BodyOfRecording, HasTheValuesOfEveryTickAtTheTimeOfItsJoints) {
  BodyFile file;
  file.Write(7, 3);
  file.Set("foot_force", "force_N[7]", -1.5);
  file.Write(7, 5);
  const BodyRun body = file.Read();
  ASSERT_EQ(body.time_s.size(), 2);
  EXPECT_EQ(body.time_s[0], 0.012);
  EXPECT_EQ(body.time_s[1], 0.020);
  EXPECT_EQ(body.foot_force_N(0, 0), 10.0);
  EXPECT_EQ(body.foot_force_N(0, 7), 17.0);
  EXPECT_EQ(body.foot_force_N(1, 7), -1.5);
  EXPECT_EQ(body.orientation_wxyz(0, 0), 0.6);
  EXPECT_EQ(body.orientation_wxyz(1, 3), 0.8);
  EXPECT_EQ(body.angular_velocity_rad_s(0, 1), -0.5);
}

TEST(BodyOfRecording, LeavesOutTicksWithASensorThatIsNotValidOrNotThere) {
  BodyFile file;
  file.Write(7, 0);
  file.Set("foot_force", "valid[4]", 0.0);
  file.Write(7, 1);
  file.Set("foot_force", "valid[4]", 1.0);
  file.Set("imu", "orientation_wxyz[2]", std::numeric_limits<double>::quiet_NaN());
  file.Write(7, 2);
  file.Set("imu", "orientation_wxyz[2]", 0.0);
  file.Write(7, 3, "imu");
  file.Write(7, 4, "joint_state");
  file.Write(7, 5);
  const BodyRun body = file.Read();
  ASSERT_EQ(body.time_s.size(), 2);
  EXPECT_EQ(body.time_s[1], 0.020);
}

TEST(BodyOfRecording, NamesTheTopicThatIsMissing) {
  for (const std::string missing : {"foot_force", "imu", "joint_state"}) {
    std::set<std::string> topics = {"joint_state", "foot_force", "imu"};
    topics.erase(missing);
    BodyFile file(topics);
    file.Write(7, 0);
    const std::string error = file.ErrorOf();
    EXPECT_THAT(error, HasSubstr("squat.mcap"));
    EXPECT_THAT(error, HasSubstr("no topic '" + missing + "'"));
  }
}

TEST(BodyOfRecording, NamesTheSensorThatIsNeverValid) {
  BodyFile feet;
  feet.Set("foot_force", "valid[0]", 0.0);
  feet.Write(7, 0);
  EXPECT_THAT(feet.ErrorOf(), HasSubstr("'foot_force'"));
  BodyFile imu;
  imu.Set("imu", "valid", 0.0);
  imu.Write(7, 0);
  EXPECT_THAT(imu.ErrorOf(), HasSubstr("'imu'"));
}

TEST(BodyOfRecording, RefusesTwoSessions) {
  BodyFile file;
  file.Write(7, 0);
  file.Write(8, 1);
  EXPECT_THAT(file.ErrorOf(), HasSubstr("more than one session"));
}

}  // namespace
}  // namespace sinew::recording
