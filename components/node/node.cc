#include "components/node/node.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/recording.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/residual.h>
#include <sinew_idl/sensors.h>
#include <sinew_idl/simulation.h>
#include <sinew_idl/status.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <random>
#include <sstream>

#include "components/node/builtin_qos.h"
#include "components/node/messages.h"
#include "components/node/node_impl.h"
#include "components/node/version.h"
#include "components/types/clock/clock.h"

namespace sinew::node {

namespace internal {

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

std::string GuidText(const rtps::GUID_t& guid) {
  std::ostringstream out;
  out << guid;
  return out.str();
}

std::string PrefixText(const rtps::GuidPrefix_t& prefix) {
  std::ostringstream out;
  out << prefix;
  return out.str();
}

std::string PolicyName(dds::QosPolicyId_t id) {
  switch (id) {
    case dds::DURABILITY_QOS_POLICY_ID:
      return "durability";
    case dds::DEADLINE_QOS_POLICY_ID:
      return "deadline";
    case dds::OWNERSHIP_QOS_POLICY_ID:
      return "ownership";
    case dds::LIVELINESS_QOS_POLICY_ID:
      return "liveliness";
    case dds::RELIABILITY_QOS_POLICY_ID:
      return "reliability";
    default:
      return "policy " + std::to_string(static_cast<int>(id));
  }
}

// Loads the profiles once per process: the built-in ones, or a user's file.
void LoadProfiles(const Options& options) {
  static std::once_flag once;
  std::call_once(once, [&] {
    dds::Log::SetVerbosity(dds::Log::Kind::Error);
    auto* factory = dds::DomainParticipantFactory::get_instance();
    if (options.qos_path.empty()) {
      const std::string_view xml = BuiltinQosXml();
      if (factory->load_XML_profiles_string(xml.data(), xml.size()) != ReturnCode_t::RETCODE_OK) {
        throw DdsError("the built-in QoS profiles cannot be read");
      }
      return;
    }
    config::ReadFile(options.qos_path);  // a clear error when it is absent
    if (factory->load_XML_profiles_file(options.qos_path.string()) != ReturnCode_t::RETCODE_OK) {
      throw UsageError(options.qos_path.string() +
                       ": no valid QoS profiles, expected a file like qos_profiles.xml");
    }
  });
}

}  // namespace

void Signal::Notify(const void* source) {
  bool wake = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    raised_ = true;
    wake = waiting_ && (awaited_ == nullptr || awaited_ == source);
  }
  if (wake) condition_.notify_one();
}

bool Signal::Wait(std::chrono::microseconds timeout, const void* source) {
  std::unique_lock<std::mutex> lock(mutex_);
  awaited_ = source;
  waiting_ = true;
  const bool raised = condition_.wait_for(lock, timeout, [this] { return raised_; });
  waiting_ = false;
  raised_ = false;
  return raised;
}

std::string RegisteredTopicName(const std::string& name) {
#ifdef SINEW_ROS2_NAMES
  return "rt/" + name;
#else
  return name;
#endif
}

BytesType::BytesType(const TopicInfo& topic) : type_name_(topic.type_name) {
  setName(topic.dds_type_name.c_str());
  m_typeSize = static_cast<std::uint32_t>(MaxEncodedSize(topic.type_name));
  m_isGetKeyDefined = IsKeyed(topic.type_name);
  auto_fill_type_information(false);
  auto_fill_type_object(false);
}

bool BytesType::serialize(void* data, rtps::SerializedPayload_t* payload) {
  const Bytes& bytes = *static_cast<const Bytes*>(data);
  if (bytes.size() < 4 || bytes.size() > payload->max_size) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = (bytes[1] & std::byte{1}) != std::byte{0} ? CDR_LE : CDR_BE;
  return true;
}

bool BytesType::deserialize(rtps::SerializedPayload_t* payload, void* data) {
  Bytes& bytes = *static_cast<Bytes*>(data);
  const auto* begin = reinterpret_cast<const std::byte*>(payload->data);
  bytes.assign(begin, begin + payload->length);
  return true;
}

