// Reports of DDS discovery on other participants, and the problems that follow from them.
//
// Threads: DDS calls the listener functions; the others may be called by any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "components/topics/node/dds_pch.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/wake_signal.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

std::string TextOf(const eprosima::fastrtps::rtps::GUID_t& guid);

class Discovery final : public dds::DomainParticipantListener {
 public:
  // on_change: called by DDS threads when an endpoint was found, changed or lost.
  Discovery(WakeSignal& signal, std::function<void()> on_change)
      : signal_(signal), on_change_(std::move(on_change)) {}

  std::vector<Endpoint> endpoints() const;  // of other participants
  // Number of times that an endpoint or a participant was found, changed or lost.
  std::uint64_t changes() const { return changes_.load(std::memory_order_acquire); }
  std::vector<std::string> problems() const;
  // The name of the participant of this endpoint; empty: not known, or gone.
  std::string ParticipantOf(const eprosima::fastrtps::rtps::GUID_t& guid) const;
  // Those that its participant commands; empty: none, not known, or gone.
  std::vector<std::string> JointNamesOf(const eprosima::fastrtps::rtps::GUID_t& guid) const;
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
  const std::function<void()> on_change_;
  std::atomic<std::uint64_t> changes_{0};
  mutable std::mutex mutex_;
  struct Peer {
    std::string name;
    std::vector<std::string> addresses;  // but for loopback
    std::vector<std::string> joint_names;
  };
  std::map<std::string, Peer> peers_;          // by GUID prefix
  std::map<std::string, Endpoint> endpoints_;  // by GUID
  std::vector<std::string> problems_;
};

}  // namespace sinew::node::internal
