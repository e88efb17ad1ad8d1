// What DDS discovery reports of other participants, and the problems that follow from it.
//
// Threads: DDS calls the listener functions; the others may be called by any thread.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "components/node/dds_pch.h"
#include "components/node/node.h"
#include "components/node/wake_signal.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

class Discovery final : public dds::DomainParticipantListener {
 public:
  explicit Discovery(WakeSignal& signal) : signal_(signal) {}

  std::vector<Endpoint> endpoints() const;  // of other participants
  std::vector<std::string> problems() const;
  // Logged as an error and kept; the same text only once.
  void AddProblem(const std::string& problem);

  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  void Discovered(const dds::DomainParticipant* participant, Endpoint endpoint,
                  const eprosima::fastrtps::rtps::GUID_t& guid, bool gone);

  WakeSignal& signal_;
  mutable std::mutex mutex_;
  std::map<std::string, std::string> participant_names_;  // by GUID prefix
  std::map<std::string, Endpoint> endpoints_;             // by GUID
  std::vector<std::string> problems_;
};

}  // namespace sinew::node::internal