std::function<uint32_t()> BytesType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
}

void* BytesType::createData() { return new Bytes; }
void BytesType::deleteData(void* data) { delete static_cast<Bytes*>(data); }

bool BytesType::getKey(void* data, rtps::InstanceHandle_t* handle, bool /*force_md5*/) {
  if (!m_isGetKeyDefined) return false;
  std::uint8_t hash[16];
  if (!KeyHash(type_name_, *static_cast<const Bytes*>(data), hash)) return false;
  for (int i = 0; i < 16; ++i) handle->value[i] = hash[i];
  return true;
}

ReaderImpl::ReaderImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info, std::size_t limit,
                       Node::RawCallback on_sample)
    : node(std::move(owner)), topic(info), queue_limit(limit), callback(std::move(on_sample)) {
  dds::Topic* dds_topic = node->FindOrMakeTopic(topic);
  dds::DataReaderQos qos;
  const std::string profile = node->ProfileFor(topic);
  if (node->subscriber->get_datareader_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("no reader QoS profile '" + profile + "'");
  }
  if (callback) {  // a recorder: the topic's own terms, the recorder's history
    dds::DataReaderQos log;
    if (node->subscriber->get_datareader_qos_from_profile("log", log) != ReturnCode_t::RETCODE_OK) {
      throw DdsError("no reader QoS profile 'log'");
    }
    qos.history(log.history());
  }
  reader = node->subscriber->create_datareader(
      dds_topic, qos, this,
      dds::StatusMask::data_available()
          << dds::StatusMask::sample_lost() << dds::StatusMask::requested_incompatible_qos());
  if (reader == nullptr) throw DdsError("no reader for topic '" + topic.name + "'");
}

ReaderImpl::~ReaderImpl() {
  if (reader == nullptr) return;
  reader->set_listener(nullptr);
  node->subscriber->delete_datareader(reader);
}

void ReaderImpl::on_data_available(dds::DataReader* source) {
  dds::SampleInfo info;
  bool any = false;
  while (source->take_next_sample(&scratch_.bytes, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    scratch_.source_stamp_ns = info.source_timestamp.to_ns();
    scratch_.reception_stamp_ns = types::EpochNow_ns();
    received.fetch_add(1, std::memory_order_relaxed);
    any = true;
    if (callback) {
      callback(RawSample{topic.name, std::move(scratch_.bytes), scratch_.source_stamp_ns,
                         scratch_.reception_stamp_ns});
      scratch_.bytes = Bytes();
      continue;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    if (queue_limit != 0 && queue_.size() >= queue_limit) {
      spare_.push_back(std::move(queue_.front().bytes));
      queue_.pop_front();
    }
    queue_.push_back(std::move(scratch_));
    scratch_.bytes = Bytes();
    if (!spare_.empty()) {
      scratch_.bytes = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  if (any) node->signal.Notify(this);
}

void ReaderImpl::on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) {
  lost.store(static_cast<std::uint64_t>(status.total_count), std::memory_order_relaxed);
}

void ReaderImpl::on_requested_incompatible_qos(dds::DataReader*,
                                               const dds::RequestedIncompatibleQosStatus& status) {
  node->AddProblem("topic '" + topic.name + "': a writer offers another " +
                   PolicyName(status.last_policy_id) +
                   " than this reader requests (does one side run in lockstep and the other not?)");
}

std::optional<Sample> ReaderImpl::TakeNext() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (queue_.empty()) return std::nullopt;
  Sample sample = std::move(queue_.front());
  queue_.pop_front();
  return sample;
}

std::optional<Sample> ReaderImpl::TakeLatest() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (queue_.empty()) return std::nullopt;
  Sample sample = std::move(queue_.back());
  queue_.clear();
  return sample;
}

void ReaderImpl::WaitForSample(std::chrono::microseconds timeout) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!queue_.empty()) return;
  }
  node->signal.Wait(timeout, this);
}

int ReaderImpl::matched() const {
  dds::SubscriptionMatchedStatus status;
  reader->get_subscription_matched_status(status);
  return status.current_count;
}

