#include "tools/security/folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <ctime>
#include <functional>

#include "components/base/config/config.h"
#include "components/base/config/whole_file.h"
#include "components/base/types/joined.h"
#include "components/topics/node/builtin_qos.h"
#include "tools/roles/roles.h"
#include "tools/security/documents.h"

namespace sinew::security {

void Describe(config::Fields& f, Settings& c) {
  constexpr double kLargestDomain = 232;
  f.Need("deployment", c.deployment, "its name");
  f.Need("domain_id", c.domain_id, {0, kLargestDomain}, "of DDS");
}

void Describe(config::Fields& f, MemberFile& c) {
  Describe(f, c.settings);
  f.Need("name", c.member.name, "of the process");
  f("roles", c.member.roles, "what it may read and write");
  f.Need("host", c.member.host, "where its folder belongs");
}

namespace {

namespace fs = std::filesystem;
using std::chrono::days;

constexpr char kSettings[] = "security.yaml";
constexpr char kMember[] = "member.yaml";
constexpr char kAuthority[] = "authority";
constexpr char kIdentityKey[] = "identity_ca.key", kPermissionsKey[] = "permissions_ca.key";
constexpr days kSoon{30};
// Clocks of hosts differ, and Fast DDS reads the times of permissions as local ones.
constexpr days kEarlier{1};

// Files and folders that are made meanwhile are their owner's alone.
class OwnersAlone {
 public:
  OwnersAlone() : before_(::umask(S_IRWXG | S_IRWXO)) {}
  ~OwnersAlone() { ::umask(before_); }
  OwnersAlone(const OwnersAlone&) = delete;
  OwnersAlone& operator=(const OwnersAlone&) = delete;

 private:
  mode_t before_;
};

// A folder that appears under its name when it is whole.
class WholeFolder {
 public:
  explicit WholeFolder(fs::path path) : path_(std::move(path)) {
    if (fs::symlink_status(path_).type() != fs::file_type::not_found) {
      throw UsageError(path_.string() + ": is there already, expected a new name");
    }
    part_ = config::PartPath(path_);
    std::error_code error;
    fs::create_directory(part_, error);
    if (error) throw UsageError(path_.string() + ": cannot be made: " + error.message());
  }
  ~WholeFolder() {
    std::error_code ignored;
    if (!part_.empty()) fs::remove_all(part_, ignored);
  }
  WholeFolder(const WholeFolder&) = delete;
  WholeFolder& operator=(const WholeFolder&) = delete;

  const fs::path& part() const { return part_; }
  void Commit() {
    config::SyncFolderOf(part_ / ".");
    std::error_code error;
    fs::rename(part_, path_, error);
    if (error) throw UsageError(path_.string() + ": cannot be made: " + error.message());
    part_.clear();
    config::SyncFolderOf(path_);
  }

 private:
  fs::path path_, part_;
};

bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= 64 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

void CheckMember(const Member& member) {
  if (!IsName(member.name) || member.name == kAuthority) {
    throw UsageError("name '" + member.name +
                     "': expected letters, digits, '_', '-' or '.', and not 'authority'");
  }
  if (!IsName(member.host)) {
    throw UsageError("host '" + member.host + "': expected letters, digits, '_', '-' or '.'");
  }
  if (member.roles.empty()) throw UsageError("'" + member.name + "': expected a role");
  (void)TopicsWrittenBy(member.roles);
}

// In names of certificates: what needs no quoting there.
std::string Plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-' && c != '.'; },
      '_');
  return text.empty() ? "deployment" : text.substr(0, 64);
}

Validity From(Seconds now, int length_days) { return {now - kEarlier, now + days(length_days)}; }

Seconds Now() {
  return std::chrono::time_point_cast<Seconds::duration>(std::chrono::system_clock::now());
}

std::string DateOf(Seconds time) {
  const std::time_t value = std::chrono::system_clock::to_time_t(time);
  std::tm fields{};
  ::gmtime_r(&value, &fields);
  char text[32];
  return {text, std::strftime(text, sizeof(text), "%Y-%m-%dT%H:%M:%S", &fields)};
}

std::string SettingsText(const Settings& settings) {
  return "deployment: '" + Plain(settings.deployment) +
         "'\ndomain_id: " + std::to_string(settings.domain_id) + "\n";
}

Settings ReadSettings(const fs::path& folder) {
  return config::Read<Settings>(config::Section::Load(folder / kSettings, kSettingsSchema));
}

struct Authorities {
  Credential identities, permissions;
};

Authorities ReadAuthorities(const fs::path& folder) {
  const fs::path authority = folder / kAuthority;
  return {{config::ReadFile(authority / kIdentityAuthority),
           config::ReadFile(authority / kIdentityKey)},
          {config::ReadFile(authority / kPermissionsAuthority),
           config::ReadFile(authority / kPermissionsKey)}};
}

