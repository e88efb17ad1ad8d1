#include "components/topics/node/discovery.h"

#include <fastrtps/utils/IPLocator.h>
#include <spdlog/spdlog.h>

#include <sstream>

#include "components/topics/node/interfaces.h"
#include "components/topics/node/names.h"
#include "components/topics/node/participant.h"
#include "components/topics/node/topics.h"

namespace sinew::node::internal {

namespace rtps = eprosima::fastrtps::rtps;

namespace {

template <class Identity>
std::string Text(const Identity& identity) {
  std::ostringstream out;
  out << identity;
  return out.str();
}

std::chrono::nanoseconds DurationOf(const eprosima::fastrtps::Duration_t& duration) {
  return duration.is_infinite() ? kUnlimited : std::chrono::nanoseconds(duration.to_ns());
}

EndpointQos::Durability DurabilityOf(dds::DurabilityQosPolicyKind kind) {
  switch (kind) {
    case dds::VOLATILE_DURABILITY_QOS:
      return EndpointQos::Durability::kVolatile;
    case dds::TRANSIENT_LOCAL_DURABILITY_QOS:
      return EndpointQos::Durability::kTransientLocal;
    case dds::TRANSIENT_DURABILITY_QOS:
      return EndpointQos::Durability::kTransient;
    case dds::PERSISTENT_DURABILITY_QOS:
      return EndpointQos::Durability::kPersistent;
  }
  return EndpointQos::Durability::kVolatile;
}

EndpointQos::Liveliness LivelinessOf(dds::LivelinessQosPolicyKind kind) {
  switch (kind) {
    case dds::AUTOMATIC_LIVELINESS_QOS:
      return EndpointQos::Liveliness::kAutomatic;
    case dds::MANUAL_BY_PARTICIPANT_LIVELINESS_QOS:
      return EndpointQos::Liveliness::kManualByParticipant;
    case dds::MANUAL_BY_TOPIC_LIVELINESS_QOS:
      return EndpointQos::Liveliness::kManualByTopic;
  }
  return EndpointQos::Liveliness::kAutomatic;
}

EndpointQos::AccessScope AccessScopeOf(dds::PresentationQosPolicyAccessScopeKind scope) {
  switch (scope) {
    case dds::INSTANCE_PRESENTATION_QOS:
      return EndpointQos::AccessScope::kInstance;
    case dds::TOPIC_PRESENTATION_QOS:
      return EndpointQos::AccessScope::kTopic;
    case dds::GROUP_PRESENTATION_QOS:
      return EndpointQos::AccessScope::kGroup;
  }
  return EndpointQos::AccessScope::kInstance;
}

// Without the numbers that XTypes gives no name.
std::vector<EndpointQos::Representation> NamedRepresentations(
    const std::vector<dds::DataRepresentationId_t>& ids) {
  std::vector<EndpointQos::Representation> named;
  for (const dds::DataRepresentationId_t id : ids) {
    switch (id) {
      case dds::XCDR_DATA_REPRESENTATION:
        named.push_back(EndpointQos::Representation::kXcdr1);
        break;
      case dds::XML_DATA_REPRESENTATION:
        named.push_back(EndpointQos::Representation::kXml);
        break;
      case dds::XCDR2_DATA_REPRESENTATION:
        named.push_back(EndpointQos::Representation::kXcdr2);
        break;
    }
  }
  return named;
}

// Terms of the QoS of a writer or a reader.
template <class Qos>
EndpointQos TermsOf(const Qos& qos) {
  EndpointQos terms;
  terms.reliable = qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  terms.durability = DurabilityOf(qos.m_durability.kind);
  terms.exclusive = qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS;
  terms.deadline = DurationOf(qos.m_deadline.period);
  terms.latency_budget = DurationOf(qos.m_latencyBudget.duration);
  terms.liveliness = LivelinessOf(qos.m_liveliness.kind);
  terms.lease = DurationOf(qos.m_liveliness.lease_duration);
  terms.by_source_stamp =
      qos.m_destinationOrder.kind == dds::BY_SOURCE_TIMESTAMP_DESTINATIONORDER_QOS;
  terms.access_scope = AccessScopeOf(qos.m_presentation.access_scope);
  terms.coherent_access = qos.m_presentation.coherent_access;
  terms.ordered_access = qos.m_presentation.ordered_access;
  terms.partitions = qos.m_partition.names();
  terms.representations = NamedRepresentations(qos.representation.m_value);
  return terms;
}

template <class Locators>
std::vector<std::string> NetworkAddresses(const Locators& locators) {
  std::vector<std::string> addresses;
  for (const rtps::Locator_t& locator : locators) {
    if (locator.kind != LOCATOR_KIND_UDPv4) continue;
    const std::string address = rtps::IPLocator::ip_to_string(locator);
    if (!IsLoopback(address)) addresses.push_back(address);
  }
  return addresses;
}

}  // namespace

std::string TextOf(const rtps::GUID_t& guid) { return Text(guid); }

std::string Discovery::ParticipantOf(const rtps::GUID_t& guid) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = peers_.find(Text(guid.guidPrefix));
  return found == peers_.end() ? "" : found->second.name;
}