WriterImpl::WriterImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info, int strength)
    : node(std::move(owner)), topic(info) {
  dds::Topic* dds_topic = node->FindOrMakeTopic(topic);
  dds::DataWriterQos qos;
  const std::string profile = node->ProfileFor(topic);
  if (node->publisher->get_datawriter_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("no writer QoS profile '" + profile + "'");
  }
  qos.ownership_strength().value = static_cast<std::uint32_t>(strength);
  writer = node->publisher->create_datawriter(dds_topic, qos, this,
                                              dds::StatusMask::offered_incompatible_qos());
  if (writer == nullptr) throw DdsError("no writer for topic '" + topic.name + "'");
}

WriterImpl::~WriterImpl() {
  if (writer == nullptr) return;
  if (node->options.mode == TimeMode::kLockstep && matched() > 0) {
    writer->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(2, 0));
  }
  writer->set_listener(nullptr);
  node->publisher->delete_datawriter(writer);
}

WriteStatus WriterImpl::Write(Bytes* bytes) {
  if (bytes->empty()) return WriteStatus::kFailed;
  return writer->write(static_cast<void*>(bytes)) ? WriteStatus::kOk : WriteStatus::kFailed;
}

int WriterImpl::matched() const {
  dds::PublicationMatchedStatus status;
  writer->get_publication_matched_status(status);
  return status.current_count;
}

void WriterImpl::on_offered_incompatible_qos(dds::DataWriter*,
                                             const dds::OfferedIncompatibleQosStatus& status) {
  node->AddProblem("topic '" + topic.name + "': a reader requests another " +
                   PolicyName(status.last_policy_id) +
                   " than this writer offers (does one side run in lockstep and the other not?)");
}

namespace {

// Unicast ports that no other process had. Fast DDS would give the successor of a killed process
// the same ports, and who has opened a port in shared memory goes on writing to the dead one for
// seconds, sometimes for good. Ports are told by discovery, so that nobody has to know them; a port
// that is taken is moved by Fast DDS. Left alone: a user's own ports and unicast peers, and the
// last domains, above which there is no room.
void UseFreshPorts(int domain, dds::DomainParticipantQos* qos) {
  auto& ports = qos->wire_protocol().port;
  const rtps::PortParameters standard;
  const auto& builtin = qos->wire_protocol().builtin;
  if (ports.portBase != standard.portBase || ports.domainIDGain != standard.domainIDGain ||
      ports.offsetd1 != standard.offsetd1 || ports.offsetd3 != standard.offsetd3 ||
      !builtin.initialPeersList.empty() || !builtin.metatrafficUnicastLocatorList.empty()) {
    return;
  }
  // A place where a participant of a following domain could be: never that domain's multicast
  // ports.
  constexpr int kHighestPort = 65535, kMostBlocks = 80, kPlaces = 100;
  const int domain_port = standard.portBase + standard.domainIDGain * domain;
  const int blocks =
      std::min((kHighestPort - domain_port) / standard.domainIDGain - 1, kMostBlocks);
  if (blocks < 2) return;
  std::random_device device;
  const int block = std::uniform_int_distribution<int>(1, blocks)(device);
  const int place = std::uniform_int_distribution<int>(0, kPlaces - 1)(device);
  const int offset = standard.domainIDGain * block + standard.participantIDGain * place;
  ports.offsetd1 = static_cast<std::uint16_t>(standard.offsetd1 + offset);
  ports.offsetd3 = static_cast<std::uint16_t>(standard.offsetd3 + offset);
}

}  // namespace

NodeImpl::NodeImpl(const Options& node_options) : options(node_options) {
  LoadProfiles(options);
  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos;
  const std::string profile = options.mode == TimeMode::kLockstep ? "sinew_lockstep" : "sinew";
  if (factory->get_participant_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw UsageError(options.qos_path.string() + ": profile '" + profile + "' is missing");
  }
  qos.name(options.name.c_str());
  UseFreshPorts(options.domain_id, &qos);
  participant = factory->create_participant(static_cast<std::uint32_t>(options.domain_id), qos,
                                            this, dds::StatusMask::none());
  if (participant == nullptr) {
    throw DdsError("no DDS participant in domain " + std::to_string(options.domain_id));
  }
  publisher = participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (publisher == nullptr || subscriber == nullptr) {
    participant->delete_contained_entities();
    factory->delete_participant(participant);
    throw DdsError("no DDS publisher or subscriber in domain " + std::to_string(options.domain_id));
  }
}

