// A lockstep recording of the rig, run again: all of it in one process, without DDS.
#include <gtest/gtest.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/snapshot.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bench/rerun/rig_recording.h"
#include "components/base/config/config.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/topics/node/codec.h"
#include "tests/support/temporary_folder.h"
#include "tools/rerun/recorded_parts.h"
#include "tools/rerun/recorded_ticks.h"
#include "tools/rerun/rerun.h"
#include "tools/rerun/stage.h"

namespace sinew::rerun {
namespace {

using testing::TemporaryFolder;

const std::filesystem::path kRig = SINEW_SOURCE_DIR "/robots/rig";
constexpr std::uint64_t kRecordedTicks = 4 * 240;
constexpr std::uint64_t kRequestTick = 300;

constexpr std::uint64_t kSnapshotTick = 500;

void RequestSnapshots(node::Node& operators, std::uint64_t session_id) {
  auto writer = operators.MakeWriter(node::kSnapshotRequest);
  msg::SnapshotRequest request;
  request.header.session_id = session_id;
  request.header.origin = msg::Origin::kSim;
  request.after_tick = kSnapshotTick;
  EXPECT_EQ(writer.Write(request), node::WriteStatus::kOk);
}

// Asks for another pressure while the joint moves.
void RequestPressure(node::Node& operators, std::uint64_t session_id, std::uint64_t tick) {
  if (tick == 10) RequestSnapshots(operators, session_id);
  if (tick != kRequestTick) return;
  auto writer = operators.MakeWriter(node::kStiffnessRequest);
  msg::StiffnessRequest request;
  request.header.session_id = session_id;
  request.header.tick = tick;
  request.header.origin = msg::Origin::kSim;
  request.joint_count = 1;
  request.kind[0] = msg::StiffnessKind::kPressure;
  request.pressure_bar[0] = 3.0;
  EXPECT_EQ(writer.Write(request), node::WriteStatus::kOk);
}

// One recording for all cases.
class RerunOfTheRig : public ::testing::Test {
 public:
  // Changes a payload; false: the message is left out.
  using Edit = std::function<bool(const std::string& topic, std::uint64_t tick, node::Bytes*)>;

 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    RecordRig(
        {.rig = kRig, .out = Recording(), .ticks = kRecordedTicks, .before = RequestPressure});
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::filesystem::path Recording() { return folder_->path() / "rig.mcap"; }

  // Those named; all when none is.
  static RerunResult Again(const std::filesystem::path& file,
                           const std::vector<std::string>& components = {},
                           const std::filesystem::path& control_config = {},
                           std::optional<double> from_s = {}, bool all_differences = false) {
    recording::FileSource source(file);
    const recording::McapReader reader(source);
    std::vector<compose::Part> parts;
    for (compose::Part part : PartsOfTheRig(kRig)) {
      const bool named =
          std::find(components.begin(), components.end(), part.name) != components.end();
      if (!components.empty() && !named) continue;
      if (part.name == "control" && !control_config.empty()) part.config = control_config;
      parts.push_back(part);
    }
    node::StopFlag stop;
    return Rerun(reader,
                 {.file = file.string(),
                  .session = SessionsOf(reader, file.string()).at(0),
                  .mode = ModeOf(reader, file.string()),
                  .parts = parts,
                  .from_s = from_s,
                  .all_differences = all_differences},
                 stop);
  }

