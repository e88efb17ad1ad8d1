// Keys (P-256), X.509 certificates and signed documents (S/MIME), by OpenSSL's library. Texts are
// PEM and S/MIME as they stand in files; no file is read or written here.
//
// Two authorities, because whoever holds a certificate that the permissions' authority has issued
// could sign permissions: it signs documents and issues nothing. Functions throw std::runtime_error
// with OpenSSL's reason, and UsageError for a text that is no certificate, key or document.
#pragma once

#include <chrono>
#include <optional>
#include <string>

namespace sinew::security {

struct Credential {
  std::string certificate, key;
};

struct Subject {
  std::string name, host, deployment;
  // The participant with the smaller GUID of two begins the handshake and chooses the key
  // agreement, and in GUIDs there is a hash of the subject (DDS Security 1.1, 9.3.3). Fast DDS 2.9
  // chooses DH and writes it as Cyclone DDS 0.10 does not read it; with ECDH, which that chooses,
  // both agree. So certificates of other libraries get subjects with a smaller hash.
  bool other_library = false;
};

using Seconds = std::chrono::sys_seconds;

struct Validity {
  Seconds not_before, not_after;
};

enum class Authority { kForIdentities, kForPermissions };
// A new self-signed one.
Credential MakeAuthority(Authority authority, const std::string& deployment,
                         const Validity& validity);

// A new key with its certificate. Its subject is never used twice (serialNumber), so that
// permissions of an earlier holder of the name are not those of a later one.
Credential Issue(const Credential& authority, const Subject& subject, const Validity& validity);

struct CertificateFacts {
  std::string subject;  // RFC 2253
  Validity validity;
};
CertificateFacts FactsOf(const std::string& certificate);

// The key belongs to the certificate.
bool Matches(const Credential& credential);

// Why `certificate` is not one that `authority` has issued and that holds now; empty: it is.
std::string FaultOfChain(const std::string& certificate, const std::string& authority);

// The document with the authority's signature.
std::string Sign(const Credential& authority, const std::string& document);

// The document, lines ending with '\n'; nothing where the signature is not the authority's.
std::optional<std::string> Verified(const std::string& signed_document,
                                    const std::string& authority);

}  // namespace sinew::security
