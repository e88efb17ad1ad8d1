// Writes runs of measured signals, one for each joint, as the topics a robot would have sent:
// joint_state, actuator_state and, when it has one, reference.
//
// Tick i is sample i, or the i-th time that any joint has, where a joint without a sample is not
// valid. stamp_ns is the time in whole nanoseconds, origin ORIGIN_REPLAY, session_id the
// hash of the samples (of several joints, each turned by its number and combined by xor),
// measured_flags the run's signals. What was not measured is 0.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

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

  // Adds the runs of a robot's joints, which have the same signals, as a session of its own, after
  // what is there. `progress` receives the ticks done, if given. Throws std::invalid_argument for
  // time before 0, two samples within one nanosecond, or more joints than topics have.
  IoStatus Add(std::span<const types::Run> joints,
               const std::function<void(Eigen::Index)>& progress = {});

 private:
  struct Topic;
  IoStatus OpenTopics(const std::vector<std::string>& names, std::span<const types::Run> joints,
                      std::vector<Topic*>* topics);

  const FindSchema& find_schema_;
  McapWriter& writer_;
  std::map<std::string, std::shared_ptr<Topic>, std::less<>> topics_;
  std::int64_t log_offset_ns_ = 0;
};

// Every time that any of the joints has a sample, in order.
std::vector<double> TimesOf(std::span<const types::Run> joints);

// Time of a sample in whole nanoseconds; and back: the double nearest to it.
std::int64_t StampFromSeconds(double time_s);
double SecondsFromStamp(std::int64_t stamp_ns);

}  // namespace sinew::recording
