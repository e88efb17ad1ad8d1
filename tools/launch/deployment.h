// The contents of a deployment file, and its command lines.
//
// Files: schema sinew-deployment/1, keys in README.md. Set-up only; throws UsageError with one
// line.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/launch/find_program.h"
#include "tools/launch/hosts.h"

namespace sinew::launch {

enum class Restart { kNever, kOnFailure, kAlways };

struct Process {
  std::string name;
  std::string host;               // of the deployment's hosts; empty: it is of one
  std::filesystem::path program;  // absolute; of another host as the file names it
  std::vector<std::string> arguments;
  std::filesystem::path config;    // empty: none
  std::vector<std::string> after;  // starts when these are ready
  std::string ready_when;          // ready with the first output line holding this; empty: any line
  Restart restart = Restart::kNever;
  int max_restarts = 3;
  double back_off_s = 0.5;  // doubled at each restart
  bool plain = false;       // a foreign program: no common options
  bool stop_last = false;
  bool vital = true;        // false: its failure is reported, and the others go on
  std::string certificate;  // its folder in Deployment::security; by default its name
};

struct Deployment {
  std::filesystem::path file;
  std::string name;
  int domain_id = 0;
  bool isolated = false;                // in a network of its own: isolation.h
  std::vector<std::string> interfaces;  // beside loopback; empty: nobody on a network is heard
  std::filesystem::path qos;            // QoS profiles of all its processes; empty: SINEW_QOS
  std::filesystem::path security;       // folder with a certificate for each; empty: none
  std::filesystem::path key;            // of their datagrams; empty: SINEW_KEY
  std::vector<std::string> open;        // where DDS security does instead of the key
  int copies = 0;                       // of a datagram to another host; 0: SINEW_COPIES
  std::string discovery_server;         // ADDRESS:PORT; empty: they find each other by multicast
  bool lockstep = false;
  double duration_s = 0.0;  // 0: until stopped
  std::uint64_t seed = 1;
  std::string provider;            // name of a process; empty: none
  std::vector<std::string> await;  // lockstep: replies that end a tick, TOPIC or TOPIC:WINDOW
  bool realtime_priority = false;
  double grace_s = 3.0;
  std::vector<Host> hosts;               // empty: of one host
  std::string host;                      // the one that is started here; empty: all that there are
  std::vector<Process> processes;        // of this host
  std::vector<Process> elsewhere;        // of the others, which start them
  std::vector<std::string> attachments;  // NAME=FILE: what its loggers attach to recordings

  const Process* Find(const std::string& process_name) const;  // nullptr: no such process here
  bool provider_elsewhere() const;
};

// Changes by a user on the command line without editing the file.
struct Overrides {
  // KEY=VALUE with KEY one of mode, duration_s, seed, domain_id, interfaces (NAME,NAME),
  // realtime_priority, grace_s or PROCESS.config, PROCESS.program, PROCESS.restart (paths relative
  // to the working folder).
  std::vector<std::string> settings;
  std::vector<std::string> arguments;  // PROCESS=ARGUMENT, added to the process
  std::vector<std::string> without;    // names of processes left out
  std::vector<std::string> compose;    // names of processes that run in the provider's thread
  bool compose_all = false;            // all that can
  // Host whose part is started: its name, kAllHosts, or empty: by this machine's name.
  std::string host;
  bool isolate = false;          // in a network of its own
  std::filesystem::path record;  // non-empty: the logger writes here; added if there is none
  bool overwrite = false;        // loggers replace files that are there
};

inline constexpr char kSchema[] = "sinew-deployment/1";
void Describe(config::Fields& fields, Deployment& deployment);

// `program_folder`: where programs named without a slash are looked for before PATH. Throws
// UsageError for anything wrong in the file or the overrides.
Deployment LoadDeployment(const std::filesystem::path& file, const Overrides& overrides = {},
                          const std::filesystem::path& program_folder = ProgramFolder());

// The file of QoS profiles of a process with this certificate; empty: that of SINEW_QOS, or none.
std::filesystem::path QosOf(const Deployment& deployment, const std::string& certificate);

// Every process has its certificate, where the deployment has them. Throws UsageError.
void CheckCertificates(const Deployment& deployment);

// Program and arguments, ready for exec. A logger that is started again writes beside its first
// file: run.mcap, run-2.mcap, run-3.mcap.
std::vector<std::string> CommandLine(const Deployment& deployment, const Process& process,
                                     int restarts = 0);

}  // namespace sinew::launch
