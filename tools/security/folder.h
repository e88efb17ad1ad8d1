// The folder of a deployment's keys and certificates:
//
//   security.yaml  what it is of (schema sinew-security/1)
//   authority/     keys and certificates of the two authorities: stays where certificates are made
//   NAME/          what one process or person has; copied as a whole to its host
//
// Folders appear whole or not at all, none is written over, and only their owner may read them.
// Throws UsageError.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/fields.h"
#include "tools/security/authority.h"

namespace sinew::security {

// The owner of a certificate.
struct Member {
  std::string name;                // also of its folder; of a process that of the deployment
  std::vector<std::string> roles;  // roles.h
  std::string host;                // where its folder belongs
  bool other_library = false;      // as Subject
};

struct Settings {
  std::string deployment;
  int domain_id = 0;
};

inline constexpr char kSettingsSchema[] = "sinew-security/1";
void Describe(config::Fields& f, Settings& c);

// The data of a certificate in its folder.
struct MemberFile {
  Member member;
  Settings settings;
};
inline constexpr char kMemberSchema[] = "sinew-security-member/1";
void Describe(config::Fields& f, MemberFile& c);

struct Days {
  int authority = 7300, certificate = 1825;
};

// Both authorities and a certificate for each member.
void Create(const std::filesystem::path& folder, const Settings& settings,
            const std::vector<Member>& members, Days length = {});

// A further one, by the authorities of the folder.
void Add(const std::filesystem::path& folder, const Member& member, Days length = {});

struct Report {
  int certificates = 0;
  Seconds first_end{};              // of their validities; where there are some
  std::vector<std::string> faults;  // a line each: FILE: what is wrong, what was expected
  std::vector<std::string> notes;   // what will be a fault
};
// The folder of a deployment, or that of one certificate, copied to its host.
Report Check(const std::filesystem::path& folder);

}  // namespace sinew::security