  // A copy of a recording; the last message of `shared`, if named, is another participant's.
  static std::filesystem::path Copy(const std::string& name, const Edit& edit,
                                    const std::filesystem::path& from = Recording(),
                                    const std::string& shared = "") {
    recording::FileSource source(from);
    const recording::McapReader reader(source);
    recording::FileSink sink(folder_->path() / name, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    EXPECT_TRUE(writer.Open().ok());
    for (const auto& metadata : reader.ReadMetadata()) {
      EXPECT_TRUE(writer.WriteMetadata(metadata).ok());
    }
    std::map<recording::ChannelId, recording::ChannelId> channels;
    recording::ChannelId other{};
    for (const auto& [id, channel] : reader.channels()) {
      const recording::McapSchema* schema = reader.SchemaOf(channel);
      recording::SchemaId schema_id{};
      EXPECT_TRUE(writer.AddSchema(schema->name, schema->encoding, schema->data, &schema_id).ok());
      auto metadata = channel.metadata;
      if (channel.topic == shared) {
        metadata["participant"] = shared;
        EXPECT_TRUE(writer
                        .AddChannel(schema_id, channel.topic, channel.message_encoding,
                                    {{"participant", "other"}}, &other)
                        .ok());
      }
      EXPECT_TRUE(writer
                      .AddChannel(schema_id, channel.topic, channel.message_encoding, metadata,
                                  &channels[id])
                      .ok());
    }
    recording::McapMessages messages = reader.Messages();
    recording::McapMessage message;
    while (messages.Next(&message)) {
      node::Bytes payload(message.data.begin(), message.data.end());
      node::HeadOfMessage head;
      EXPECT_TRUE(node::PeekHead(payload.data(), payload.size(), &head));
      const std::string& topic = reader.channels().at(message.channel_id).topic;
      if (!edit(topic, head.tick, &payload)) continue;
      const bool others = topic == shared && head.tick == kRecordedTicks - 1;
      EXPECT_TRUE(writer
                      .WriteMessage(others ? other : channels[message.channel_id],
                                    message.log_time_ns, message.publish_time_ns, payload)
                      .ok());
    }
    EXPECT_TRUE(writer.Close().ok());
    EXPECT_TRUE(sink.Close().ok());
    return folder_->path() / name;
  }

  static const ComponentResult& Of(const RerunResult& result, const std::string& name) {
    for (const ComponentResult& component : result.components) {
      if (component.name == name) return component;
    }
    throw std::out_of_range(name);
  }

 private:
  static std::unique_ptr<TemporaryFolder> folder_;
};

std::unique_ptr<TemporaryFolder> RerunOfTheRig::folder_;

TEST_F(RerunOfTheRig, IsIdenticalFromTheStart) {
  const RerunResult result = Again(Recording());
  ASSERT_EQ(result.components.size(), 6u);
  for (const ComponentResult& component : result.components) {
    ASSERT_EQ(component.verdict, Verdict::kIdentical)
        << component.name << ' ' << component.lost
        << (component.difference
                ? component.difference->topic + "." + component.difference->field.field + " tick " +
                      std::to_string(component.difference->tick) + ": " +
                      component.difference->field.recorded + ", " +
                      component.difference->field.rerun
                : "");
    EXPECT_EQ(component.ticks, kRecordedTicks) << component.name;
    EXPECT_GE(component.messages, kRecordedTicks) << component.name;
  }
  EXPECT_TRUE(result.identical());
}

TEST_F(RerunOfTheRig, IsIdenticalFromASnapshot) {
  const RerunResult result = Again(Recording(), {}, {}, 3.0);
  ASSERT_EQ(result.components.size(), 6u);
  for (const ComponentResult& component : result.components) {
    ASSERT_EQ(component.verdict, Verdict::kIdentical)
        << component.name << ' ' << component.lost
        << (component.difference
                ? component.difference->topic + "." + component.difference->field.field + " tick " +
                      std::to_string(component.difference->tick)
                : "");
    EXPECT_EQ(component.from_tick, kSnapshotTick) << component.name;
    EXPECT_EQ(component.ticks, kRecordedTicks - 1 - kSnapshotTick) << component.name;
  }
}

TEST_F(RerunOfTheRig, BeforeTheRequestOnlyTheFirstCyclesSnapshotIsThere) {
  const RerunResult result = Again(Recording(), {"rls"}, {}, 1.0);
  EXPECT_EQ(Of(result, "rls").verdict, Verdict::kIdentical);
  EXPECT_EQ(Of(result, "rls").from_tick, 0u);
  EXPECT_EQ(Of(result, "rls").ticks, kRecordedTicks - 1);
}

// The recording with another snapshot of control: one byte of its content.
RerunOfTheRig::Edit TamperWith(std::size_t byte) {
  return [byte](const std::string& topic, std::uint64_t tick, node::Bytes* payload) {
    if (topic != "component_snapshot" || tick != kSnapshotTick) return true;
    msg::ComponentSnapshot snapshot;
    EXPECT_TRUE(node::Decode(*payload, &snapshot));
    if (snapshot.name != "control") return true;
    snapshot.content.at(byte) ^= 1;
    EXPECT_TRUE(node::Encode(snapshot, payload));
    return true;
  };
}

TEST_F(RerunOfTheRig, ASnapshotOfAnotherStateIsADifference) {
  // The number of joints has 8 bytes, the integral of the first one's PID is the first number.
  const auto file = Copy("state.mcap", TamperWith(8 + 5));
  const RerunResult result = Again(file, {"control"}, {}, 3.0);
  ASSERT_EQ(Of(result, "control").verdict, Verdict::kDiffers);
  EXPECT_EQ(Of(result, "control").difference->tick, kSnapshotTick + 1);
}

TEST_F(RerunOfTheRig, ASnapshotOfAnotherConfigurationIsRefused) {
  const auto file = Copy("joints.mcap", TamperWith(0));
  try {
    (void)Again(file, {"control"}, {}, 3.0);
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()),
              "'control': the snapshot of tick 500 does not fit its configuration: state: a list "
              "of 0, expected 1: another configuration");
  }
}

TEST_F(RerunOfTheRig, WithoutASnapshotItIsRefused) {
  const auto file =
      Copy("no_snapshot.mcap", [](const std::string& topic, std::uint64_t, node::Bytes*) {
        return topic != "component_snapshot";
      });
  try {
    (void)Again(file, {"control"}, {}, 3.0);
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("no snapshot of 'control' up to tick 720"),
              std::string::npos)
        << error.what();
  }
}