NodeImpl::~NodeImpl() {
  participant->set_listener(nullptr);
  participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

dds::Topic* NodeImpl::FindOrMakeTopic(const TopicInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = topics_.find(info.name);
  if (found != topics_.end()) return found->second;
  const dds::TypeSupport type(new BytesType(info));
  if (type.register_type(participant) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("type '" + info.dds_type_name + "' cannot be registered");
  }
  dds::Topic* topic = participant->create_topic(RegisteredTopicName(info.name), info.dds_type_name,
                                                dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw DdsError("topic '" + info.name + "' cannot be made");
  topics_[info.name] = topic;
  return topic;
}

std::string NodeImpl::ProfileFor(const TopicInfo& info) const {
  const bool latched_status = info.name == kComponentStatus.name;
  if (options.mode == TimeMode::kLockstep && !latched_status) return "lockstep";
  return std::string(ProfileName(info.profile));
}

void NodeImpl::AddProblem(const std::string& problem) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const std::string& known : problems_) {
      if (known == problem) return;
    }
    problems_.push_back(problem);
  }
  spdlog::error("{}", problem);
}

void NodeImpl::on_participant_discovery(dds::DomainParticipant*,
                                        rtps::ParticipantDiscoveryInfo&& info) {
  const std::string prefix = PrefixText(info.info.m_guid.guidPrefix);
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  if (gone) {
    participant_names_.erase(prefix);
  } else {
    participant_names_[prefix] = info.info.m_participantName.to_string();
  }
}

void NodeImpl::on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) {
  Discovered(false, info.info.topicName().to_string(), info.info.typeName().to_string(),
             info.info.guid(), info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
}

void NodeImpl::on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) {
  Discovered(true, info.info.topicName().to_string(), info.info.typeName().to_string(),
             info.info.guid(), info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
}

void NodeImpl::Discovered(bool is_writer, const std::string& topic, const std::string& type,
                          const rtps::GUID_t& guid, bool gone) {
  if (participant != nullptr && guid.guidPrefix == participant->guid().guidPrefix)
    return;  // our own
  std::string problem;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::string key = GuidText(guid);
    if (gone) {
      endpoints_.erase(key);
    } else {
      const std::string name = participant_names_[PrefixText(guid.guidPrefix)];
      endpoints_[key] = Endpoint{is_writer, topic, type, name, key};
      for (const TopicInfo& info : AllTopics()) {
        if (RegisteredTopicName(info.name) == topic && info.dds_type_name != type) {
          problem = "topic '" + info.name + "': participant '" + name + "' uses type " + type +
                    ", this build uses " + info.dds_type_name +
                    "; they never match: rebuild one of them";
        }
      }
    }
  }
  if (!problem.empty()) AddProblem(problem);
  signal.Notify(nullptr);
}

namespace {

double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

const char* Word(Node::State state) {
  switch (state) {
    case Node::State::kConfigured:
      return "configured";
    case Node::State::kActive:
      return "active";
    case Node::State::kFault:
      return "fault";
    case Node::State::kStopped:
      return "stopped";
  }
  return "fault";
}

msg::ComponentState ToMessage(Node::State state) {
  switch (state) {
    case Node::State::kConfigured:
      return msg::COMPONENT_CONFIGURED;
    case Node::State::kActive:
      return msg::COMPONENT_ACTIVE;
    case Node::State::kFault:
      return msg::COMPONENT_FAULT;
    case Node::State::kStopped:
      return msg::COMPONENT_STOPPED;
  }
  return msg::COMPONENT_FAULT;
}

}  // namespace

