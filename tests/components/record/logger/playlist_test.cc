#include "components/record/logger/player/playlist.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "components/record/recording/mcap_writer.h"
#include "tests/components/record/logger/messages.h"
#include "tests/support/memory_io.h"

namespace sinew::logger {
namespace {

using recording::Bytes;
using testing::FieldOf;
using ::testing::HasSubstr;
using testing::MakeMessage;
using testing::SchemaOf;

// Ten ticks of joint_state and reference, 10 ms apart, two sessions; one component_status.
Bytes MakeRecording(const recording::TopicSchema& joint_schema = SchemaOf("joint_state")) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink);
  recording::ChannelId joint{};
  recording::ChannelId reference{};
  recording::ChannelId status{};
  EXPECT_TRUE(writer.Open().ok());
  EXPECT_TRUE(recording::AddTopic(joint_schema, &writer, &joint).ok());
  EXPECT_TRUE(recording::AddTopic(SchemaOf("reference"), &writer, &reference).ok());
  EXPECT_TRUE(recording::AddTopic(SchemaOf("component_status"), &writer, &status).ok());
  EXPECT_TRUE(
      writer.WriteMessage(status, 999'000'000, 0, MakeMessage("component_status", {})).ok());
  for (int i = 0; i < 10; ++i) {
    const double session = i < 5 ? 1 : 2;
    const double tick = i % 5;
    const std::int64_t log_ns = 1'000'000'000 + 10'000'000LL * i;
    EXPECT_TRUE(writer
                    .WriteMessage(joint, log_ns, 0,
                                  MakeMessage("joint_state", {{"header.session_id", session},
                                                              {"header.tick", tick},
                                                              {"header.origin", 1},
                                                              {"last_tick", i % 5 == 4 ? 1 : 0},
                                                              {"position_rad[0]", 0.5 * i}}))
                    .ok());
    EXPECT_TRUE(writer
                    .WriteMessage(reference, log_ns + 1, 0,
                                  MakeMessage("reference", {{"header.session_id", session},
                                                            {"header.tick", tick}}))
                    .ok());
  }
  EXPECT_TRUE(writer.Close().ok());
  return sink.bytes();
}

const std::vector<recording::TopicSchema>& Known() {
  static const std::vector<recording::TopicSchema> known = {
      SchemaOf("joint_state"), SchemaOf("reference"), SchemaOf("actuator_state"),
      SchemaOf("component_status")};
  return known;
}

std::string ErrorOf(const Bytes& bytes, const PlaylistOptions& options) {
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  try {
    const Playlist playlist(reader, "run.mcap", Known(), options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(Playlist, TakesTheChannelsOfATopicsWritersTogether) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink);
  recording::ChannelId one{}, other{}, foreign{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(recording::AddTopic(SchemaOf("reference"), &writer, &one).ok());
  ASSERT_TRUE(recording::AddTopic(SchemaOf("reference"), &writer, &other).ok());
  recording::TopicSchema unknown = SchemaOf("reference");
  unknown.topic = "no_topic";
  ASSERT_TRUE(recording::AddTopic(unknown, &writer, &foreign).ok());
  ASSERT_TRUE(recording::AddTopic(unknown, &writer, &foreign).ok());
  for (int tick = 0; tick < 10; ++tick) {
    ASSERT_TRUE(writer
                    .WriteMessage(tick % 3 == 0 ? one : other, tick, 0,
                                  MakeMessage("reference", {{"header.tick", tick}}))
                    .ok());
  }
  ASSERT_TRUE(writer.Close().ok());
  recording::MemorySource source(sink.bytes());
  const recording::McapReader reader(source);
  Playlist playlist(reader, "run.mcap", Known(), {});
  EXPECT_EQ(playlist.published(), std::vector<std::string>{"reference"});
  EXPECT_EQ(playlist.left_out(), std::vector<std::string>{"no_topic"});
  PlayedMessage message;
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    ASSERT_TRUE(playlist.Next(&message));
    EXPECT_EQ(message.topic, 0u);
    EXPECT_EQ(message.tick, tick);
  }
  EXPECT_FALSE(playlist.Next(&message));
}

TEST(Playlist, PlaysAllButStatusInOrderMarkedAsReplay) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  Playlist playlist(reader, "run.mcap", Known(), {});
  EXPECT_EQ(playlist.published(), (std::vector<std::string>{"joint_state", "reference"}));
  EXPECT_EQ(playlist.message_count(), 20u);
  EXPECT_EQ(playlist.duration_ns(), 90'000'001);
  PlayedMessage message;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(playlist.Next(&message));
    EXPECT_EQ(message.topic, 0u);
    EXPECT_TRUE(message.is_state);
    EXPECT_EQ(message.due_ns, 10'000'000LL * i);
    EXPECT_EQ(message.session_id, i < 5 ? 1u : 2u);
    EXPECT_EQ(message.tick, static_cast<std::uint64_t>(i % 5));
    EXPECT_EQ(FieldOf("joint_state", message.payload, "header.origin"), 2.0);
    EXPECT_EQ(FieldOf("joint_state", message.payload, "position_rad[0]"), 0.5 * i);
    // Only the end of the replay is the end of what a recorder should wait for.
    EXPECT_EQ(FieldOf("joint_state", message.payload, "last_tick"), i == 9 ? 1.0 : 0.0);
    ASSERT_TRUE(playlist.Next(&message));
    EXPECT_EQ(message.topic, 1u);
    EXPECT_FALSE(message.is_state);
  }
  EXPECT_FALSE(playlist.Next(&message));
}

