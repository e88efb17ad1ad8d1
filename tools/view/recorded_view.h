// A recording as the page asks for it: its sessions, the messages of a span of time, and the
// participants at a moment.
//
// A session is what one run of the state provider wrote: all messages with its header.session_id.
// They are numbered from 1 on, as their first joint_state was received. Time is the stamp of the
// messages (header.stamp_ns), since in a recording of lockstep the time of reception says nothing;
// that of component_status alone is its reception (recorded_participants.h). One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/session_clock.h"
#include "tools/inspect/log_lines.h"
#include "tools/view/recorded_participants.h"

namespace sinew::live {

struct RecordedTopic {
  std::string topic, schema_name, schema;
  std::uint64_t messages = 0;  // in the file
};

struct RecordedSession {
  std::uint64_t id = 0;                   // header.session_id
  std::int64_t start_ns = 0, end_ns = 0;  // stamps of its first and its last joint_state
  std::uint64_t ticks = 0;                // joint_state that it has
};

class RecordedView {
 public:
  // Throws UsageError naming the file and what is wrong: no recording, no joint_state.
  explicit RecordedView(const std::filesystem::path& file);

  // One at least.
  const std::vector<RecordedSession>& sessions() const { return sessions_; }
  // One a topic and schema, however many wrote it.
  const std::vector<RecordedTopic>& topics() const { return topics_; }
  // The data that do not change, as JSON: file; sessions (session, session_id, start_ns and end_ns
  // as texts, since a number of JavaScript has 53 bits, length_s, ticks); topics (topic,
  // schemaName, schema, messages).
  std::string Description() const;

  struct Query {
    std::size_t session = 1;
    std::vector<std::string> topics;
    std::int64_t from_ns = 0, to_ns = 0;  // both inclusive
  };
  // Little-endian, one message after the other: index in topics() (uint16), stamp (int64), size of
  // the payload (uint32), payload. Topics that the file does not have are left out. Throws
  // UsageError when that is more than kMostBytes, or there is no such session.
  std::string Messages(const Query& query) const;
  static constexpr std::size_t kMostBytes = 64u << 20;

  struct Moment {
    std::size_t session = 1;
    std::int64_t at_ns = 0;
  };
  // The rows of the participants at that moment, as JSON: Participants::Rows. Throws UsageError:
  // there is no such session.
  std::string ParticipantsAt(const Moment& moment) const;
  // The newest lines of the log that were received until then, since the end of the session before,
  // as JSON: each with time_s (on the clock of the session, from its start), level, name and text.
  // Throws UsageError: there is no such session.
  std::string LogAt(const Moment& moment) const;

 private:
  struct Times {
    std::int64_t stamp_ns, log_ns;  // stamp: of the session's clock
  };
  struct Tick {
    std::uint64_t tick;
    std::int64_t stamp_ns, log_ns;  // as recorded
  };
  struct Reader {
    std::size_t index;  // in topics_
    recording::MessageType type;
    recording::CdrField session, tick, stamp;
    std::optional<StatusReader> status;  // of component_status
    std::optional<inspect::LogReader> log;
  };

  void AddChannel(recording::ChannelId id, const recording::McapChannel& channel,
                  std::uint64_t messages);
  void AddTick(const Reader& reader, const recording::McapMessage& message);
  void EndTicks();
  void AddLine(const Reader& reader, const recording::McapMessage& message);
  void AddStatus(const Reader& reader, const recording::McapMessage& message);
  // Index in sessions_ and times_ of one that is numbered from 1 on.
  std::size_t IndexOf(std::size_t session) const;
  // Time at which the first joint_state of that stamp or a later one was received.
  std::int64_t LogTime(std::size_t index, std::int64_t stamp_ns) const;
  // Times at which those from one stamp to another were received.
  std::pair<std::int64_t, std::int64_t> LogTimes(std::size_t index, const Query& query) const;

  std::string file_;
  recording::FileSource source_;
  recording::McapReader reader_;
  std::vector<RecordedTopic> topics_;
  std::map<recording::ChannelId, Reader> readers_;
  std::vector<RecordedSession> sessions_;
  std::vector<std::vector<Tick>> ticks_;         // of each session's joint_state, until EndTicks
  std::vector<std::vector<Times>> times_;        // the same, in order of the stamps
  std::vector<recording::SessionClock> clocks_;  // of each session
  RecordedParticipants participants_;
  struct Line {
    std::int64_t log_ns;
    inspect::LogText line;
  };
  std::vector<Line> lines_;  // in the order of reception
};

// "session=2&topics=a,b&from_ns=0&to_ns=9", without a session the first. Throws UsageError naming
// the part that is missing or wrong.
RecordedView::Query ParseQuery(const std::string& query);
// "session=2&at_ns=9", likewise.
RecordedView::Moment ParseMoment(const std::string& query);

}  // namespace sinew::live
