// Time and order of the messages of a recording: by session and tick of joint_state.
//
// Log times are those of reception. In lockstep they say nothing of the motion, whose time is that
// of the stamps; where the computer's clock was set back within a session they are no order.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "components/record/recording/cdr.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/record/recording/session_clock.h"

namespace sinew::recording {

class RecordedTime {
 public:
  // Reads every joint_state. Keeps nothing of the reader. Throws McapError.
  explicit RecordedTime(const McapReader& reader);

  // Stamps are simulated: recorded in lockstep, or, without metadata, stamps of no epoch clock
  // beside log times of one.
  bool is_simulated() const { return is_simulated_; }
  // The clock was set back within a session: messages are read as they stand in the file.
  bool in_file_order() const { return in_file_order_; }
  // Time that goes on through sessions and where the clock was set back: that of the stamp where it
  // is simulated, else of reception; the log time of a message without our header.
  std::int64_t Of(const McapMessage& message) const;
  // From the first joint_state to the last, where log times have another one; else none.
  struct Span {
    std::int64_t start_ns, end_ns;
  };
  std::optional<Span> span() const;

 private:
  struct Header {
    MessageType type;
    CdrField session, tick;
  };
  std::map<ChannelId, Header> headers_;
  std::optional<SessionTimes> times_;  // none: no joint_state
  bool is_simulated_ = false, in_file_order_ = false;
};

}  // namespace sinew::recording
