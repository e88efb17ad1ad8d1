#include "components/topics/node/dds_security.h"

#include <fastdds/rtps/attributes/PropertyPolicy.h>

#include <string>
#include <string_view>

namespace sinew::node::internal {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::PropertyPolicyHelper;

Protection ProtectionOf(const dds::DomainParticipantQos& qos) {
  if (PropertyPolicyHelper::find_property(qos.properties(), "dds.sec.auth.plugin") == nullptr) {
    return Protection::kNone;
  }
  const std::string* all =
      PropertyPolicyHelper::find_property(qos.properties(), "sinew.security.protected");
  return all != nullptr && *all == "all" ? Protection::kRequired : Protection::kAllowed;
}

void ResolveFiles(const std::filesystem::path& qos_file, dds::DomainParticipantQos* qos) {
  constexpr std::string_view kPrefix = "dds.sec.", kFile = "file://";
  for (auto& property : qos->properties().properties()) {
    const std::string& value = property.value();
    if (!property.name().starts_with(kPrefix) || !value.starts_with(kFile)) continue;
    const std::filesystem::path named = value.substr(kFile.size());
    property.value(std::string(kFile) +
                   (std::filesystem::absolute(qos_file).parent_path() / named).string());
  }
}

}  // namespace sinew::node::internal
