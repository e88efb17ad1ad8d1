// Owner of a DDS reader and its queue.
//
// Threads: DDS calls the listener functions, which copy samples into the queue or hand them to the
// callback; the others belong to the thread that reads. Throws DdsError.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>

#include "components/topics/node/dds_pch.h"
#include "components/topics/node/node.h"
#include "components/topics/node/sample_queue.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

struct ReaderImpl final : public dds::DataReaderListener {
  // With a callback the queue stays empty. wakes: samples wake the thread that waits on the node.
  ReaderImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info,
             Node::RawCallback on_sample = {}, bool wakes = true);
  ~ReaderImpl() override;  // logs how many samples the queue has dropped

  std::optional<Sample> TakeNext();
  std::optional<Sample> TakeLatest();
  bool empty() const { return queue_.empty(); }
  // Returns when a sample is waiting here or the timeout is over.
  void WaitForSample(std::chrono::microseconds timeout);
  int matched() const;
  std::uint64_t received() const { return received_; }
  std::uint64_t lost() const { return lost_; }
  std::uint64_t dropped() const { return queue_.dropped(); }
  // Counts, logs and forgets a sample taken from here that could not be decoded.
  void CountMalformed();
  // Period of an EXCLUSIVE topic in real time: its owner may be silent for Deadline(period).
  void SetPeriod(std::chrono::nanoseconds period);
  std::uint64_t malformed() const { return malformed_; }
  // A sample of a composed writer (composition.h).
  void TakeComposed(const Bytes& bytes, std::int64_t stamp_ns, const WriterId& writer);

  void on_data_available(dds::DataReader* source) override;
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override;
  void on_requested_incompatible_qos(dds::DataReader*,
                                     const dds::RequestedIncompatibleQosStatus& status) override;

  const std::shared_ptr<NodeImpl> node;
  const TopicInfo topic;
  const std::size_t queue_limit;

 private:
  void OpenDds();
  // False where only the newest sample matters, so that dropping is no loss.
  bool dropping_is_a_loss() const;
  bool has_owners() const;
  // Queues the sample, and reports what a full queue dropped.
  void Queue(Sample* sample);

  Node::RawCallback callback_;
  const bool wakes_;
  SampleQueue queue_;
  dds::DataReader* reader_ = nullptr;  // stays null in a composition apart
  std::atomic<std::uint64_t> received_{0};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> malformed_{0};
  Sample scratch_;   // DDS thread only
  Sample composed_;  // of the composition's thread only
  // The last sample of DDS, of a topic with owners, came from the composed writer.
  std::atomic<bool> composed_heard_{true};
};

}  // namespace sinew::node::internal