std::vector<std::string> Discovery::JointNamesOf(const rtps::GUID_t& guid) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = peers_.find(Text(guid.guidPrefix));
  return found == peers_.end() ? std::vector<std::string>() : found->second.joint_names;
}

void Discovery::AddProblem(const std::string& problem) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const std::string& known : problems_) {
      if (known == problem) return;
    }
    problems_.push_back(problem);
  }
  spdlog::error("{}", problem);
}

void Discovery::on_participant_discovery(dds::DomainParticipant*,
                                         rtps::ParticipantDiscoveryInfo&& info) {
  const std::string prefix = Text(info.info.m_guid.guidPrefix);
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool gone = info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
                    info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT;
  if (gone) {
    peers_.erase(prefix);
  } else {
    peers_[prefix] = {info.info.m_participantName.to_string(),
                      NetworkAddresses(info.info.default_locators.unicast),
                      JointNamesFromWire(info.info.m_userData.data_vec())};
  }
  changes_.fetch_add(1, std::memory_order_release);
}

void Discovery::on_subscriber_discovery(dds::DomainParticipant* participant,
                                        rtps::ReaderDiscoveryInfo&& info) {
  Discovered(participant,
             {.is_writer = false,
              .topic = info.info.topicName().to_string(),
              .type_name = info.info.typeName().to_string(),
              .qos = TermsOf(info.info.m_qos)},
             info.info.guid(), info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
}

void Discovery::on_publisher_discovery(dds::DomainParticipant* participant,
                                       rtps::WriterDiscoveryInfo&& info) {
  Discovered(participant,
             {.is_writer = true,
              .topic = info.info.topicName().to_string(),
              .type_name = info.info.typeName().to_string(),
              .strength = info.info.m_qos.m_ownershipStrength.value,
              .qos = TermsOf(info.info.m_qos)},
             info.info.guid(), info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
}

void Discovery::Discovered(const dds::DomainParticipant* participant, Endpoint endpoint,
                           const rtps::GUID_t& guid, bool gone) {
  if (participant != nullptr && guid.guidPrefix == participant->guid().guidPrefix) return;
  std::string problem;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    endpoint.guid = Text(guid);
    if (gone) {
      endpoints_.erase(endpoint.guid);
    } else {
      const Peer& peer = peers_[Text(guid.guidPrefix)];
      endpoint.participant = peer.name;
      endpoint.addresses = peer.addresses;
      for (const TopicInfo& info : AllTopics()) {
        if (RegisteredTopicName(info.name) != endpoint.topic) continue;
        endpoint.topic = info.name;
        if (info.dds_type_name != endpoint.type_name) {
          problem = "topic '" + info.name + "': participant '" + endpoint.participant +
                    "' uses type " + endpoint.type_name + ", this build uses " +
                    info.dds_type_name + "; they never match: rebuild one of them";
        }
        break;
      }
      endpoints_[endpoint.guid] = endpoint;
    }
  }
  changes_.fetch_add(1, std::memory_order_release);
  if (!problem.empty()) AddProblem(problem);
  signal_.Notify(nullptr);
  if (on_change_) on_change_();
}

std::vector<Endpoint> Discovery::endpoints() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Endpoint> endpoints;
  for (const auto& [guid, endpoint] : endpoints_) endpoints.push_back(endpoint);
  return endpoints;
}

std::vector<std::string> Discovery::problems() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return problems_;
}

}  // namespace sinew::node::internal