void NodeImpl::PublishStatusIfDue(bool now) {
  systemd.Beat();
  const auto time = std::chrono::steady_clock::now();
  if (!now && time - last_status < std::chrono::seconds(1)) return;
  if (status_writer == nullptr) return;
  last_status = time;
  char host[64] = {};
  ::gethostname(host, sizeof(host) - 1);
  msg::ComponentStatus status;
  status.name(options.name);
  status.header().session_id(session_id);
  status.header().tick(tick);
  status.header().stamp_ns(stamp_ns);
  status.header().origin(static_cast<msg::Origin>(origin));
  status.state(ToMessage(state));
  status.process_id(static_cast<std::uint32_t>(::getpid()));
  status.host(host);
  status.version(kVersion);
  status.idl_hash(AllTopicsHash());
  status.cycles(counts.cycles);
  status.stale_inputs(counts.stale_inputs);
  status.missed_ticks(counts.missed_ticks);
  status.write_failures(counts.write_failures);
  status.resident_MB(ResidentMegabytes());
  status.message(state_message.substr(0, 255));
  Bytes bytes;
  if (!Encode(status, &bytes) || status_writer->Write(&bytes) != WriteStatus::kOk) {
    ++counts.write_failures;
  }
}

// The first state that a component sets means that it is configured.
void NodeImpl::TellSystemd() {
  told_systemd = true;
  systemd.SetStatus(Word(state) + (state_message.empty() ? "" : ": " + state_message));
  if (state == Node::State::kStopped) systemd.SetStopping();
}

}  // namespace internal

Node::Node(const Options& options) : impl_(std::make_shared<internal::NodeImpl>(options)) {
  impl_->status_writer =
      std::make_unique<internal::WriterImpl>(impl_, *FindTopic(kComponentStatus.name), 10);
  impl_->PublishStatusIfDue(true);
}

Node::~Node() {
  impl_->systemd.SetStopping();
  if (impl_->state != State::kFault) impl_->state = State::kStopped;
  impl_->PublishStatusIfDue(true);
  impl_->raw_readers.clear();
  impl_->status_writer.reset();  // the writer keeps the node alive: end that here
}

template <class Message>
Reader<Message> Node::MakeReader(const Topic<Message>& topic) {
  const bool all = options().mode == TimeMode::kLockstep || topic.profile == Profile::kEvent ||
                   topic.profile == Profile::kLatched;
  return Reader<Message>(
      std::make_shared<internal::ReaderImpl>(impl_, *FindTopic(topic.name), all ? 0 : 8, nullptr));
}

template <class Message>
Writer<Message> Node::MakeWriter(const Topic<Message>& topic, int strength) {
  return Writer<Message>(
      std::make_shared<internal::WriterImpl>(impl_, *FindTopic(topic.name), strength));
}

void Node::ReadRaw(const TopicInfo& topic, RawCallback callback) {
  impl_->raw_readers.push_back(
      std::make_unique<internal::ReaderImpl>(impl_, topic, 0, std::move(callback)));
}

RawWriter Node::MakeRawWriter(const TopicInfo& topic, int strength) {
  return RawWriter(std::make_shared<internal::WriterImpl>(impl_, topic, strength));
}

RawWriter::RawWriter(std::shared_ptr<internal::WriterImpl> impl) : impl_(std::move(impl)) {}

WriteStatus RawWriter::operator()(const std::byte* payload, std::size_t size) const {
  impl_->scratch.assign(payload, payload + size);
  return impl_->Write(&impl_->scratch);
}

int RawWriter::matched_readers() const { return impl_->matched(); }

bool RawWriter::WaitAcknowledged(std::chrono::milliseconds timeout) const {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const auto rest = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout - seconds);
  const eprosima::fastrtps::Duration_t limit(static_cast<std::int32_t>(seconds.count()),
                                             static_cast<std::uint32_t>(rest.count()));
  return impl_->writer->wait_for_acknowledgments(limit) == internal::ReturnCode_t::RETCODE_OK;
}