TEST_F(RerunOfTheRig, OneChangedGainIsFoundInControlAlone) {
  const TemporaryFolder changed;
  std::string text = config::ReadFile(SINEW_SOURCE_DIR "/robots/rig/control_pid_esn.yaml");
  const auto replace = [&text](const std::string& before, const std::string& after) {
    const std::size_t at = text.find(before);
    ASSERT_NE(at, std::string::npos) << before << " in " << text;
    text.replace(at, before.size(), after);
  };
  replace("proportional_Nm_rad: 18.7,", "proportional_Nm_rad: 18.8,");
  replace("model: ", "model: " SINEW_SOURCE_DIR "/robots/rig/");
  const std::string file = changed.Write("control.yaml", text);
  const RerunResult result = Again(Recording(), {"esn", "control"}, file);
  EXPECT_EQ(Of(result, "esn").verdict, Verdict::kIdentical);
  const ComponentResult& control = Of(result, "control");
  ASSERT_EQ(control.verdict, Verdict::kDiffers);
  EXPECT_EQ(control.difference->topic, "joint_command");
  EXPECT_EQ(control.difference->field.field, "motor_torque_Nm[0]");
  EXPECT_NE(std::stod(control.difference->field.recorded),
            std::stod(control.difference->field.rerun));
  EXPECT_LT(control.difference->tick, kRecordedTicks);
  EXPECT_FALSE(result.identical());
}

TEST_F(RerunOfTheRig, AllDifferencesOfAnotherControllerAreNumbers) {
  const RerunResult result =
      Again(Recording(), {"esn", "control"}, kRig / "control_pid_model.yaml", {}, true);
  EXPECT_EQ(Of(result, "esn").verdict, Verdict::kIdentical);
  EXPECT_TRUE(Of(result, "esn").differences.empty());
  const ComponentResult& control = Of(result, "control");
  EXPECT_EQ(control.verdict, Verdict::kDiffers);
  EXPECT_EQ(control.ticks, kRecordedTicks);
  const auto torque =
      std::find_if(control.differences.begin(), control.differences.end(),
                   [](const FieldSummary& field) { return field.field == "motor_torque_Nm[0]"; });
  ASSERT_NE(torque, control.differences.end());
  EXPECT_EQ(torque->first_tick, control.difference->tick);
  EXPECT_GT(torque->ticks, kRecordedTicks / 2);
  EXPECT_GT(torque->rms, 0.0);
  EXPECT_GE(std::abs(torque->largest), torque->rms);
}

TEST_F(RerunOfTheRig, OneFlippedBitOfAnOutputIsFound) {
  std::size_t byte = 0;
  const auto file =
      Copy("flipped.mcap", [&](const std::string& topic, std::uint64_t tick, node::Bytes* payload) {
        if (topic == "valve_command" && tick == 500) {
          byte = payload->size() / 2;
          (*payload)[byte] ^= std::byte{1};
        }
        return true;
      });
  const RerunResult result = Again(file, {"pneumatics", "regime"});
  EXPECT_EQ(Of(result, "regime").verdict, Verdict::kIdentical);
  const ComponentResult& pneumatics = Of(result, "pneumatics");
  ASSERT_EQ(pneumatics.verdict, Verdict::kDiffers);
  EXPECT_EQ(pneumatics.difference->topic, "valve_command");
  EXPECT_EQ(pneumatics.difference->tick, 500u);
  EXPECT_EQ(pneumatics.difference->field.byte, byte);
}