std::string PermissionsOf(const Member& member, const Settings& settings,
                          const CertificateFacts& facts) {
  return Permissions({.name = member.name,
                      .subject = facts.subject,
                      .roles = member.roles,
                      .domain_id = settings.domain_id,
                      .not_before = DateOf(facts.validity.not_before),
                      .not_after = DateOf(facts.validity.not_after)});
}

void WriteMember(const fs::path& at, const Member& member, const Settings& settings,
                 const Authorities& authorities, int length_days) {
  // Not longer than its authority.
  Validity validity = From(Now(), length_days);
  validity.not_after =
      std::min(validity.not_after, FactsOf(authorities.identities.certificate).validity.not_after);
  const Credential own =
      Issue(authorities.identities,
            {member.name, member.host, Plain(settings.deployment), member.other_library}, validity);
  const auto write = [&at](const char* name, const std::string& text) {
    config::WriteFileAtomically(at / name, text);
  };
  write(kIdentityAuthority, authorities.identities.certificate);
  write(kPermissionsAuthority, authorities.permissions.certificate);
  write(kCertificate, own.certificate);
  write(kPrivateKey, own.key);
  write(kGovernance, Sign(authorities.permissions, Governance(settings.domain_id)));
  write(kPermissions,
        Sign(authorities.permissions, PermissionsOf(member, settings, FactsOf(own.certificate))));
  write(kQos, WithSecurity(std::string(node::BuiltinQosXml())));
  write(kMember, "schema: " + std::string(kMemberSchema) + "\n" + SettingsText(settings) +
                     "name: '" + member.name + "'\nhost: '" + member.host + "'\nroles: [" +
                     types::Joined(member.roles) + "]\n");
}

// Checks a folder's files; reports what is wrong with them, a line each.
class Checker {
 public:
  Report Take() { return std::move(report_); }

  void CheckDeployment(const fs::path& folder) {
    Run(folder / kSettings, [&] { (void)ReadSettings(folder); });
    CheckAuthority(folder / kAuthority);
    std::vector<fs::path> members;
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.is_directory() && entry.path().filename() != kAuthority) {
        members.push_back(entry.path());
      }
    }
    std::sort(members.begin(), members.end());
    for (const fs::path& member : members) {
      CheckMemberFolder(member);
      for (const char* name : {kIdentityAuthority, kPermissionsAuthority}) {
        CheckSame(member / name, folder / kAuthority / name);
      }
    }
  }

  void CheckMemberFolder(const fs::path& folder) {
    ++report_.certificates;
    CheckKey(folder / kPrivateKey);
    std::string identities, permissions, certificate;
    if (!Read(folder / kIdentityAuthority, &identities) ||
        !Read(folder / kPermissionsAuthority, &permissions) ||
        !Read(folder / kCertificate, &certificate)) {
      return;
    }
    if (identities == permissions) {
      Fault(folder / kPermissionsAuthority,
            "is the authority of identities as well, expected one of its own: with one for both, "
            "whoever has a certificate can sign permissions");
    }
    bool good = false;
    Run(folder / kCertificate, [&] {
      const std::string fault = FaultOfChain(certificate, identities);
      if (!fault.empty()) {
        Fault(folder / kCertificate,
              fault + ", expected a certificate of " + kIdentityAuthority + " that holds now");
      }
      NoteEnd(folder / kCertificate, FactsOf(certificate).validity.not_after);
      good = true;
    });
    std::string key;
    if (good && Read(folder / kPrivateKey, &key)) {
      Run(folder / kPrivateKey, [&] {
        if (!Matches({certificate, key})) {
          Fault(folder / kPrivateKey, std::string("is not the key of ") + kCertificate);
        }
      });
    }
    CheckQos(folder / kQos);
    Run(folder / kMember, [&] {
      const auto [member, settings] =
          config::Read<MemberFile>(config::Section::Load(folder / kMember, kMemberSchema));
      CheckMember(member);
      CheckDocument(
          folder / kGovernance, permissions, Governance(settings.domain_id),
          "the governance of this version for domain " + std::to_string(settings.domain_id));
      if (good) {
        CheckDocument(folder / kPermissions, permissions,
                      PermissionsOf(member, settings, FactsOf(certificate)),
                      "what this version grants to the roles of member.yaml (" +
                          types::Joined(member.roles) + ")");
      }
    });
  }

 private:
  void Fault(const fs::path& file, const std::string& what) {
    report_.faults.push_back(file.string() + ": " + what);
  }

  // Reports what a check throws as a fault; a UsageError that names its file already, as it is.
  void Run(const fs::path& file, const std::function<void()>& check) {
    try {
      check();
    } catch (const UsageError& error) {
      const std::string text = error.what();
      report_.faults.push_back(text.starts_with(file.string()) ? text
                                                               : file.string() + ": " + text);
    }
  }

  bool Read(const fs::path& file, std::string* text) {
    bool read = false;
    Run(file, [&] {
      *text = config::ReadFile(file);
      read = true;
    });
    return read;
  }

  void CheckKey(const fs::path& file) {
    struct stat status {};
    if (::stat(file.c_str(), &status) != 0) {
      Fault(file, "is not there, expected a private key");
    } else if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
      Fault(file, "others may read or write it, expected mode 0600 (chmod 600)");
    }
  }

  void NoteEnd(const fs::path& file, Seconds end) {
    if (report_.certificates > 0 && (report_.first_end == Seconds{} || end < report_.first_end)) {
      report_.first_end = end;
    }
    const Seconds now = Now();
    if (end > now && end - now < kSoon) {
      report_.notes.push_back(file.string() + ": ends on " + DateOf(end) + " UTC");
    }
  }

  // Kept elsewhere it is no fault: it is not needed where the robot runs.
  void CheckAuthority(const fs::path& folder) {
    if (!fs::exists(folder)) return;
    const std::pair<const char*, const char*> pairs[] = {{kIdentityAuthority, kIdentityKey},
                                                         {kPermissionsAuthority, kPermissionsKey}};
    for (const auto& [name, key_name] : pairs) {
      CheckKey(folder / key_name);
      std::string certificate, key;
      if (!Read(folder / name, &certificate) || !Read(folder / key_name, &key)) continue;
      Run(folder / name, [&, file = folder / name] {
        const std::string fault = FaultOfChain(certificate, certificate);
        if (!fault.empty()) Fault(file, fault + ", expected an authority that holds now");
        if (!Matches({certificate, key})) Fault(file, "has another key than the one beside it");
        NoteEnd(file, FactsOf(certificate).validity.not_after);
      });
    }
  }

  void CheckSame(const fs::path& file, const fs::path& authority) {
    std::error_code error;
    if (!fs::exists(file, error) || !fs::exists(authority, error)) return;
    std::string own, its;
    if (Read(file, &own) && Read(authority, &its) && own != its) {
      Fault(file, "is another one than " + authority.string());
    }
  }

  // Profiles may be edited, but for the properties of DDS security.
  void CheckQos(const fs::path& file) {
    std::string text;
    if (!Read(file, &text)) return;
    for (const Property& property : SecurityProperties()) {
      if (text.find("<name>" + property.name + "</name><value>" + property.value + "</value>") ==
          std::string::npos) {
        Fault(file, "has no property " + property.name + " with the value " + property.value);
      }
    }
  }

  void CheckDocument(const fs::path& file, const std::string& authority,
                     const std::string& document, const std::string& expected) {
    std::string text;
    if (!Read(file, &text)) return;
    Run(file, [&] {
      const auto content = Verified(text, authority);
      if (!content) {
        Fault(file, std::string("has no signature of ") + kPermissionsAuthority);
      } else if (*content != document) {
        Fault(file, "differs, expected " + expected);
      }
    });
  }

  Report report_;
};

}  // namespace

