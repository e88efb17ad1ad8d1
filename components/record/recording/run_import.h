// Writes a run of measured signals as the topics a robot would have sent: joint_state,
// actuator_state and, when it has one, reference.
//
// Tick i is sample i, stamp_ns its time in whole nanoseconds, origin ORIGIN_REPLAY, session_id the
// hash of the samples, measured_flags the run's signals. What was not measured is 0.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "components/base/types/run.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/idl_schema.h"
#include "components/record/recording/io.h"
#include "components/record/recording/mcap_writer.h"

namespace sinew::recording {

struct TopicSchema {
  std::string topic;      // "joint_state"
  std::string type_name;  // "sinew::msg::JointState"
  std::string idl;        // flattened text of the type
  std::string idl_hash;
};

// Finds the schema of a topic. Throws std::invalid_argument when there is none.
using FindSchema = std::function<TopicSchema(std::string_view topic)>;

// Adds schema and channel of a topic; the channel's metadata carry the hash of its type.
IoStatus AddTopic(const TopicSchema& schema, McapWriter* writer, ChannelId* id);

class RunImporter {
 public:
  // Keeps references. Throws IdlError when a schema lacks a field.
  RunImporter(const FindSchema& find_schema, McapWriter& writer);
  RunImporter(const RunImporter&) = delete;
  RunImporter& operator=(const RunImporter&) = delete;

  // Adds a run as a session of its own, after what is there. `progress` receives the rows done, if
  // given. Throws std::invalid_argument for time before 0 or two samples within one nanosecond.
  IoStatus Add(const types::Run& run, const std::function<void(Eigen::Index)>& progress = {});

 private:
  struct Topic;

  const FindSchema& find_schema_;
  McapWriter& writer_;
  std::map<std::string, std::shared_ptr<Topic>, std::less<>> topics_;
  std::int64_t log_offset_ns_ = 0;
};

// Time of a sample in whole nanoseconds; and back: the double nearest to it.
std::int64_t StampFromSeconds(double time_s);
double SecondsFromStamp(std::int64_t stamp_ns);

}  // namespace sinew::recording