int Node::RawMatchedWriters(const std::string& topic) const {
  int count = 0;
  for (const auto& reader : impl_->raw_readers) {
    if (reader->topic.name == topic) count += reader->matched();
  }
  return count;
}

std::vector<Endpoint> Node::Endpoints() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  std::vector<Endpoint> endpoints;
  for (const auto& [key, endpoint] : impl_->endpoints_) endpoints.push_back(endpoint);
  return endpoints;
}

std::vector<std::string> Node::Problems() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex_);
  return impl_->problems_;
}

void Node::SetState(State state, const std::string& message) {
  const bool changed = state != impl_->state || message != impl_->state_message;
  impl_->state = state;
  impl_->state_message = message;
  impl_->PublishStatusIfDue(changed);
  if (changed || !impl_->told_systemd) impl_->TellSystemd();
}

void Node::SetCounts(const Counts& counts) {
  impl_->counts = counts;
  impl_->PublishStatusIfDue(false);
}

void Node::SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                    int origin) {
  impl_->session_id = session_id;
  impl_->tick = tick;
  impl_->stamp_ns = stamp_ns;
  impl_->origin = origin;
  impl_->systemd.Beat();
}

bool Node::WaitForData(std::chrono::microseconds timeout) {
  const bool raised = impl_->signal.Wait(timeout);
  impl_->PublishStatusIfDue(false);
  return raised;
}

const Options& Node::options() const { return impl_->options; }

namespace {

template <class Message>
std::optional<Message> DecodeSample(std::optional<internal::Sample> sample) {
  if (!sample) return std::nullopt;
  Message message;
  if (!Decode(sample->bytes, &message)) return std::nullopt;
  return message;
}

}  // namespace

template <class Message>
Reader<Message>::Reader(std::shared_ptr<internal::ReaderImpl> impl) : impl_(std::move(impl)) {}
template <class Message>
Reader<Message>::Reader(Reader&&) noexcept = default;
template <class Message>
Reader<Message>& Reader<Message>::operator=(Reader&&) noexcept = default;
template <class Message>
Reader<Message>::~Reader() = default;

template <class Message>
std::optional<Message> Reader<Message>::TakeNext() {
  return DecodeSample<Message>(impl_->TakeNext());
}

template <class Message>
std::optional<Message> Reader<Message>::TakeLatest() {
  return DecodeSample<Message>(impl_->TakeLatest());
}

template <class Message>
std::optional<Message> Reader<Message>::WaitNext(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    if (auto message = TakeNext()) return message;
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return std::nullopt;
    impl_->WaitForSample(left);
  }
}

template <class Message>
void Reader<Message>::WaitForSample(std::chrono::microseconds timeout) {
  impl_->WaitForSample(timeout);
  impl_->node->PublishStatusIfDue(false);
}

template <class Message>
int Reader<Message>::matched_writers() const {
  return impl_->matched();
}
template <class Message>
std::uint64_t Reader<Message>::received() const {
  return impl_->received;
}
template <class Message>
std::uint64_t Reader<Message>::lost() const {
  return impl_->lost;
}

template <class Message>
Writer<Message>::Writer(std::shared_ptr<internal::WriterImpl> impl) : impl_(std::move(impl)) {}
template <class Message>
Writer<Message>::Writer(Writer&&) noexcept = default;
template <class Message>
Writer<Message>& Writer<Message>::operator=(Writer&&) noexcept = default;
template <class Message>
Writer<Message>::~Writer() = default;

template <class Message>
WriteStatus Writer<Message>::Write(const Message& message) {
  if (!Encode(message, &impl_->scratch)) return WriteStatus::kFailed;
  return impl_->Write(&impl_->scratch);
}

template <class Message>
int Writer<Message>::matched_readers() const {
  return impl_->matched();
}

#define SINEW_INSTANTIATE(Type)                                         \
  template class Reader<msg::Type>;                                     \
  template class Writer<msg::Type>;                                     \
  template Reader<msg::Type> Node::MakeReader(const Topic<msg::Type>&); \
  template Writer<msg::Type> Node::MakeWriter(const Topic<msg::Type>&, int);
SINEW_FOR_EACH_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node