TEST(Playlist, TakesASubsetATimeAndAnotherName) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.topics = {"joint_state"};
  options.start_s = 0.021 + 0.001;  // the recording begins with the status, 1 ms earlier
  options.end_s = 0.051;
  Playlist playlist(reader, "run.mcap", Known(), options);
  EXPECT_EQ(playlist.message_count(), 3u);
  PlayedMessage message;
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(message.due_ns, 0);
  EXPECT_EQ(FieldOf("joint_state", message.payload, "position_rad[0]"), 0.5 * 3);
}

TEST(Playlist, TopicsThatCommandAreSentOnlyWhenNamed) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.only_when_named = {"reference", "joint_command"};
  const Playlist quiet(reader, "run.mcap", Known(), options);
  EXPECT_EQ(quiet.published(), (std::vector<std::string>{"joint_state"}));
  EXPECT_EQ(quiet.not_named(), (std::vector<std::string>{"reference"}));
  EXPECT_EQ(quiet.message_count(), 10u);
  options.topics = {"reference"};
  const Playlist named(reader, "run.mcap", Known(), options);
  EXPECT_EQ(named.published(), (std::vector<std::string>{"reference"}));
  EXPECT_TRUE(named.not_named().empty());
  options.topics = {};
  options.only_when_named = {"reference", "joint_state"};
  EXPECT_EQ(ErrorOf(bytes, options),
            "run.mcap: no topic to play; those in it command, and are played when --topics names "
            "them");
}

TEST(Playlist, TopicsAreChosenAndExcludedByRegularExpressions) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.topics = {".*_state"};
  EXPECT_EQ(Playlist(reader, "run.mcap", Known(), options).published(),
            (std::vector<std::string>{"joint_state"}));
  options.topics = {"joint.*", "ref.*"};
  EXPECT_EQ(Playlist(reader, "run.mcap", Known(), options).published(),
            (std::vector<std::string>{"joint_state", "reference"}));
  options.topics = {};
  options.exclude = {"ref.*"};
  EXPECT_EQ(Playlist(reader, "run.mcap", Known(), options).published(),
            (std::vector<std::string>{"joint_state"}));
  options.exclude = {"("};
  EXPECT_THAT(ErrorOf(bytes, options), HasSubstr("--exclude: '(' is no regular expression"));
  options.exclude = {};
  options.topics = {"joint"};  // of whole names
  EXPECT_EQ(ErrorOf(bytes, options),
            "--topics: topic 'joint' is not in run.mcap, expected one of: component_status, "
            "joint_state, reference");
}

TEST(Playlist, AnExpressionDoesNotNameATopicThatCommands) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.only_when_named = {"reference"};
  options.topics = {".*"};
  const Playlist quiet(reader, "run.mcap", Known(), options);
  EXPECT_EQ(quiet.published(), (std::vector<std::string>{"joint_state"}));
  EXPECT_EQ(quiet.not_named(), (std::vector<std::string>{"reference"}));
  options.topics = {".*", "reference"};
  const Playlist named(reader, "run.mcap", Known(), options);
  EXPECT_EQ(named.published(), (std::vector<std::string>{"joint_state", "reference"}));
}

