// A recording of two sessions, written here with the project's own topic types.
#include "tools/view/recorded_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "idl/embedded_idl.h"
#include "tests/support/json_cdr.h"
#include "tests/support/temporary_folder.h"
#include "tools/view/routes.h"
#include "tools/view/shown_log.h"

namespace sinew::live {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kSecond_ns = 1'000'000'000;
// The robot's time begins anew with the second session; the time of reception goes on.
constexpr std::int64_t kReception_ns = 1'700'000'000 * kSecond_ns;
constexpr std::int64_t kFirstStart_ns = 5 * kSecond_ns;
constexpr std::int64_t kSecondStart_ns = 2 * kSecond_ns;
constexpr std::int64_t kSecondReception_ns = kReception_ns + 40 * kSecond_ns;
constexpr std::uint64_t kFirstId = 0xfedcba9876543210;  // more than 2^63
constexpr std::uint64_t kSecondId = 7;
constexpr std::int64_t kTick_ns = 100'000'000;

const idl::EmbeddedType& TypeNamed(const std::string& name) {
  for (const idl::EmbeddedType& type : idl::EmbeddedTypes()) {
    if (type.type_name == name) return type;
  }
  throw std::logic_error("no type " + name);
}

class SessionsFile {
 public:
  explicit SessionsFile(const std::filesystem::path& path)
      : sink_(path, recording::Existing::kReplace), writer_(sink_) {
    EXPECT_TRUE(writer_.Open().ok());
  }
  ~SessionsFile() {
    EXPECT_TRUE(writer_.Close().ok());
    EXPECT_TRUE(sink_.Close().ok());
  }

  // A channel for each writer, as the logger has them.
  recording::ChannelId AddWriter(const std::string& topic, const std::string& type) {
    const idl::EmbeddedType& embedded = TypeNamed(type);
    recording::SchemaId schema{};
    recording::ChannelId channel{};
    EXPECT_TRUE(writer_.AddSchema(type, "omgidl", std::string(embedded.text), &schema).ok());
    EXPECT_TRUE(
        writer_
            .AddChannel(schema, topic, "cdr", {{"writer", std::to_string(types_.size())}}, &channel)
            .ok());
    types_[channel] = type;
    return channel;
  }
  // A topic that nobody here can read.
  void AddOther(const std::string& topic, const std::string& idl) {
    recording::SchemaId schema{};
    recording::ChannelId channel{};
    EXPECT_TRUE(writer_.AddSchema("Other", "omgidl", idl, &schema).ok());
    EXPECT_TRUE(writer_.AddChannel(schema, topic, "cdr", {}, &channel).ok());
    EXPECT_TRUE(writer_.WriteMessage(channel, 0, 0, recording::Bytes(8)).ok());
  }
  void Write(recording::ChannelId channel, std::int64_t log_ns, const Json& message) {
    const std::string& type = types_.at(channel);
    const auto idl = recording::IdlSchema::Parse(std::string(TypeNamed(type).text));
    const recording::Bytes bytes = recording::JsonToCdr(idl.Struct(type), message);
    EXPECT_TRUE(writer_.WriteMessage(channel, log_ns, log_ns, bytes).ok());
  }

