// DDS security of a participant, by the properties of its QoS profile.
//
// Set-up only, any thread.
#pragma once

#include <filesystem>

#include "components/topics/node/datagram_filter.h"
#include "components/topics/node/dds_pch.h"

namespace sinew::node::internal {

// Protection that the profile demands of datagrams. kRequired: the profile has the property
// "sinew.security.protected" with the value "all", as those of `sinew security` have; another
// governance may leave something plain.
Protection ProtectionOf(const eprosima::fastdds::dds::DomainParticipantQos& qos);

// Relative names in the values file://NAME of its properties are of files beside the QoS file, as
// everywhere in configuration; the library would look in the working folder.
void ResolveFiles(const std::filesystem::path& qos_file,
                  eprosima::fastdds::dds::DomainParticipantQos* qos);

}  // namespace sinew::node::internal