TEST(Playlist, EveryPassHasSessionsOfItsOwnAndTicksThatGrow) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.topics = {"joint_state"};
  Playlist playlist(reader, "run.mcap", Known(), options);
  std::set<std::uint64_t> sessions;
  std::uint64_t session = 0, tick = 0;
  PlayedMessage message;
  for (std::uint64_t pass = 0; pass < 3; ++pass) {
    playlist.BeginPass(pass, 0, pass == 2);
    for (int i = 0; i < 10; ++i) {
      ASSERT_TRUE(playlist.Next(&message));
      EXPECT_EQ(FieldOf("joint_state", message.payload, "last_tick"),
                pass == 2 && i == 9 ? 1.0 : 0.0);
      const bool is_new = sessions.insert(message.session_id).second;
      EXPECT_EQ(is_new, i % 5 == 0) << "pass " << pass << " message " << i;
      if (is_new) {
        session = message.session_id;
      } else {
        EXPECT_EQ(message.session_id, session);
        EXPECT_GT(message.tick, tick);
      }
      tick = message.tick;
    }
    EXPECT_FALSE(playlist.Next(&message));
  }
  EXPECT_EQ(sessions.size(), 6u);
  EXPECT_EQ(*sessions.begin(), 1u) << "pass 0 keeps the recorded sessions 1 and 2";
  EXPECT_EQ(SessionInPass(17, 0), 17u);
}

TEST(Playlist, AJumpBeginsWithAWholeTick) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  Playlist playlist(reader, "run.mcap", Known(), {});
  PlayedMessage message;
  playlist.BeginPass(1, 30'000'001, true);  // the reference of tick 3
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_TRUE(message.is_state);
  EXPECT_EQ(message.due_ns, 40'000'000);
  playlist.BeginPass(2, 20'000'000, true);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(message.due_ns, 20'000'000);
  playlist.BeginPass(3, 1'000'000'000, true);  // cut to the end, where no whole tick is left
  EXPECT_FALSE(playlist.Next(&message));
  playlist.BeginPass(4, -5, true);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(message.due_ns, 0);
}

TEST(Playlist, BeginsWithTheLatchedSampleFromBefore) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.topics = {"component_status", "joint_state"};
  options.latched = {"component_status"};
  options.start_s = 0.052;
  Playlist playlist(reader, "run.mcap", Known(), options);
  EXPECT_EQ(playlist.message_count(), 5u);  // the status, and ticks 6 to 9
  PlayedMessage message;
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(playlist.published()[message.topic], "component_status");
  EXPECT_EQ(message.due_ns, 0);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_TRUE(message.is_state);
  EXPECT_EQ(message.due_ns, 0);
  playlist.BeginPass(1, 20'000'000, true);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(playlist.published()[message.topic], "component_status");
  EXPECT_EQ(message.due_ns, 20'000'000);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(message.due_ns, 20'000'000);

  options.topics = {"component_status"};  // nothing after the start
  Playlist alone(reader, "run.mcap", Known(), options);
  EXPECT_EQ(alone.message_count(), 1u);
  EXPECT_TRUE(alone.Next(&message));
  EXPECT_FALSE(alone.Next(&message));
  EXPECT_THAT(ErrorOf(bytes, {.topics = {"component_status"}, .start_s = 0.052}),
              HasSubstr("no message between the start and end"));
}

TEST(Playlist, TicksGrowWhereTheClockWasSetBack) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink);
  recording::ChannelId joint{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(recording::AddTopic(SchemaOf("joint_state"), &writer, &joint).ok());
  for (int i = 0; i < 10; ++i) {
    const std::int64_t set_back_ns = i < 5 ? 0 : 30'000'000;
    ASSERT_TRUE(writer
                    .WriteMessage(joint, 1'000'000'000 + 10'000'000LL * i - set_back_ns, 0,
                                  MakeMessage("joint_state", {{"header.session_id", 1},
                                                              {"header.tick", double(i)}}))
                    .ok());
  }
  ASSERT_TRUE(writer.Close().ok());
  recording::MemorySource source(sink.bytes());
  const recording::McapReader reader(source);
  Playlist playlist(reader, "run.mcap", Known(), {});
  EXPECT_EQ(playlist.duration_ns(), 80'000'000);
  PlayedMessage message;
  std::int64_t due_ns = 0;
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    ASSERT_TRUE(playlist.Next(&message));
    EXPECT_EQ(message.tick, tick);
    EXPECT_GE(message.due_ns, due_ns);
    due_ns = message.due_ns;
    EXPECT_EQ(FieldOf("joint_state", message.payload, "last_tick"), tick == 9 ? 1 : 0);
  }
  EXPECT_FALSE(playlist.Next(&message));
  playlist.BeginPass(1, 60'000'000, true);
  ASSERT_TRUE(playlist.Next(&message));
  EXPECT_EQ(message.tick, 7u);
  EXPECT_EQ(message.due_ns, 60'000'000);
}