 private:
  recording::FileSink sink_;
  recording::McapWriter writer_;
  std::map<recording::ChannelId, std::string> types_;
};

Json HeaderOf(std::uint64_t session, int tick, std::int64_t start_ns) {
  return {{"session_id", session}, {"tick", tick}, {"stamp_ns", start_ns + tick * kTick_ns}};
}

// 30 s and, after a restart of the state provider, 20 s. control is there in both, pneumatics ends
// 12 s before the first session does; both report once a second. The header of control's first
// status is empty, since it had heard no tick.
std::filesystem::path WriteTwoSessions(const testing::TemporaryFolder& folder) {
  const std::filesystem::path path = folder.path() / "two.mcap";
  SessionsFile file(path);
  const auto ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
  const auto next_ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
  const auto control = file.AddWriter("component_status", "sinew::msg::ComponentStatus");
  const auto pneumatics = file.AddWriter("component_status", "sinew::msg::ComponentStatus");
  const auto status = [](const char* name, int pid, const char* state, std::int64_t cycles) {
    return Json{{"name", name},       {"component_kind", name}, {"host", "robot"},
                {"process_id", pid},  {"state", state},         {"cycles", cycles},
                {"resident_MB", 12.5}};
  };
  for (int tick = 0; tick <= 300; ++tick) {
    const std::int64_t log_ns = kReception_ns + tick * kTick_ns;
    if (tick % 10 == 0) {
      Json message = status("control", 10, "COMPONENT_ACTIVE", 24 * tick);
      if (tick > 0) message["header"] = HeaderOf(kFirstId, tick, kFirstStart_ns);
      message["stale_inputs"] = tick / 10;
      file.Write(control, log_ns, message);
      if (tick <= 180) {
        Json other = status("pneumatics", 11, tick < 180 ? "COMPONENT_ACTIVE" : "COMPONENT_STOPPED",
                            10 * tick);
        other["message"] = tick < 180 ? "" : "stopped by its operator";
        file.Write(pneumatics, log_ns, other);
      }
    }
    file.Write(ticks, log_ns, {{"header", HeaderOf(kFirstId, tick, kFirstStart_ns)}});
  }
  for (int tick = 0; tick <= 200; ++tick) {
    const std::int64_t log_ns = kSecondReception_ns + tick * kTick_ns;
    if (tick % 10 == 0) {
      file.Write(control, log_ns, status("control", 10, "COMPONENT_ACTIVE", 9600 + 24 * tick));
    }
    file.Write(next_ticks, log_ns, {{"header", HeaderOf(kSecondId, tick, kSecondStart_ns)}});
  }
  return path;
}

struct SpanMessage {
  std::uint16_t topic;
  std::int64_t stamp_ns;
};

std::vector<SpanMessage> Unpacked(const std::string& bytes) {
  std::vector<SpanMessage> out;
  for (std::size_t at = 0; at < bytes.size();) {
    SpanMessage message{};
    std::uint32_t size = 0;
    std::memcpy(&message.topic, &bytes[at], 2);
    std::memcpy(&message.stamp_ns, &bytes[at + 2], 8);
    std::memcpy(&size, &bytes[at + 10], 4);
    at += 14 + size;
    out.push_back(message);
  }
  return out;
}

class RecordedViewTwoSessions : public ::testing::Test {
 protected:
  Json RowsAt(std::size_t session, std::int64_t at_ns) const {
    return Json::parse(view_.ParticipantsAt({session, at_ns}));
  }
  const testing::TemporaryFolder folder_;
  const RecordedView view_{WriteTwoSessions(folder_)};
};

TEST_F(RecordedViewTwoSessions, AreListedWithStartAndLength) {
  ASSERT_EQ(view_.sessions().size(), 2u);
  EXPECT_EQ(view_.sessions()[0].id, kFirstId);
  EXPECT_EQ(view_.sessions()[1].id, kSecondId);
  const Json described = Json::parse(view_.Description());
  EXPECT_THAT(described["file"].get<std::string>(), HasSubstr("two.mcap"));
  const Json& first = described["sessions"][0];
  EXPECT_EQ(first["session"], 1);
  EXPECT_EQ(first["session_id"], std::to_string(kFirstId));
  EXPECT_EQ(first["start_ns"], std::to_string(kFirstStart_ns));
  EXPECT_EQ(first["length_s"], 30.0);
  EXPECT_EQ(first["ticks"], 301);
  const Json& second = described["sessions"][1];
  EXPECT_EQ(second["session"], 2);
  EXPECT_EQ(second["start_ns"], std::to_string(kSecondStart_ns));
  EXPECT_EQ(second["end_ns"], std::to_string(kSecondStart_ns + 20 * kSecond_ns));
  EXPECT_EQ(second["length_s"], 20.0);
}

TEST_F(RecordedViewTwoSessions, ATopicOfSeveralWritersIsOne) {
  ASSERT_EQ(view_.topics().size(), 2u);
  for (const RecordedTopic& topic : view_.topics()) {
    EXPECT_EQ(topic.messages, topic.topic == "joint_state" ? 301u + 201u : 31u + 19u + 21u)
        << topic.topic;
  }
}

// Both have stamps from 5 to 22 s.
TEST_F(RecordedViewTwoSessions, ASpanHasTheMessagesOfItsSessionAlone) {
  const std::int64_t from_ns = 6 * kSecond_ns, to_ns = 8 * kSecond_ns;
  const auto stamps = [&](std::size_t session) {
    std::vector<std::int64_t> out;
    const RecordedView::Query query{session, {"joint_state"}, from_ns, to_ns};
    for (const SpanMessage& message : Unpacked(view_.Messages(query))) {
      EXPECT_EQ(view_.topics()[message.topic].topic, "joint_state");
      out.push_back(message.stamp_ns);
    }
    return out;
  };
  std::vector<std::int64_t> expected;
  for (std::int64_t stamp_ns = from_ns; stamp_ns <= to_ns; stamp_ns += kTick_ns) {
    expected.push_back(stamp_ns);
  }
  EXPECT_EQ(stamps(1), expected);
  EXPECT_EQ(stamps(2), expected);
  const RecordedView::Query before{2, {"joint_state"}, kSecondStart_ns, kFirstStart_ns - 1};
  EXPECT_EQ(Unpacked(view_.Messages(before)).size(), 30u) << "only the second has them";
  const RecordedView::Query beyond{2, {"joint_state"}, 23 * kSecond_ns, 30 * kSecond_ns};
  EXPECT_EQ(view_.Messages(beyond), "") << "only the first has them";
}

TEST_F(RecordedViewTwoSessions, ParticipantsAreThoseOfTheMoment) {
  const Json begin = RowsAt(1, kFirstStart_ns);
  ASSERT_EQ(begin.size(), 2u);
  EXPECT_EQ(begin[0]["name"], "control");
  EXPECT_EQ(begin[0]["state"], "active") << "without a tick of its own";
  EXPECT_EQ(begin[0]["cycles_Hz"], 0.0);
  const Json rows = RowsAt(1, kFirstStart_ns + 17 * kSecond_ns + 5 * kTick_ns);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0]["cycles_Hz"], 240.0);
  EXPECT_EQ(rows[0]["stale_inputs"], 17);
  EXPECT_EQ(rows[0]["resident_MB"], 12.5);
  EXPECT_TRUE(rows[0]["cpu_percent"].is_null());
  EXPECT_NEAR(rows[0]["age_s"].get<double>(), 0.5, 1e-9);
  EXPECT_EQ(rows[1]["name"], "pneumatics");
  EXPECT_EQ(rows[1]["state"], "active");
  EXPECT_EQ(rows[1]["cycles_Hz"], 100.0);
}

