#include "components/topics/node/participant.h"

#include <algorithm>
#include <random>

#include "components/base/config/config.h"
#include "components/topics/node/builtin_qos.h"
#include "components/topics/node/bytes_type.h"
#include "components/topics/node/dds_security.h"
#include "components/topics/node/names.h"
#include "components/topics/node/transports.h"

namespace sinew::node::internal {

namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

namespace {

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
    const std::string xml = config::ReadFile(options.qos_path);
    if (factory->load_XML_profiles_string(xml.data(), xml.size()) != ReturnCode_t::RETCODE_OK) {
      throw UsageError(options.qos_path.string() +
                       ": no valid QoS profiles, expected a file like qos_profiles.xml");
    }
  });
}

// Unicast ports that no other process had. Fast DDS would give the successor of a killed process
// the same ports, and a peer that has opened a port in shared memory goes on writing to the dead
// one for seconds, sometimes for good. Discovery announces the ports, so that no peer has to know
// them; a port that is taken is moved by Fast DDS. Left alone: a user's own ports and unicast
// peers, and the last domains, above which there are no ports.
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

Participant::Participant(const Options& options, const std::vector<std::string>& joint_names,
                         dds::DomainParticipantListener* listener)
    : mode_(options.mode), qos_path_(options.qos_path) {
  LoadProfiles(options);
  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos;
  const std::string profile = options.mode == TimeMode::kLockstep ? "sinew_lockstep" : "sinew";
  if (factory->get_participant_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw UsageError(options.qos_path.string() + ": profile '" + profile + "' is missing");
  }
  qos.name(options.name.c_str());
  if (!joint_names.empty()) qos.user_data().setValue(JointNamesOnWire(joint_names));
  secure_ = ProtectionOf(qos) != Protection::kNone;
  if (secure_) ResolveFiles(qos_path_, &qos);
  UseFreshPorts(options.domain_id, &qos);
  RestrictTransports(options, &qos);
  participant_ = factory->create_participant(static_cast<std::uint32_t>(options.domain_id), qos,
                                             listener, dds::StatusMask::none());
  if (participant_ == nullptr) Refuse("participant in domain " + std::to_string(options.domain_id));
  if (options.mode == TimeMode::kLockstep) RestrictSharedMemory();
  publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
  subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    participant_->delete_contained_entities();
    factory->delete_participant(participant_);
    throw DdsError("no DDS publisher or subscriber in domain " + std::to_string(options.domain_id));
  }
}

Participant::~Participant() {
  participant_->set_listener(nullptr);
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* Participant::FindOrMakeTopic(const TopicInfo& info) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = topics_.find(info.name);
  if (found != topics_.end()) return found->second;
  const dds::TypeSupport type(new BytesType(info));
  if (type.register_type(participant_) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("type '" + info.dds_type_name + "' cannot be registered");
  }
  dds::Topic* topic = participant_->create_topic(RegisteredTopicName(info.name), info.dds_type_name,
                                                 dds::TOPIC_QOS_DEFAULT);
  if (topic == nullptr) throw DdsError("topic '" + info.name + "' cannot be made");
  topics_[info.name] = topic;
  return topic;
}

void Participant::Refuse(const std::string& what) const {
  if (!secure_) throw DdsError("no DDS " + what);
  throw RefusedBySecurity("no DDS " + what + ": the certificate of " + qos_path_.string() +
                          " does not allow it (sinew security check " +
                          qos_path_.parent_path().string() + ")");
}

std::string Participant::ProfileFor(const TopicInfo& info) const {
  const bool latched_status = info.name == kComponentStatus.name;
  if (mode_ == TimeMode::kLockstep && !latched_status) return "lockstep";
  return std::string(ProfileName(info.profile));
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

}  // namespace sinew::node::internal
