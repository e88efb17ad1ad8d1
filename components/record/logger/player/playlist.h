// Messages that a player sends: those of a recording in the order they were received, marked as
// replay.
//
// Only topics whose recorded type is this build's are played: equal names with other fields would
// swap values.
//
// A replay may begin again or jump: each time is a further pass. Pass 0 has the sessions of the
// recording; in a later pass every session id is another one (SessionInPass), so that to a receiver
// it is a state provider that was started again: within a session ticks only grow.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/record/recording/bytes.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/run_import.h"

namespace sinew::logger {

struct PlaylistOptions {
  // Regular expressions (ECMAScript) of whole recorded names; empty: all but component_status,
  // log, recording_progress and only_when_named, which are played only when one of these is exactly
  // their name.
  std::vector<std::string> topics;
  std::vector<std::string> exclude;          // the same, of what is left out
  std::vector<std::string> only_when_named;  // the topics that command
  // Topics whose sample stays valid until the next one. Where a pass begins later than the file,
  // the newest earlier sample of each of their writers goes first, as to a reader that joins late.
  std::vector<std::string> latched;
  std::map<std::string, std::string> remap;  // recorded name -> published name (of the same type)
  double start_s = 0.0;                      // from the first message
  double end_s = std::numeric_limits<double>::infinity();
};

struct PlayedMessage {
  std::size_t topic = 0;    // index into Playlist::published
  std::int64_t due_ns = 0;  // after the first message
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  bool is_state = false;  // a joint_state
  recording::Bytes payload;
};

// The session id in a pass; pass 0: as recorded. Never 0.
std::uint64_t SessionInPass(std::uint64_t recorded, std::uint64_t pass);

class Playlist {
 public:
  // `known` are this build's topics. Keeps a reference to the reader. Throws std::invalid_argument
  // (with `file` in the message) when a topic is not there, not known, or of another type, an
  // expression is none or matches nothing, or nothing is left.
  Playlist(const recording::McapReader& reader, const std::string& file,
           const std::vector<recording::TopicSchema>& known, const PlaylistOptions& options);
  ~Playlist();

  // Names to publish, and how many messages pass 0 has.
  const std::vector<std::string>& published() const { return published_; }
  // Topics that this build has not.
  const std::vector<std::string>& left_out() const { return left_out_; }
  // Topics whose messages cannot be read, whatever this build has of their names.
  const recording::LeftOut& not_readable() const { return not_readable_; }
  // Topics of only_when_named that are in the file and were not named.
  const std::vector<std::string>& not_named() const { return not_named_; }
  std::uint64_t message_count() const { return message_count_; }
  std::int64_t duration_ns() const { return duration_ns_; }

  // False at the end. The last joint_state of the last pass says last_tick, the others do not: a
  // recorder goes on through several sessions and ends with the replay. Throws McapError where the
  // file is broken.
  bool Next(PlayedMessage* message);
  // Begins a pass at a position (after the first message, cut to the recording): Next gives the
  // first joint_state that is not before it, where joint_state is played, so that a session begins
  // with a whole tick; else the first message. last_pass: its last joint_state ends the replay (as
  // that of pass 0 does until BeginPass is called).
  void BeginPass(std::uint64_t pass, std::int64_t position_ns, bool last_pass);
  // Makes a message part of a session that runs now.
  void Retarget(PlayedMessage* message, std::uint64_t session_id, std::uint64_t tick,
                std::int64_t stamp_ns) const;

 private:
  struct Channel;
  // Log times that only go on, in file order.
  class RisingTime {
   public:
    std::int64_t Take(std::int64_t log_time_ns) {
      shift_ns_ += std::max<std::int64_t>(last_ns_ - (log_time_ns + shift_ns_), 0);
      return last_ns_ = log_time_ns + shift_ns_;
    }

   private:
    std::int64_t shift_ns_ = 0, last_ns_ = 0;
  };
  struct Latched {
    recording::ChannelId channel{};
    std::int64_t log_time_ns = 0;
    std::uint32_t sequence = 0;
    recording::Bytes data;
  };
  // Once through, to know what there is: reading costs little beside sending. Gives the last time.
  std::int64_t CountMessages();
  // The same once more where the clock was set back: first, last and last state in file order.
  void ReadPlaces(std::int64_t* last_ns);
  // Before a time of the recording, the oldest first.
  std::deque<Latched> NewestBefore(std::int64_t time_ns) const;
  void Fill(recording::ChannelId id, std::uint32_t sequence, std::int64_t log_time_ns,
            PlayedMessage* message) const;
  // Place of the last joint_state; there may be several messages at one time.
  struct Place {
    recording::ChannelId channel{};
    std::int64_t log_time_ns = 0;
    std::uint32_t sequence = 0;
    bool operator==(const Place&) const = default;
  };

  const recording::McapReader& reader_;
  recording::MessageFilter filter_;
  std::map<recording::ChannelId, std::unique_ptr<Channel>> channels_;
  std::vector<std::string> published_;
  std::vector<const Channel*> by_topic_;
  std::vector<std::string> left_out_, not_named_;
  recording::LeftOut not_readable_;
  std::uint64_t message_count_ = 0;
  std::optional<Place> last_state_;
  std::uint64_t pass_ = 0;
  bool last_pass_ = true;
  bool before_state_ = false;
  std::int64_t first_ns_ = 0;
  std::int64_t duration_ns_ = 0;
  std::set<std::string> latched_;  // that are played
  std::deque<Latched> earlier_;    // to be given next, at the begin of the pass
  std::int64_t begin_ns_ = 0;      // of the pass, after first_ns_
  RisingTime time_;                // of the pass
  std::optional<recording::McapMessages> messages_;
};

}  // namespace sinew::logger