TEST_F(RecordedViewTwoSessions, WhoHasStoppedAgesAndIsLeftOutAfterTenSeconds) {
  const Json stopped = RowsAt(1, kFirstStart_ns + 25 * kSecond_ns);
  ASSERT_EQ(stopped.size(), 2u);
  EXPECT_EQ(stopped[1]["state"], "stopped");
  EXPECT_EQ(stopped[1]["message"], "stopped by its operator");
  EXPECT_NEAR(stopped[1]["age_s"].get<double>(), 7.0, 1e-9);
  EXPECT_EQ(RowsAt(1, kFirstStart_ns + 28 * kSecond_ns).size(), 2u) << "ten seconds, no more";
  const Json left = RowsAt(1, kFirstStart_ns + 28 * kSecond_ns + kTick_ns);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(left[0]["name"], "control");
  const Json next = RowsAt(2, kSecondStart_ns + 2 * kSecond_ns);
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0]["name"], "control");
  EXPECT_EQ(next[0]["cycles"], 9600 + 24 * 20);
  EXPECT_EQ(next[0]["cycles_Hz"], 240.0);
}

TEST_F(RecordedViewTwoSessions, RoutesTakeASessionAndTheFirstWithoutOne) {
  Routes routes;
  routes.recorded = &view_;
  const auto ask = [&routes](const std::string& path, const std::string& query) {
    HttpRequest request;
    request.method = "GET";
    request.path = path;
    request.query = query;
    return routes.Answer(request);
  };
  EXPECT_EQ(ask("/api/recording", "").body, view_.Description());
  const std::string span = "topics=joint_state&from_ns=2000000000&to_ns=4900000000";
  EXPECT_EQ(ask("/api/recording/messages", span).body, "");
  EXPECT_EQ(Unpacked(ask("/api/recording/messages", "session=2&" + span).body).size(), 30u);
  const HttpReply rows = ask("/api/recording/participants", "session=2&at_ns=4000000000");
  EXPECT_EQ(rows.content_type, "application/json");
  EXPECT_EQ(Json::parse(rows.body), RowsAt(2, 4 * kSecond_ns));
  EXPECT_EQ(ask("/api/recording/nothing", "").status, 404u);
  for (const char* session : {"0", "3", "-1", "x", "", "99999999999999999999"}) {
    for (const auto& [path, rest] : std::map<std::string, std::string>{
             {"/api/recording/messages", span}, {"/api/recording/participants", "at_ns=1"}}) {
      const HttpReply reply = ask(path, "session=" + std::string(session) + "&" + rest);
      EXPECT_EQ(reply.status, 400u) << path << " " << session;
      EXPECT_THAT(reply.body, HasSubstr(std::string("session=") + session));
    }
  }
  EXPECT_THAT(ask("/api/recording/participants", "session=1").body, HasSubstr("at_ns"));
  routes.recorded = nullptr;
  EXPECT_EQ(ask("/api/recording", "").status, 404u);
}

