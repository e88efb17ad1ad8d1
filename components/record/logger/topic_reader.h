// Facts that a recorder reads of the messages that it writes: their header, the end of a session,
// faults. Pure; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/cdr.h"
#include "components/record/recording/idl_schema.h"
#include "components/record/recording/run_import.h"

namespace sinew::logger {

struct MessageFacts {
  bool malformed = false;  // it does not fit its type: the rest is not known
  std::uint64_t session_id = 0;
  std::uint64_t tick = 0;
  std::int64_t stamp_ns = 0;
  std::int64_t origin = 0;
  std::uint64_t instance = 0;  // a hash of the key fields; 0 without any
  bool last_tick = false;      // joint_state
  bool fault = false;          // joint_state: fault or estop of the robot; component_status: fault
};

class TopicReader {
 public:
  // Throws recording::IdlError when the schema cannot be read, recording::CdrError when it lacks a
  // field.
  explicit TopicReader(const recording::TopicSchema& schema);
  TopicReader(const TopicReader&) = delete;
  TopicReader& operator=(const TopicReader&) = delete;

  // Makes the payload canonical.
  MessageFacts Read(recording::Bytes* payload) const;
  // Words for what is in fault, of a message with a fault.
  std::string FaultText(const recording::Bytes& payload) const;
  bool is_joint_state() const { return last_tick_.has_value(); }

 private:
  recording::IdlSchema idl_;
  const recording::IdlType& type_;
  recording::CdrField session_id_, tick_, stamp_ns_, origin_;
  std::vector<recording::CdrField> keys_;
  std::optional<recording::CdrField> last_tick_, robot_state_;               // joint_state
  std::optional<recording::CdrField> component_state_, component_, reason_;  // component_status
};

}  // namespace sinew::logger
