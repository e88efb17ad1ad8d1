// Owner of a DDS writer.
//
// Threads: DDS calls the listener function; the others belong to the thread that writes, unless
// they say otherwise. Throws DdsError.
#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <string>

#include "components/topics/node/codec.h"
#include "components/topics/node/dds_pch.h"
#include "components/topics/node/node.h"
#include "components/topics/node/ownership.h"
#include "components/topics/node/writer_id.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

struct WriterImpl final : public dds::DataWriterListener {
  WriterImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info);
  ~WriterImpl() override;  // in lockstep waits up to 2 s until every reader has everything

  WriteStatus Write(Bytes* bytes);
  WriteStatus WriteToDds(Bytes* bytes);  // at once, of a composed node too
  bool WaitAcknowledged(std::chrono::milliseconds timeout) const;
  int matched() const;

  // Strength on EXCLUSIVE topics. SetStrength goes to all readers; it may be called by any one
  // thread at a time, and does nothing when the strength is the same.
  Strength strength() const noexcept { return strength_.load(std::memory_order_relaxed); }
  void SetStrength(Strength strength);
  const std::string& guid() const noexcept { return guid_; }
  const WriterId& id() const noexcept { return id_; }

  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override;

  const std::shared_ptr<NodeImpl> node;
  const TopicInfo topic;
  Bytes scratch;  // of the thread that writes

 private:
  void OpenDds();
  bool HasOwners() const;

  dds::DataWriter* writer_ = nullptr;  // stays null in a composition apart
  std::atomic<Strength> strength_{kJoiningStrength};
  std::string guid_;
  WriterId id_{};
};

}  // namespace sinew::node::internal