// A simulation that is started again at once has the same stamps, received within a second.
TEST(RecordedView, SessionsThatFollowAtOnceAreNotMixed) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "close.mcap";
  constexpr std::int64_t kMs_ns = 1'000'000;
  {
    SessionsFile file(path);
    const auto ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
    for (int i = 0; i < 20; ++i) {
      file.Write(ticks, kReception_ns + i * kMs_ns,
                 {{"header", HeaderOf(i < 10 ? kFirstId : kSecondId, i % 10, 0)}});
    }
  }
  const RecordedView view(path);
  ASSERT_EQ(view.sessions().size(), 2u);
  for (const std::size_t session : {1u, 2u}) {
    EXPECT_EQ(view.sessions()[session - 1].ticks, 10u);
    const RecordedView::Query all{session, {"joint_state"}, 0, kSecond_ns};
    EXPECT_EQ(Unpacked(view.Messages(all)).size(), 10u) << session;
  }
}

TEST(RecordedView, StatusesThatDoNotFitTheirTypeAreNobody) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "malformed.mcap";
  {
    recording::FileSink sink(path, recording::Existing::kReplace);
    recording::McapWriter writer(sink);
    EXPECT_TRUE(writer.Open().ok());
    for (const auto& [topic, type] :
         std::map<std::string, std::string>{{"component_status", "sinew::msg::ComponentStatus"},
                                            {"joint_state", "sinew::msg::JointState"}}) {
      recording::SchemaId schema{};
      recording::ChannelId channel{};
      const std::string text(TypeNamed(type).text);
      EXPECT_TRUE(writer.AddSchema(type, "omgidl", text, &schema).ok());
      EXPECT_TRUE(writer.AddChannel(schema, topic, "cdr", {}, &channel).ok());
      recording::Bytes bytes = recording::ZeroCdr(recording::IdlSchema::Parse(text).Struct(type));
      if (topic == "component_status") bytes.resize(9);
      EXPECT_TRUE(writer.WriteMessage(channel, 1, 1, bytes).ok());
    }
    EXPECT_TRUE(writer.Close().ok());
    EXPECT_TRUE(sink.Close().ok());
  }
  const RecordedView view(path);
  EXPECT_EQ(view.ParticipantsAt({1, 0}), "[]");
}

