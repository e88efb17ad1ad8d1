// The documents of DDS security (OMG DDS Security 1.1, 9.4.1) that a deployment has, and the QoS
// profiles that name them. Pure.
//
// Everything travels as encrypted RTPS messages (rtps_protection_kind); payloads of commanding
// topics are encrypted once more, with keys that only their readers have. Why: README.md.
#pragma once

#include <string>
#include <vector>

namespace sinew::security {

// Demands of all participants of a domain on each other.
std::string Governance(int domain_id);

// Rights of one certificate. Times are local times of a host, as Fast DDS reads them.
struct Grant {
  std::string name;
  std::string subject;  // RFC 2253, as in its certificate
  std::vector<std::string> roles;
  int domain_id = 0;
  std::string not_before, not_after;  // "2026-01-31T00:00:00"
};
// Throws UsageError for a role that is none.
std::string Permissions(const Grant& grant);

// Names of the files of a certificate's folder.
inline constexpr char kIdentityAuthority[] = "identity_ca.pem";
inline constexpr char kPermissionsAuthority[] = "permissions_ca.pem";
inline constexpr char kCertificate[] = "certificate.pem";
inline constexpr char kPrivateKey[] = "private.key";
inline constexpr char kGovernance[] = "governance.p7s";
inline constexpr char kPermissions[] = "permissions.p7s";
inline constexpr char kQos[] = "qos.xml";

struct Property {
  std::string name, value;
};
// A participant's, whose files lie beside its QoS file.
std::vector<Property> SecurityProperties();

// `profiles` (like components/topics/node/qos_profiles.xml) with these properties in every profile
// of a participant. Throws std::invalid_argument when there is none.
std::string WithSecurity(const std::string& profiles);

}  // namespace sinew::security
