#include "tools/security/documents.h"

#include <stdexcept>

#include "components/base/types/printable.h"
#include "components/topics/node/names.h"
#include "tools/roles/roles.h"

namespace sinew::security {

namespace {

std::string Topic(const std::string& name) {
  return "<topic>" + node::internal::RegisteredTopicName(name) + "</topic>";
}

std::string Domains(int domain_id) {
  return "<domains><id>" + std::to_string(domain_id) + "</id></domains>\n";
}

// `payload`: protection of the payload itself.
std::string TopicRule(const std::string& expression, const char* payload) {
  return "<topic_rule><topic_expression>" + expression +
         "</topic_expression>\n"
         "<enable_discovery_protection>true</enable_discovery_protection>\n"
         "<enable_liveliness_protection>true</enable_liveliness_protection>\n"
         "<enable_read_access_control>true</enable_read_access_control>\n"
         "<enable_write_access_control>true</enable_write_access_control>\n"
         "<metadata_protection_kind>NONE</metadata_protection_kind>\n"
         "<data_protection_kind>" +
         payload + "</data_protection_kind></topic_rule>\n";
}

constexpr char kHead[] = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";

}  // namespace

std::string Governance(int domain_id) {
  std::string rules;
  // The first rule whose expression fits counts.
  for (const std::string& topic : CommandingTopics()) {
    rules += TopicRule(node::internal::RegisteredTopicName(topic), "ENCRYPT");
  }
  rules += TopicRule("*", "NONE");
  return std::string(kHead) + "<dds><domain_access_rules><domain_rule>\n" + Domains(domain_id) +
         "<allow_unauthenticated_participants>false</allow_unauthenticated_participants>\n"
         "<enable_join_access_control>true</enable_join_access_control>\n"
         "<discovery_protection_kind>ENCRYPT</discovery_protection_kind>\n"
         "<liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>\n"
         "<rtps_protection_kind>ENCRYPT</rtps_protection_kind>\n"
         "<topic_access_rules>\n" +
         rules + "</topic_access_rules></domain_rule></domain_access_rules></dds>\n";
}

std::string Permissions(const Grant& grant) {
  std::string topics;
  for (const std::string& topic : TopicsWrittenBy(grant.roles)) topics += Topic(topic) + "\n";
  return std::string(kHead) + "<dds><permissions><grant name=\"" + types::Entities(grant.name) +
         "\">\n" + "<subject_name>" + types::Entities(grant.subject) + "</subject_name>\n" +
         "<validity><not_before>" + grant.not_before + "</not_before><not_after>" +
         grant.not_after + "</not_after></validity>\n" + "<allow_rule>" + Domains(grant.domain_id) +
         "<publish><topics>\n" + topics + "</topics></publish>\n" +
         "<subscribe><topics><topic>*</topic></topics></subscribe></allow_rule>\n"
         "<default>DENY</default></grant></permissions></dds>\n";
}

std::vector<Property> SecurityProperties() {
  const std::string authentication = "dds.sec.auth.builtin.PKI-DH.";
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  const auto file = [](const char* name) { return std::string("file://") + name; };
  return {{"dds.sec.auth.plugin", "builtin.PKI-DH"},
          {authentication + "identity_ca", file(kIdentityAuthority)},
          {authentication + "identity_certificate", file(kCertificate)},
          {authentication + "private_key", file(kPrivateKey)},
          {"dds.sec.access.plugin", "builtin.Access-Permissions"},
          {access + "permissions_ca", file(kPermissionsAuthority)},
          {access + "governance", file(kGovernance)},
          {access + "permissions", file(kPermissions)},
          {"dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC"},
          // Not of DDS: plain datagrams are not read (components/topics/node/dds_security.h).
          {"sinew.security.protected", "all"}};
}

std::string WithSecurity(const std::string& profiles) {
  std::string more = "\n        <propertiesPolicy><properties>\n";
  for (const Property& property : SecurityProperties()) {
    more += "          <property><name>" + property.name + "</name><value>" + property.value +
            "</value></property>\n";
  }
  more += "        </properties></propertiesPolicy>";
  const std::string end = "</builtin>";  // only participants have it
  std::string xml = profiles;
  std::size_t found = xml.find(end);
  if (found == std::string::npos) {
    throw std::invalid_argument("QoS profiles without a participant, expected </builtin>");
  }
  for (; found != std::string::npos; found = xml.find(end, found + more.size())) {
    xml.insert(found + end.size(), more);
  }
  return xml;
}

}  // namespace sinew::security
