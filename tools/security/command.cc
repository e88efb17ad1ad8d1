#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/topics/node/host_name.h"
#include "tools/launch/deployment.h"
#include "tools/roles/roles.h"
#include "tools/security/documents.h"
#include "tools/security/folder.h"
#include "tools/security/members.h"

namespace sinew::security {

namespace {

namespace fs = std::filesystem;

constexpr char kExtension[] = ".security";

std::vector<std::string> Split(const std::string& text) {
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; std::getline(in, word, ',');) words.push_back(word);
  return words;
}

std::string RoleTable() {
  std::size_t width = 0;
  for (const std::string& role : RoleNames()) width = std::max(width, role.size());
  std::string text;
  for (const std::string& role : RoleNames()) {
    text += "  " + role + std::string(width + 2 - role.size(), ' ') + std::string(PurposeOf(role)) +
            "\n";
  }
  return text;
}

// PROCESS=ROLE,ROLE
std::map<std::string, std::vector<std::string>> ParseRoles(const std::vector<std::string>& given) {
  std::map<std::string, std::vector<std::string>> roles;
  for (const std::string& text : given) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw UsageError("--role " + text + ": expected PROCESS=ROLE,...");
    }
    roles[text.substr(0, equals)] = Split(text.substr(equals + 1));
  }
  return roles;
}

void PrintMembers(const std::vector<Member>& members) {
  std::size_t width = 4;
  for (const Member& member : members) width = std::max(width, member.name.size());
  const auto print = [width](const std::string& name, const std::string& roles) {
    std::cout << name << std::string(width + 2 - name.size(), ' ') << roles << '\n';
  };
  print("name", "role");
  for (const Member& member : members) print(member.name, types::Joined(member.roles));
}

struct InitOptions {
  std::string deployment, folder, host;
  std::vector<std::string> roles;
  Days days;
};

void Init(const InitOptions& options) {
  launch::Overrides overrides;
  overrides.host = launch::kAllHosts;
  const launch::Deployment deployment = launch::LoadDeployment(options.deployment, overrides);
  fs::path folder = options.folder;
  if (folder.empty()) {
    folder = !deployment.security.empty()
                 ? deployment.security
                 : fs::path(options.deployment).replace_extension(kExtension);
  }
  const std::vector<Member> members =
      MembersOf(deployment, ParseRoles(options.roles),
                options.host.empty() ? node::HostName() : options.host);
  Create(folder, {deployment.name, deployment.domain_id}, members, options.days);
  PrintMembers(members);
  const fs::path beside = fs::absolute(folder).lexically_relative(
      fs::absolute(options.deployment).lexically_normal().parent_path());
  std::cout << "\n"
            << folder.string() << ": " << members.size() << " certificates, domain "
            << deployment.domain_id << "\n";
  if (deployment.security.empty()) {
    std::cout << "in the deployment:  network: {security: "
              << (beside.empty() ? folder : beside).string() << "}\n";
  }
  std::cout << "for commands here:  export SINEW_QOS=" << fs::absolute(folder / "operator").string()
            << "/" << kQos << "\nfor another host:   copy the folder of a name as a whole, and "
            << "nothing else\nkeep away from the robot: " << (folder / "authority").string()
            << ", which makes further certificates (sinew security add)\n";
}

struct AddOptions {
  std::string roles, folder;
  Member member;
  Days days;
};

// The one folder of this kind in the working folder.
fs::path OnlyFolder() {
  std::vector<std::string> found;
  for (const auto& entry : fs::directory_iterator(fs::current_path())) {
    if (entry.is_directory() && entry.path().extension() == kExtension) {
      found.push_back(entry.path().filename().string());
    }
  }
  if (found.size() == 1) return found.front();
  throw UsageError(found.empty()
                       ? "no folder NAME.security here, expected --folder, or first 'sinew "
                         "security init'"
                       : "several folders here, expected --folder with one of: " +
                             types::Joined(found));
}

