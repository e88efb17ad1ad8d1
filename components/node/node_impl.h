// Internals of the module: owner objects around Fast DDS entities.
#pragma once

#include "components/node/codec.h"
#include "components/node/dds_pch.h"
#include "components/node/node.h"
#include "components/node/systemd_link.h"

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;

// Wakes the one thread that waits on a node. DDS threads call Notify with the source of the news; a
// thread that waits for one source sleeps through the others (every needless wake-up costs two
// context switches, and in lockstep these are what a tick consists of).
class Signal {
 public:
  void Notify(const void* source);
  // Waits for news of `source`, or of anything when it is null. True: there was some since the last
  // wait.
  bool Wait(std::chrono::microseconds timeout, const void* source = nullptr);

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  const void* awaited_ = nullptr;
  bool waiting_ = false;
  bool raised_ = false;
};

// Every topic travels as bytes; messages are encoded and decoded by the caller's thread (codec.h).
class BytesType : public dds::TopicDataType {
 public:
  explicit BytesType(const TopicInfo& topic);
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle,
              bool force_md5) override;

 private:
  std::string type_name_;
};

struct Sample {
  Bytes bytes;
  std::int64_t source_stamp_ns = 0;
  std::int64_t reception_stamp_ns = 0;
};

struct ReaderImpl final : public dds::DataReaderListener {
  ReaderImpl(std::shared_ptr<NodeImpl> node, const TopicInfo& topic, std::size_t queue_limit,
             Node::RawCallback callback);
  ~ReaderImpl() override;

  std::optional<Sample> TakeNext();
  std::optional<Sample> TakeLatest();
  // Returns when a sample is waiting here or the timeout is over.
  void WaitForSample(std::chrono::microseconds timeout);
  int matched() const;

  void on_data_available(dds::DataReader* reader) override;
  void on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) override;
  void on_requested_incompatible_qos(dds::DataReader*,
                                     const dds::RequestedIncompatibleQosStatus& status) override;

  std::shared_ptr<NodeImpl> node;
  TopicInfo topic;
  std::size_t queue_limit;  // 0: unlimited
  Node::RawCallback callback;
  dds::DataReader* reader = nullptr;
  std::atomic<std::uint64_t> received{0};
  std::atomic<std::uint64_t> lost{0};

 private:
  mutable std::mutex mutex_;
  std::deque<Sample> queue_;
  std::vector<Bytes> spare_;  // buffers to use again
  Sample scratch_;            // DDS thread only
};

struct WriterImpl final : public dds::DataWriterListener {
  WriterImpl(std::shared_ptr<NodeImpl> node, const TopicInfo& topic, int strength);
  ~WriterImpl() override;

  WriteStatus Write(Bytes* bytes);
  int matched() const;

  void on_offered_incompatible_qos(dds::DataWriter*,
                                   const dds::OfferedIncompatibleQosStatus& status) override;

  std::shared_ptr<NodeImpl> node;
  TopicInfo topic;
  dds::DataWriter* writer = nullptr;
  Bytes scratch;
};

struct NodeImpl final : public dds::DomainParticipantListener {
  explicit NodeImpl(const Options& options);
  ~NodeImpl() override;

  dds::Topic* FindOrMakeTopic(const TopicInfo& info);
  std::string ProfileFor(const TopicInfo& info) const;
  void AddProblem(const std::string& problem);
  void PublishStatusIfDue(bool now);
  void TellSystemd();

  void on_participant_discovery(dds::DomainParticipant*,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_subscriber_discovery(dds::DomainParticipant*,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant*,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

  Options options;
  Signal signal;
  SystemdLink systemd;
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;

  // Status; the owner's thread only.
  Node::State state = Node::State::kConfigured;
  std::string state_message;
  bool told_systemd = false;
  Node::Counts counts;
  std::uint64_t session_id = 0, tick = 0;
  std::int64_t stamp_ns = 0;
  int origin = 0;
  std::chrono::steady_clock::time_point last_status{};
  std::unique_ptr<WriterImpl>
      status_writer;  // holds no shared pointer to this (cycle): see node.cc
  std::vector<std::unique_ptr<ReaderImpl>> raw_readers;

 private:
  friend class sinew::node::Node;
  void Discovered(bool is_writer, const std::string& topic, const std::string& type,
                  const eprosima::fastrtps::rtps::GUID_t& guid, bool gone);

  mutable std::mutex mutex_;
  std::map<std::string, dds::Topic*> topics_;
  std::map<std::string, std::string> participant_names_;  // by GUID prefix
  std::map<std::string, Endpoint> endpoints_;             // by GUID
  std::vector<std::string> problems_;
};

std::string RegisteredTopicName(const std::string& name);

}  // namespace sinew::node::internal