TEST_F(RerunOfTheRig, ALostInputIsNoDifference) {
  const auto file =
      Copy("lost.mcap", [](const std::string& topic, std::uint64_t tick, node::Bytes*) {
        return topic != "reservoir_state" || tick != 600;
      });
  const RerunResult result = Again(file, {"rls", "control", "esn"});
  const ComponentResult& rls = Of(result, "rls");
  ASSERT_EQ(rls.verdict, Verdict::kInputLost);
  EXPECT_EQ(rls.lost_tick, 601u);
  EXPECT_EQ(rls.lost,
            "reservoir_state of tick 600 is not in the recording; rls used it in tick 601");
  EXPECT_EQ(Of(result, "control").verdict, Verdict::kIdentical);
  // The sample that is gone is an output of esn.
  EXPECT_EQ(Of(result, "esn").verdict, Verdict::kOutputLost);
  EXPECT_EQ(Of(result, "esn").lost, "reservoir_state of tick 600 is not in the recording");
}

TEST_F(RerunOfTheRig, TheRequestCountsInTheTickThatNamesIt) {
  recording::FileSource source(Recording());
  const recording::McapReader reader(source);
  recording::McapMessages messages = reader.Messages();
  recording::McapMessage message;
  std::uint64_t request = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> named;  // tick, event
  while (messages.Next(&message)) {
    const std::string& topic = reader.channels().at(message.channel_id).topic;
    if (topic == "stiffness_request") request = node::EventId(message.data);
    if (topic != "valve_command") continue;
    msg::ValveCommand command;
    ASSERT_TRUE(node::Decode({message.data.begin(), message.data.end()}, &command));
    for (const std::uint64_t id : command.event_ids) {
      named.emplace_back(command.header.tick, id);
    }
  }
  ASSERT_NE(request, 0u);
  ASSERT_EQ(named.size(), 1u);
  EXPECT_EQ(named[0], (std::pair<std::uint64_t, std::uint64_t>{kRequestTick, request}));
}

TEST_F(RerunOfTheRig, ALostRequestIsALostInput) {
  const auto file =
      Copy("no_request.mcap", [](const std::string& topic, std::uint64_t, node::Bytes*) {
        return topic != "stiffness_request";
      });
  const RerunResult result = Again(file, {"pneumatics"});
  ASSERT_EQ(Of(result, "pneumatics").verdict, Verdict::kInputLost);
  EXPECT_EQ(Of(result, "pneumatics").lost_tick, kRequestTick);
}

constexpr std::uint64_t kJoiningTicks = 240;  // node::internal::kSettleTime at the rig's rate

// In real time, with participants that stand by at first, a regime detector that misses every 100th
// tick and a recorder that hears all.
std::filesystem::path RecordRealTime(const std::filesystem::path& file) {
  RecordRig({.rig = kRig,
             .out = file,
             .ticks = kRecordedTicks,
             .mode = node::TimeMode::kRealtime,
             .joining_ticks = kJoiningTicks,
             .before = RequestPressure,
             .misses = [](const std::string& name, std::uint64_t tick) {
               return name == "regime" && tick % 100 == 99;
             }});
  return file;
}

TEST_F(RerunOfTheRig, InRealTimeTheInputsAreThoseThatTheOutputsName) {
  const TemporaryFolder folder;
  const auto file = RecordRealTime(folder.path() / "real_time.mcap");
  const RerunResult result = Again(file);
  EXPECT_FALSE(result.lockstep);
  for (const ComponentResult& component : result.components) {
    ASSERT_EQ(component.verdict, Verdict::kIdentical)
        << component.name << ' ' << component.lost
        << (component.difference
                ? component.difference->topic + "." + component.difference->field.field + " tick " +
                      std::to_string(component.difference->tick)
                : "");
  }
  EXPECT_EQ(Of(result, "control").ticks, kRecordedTicks);
  EXPECT_EQ(Of(result, "regime").ticks, kRecordedTicks - kRecordedTicks / 100);
}

// What a participant does in its first second is not what it does later.
TEST_F(RerunOfTheRig, InRealTimeAFirstSecondThatIsNotNamedIsADifference) {
  const TemporaryFolder folder;
  const auto whole = RecordRealTime(folder.path() / "whole.mcap");
  const recording::CdrField of_control(TypeOf("joint_command"), "joining");
  const recording::CdrField of_pneumatics(TypeOf("valve_command"), "joining");
  const auto file = Copy(
      "settled.mcap",
      [&](const std::string& topic, std::uint64_t tick, node::Bytes* payload) {
        const auto& field = topic == "joint_command" ? of_control : of_pneumatics;
        if (topic == "joint_command" || topic == "valve_command") {
          EXPECT_EQ(field.AsInt(*payload), tick < kJoiningTicks ? 1 : 0) << topic << ' ' << tick;
          field.Set(*payload, 0.0);
        }
        return true;
      },
      whole);
  const RerunResult result = Again(file, {"control", "pneumatics"});
  ASSERT_EQ(Of(result, "control").verdict, Verdict::kDiffers);
  EXPECT_LT(Of(result, "control").difference->tick, kJoiningTicks);
  // It switches nothing before the request, and has another state by then.
  EXPECT_EQ(Of(result, "pneumatics").verdict, Verdict::kDiffers);
}