// Two ticks, 1 s apart, and lines before, between and after them; the first has no session yet.
TEST(RecordedView, TheLogIsThatOfTheMomentByItsReception) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "log.mcap";
  {
    SessionsFile file(path);
    const auto ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
    const auto log = file.AddWriter("log", "sinew::msg::LogLine");
    const auto line = [&](std::int64_t after_ns, const char* level, const char* text) {
      file.Write(log, kReception_ns + after_ns,
                 {{"level", level}, {"name", "control"}, {"text", text}, {"time_ns", 5}});
    };
    line(-kSecond_ns, "LOG_LEVEL_INFO", "starts");
    file.Write(ticks, kReception_ns, {{"header", HeaderOf(7, 0, kFirstStart_ns)}});
    line(kSecond_ns / 2, "LOG_LEVEL_WARNING", "late\x1b[2J");
    file.Write(ticks, kReception_ns + kSecond_ns,
               {{"header", HeaderOf(7, static_cast<int>(kSecond_ns / kTick_ns), kFirstStart_ns)}});
    line(2 * kSecond_ns, "LOG_LEVEL_ERROR", "after the end");
  }
  const RecordedView view(path);
  const Json first = Json::parse(view.LogAt({1, kFirstStart_ns}));
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0]["text"], "starts");
  EXPECT_EQ(first[0]["level"], "info");
  EXPECT_EQ(first[0]["name"], "control");
  EXPECT_EQ(first[0]["time_s"], 0.0);
  const Json second = Json::parse(view.LogAt({1, kFirstStart_ns + kSecond_ns / 2}));
  ASSERT_EQ(second.size(), 2u);
  EXPECT_EQ(second[1]["text"], "late\\u001b[2J");
  EXPECT_EQ(second[1]["time_s"], 1.0);
  const Json last = Json::parse(view.LogAt({1, kFirstStart_ns + kSecond_ns}));
  ASSERT_EQ(last.size(), 3u);
  EXPECT_EQ(last[2]["text"], "after the end");
  EXPECT_THROW(view.LogAt({2, 0}), UsageError);
}

