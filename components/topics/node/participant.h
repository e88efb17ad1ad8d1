// Owner of a DDS participant with its publisher, subscriber and topics.
//
// Threads: FindOrMakeTopic may be called by any thread. Throws DdsError, or UsageError for a file
// of QoS profiles that has none.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "components/topics/node/dds_pch.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"
#include "components/topics/node/topics.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

// A certificate of DDS security that may not do this.
class RefusedBySecurity : public DdsError {
 public:
  using DdsError::DdsError;
};

class Participant {
 public:
  // The listener must outlive the participant.
  Participant(const Options& options, const std::vector<std::string>& joint_names,
              dds::DomainParticipantListener* listener);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds::Topic* FindOrMakeTopic(const TopicInfo& info);
  // The QoS profile that a topic uses in this time mode.
  std::string ProfileFor(const TopicInfo& info) const;
  dds::Publisher& publisher() const { return *publisher_; }
  const eprosima::fastrtps::rtps::GUID_t& guid() const { return participant_->guid(); }
  dds::Subscriber& subscriber() const { return *subscriber_; }
  bool secure() const { return secure_; }  // DDS security
  // For a writer or a reader that could not be made. what: "writer for topic 'imu'".
  [[noreturn]] void Refuse(const std::string& what) const;

 private:
  const TimeMode mode_;
  const std::filesystem::path qos_path_;
  bool secure_ = false;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::mutex mutex_;
  std::map<std::string, dds::Topic*> topics_;
};

// The name of a QoS policy in messages, e.g. "durability".
std::string PolicyName(dds::QosPolicyId_t id);

}  // namespace sinew::node::internal