void Create(const fs::path& folder, const Settings& settings, const std::vector<Member>& members,
            Days length) {
  for (const Member& member : members) CheckMember(member);
  const OwnersAlone alone;
  WholeFolder whole(folder);
  const Validity validity = From(Now(), length.authority);
  const Authorities authorities{
      MakeAuthority(Authority::kForIdentities, Plain(settings.deployment), validity),
      MakeAuthority(Authority::kForPermissions, Plain(settings.deployment), validity)};
  const fs::path authority = whole.part() / kAuthority;
  fs::create_directory(authority);
  config::WriteFileAtomically(authority / kIdentityAuthority, authorities.identities.certificate);
  config::WriteFileAtomically(authority / kIdentityKey, authorities.identities.key);
  config::WriteFileAtomically(authority / kPermissionsAuthority,
                              authorities.permissions.certificate);
  config::WriteFileAtomically(authority / kPermissionsKey, authorities.permissions.key);
  config::WriteFileAtomically(whole.part() / kSettings, "schema: " + std::string(kSettingsSchema) +
                                                            "\n" + SettingsText(settings));
  for (const Member& member : members) {
    if (!fs::create_directory(whole.part() / member.name)) {
      throw UsageError("name '" + member.name + "': given twice, expected names of their own");
    }
    WriteMember(whole.part() / member.name, member, settings, authorities, length.certificate);
  }
  whole.Commit();
}

void Add(const fs::path& folder, const Member& member, Days length) {
  CheckMember(member);
  const Settings settings = ReadSettings(folder);
  const Authorities authorities = ReadAuthorities(folder);
  const OwnersAlone alone;
  WholeFolder whole(folder / member.name);
  WriteMember(whole.part(), member, settings, authorities, length.certificate);
  whole.Commit();
}

Report Check(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw UsageError(folder.string() + ": no folder, expected one of 'sinew security init'");
  }
  Checker checker;
  if (fs::exists(folder / kMember, error)) {
    checker.CheckMemberFolder(folder);
  } else {
    checker.CheckDeployment(folder);
  }
  return checker.Take();
}

}  // namespace sinew::security