TEST(ShownLog, GivesWhatCameAfterALineAndForgetsTheOldest) {
  ShownLog log;
  EXPECT_EQ(Json::parse(log.After("after=0")), Json({{"last", 0}, {"lines", Json::array()}}));
  for (std::size_t line = 0; line < ShownLog::kMost + 2; ++line) {
    log.Add({1'500'000'000, msg::LogLevel::kError, "esn", std::to_string(line)});
  }
  const Json all = Json::parse(log.After("after=0"));
  EXPECT_EQ(all["last"], ShownLog::kMost + 2);
  ASSERT_EQ(all["lines"].size(), ShownLog::kMost);
  EXPECT_EQ(all["lines"][0]["text"], "2");
  EXPECT_EQ(all["lines"][0]["time_ms"], 1500.0);
  const Json newest = Json::parse(log.After("after=" + std::to_string(ShownLog::kMost + 1)));
  ASSERT_EQ(newest["lines"].size(), 1u);
  EXPECT_EQ(newest["lines"][0]["level"], "error");
  for (const char* query : {"", "after=", "after=x", "after=1x", "before=1"}) {
    EXPECT_THROW(log.After(query), UsageError) << query;
  }
}

TEST(RecordedView, AnOlderStatusHasTheFieldsThatItHas) {
  const auto idl = recording::IdlSchema::Parse(
      "module old { enum State { COMPONENT_CONFIGURED, COMPONENT_ACTIVE };\n"
      "@final struct Status { @key string<64> name; State state; unsigned long long cycles; }; };");
  const recording::IdlType& type = idl.Struct("old::Status");
  const ParticipantStatus status = StatusReader(type).Read(recording::JsonToCdr(
      type, {{"name", "control"}, {"state", "COMPONENT_ACTIVE"}, {"cycles", 3}}));
  EXPECT_EQ(status.name, "control");
  EXPECT_EQ(status.state, "active");
  EXPECT_EQ(status.cycles, 3u);
  EXPECT_EQ(status.missed_ticks, 0u);
  EXPECT_EQ(status.message, "");
  const auto other = recording::IdlSchema::Parse("@final struct Status { string<64> name; };");
  EXPECT_THROW(StatusReader(other.Struct("Status")), recording::CdrError);
}

TEST(RecordedViewMoment, IsReadOrNamedWhatIsMissing) {
  const RecordedView::Moment moment = ParseMoment("session=3&at_ns=-5");
  EXPECT_EQ(moment.session, 3u);
  EXPECT_EQ(moment.at_ns, -5);
  EXPECT_EQ(ParseMoment("at_ns=0").session, 1u);
  EXPECT_EQ(ParseQuery("topics=a&from_ns=1&to_ns=2").session, 1u);
  EXPECT_EQ(ParseQuery("session=2&topics=a&from_ns=1&to_ns=2").session, 2u);
  for (const char* text : {"", "session=1", "at_ns=", "at_ns=1x", "session=&at_ns=1"}) {
    EXPECT_THROW(ParseMoment(text), UsageError) << text;
  }
}

// 20 ticks, of which the last ten have a clock that was set back by 5 s.
TEST(RecordedView, ShowsAllTicksOfAClockThatWasSetBackInTheirOrder) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "back.mcap";
  {
    SessionsFile file(path);
    const auto ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
    for (int tick = 0; tick < 20; ++tick) {
      const std::int64_t back_ns = tick < 10 ? 0 : 5 * kSecond_ns;
      file.Write(ticks, kReception_ns + tick * kTick_ns - back_ns,
                 {{"header", HeaderOf(7, tick, kFirstStart_ns - back_ns)}});
    }
  }
  const RecordedView view(path);
  ASSERT_EQ(view.sessions().size(), 1u);
  EXPECT_EQ(view.sessions()[0].ticks, 20u);
  EXPECT_EQ(view.sessions()[0].end_ns, kFirstStart_ns + 19 * kTick_ns);
  const std::int64_t from_ns = kFirstStart_ns + 5 * kTick_ns,
                     to_ns = kFirstStart_ns + 14 * kTick_ns;
  std::int64_t expected_ns = from_ns;
  for (const SpanMessage& message : Unpacked(view.Messages({1, {"joint_state"}, from_ns, to_ns}))) {
    EXPECT_EQ(message.stamp_ns, expected_ns);
    expected_ns += kTick_ns;
  }
  EXPECT_EQ(expected_ns, to_ns + kTick_ns);
}

TEST(RecordedView, LeavesOutATopicWhoseIdlIsNotUnderstood) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "other.mcap";
  {
    SessionsFile file(path);
    const auto ticks = file.AddWriter("joint_state", "sinew::msg::JointState");
    file.AddOther("choice", "union Other switch (long) { case 0: long a; };");
    file.AddOther("absent", "struct Another { long a; };");
    file.AddOther("component_status", "@final struct Other { long a; };");
    file.Write(ticks, kReception_ns, {{"header", HeaderOf(7, 0, kFirstStart_ns)}});
  }
  const RecordedView view(path);
  ASSERT_EQ(view.topics().size(), 1u);
  EXPECT_EQ(view.topics()[0].topic, "joint_state");
}

}  // namespace
}  // namespace sinew::live
