// A session of a recording, tick by tick: what was sent on each topic in a tick, and events by id.
//
// Reads the file once, from its start, and keeps kTicksKept ticks before and after the present one
// and of each topic the newest one before them, so that memory does not grow with the recording.
// Thread: one.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/codec.h"

namespace sinew::rerun {

struct Session {
  std::uint64_t id = 0;
  std::uint64_t first_tick = 0, last_tick = 0;  // of joint_state
  std::uint64_t states = 0;
  double period_s = 0.0;       // nominal, of its first joint_state
  bool in_file_order = false;  // of the file: log times are no order of its ticks
};

// In the order in which they began. `file` is named in messages. Throws UsageError when a
// joint_state is of another type than this build's or cannot be decoded.
std::vector<Session> SessionsOf(const recording::McapReader& reader, const std::string& file);

// Throws UsageError naming the topic where the recorded type is not this build's: what another
// build computed from other fields cannot be computed again.
void CheckTypes(const recording::McapReader& reader, const std::string& file,
                const std::vector<std::string>& topics);

// Throws UsageError naming a topic of states or commands that participants of several names wrote:
// which of them was heard in a tick is not recorded.
void CheckWriters(const recording::McapReader& reader, const std::string& file,
                  const std::vector<std::string>& topics);

class RecordedTicks {
 public:
  // In lockstep no writer is further ahead of a reader than its history is deep (256 samples, the
  // profile `lockstep` of components/topics/node/qos_profiles.xml), and no reader of it further
  // ahead of the recorder: twice that. In real time inputs are older by less.
  static constexpr std::uint64_t kTicksKept = 512;

  // topics: those that are read at all. The reader must outlive it.
  RecordedTicks(const recording::McapReader& reader, const Session& session,
                const std::vector<std::string>& topics);

  // The next tick that has a joint_state; nothing at the end. Throws recording::McapError.
  std::optional<std::uint64_t> Next();

  // Messages of that topic and tick (header); several where a writer sent several. nullptr: none.
  const std::vector<node::Bytes>* Find(std::string_view topic, std::uint64_t tick) const;
  // A later tick of the topic is in the file: a gap before it is a loss.
  bool HasLater(std::string_view topic, std::uint64_t tick) const;
  // Message of a topic whose messages are events (profile `event`), by EventId. nullptr: none.
  const node::Bytes* FindEvent(std::string_view topic, std::uint64_t id) const;
  bool Has(std::string_view topic) const { return recorded_.contains(std::string(topic)); }

 private:
  struct Topic {
    std::map<std::uint64_t, std::vector<node::Bytes>> by_tick;
    std::map<std::uint64_t, node::Bytes> events;
    bool is_event = false;
  };
  // Reads until a joint_state later than `tick`, or the end.
  void ReadBeyond(std::uint64_t tick);

  const recording::McapReader& reader_;
  const Session session_;
  recording::McapMessages messages_;
  std::map<std::string, Topic, std::less<>> recorded_;
  std::map<recording::ChannelId, Topic*> by_channel_;
  Topic* states_ = nullptr;
  std::optional<std::uint64_t> tick_;
  bool at_end_ = false;
};

}  // namespace sinew::rerun