void AddOne(AddOptions options) {
  options.member.roles = Split(options.roles);
  const fs::path folder = options.folder.empty() ? OnlyFolder() : fs::path(options.folder);
  Add(folder, options.member, options.days);
  std::cout << (folder / options.member.name).string() << ": "
            << types::Joined(options.member.roles) << ", for host " << options.member.host
            << "\nthere:  --qos " << options.member.name << "/" << kQos << ", or SINEW_QOS\n";
}

void CheckFolder(const std::string& given) {
  const Report report = Check(given.empty() ? OnlyFolder() : fs::path(given));
  for (const std::string& note : report.notes) std::cout << "note: " << note << '\n';
  for (const std::string& fault : report.faults) std::cout << "fault: " << fault << '\n';
  if (!report.faults.empty()) throw CLI::RuntimeError(1);
  const std::time_t end = std::chrono::system_clock::to_time_t(report.first_end);
  std::tm fields{};
  ::gmtime_r(&end, &fields);
  char text[16];
  std::strftime(text, sizeof(text), "%Y-%m-%d", &fields);
  std::cout << report.certificates << " certificates, no fault; the first one ends on " << text
            << '\n';
}

void AddDays(CLI::App& command, Days* days) {
  constexpr int kMost = 36500;
  command.add_option("--days", days->certificate, "How long certificates hold")
      ->check(CLI::Range(1, kMost))
      ->capture_default_str();
}

}  // namespace

void AddSecurityCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("security", "Keys and certificates of a deployment: DDS security");
  command->require_subcommand(1);
  command->footer("Roles, by the writers of idl/README.md:\n" + RoleTable() +
                  "\nWhat it protects from: docs/how-to/several-hosts.md\n\nExample:\n"
                  "  sinew security init rig.yaml");

  const auto init = std::make_shared<InitOptions>();
  CLI::App* make = command->add_subcommand(
      "init", "New keys: a certificate for each process, an operator, an observer, a player");
  make->add_option("deployment", init->deployment, "Deployment (schema sinew-deployment/1)")
      ->required()
      ->type_name("FILE.yaml");
  make->add_option("--folder", init->folder,
                   "Where; by default network.security of the deployment, else its name with "
                   ".security");
  make->add_option("--role", init->roles, "Roles of a process whose program is not known")
      ->type_name("PROCESS=ROLE,...")
      ->take_all()
      ->expected(1);
  make->add_option("--host", init->host, "Name of the robot's host, by default of this one");
  AddDays(*make, &init->days);
  make->footer("\nExample:\n  sinew security init rig.yaml");
  make->callback([init] { Init(*init); });

  const auto more = std::make_shared<AddOptions>();
  CLI::App* add = command->add_subcommand("add", "A further certificate");
  add->add_option("role", more->roles, "Its role, or several with commas between them")
      ->required()
      ->type_name("ROLE,...");
  add->add_option("name", more->member.name, "Its name and that of its folder")
      ->required()
      ->type_name("NAME");
  add->add_option("host", more->member.host, "Host that the folder is for")
      ->required()
      ->type_name("HOST");
  add->add_option("--folder", more->folder, "That of 'init'; by default the one *.security here");
  add->add_flag("--other-dds", more->member.other_library,
                "For another DDS implementation, such as Cyclone DDS");
  AddDays(*add, &more->days);
  add->footer("Roles:\n" + RoleTable() +
              "\nExamples:\n  sinew security add observer alice desk\n"
              "  sinew security add provider,reference,esn,control compose robot");
  add->callback([more] { AddOne(*more); });

  const auto folder = std::make_shared<std::string>();
  CLI::App* check = command->add_subcommand(
      "check", "Chain, dates, signatures, roles and file modes, a line for each fault");
  check->add_option("folder", *folder,
                    "That of 'init' or of one certificate; by default the one *.security here");
  check->footer("Exit code 1 with any fault.\n\nExample:\n  sinew security check rig.security");
  check->callback([folder] { CheckFolder(*folder); });
}

}  // namespace sinew::security