TEST(Playlist, PutsAMessageIntoARunningSession) {
  const Bytes bytes = MakeRecording();
  recording::MemorySource source(bytes);
  const recording::McapReader reader(source);
  PlaylistOptions options;
  options.topics = {"reference"};
  Playlist playlist(reader, "run.mcap", Known(), options);
  PlayedMessage message;
  ASSERT_TRUE(playlist.Next(&message));
  playlist.Retarget(&message, 77, 1234, -5);
  EXPECT_EQ(FieldOf("reference", message.payload, "header.session_id"), 77.0);
  EXPECT_EQ(FieldOf("reference", message.payload, "header.tick"), 1234.0);
  EXPECT_EQ(FieldOf("reference", message.payload, "header.stamp_ns"), -5.0);
  EXPECT_EQ(FieldOf("reference", message.payload, "header.origin"), 2.0);
}

TEST(Playlist, RefusesARecordingOfAnotherType) {
  recording::TopicSchema other = SchemaOf("joint_state");
  // Position and velocity change places: the bytes fit, the meaning does not.
  const std::size_t position = other.idl.find("double position_rad[12]");
  const std::size_t velocity = other.idl.find("double velocity_rad_s[12]");
  ASSERT_LT(position, velocity);
  other.idl.replace(velocity, 25, "double position_rad[12]");
  other.idl.replace(position, 23, "double velocity_rad_s[12]");
  other.idl_hash = "0badcafe";
  const std::string error = ErrorOf(MakeRecording(other), {});
  EXPECT_NE(error.find("run.mcap: topic 'joint_state' was recorded with another type"),
            std::string::npos)
      << error;
  EXPECT_NE(error.find("hash 0badcafe"), std::string::npos) << error;
  EXPECT_NE(error.find("hash " + SchemaOf("joint_state").idl_hash), std::string::npos) << error;
  PlaylistOptions without;
  without.topics = {"reference"};
  EXPECT_EQ(ErrorOf(MakeRecording(other), without), "");
}

TEST(Playlist, LeavesOutAKnownNameWithMessagesThatNobodyReads) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink);
  recording::ChannelId joint{}, reference{};
  ASSERT_TRUE(writer.Open().ok());
  ASSERT_TRUE(recording::AddTopic(SchemaOf("joint_state"), &writer, &joint).ok());
  ASSERT_TRUE(writer.AddChannel(recording::SchemaId{}, "reference", "json", {}, &reference).ok());
  ASSERT_TRUE(writer.WriteMessage(joint, 1000, 0, MakeMessage("joint_state", {})).ok());
  ASSERT_TRUE(writer.WriteMessage(reference, 2000, 0, Bytes(2)).ok());
  ASSERT_TRUE(writer.Close().ok());
  recording::MemorySource source(sink.bytes());
  const recording::McapReader reader(source);
  const Playlist playlist(reader, "run.mcap", Known(), {});
  EXPECT_EQ(playlist.published(), std::vector<std::string>{"joint_state"});
  EXPECT_EQ(recording::LeftOutText("run.mcap", playlist.not_readable()),
            "run.mcap: left out: topic 'reference' has messages 'json' with no schema, expected "
            "'cdr' with 'omgidl'");
  EXPECT_THAT(ErrorOf(sink.bytes(), {.topics = {"reference"}}),
              HasSubstr("topic 'reference' was recorded with another type (no schema"));
}

TEST(Playlist, AcceptsAnotherComment) {
  recording::TopicSchema other = SchemaOf("joint_state");
  other.idl = "// recorded yesterday\n" + other.idl;
  EXPECT_EQ(ErrorOf(MakeRecording(other), {}), "");
}

TEST(Playlist, NamesTopicsThatAreNotThere) {
  const Bytes bytes = MakeRecording();
  PlaylistOptions options;
  options.topics = {"regime"};
  EXPECT_EQ(ErrorOf(bytes, options),
            "--topics: topic 'regime' is not in run.mcap, expected one of: component_status, "
            "joint_state, reference");
  options = {};
  options.remap = {{"joint_state", "nothing"}};
  EXPECT_EQ(ErrorOf(bytes, options), "--remap: no topic 'nothing' in this build");
  options.remap = {{"joint_state", "reference"}};  // another type
  EXPECT_NE(ErrorOf(bytes, options), "");
  options = {};
  options.start_s = 1000;
  EXPECT_NE(ErrorOf(bytes, options).find("no message between"), std::string::npos);
}

}  // namespace
}  // namespace sinew::logger