TEST_F(RerunOfTheRig, InRealTimeASampleThatTheRecorderLostIsALostInput) {
  const TemporaryFolder folder;
  const auto whole = RecordRealTime(folder.path() / "whole.mcap");
  const auto file = Copy(
      "lossy.mcap",
      [](const std::string& topic, std::uint64_t tick, node::Bytes*) {
        const bool used = topic == "regime" && tick == 398;  // in ticks 398 and 399
        const bool unused = topic == "pneumatic_state" && tick == 200;
        return !used && !unused;
      },
      whole);
  const RerunResult result = Again(file, {"control", "pneumatics", "rls"});
  EXPECT_EQ(Of(result, "control").verdict, Verdict::kInputLost);
  EXPECT_EQ(Of(result, "control").lost,
            "regime of tick 398 is not in the recording; control used it in tick 398");
  EXPECT_EQ(Of(result, "pneumatics").verdict, Verdict::kIdentical);
  EXPECT_EQ(Of(result, "rls").verdict, Verdict::kIdentical);
}

TEST_F(RerunOfTheRig, InRealTimeACycleWithoutOutputsIsNoDifference) {
  const TemporaryFolder folder;
  const auto whole = RecordRealTime(folder.path() / "whole.mcap");
  const auto file = Copy(
      "unpublished.mcap",
      [](const std::string& topic, std::uint64_t tick, node::Bytes*) {
        return tick != 600 || (topic != "torque_prediction" && topic != "reservoir_state");
      },
      whole);
  const RerunResult result = Again(file, {"esn"});
  ASSERT_EQ(Of(result, "esn").verdict, Verdict::kOutputLost);
  EXPECT_EQ(Of(result, "esn").lost,
            "the outputs of its cycle in tick 600, which it names in tick 601, are not in the "
            "recording");
  EXPECT_EQ(Of(result, "esn").ticks, 600u);
  EXPECT_EQ(Of(Again(file, {"esn"}, {}, 3.0), "esn").verdict, Verdict::kOutputLost);
}

void RequestMotion(node::Node& operators, std::uint64_t session_id, std::uint64_t tick) {
  if (tick != 5) return;
  auto writer = operators.MakeWriter(node::kMotionRequest);
  msg::MotionRequest request;
  request.header.session_id = session_id;
  request.header.tick = tick;
  request.header.origin = msg::Origin::kSim;
  EXPECT_EQ(writer.Write(request), node::WriteStatus::kOk);
}

TEST(RecordedTicks, ARequestIsKeptAsLongAsItMayBeInForce) {
  const TemporaryFolder folder;
  const auto file = folder.path() / "requested.mcap";
  RecordRig({.rig = kRig, .out = file, .ticks = kRecordedTicks, .before = RequestMotion});
  recording::FileSource source(file);
  const recording::McapReader reader(source);
  const Session session = SessionsOf(reader, file.string()).at(0);
  RecordedTicks recorded(reader, session, {"joint_state", "joint_command", "motion_request"});
  std::optional<std::uint64_t> tick;
  do {
    tick = recorded.Next();
    ASSERT_TRUE(tick);
  } while (*tick < kRecordedTicks - 1);
  EXPECT_NE(recorded.Find("motion_request", 5), nullptr);
  EXPECT_EQ(recorded.Find("joint_command", 5), nullptr);
  EXPECT_NE(recorded.Find("joint_command", *tick - RecordedTicks::kTicksKept), nullptr);
}

TEST_F(RerunOfTheRig, ATopicOfSeveralWritersIsRefused) {
  const auto file = Copy(
      "shared.mcap", [](const std::string&, std::uint64_t, node::Bytes*) { return true; },
      Recording(), "regime");
  try {
    (void)Again(file, {"control"});
    FAIL() << "expected a UsageError";
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()).substr(file.string().size()),
              ": topic 'regime' has several writers (other, regime), expected one: which of them "
              "was heard is not recorded");
  }
  EXPECT_EQ(Of(Again(file, {"pneumatics"}), "pneumatics").verdict, Verdict::kIdentical);
}

}  // namespace
}  // namespace sinew::rerun
