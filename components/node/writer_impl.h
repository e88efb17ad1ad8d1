// Owner of a DDS writer.
//
// Threads: DDS calls the listener function; the others belong to the thread that writes. Throws
// DdsError.
#pragma once

#include <chrono>
#include <memory>

#include "components/node/codec.h"
#include "components/node/dds_pch.h"
#include "components/node/node.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

struct WriterImpl final : public dds::DataWriterListener {
  WriterImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info, int strength);
  ~WriterImpl() override;  // in lockstep waits up to 2 s until every reader has everything

  WriteStatus Write(Bytes* bytes);
  bool WaitAcknowledged(std::chrono::milliseconds timeout) const;
  int matched() const;

  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override;

  const std::shared_ptr<NodeImpl> node;
  const TopicInfo topic;
  Bytes scratch;  // of the thread that writes

 private:
  dds::DataWriter* writer_ = nullptr;
};

}  // namespace sinew::node::internal
