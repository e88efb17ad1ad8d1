#include "tools/launch/deployment.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>

#include "components/base/config/config.h"
#include "components/topics/isolation/isolation.h"
#include "tools/launch/deployment_files.h"
#include "tools/roles/roles.h"

namespace sinew::launch {

namespace {

namespace fs = std::filesystem;

constexpr int kLargestDomain = 232;  // ports of the RTPS mapping end there
constexpr int kMostCopies = 4;       // as --copies takes
constexpr double kLongestGrace_s = 600.0;
constexpr char kProgressTopic[] = "recording_progress";
// The profiles of a certificate (tools/security).
constexpr char kQosOfCertificate[] = "qos.xml";
constexpr int kRecordingWindow = 64;  // ticks a logger may lag; half of what a reader keeps
const std::vector<std::string> kRestartWords = {"never", "on_failure", "always"};

// Data that the file alone lacks: where programs are, and of which host the processes start.
struct Place {
  fs::path folder;
  std::string chosen_host;
  const Host* here = nullptr;  // nullptr: of all
};

bool IsLogger(const Process& process) { return process.program.filename() == "sinew-logger"; }
// Nothing that moves depends on what it publishes.
bool IsObserver(const Process& process) {
  const std::filesystem::path program = process.program.filename();
  return IsLogger(process) || program == "sinew-residual" || program == "sinew-performance" ||
         program == "sinew-view";
}

Restart RestartFromWord(const std::string& word) {
  return static_cast<Restart>(std::find(kRestartWords.begin(), kRestartWords.end(), word) -
                              kRestartWords.begin());
}

bool IsName(const std::string& name) {
  return !name.empty() && name.size() <= 64 &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
}

void DescribeInterfaces(config::Fields& f, const char* key, std::vector<std::string>& names,
                        const char* help) {
  f(key, names, help);
  const std::string unknown = UnknownInterface(names);
  if (!unknown.empty()) {
    f.Fail(key,
           "no interface '" + unknown + "', expected names of this machine's: " + InterfaceNames());
  }
}

// ADDRESS:PORT of a discovery server of Fast DDS.
void CheckDiscoveryServer(const config::Fields& network, const Deployment& deployment) {
  const std::string& text = deployment.discovery_server;
  const char* key = "discovery_server";
  if (text.empty()) return;
  const std::size_t colon = text.find(':');
  in_addr address{};
  int port = 0;
  const char* end = text.data() + text.size();
  const bool good =
      colon != std::string::npos &&
      ::inet_pton(AF_INET, text.substr(0, colon).c_str(), &address) == 1 &&
      std::from_chars(text.data() + colon + 1, end, port) == std::from_chars_result{end, {}} &&
      port > 0 && port < 65536;
  if (!good) network.Fail(key, "'" + text + "', expected an IPv4 address and a port, ADDRESS:PORT");
  if (!deployment.key.empty()) {
    network.Fail(key, "its datagrams carry no authentication tag, expected no 'key' beside it");
  }
}

// The host that the process names, by default the first one: the file means the same everywhere.
void DescribeHost(config::Fields& f, const std::vector<Host>& hosts, std::string& host) {
  std::optional<std::string> given;
  f("host", given, "of `hosts`; left out: the first");
  if (given && hosts.empty()) f.Fail("host", "expected 'hosts' in this file");
  if (hosts.empty()) return;
  std::vector<std::string> names;
  names.reserve(hosts.size());
  for (const Host& one : hosts) names.push_back(one.name);
  host = given ? f.section().Choice("host", names) : names.front();
}

// Programs and files of other hosts are looked for there.
void DescribeFiles(config::Fields& f, const fs::path& folder, bool here, Process* process) {
  std::string program, config;
  f.Need("program", program, "by its name, or a path relative to this file");
  f("config", config, "its configuration, relative to this file");
  if (!f.reads()) return;
  const fs::path base = f.section().file().parent_path();
  process->program = here ? FindProgram(program, base, folder) : fs::path(program);
  if (process->program.empty()) f.Fail("program", NoProgram(program, folder));
  if (config.empty()) return;
  process->config = fs::absolute(here ? f.section().ExistingPath("config") : base / config);
}

void DescribeProcess(config::Fields& f, const Place& place, const Deployment& deployment,
                     Process* c) {
  std::optional<bool> vital, stop_last;
  std::optional<Restart> restart;
  f.Need("name", c->name, "letters, digits, '_' or '-'");
  if (f.reads() && !IsName(c->name)) {
    f.Fail("name", "'" + c->name + "', expected letters, digits, '_' or '-'");
  }
  c->certificate = c->name;
  DescribeHost(f, deployment.hosts, c->host);
  DescribeFiles(f, place.folder, place.here == nullptr || c->host == place.here->name, c);
  f("arguments", c->arguments, "of its command line");
  f("after", c->after, "starts when these are ready");
  f("ready_when", c->ready_when, "with the first line that holds this; left out: any line");
  f("vital", vital, "its failure ends the others; left out: yes, but of observers");
  c->vital = vital.value_or(!IsObserver(*c));
  f.Word("restart", restart,
         {{"never", Restart::kNever},
          {"on_failure", Restart::kOnFailure},
          {"always", Restart::kAlways}},
         "left out: never if vital or in lockstep, else on_failure");
  c->restart =
      restart.value_or(c->vital || deployment.lockstep ? Restart::kNever : Restart::kOnFailure);
  f("max_restarts", c->max_restarts, {0, 1000}, "then it is given up");
  f("back_off_s", c->back_off_s, {0.0, 600.0}, "before a restart, doubled at each");
  f("plain", c->plain, "a foreign program: no common options");
  f("stop_last", stop_last, "left out: loggers do");
  c->stop_last = stop_last.value_or(IsLogger(*c));
}

void DescribeNetwork(config::Fields& f, const Place& place, std::vector<std::string>& moved,
                     Deployment* c) {
  std::optional<fs::path> qos, key;
  std::optional<std::string> security;
  std::optional<int> copies;
  DescribeInterfaces(f, "interfaces", c->interfaces, "beside loopback");
  f("qos", qos, "QoS profiles of all processes");
  f("security", security, "folder with a certificate for each (sinew security)");
  f("key", key, "of the datagrams");
  DescribeInterfaces(f, "open", c->open, "where DDS security does instead of the key");
  f("copies", copies, {1, kMostCopies}, "of a datagram to another host; left out: 2");
  f("isolate", c->isolated, "in a network of its own");
  f("discovery_server", c->discovery_server, "ADDRESS:PORT, in place of multicast");
  DescribeInterfaces(f, "move", moved, "what moves into the network of its own");
  c->copies = copies.value_or(0);
  if (!c->hosts.empty() && (!c->interfaces.empty() || !c->open.empty())) {
    f.Fail(c->interfaces.empty() ? "open" : "interfaces",
           "each of the 'hosts' names its own interface, expected none here");
  }
  if (qos && security) {
    f.Fail("qos",
           "given with 'security', whose certificates have profiles of their own, expected one of "
           "them");
  }
  if (place.here != nullptr) c->interfaces = {place.here->interface};
  if (qos) c->qos = fs::absolute(*qos);
  if (key) c->key = fs::absolute(*key);
  if (security) c->security = fs::absolute(c->file).parent_path() / *security;
  CheckDiscoveryServer(f, *c);
}

void Describe(config::Fields& f, Deployment& c, Place* place, std::vector<std::string>& moved) {
  f("name", c.name, "left out: that of the file");
  f("domain_id", c.domain_id, {0, kLargestDomain}, "of DDS");
  DescribeHosts(f, &c.hosts);
  if (f.reads()) place->here = HostHere(c.hosts, c.file, place->chosen_host);
  if (place->here != nullptr) c.host = place->here->name;
  f.Object("network", "which hosts may be heard",
           [&](config::Fields& g) { DescribeNetwork(g, *place, moved, &c); });
  f.Word("mode", c.lockstep, {{"realtime", false}, {"lockstep", true}}, "of time");
  f("duration_s", c.duration_s, config::kNotNegative, "of the session; 0: until stopped");
  f("seed", c.seed, config::kNotNegative, "of all that is drawn");
  f("provider", c.provider, "name of the process that provides the state");
  f("await", c.await, "lockstep: replies that end a tick, TOPIC or TOPIC:WINDOW");
  f("realtime_priority", c.realtime_priority, "of the processes");
  f("grace_s", c.grace_s, {0.0, kLongestGrace_s}, "until a process that does not stop is killed");
  f.NeedList("processes", {1}, "in the order of their start", [&](config::Fields& g) {
    Process process;
    DescribeProcess(g, *place, c, &process);
    g.Require(c.Find(process.name) == nullptr, "name",
              "'" + process.name + "' given twice, expected a name of its own");
    c.processes.push_back(std::move(process));
  });
}

// A circle in `after` would never start.
void CheckOrder(const std::vector<config::Section>& sections, const std::vector<Process>& list) {
  std::set<std::string> startable;
  for (bool progress = true; progress;) {
    progress = false;
    for (const Process& process : list) {
      if (startable.contains(process.name)) continue;
      if (std::all_of(process.after.begin(), process.after.end(),
                      [&](const std::string& name) { return startable.contains(name); })) {
        startable.insert(process.name);
        progress = true;
      }
    }
  }
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!startable.contains(list[i].name)) {
      sections[i].Fail("after", "waits for itself in a circle, expected an order of starting");
    }
  }
}

[[noreturn]] void FailOption(const std::string& option, const std::string& text,
                             const std::string& expected) {
  throw UsageError(option + " " + text + ": expected " + expected);
}

double ParseNumber(const std::string& setting, const std::string& text, double lower,
                   double upper) {
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !(value >= lower) ||
      !(value <= upper)) {
    std::ostringstream expected;
    expected << "a number from " << lower << " to " << upper;
    FailOption("--set", setting, expected.str());
  }
  return value;
}

std::uint64_t ParseWhole(const std::string& setting, const std::string& text, std::uint64_t upper) {
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || value > upper) {
    FailOption("--set", setting, "a whole number from 0 to " + std::to_string(upper));
  }
  return value;
}

Process* FindMutable(Deployment* deployment, const std::string& name, const std::string& option,
                     const std::string& text) {
  std::string names;
  for (Process& process : deployment->processes) {
    if (process.name == name) return &process;
    names += (names.empty() ? "" : ", ") + process.name;
  }
  const std::string here = deployment->host.empty() ? "" : " on host " + deployment->host;
  FailOption(option, text, "a process of " + deployment->file.string() + here + ": " + names);
}

void ApplyToProcess(const std::string& setting, const std::string& process_name,
                    const std::string& key, const std::string& value, const fs::path& folder,
                    Deployment* deployment) {
  Process* process = FindMutable(deployment, process_name, "--set", setting);
  if (key == "config") {
    std::error_code error;
    if (!fs::is_regular_file(value, error)) FailOption("--set", setting, "an existing file");
    process->config = fs::absolute(value);
  } else if (key == "program") {
    process->program = FindProgram(value, fs::current_path(), folder);
    if (process->program.empty()) {
      throw UsageError("--set " + setting + ": " + NoProgram(value, folder));
    }
  } else if (key == "restart") {
    if (std::find(kRestartWords.begin(), kRestartWords.end(), value) == kRestartWords.end()) {
      FailOption("--set", setting, "never, on_failure or always");
    }
    process->restart = RestartFromWord(value);
  } else {
    FailOption("--set", setting, "PROCESS.config, PROCESS.program or PROCESS.restart");
  }
}

// For what the provider is given, and it alone.
void RequireProvider(const std::string& option, const std::string& text,
                     const Deployment& deployment) {
  if (!deployment.provider_elsewhere()) return;
  FailOption(option, text, "it where the provider '" + deployment.provider + "' runs");
}

void ApplySetting(const std::string& setting, const fs::path& folder, Deployment* deployment) {
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) FailOption("--set", setting, "KEY=VALUE");
  const std::string key = setting.substr(0, equals);
  const std::string value = setting.substr(equals + 1);
  if (const std::size_t dot = key.rfind('.'); dot != std::string::npos) {
    ApplyToProcess(setting, key.substr(0, dot), key.substr(dot + 1), value, folder, deployment);
  } else if (key == "mode") {
    if (value != "realtime" && value != "lockstep") {
      FailOption("--set", setting, "realtime or lockstep");
    }
    deployment->lockstep = value == "lockstep";
  } else if (key == "duration_s") {
    RequireProvider("--set", setting, *deployment);
    deployment->duration_s = ParseNumber(setting, value, 0.0, 1e9);
  } else if (key == "grace_s") {
    deployment->grace_s = ParseNumber(setting, value, 0.0, kLongestGrace_s);
  } else if (key == "seed") {
    deployment->seed = ParseWhole(setting, value, ~std::uint64_t{0});
  } else if (key == "domain_id") {
    deployment->domain_id = static_cast<int>(ParseWhole(setting, value, kLargestDomain));
  } else if (key == "interfaces") {
    deployment->interfaces.clear();
    std::istringstream names(value);
    for (std::string name; std::getline(names, name, ',');) deployment->interfaces.push_back(name);
    if (!UnknownInterface(deployment->interfaces).empty()) {
      FailOption("--set", setting, "names of this machine's interfaces: " + InterfaceNames());
    }
  } else if (key == "realtime_priority") {
    if (value != "true" && value != "false") FailOption("--set", setting, "true or false");
    deployment->realtime_priority = value == "true";
  } else {
    FailOption("--set", setting,
               "one of mode, duration_s, seed, domain_id, interfaces, realtime_priority, grace_s, "
               "PROCESS.config, PROCESS.program, PROCESS.restart");
  }
}

// Replies that only this program wrote end no tick any more. A program that is not ours may write
// anything.
void LeaveUnawaited(const std::string& program, Deployment* deployment) {
  const auto role_of = [](const std::string& path) {
    return security::RoleOfProgram(fs::path(path).filename().string());
  };
  std::vector<std::string> others;
  for (const auto* list : {&deployment->processes, &deployment->elsewhere}) {
    for (const Process& process : *list) {
      others.push_back(role_of(process.program));
      if (others.back().empty()) return;
    }
  }
  const std::string role = role_of(program);
  if (role.empty()) return;
  const std::vector<std::string> written = security::TopicsWrittenBy({role}),
                                 still_written = security::TopicsWrittenBy(others);
  std::erase_if(deployment->await, [&](const std::string& reply) {
    const std::string topic = reply.substr(0, reply.find(':'));
    return std::ranges::binary_search(written, topic) &&
           !std::ranges::binary_search(still_written, topic);
  });
}

void RemoveProcess(const std::string& name, Deployment* deployment) {
  const std::string program = FindMutable(deployment, name, "--without", name)->program;
  if (name == deployment->provider) {
    FailOption("--without", name, "another process: this one is the provider");
  }
  auto& list = deployment->processes;
  list.erase(std::remove_if(list.begin(), list.end(),
                            [&](const Process& process) { return process.name == name; }),
             list.end());
  for (Process& process : list) {
    process.after.erase(std::remove(process.after.begin(), process.after.end(), name),
                        process.after.end());
  }
  LeaveUnawaited(program, deployment);
}

// Programs that sinew-compose can run (tools/compose/chain.cc).
std::vector<std::string> WhatComposes(const Deployment& deployment) {
  static const std::set<std::string> kPrograms = {"sinew-reference",  "sinew-regime",
                                                  "sinew-esn",        "sinew-control",
                                                  "sinew-pneumatics", "sinew-rls"};
  std::vector<std::string> names;
  for (const Process& process : deployment.processes) {
    if (kPrograms.contains(process.program.filename().string()) && process.arguments.empty()) {
      names.push_back(process.name);
    }
  }
  return names;
}

// The provider's process becomes a sinew-compose that runs the others in its thread.
void Compose(const std::vector<std::string>& names, const fs::path& program_folder,
             Deployment* deployment) {
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ",") + name;
  if (deployment->lockstep) {
    FailOption("--compose", list, "mode realtime: lockstep has no use for it");
  }
  if (deployment->provider.empty()) FailOption("--compose", list, "a deployment with a provider");
  RequireProvider("--compose", list, *deployment);
  Process composed = *deployment->Find(deployment->provider);
  composed.certificate = "compose";  // with the roles of all of them
  composed.arguments.insert(composed.arguments.begin(),
                            {"--provider", composed.program.filename().string()});
  for (const std::string& name : names) {
    const Process* process = FindMutable(deployment, name, "--compose", list);
    if (name == deployment->provider) continue;
    if (!process->arguments.empty() || process->plain) {
      FailOption("--compose", list, "processes without arguments; '" + name + "' has some");
    }
    composed.arguments.push_back("--component");
    composed.arguments.push_back(name + "=" + process->program.filename().string() + "=" +
                                 process->config.string());
  }
  composed.program = FindProgram("sinew-compose", fs::current_path(), program_folder);
  if (composed.program.empty())
    FailOption("--compose", list, NoProgram("sinew-compose", program_folder));
  for (const std::string& name : names) {
    if (name != deployment->provider) RemoveProcess(name, deployment);
  }
  *FindMutable(deployment, deployment->provider, "--compose", list) = std::move(composed);
}

// The logger of the deployment writes to `path`; one is added when there is none.
void Record(const fs::path& path, const fs::path& folder, Deployment* deployment) {
  const std::string output = fs::absolute(path).lexically_normal().string();
  // In lockstep the provider waits for the loggers that it knows of.
  if (deployment->lockstep) RequireProvider("--record", path.string(), *deployment);
  for (Process& process : deployment->processes) {
    if (!IsLogger(process)) continue;
    auto& arguments = process.arguments;
    const auto at = std::find(arguments.begin(), arguments.end(), "--out");
    if (at != arguments.end() && at + 1 != arguments.end()) {
      *(at + 1) = output;
    } else {
      arguments.insert(arguments.end(), {"--out", output});
    }
    return;
  }
  Process logger;
  logger.name = "logger";
  for (const Process& other : deployment->elsewhere) {
    if (other.name == logger.name) logger.name += "_" + deployment->host;
  }
  logger.certificate = "logger";
  logger.program = FindProgram("sinew-logger", fs::current_path(), folder);
  if (logger.program.empty()) throw UsageError("--record: " + NoProgram("sinew-logger", folder));
  logger.arguments = {"--out", output};
  logger.stop_last = true;
  logger.vital = false;
  logger.restart = deployment->lockstep ? Restart::kNever : Restart::kOnFailure;
  deployment->processes.push_back(logger);
}

void Overwrite(Deployment* deployment) {
  bool any = false;
  for (Process& process : deployment->processes) {
    if (!IsLogger(process)) continue;
    any = true;
    auto& arguments = process.arguments;
    if (std::find(arguments.begin(), arguments.end(), "--overwrite") == arguments.end()) {
      arguments.push_back("--overwrite");
    }
  }
  if (!any) throw UsageError("--overwrite: no logger in the deployment, expected --record FILE");
}

// The holder of the network is the first to start and among the last to stop.
void Isolate(const config::Section& network, const std::vector<std::string>& moved,
             const fs::path& folder, Deployment* deployment) {
  for (const std::string& name : deployment->interfaces) {
    if (std::find(moved.begin(), moved.end(), name) != moved.end()) continue;
    network.Fail("move", "without '" + name +
                             "', expected it: an isolated deployment is reached on "
                             "what moves in alone, such as a tunnel to its other hosts");
  }
  Process holder;
  holder.name = "network";
  holder.program = FindProgram("sinew", fs::current_path(), folder);
  if (holder.program.empty()) throw UsageError("isolate: " + NoProgram("sinew", folder));
  holder.arguments = isolation::HolderArguments(deployment->name, deployment->domain_id, moved);
  holder.plain = holder.stop_last = true;
  holder.ready_when = deployment->name;
  if (deployment->Find(holder.name) != nullptr) {
    throw UsageError(deployment->file.string() + ": the name '" + holder.name +
                     "' is of the holder of an isolated deployment's network, expected another");
  }
  for (Process& process : deployment->processes) {
    // Programs of our own enter by themselves.
    if (process.plain) {
      std::vector<std::string> line = {"enter", deployment->name, process.program.string()};
      line.insert(line.end(), process.arguments.begin(), process.arguments.end());
      process.arguments = std::move(line);
      process.program = holder.program;
    }
    process.after.push_back(holder.name);
  }
  deployment->processes.insert(deployment->processes.begin(), std::move(holder));
}

std::string NumberText(double value) {
  std::ostringstream out;
  out.precision(15);
  out << value;
  return out.str();
}

// In lockstep the provider waits for what the deployment declares, and for its loggers.
void AddProviderOptions(const Deployment& deployment, std::vector<std::string>* line) {
  if (deployment.duration_s > 0.0) {
    line->insert(line->end(), {"--duration", NumberText(deployment.duration_s)});
  }
  if (!deployment.lockstep) return;
  std::string await;
  for (const std::string& topic : deployment.await) await += (await.empty() ? "" : ",") + topic;
  const bool named = await.find(kProgressTopic) != std::string::npos;
  const bool recorded =
      std::any_of(deployment.processes.begin(), deployment.processes.end(), IsLogger) ||
      std::any_of(deployment.elsewhere.begin(), deployment.elsewhere.end(), IsLogger);
  if (!named && recorded) {
    await += (await.empty() ? "" : ",") + std::string(kProgressTopic) + ":" +
             std::to_string(kRecordingWindow);
  }
  if (!await.empty()) line->insert(line->end(), {"--await", await});
}

// Named also when it is loopback alone, so that SINEW_INTERFACE of a shell opens no robot.
void AddNetwork(const Deployment& deployment, const Process& process,
                std::vector<std::string>* line) {
  for (const std::string& name : deployment.interfaces) {
    line->insert(line->end(), {"--interface", name});
  }
  if (deployment.interfaces.empty()) line->insert(line->end(), {"--interface", "lo"});
  const fs::path qos = QosOf(deployment, process.certificate);
  if (!qos.empty()) line->insert(line->end(), {"--qos", qos.string()});
  if (!deployment.key.empty()) line->insert(line->end(), {"--key", deployment.key.string()});
  for (const std::string& name : deployment.open) line->insert(line->end(), {"--open", name});
  if (deployment.copies > 0) {
    line->insert(line->end(), {"--copies", std::to_string(deployment.copies)});
  }
}

}  // namespace

const Process* Deployment::Find(const std::string& process_name) const {
  for (const Process& process : processes) {
    if (process.name == process_name) return &process;
  }
  return nullptr;
}

bool Deployment::provider_elsewhere() const {
  return std::any_of(elsewhere.begin(), elsewhere.end(),
                     [this](const Process& process) { return process.name == provider; });
}

void Describe(config::Fields& f, Deployment& deployment) {
  Place place;
  std::vector<std::string> moved;
  Describe(f, deployment, &place, moved);
}

Deployment LoadDeployment(const fs::path& file, const Overrides& overrides,
                          const fs::path& program_folder) {
  const config::Section root = config::Section::Load(file, kSchema);
  Deployment deployment;
  deployment.file = file;
  deployment.name = file.stem().string();
  Place place{.folder = program_folder, .chosen_host = overrides.host};
  std::vector<std::string> moved;
  config::Fields fields(root);
  Describe(fields, deployment, &place, moved);
  root.RejectUnknownKeys();
  const Host* here = place.here;
  const config::Section network = root.ChildOrEmpty("network");
  const std::vector<config::Section> sections = root.List("processes");
  if (!deployment.provider.empty() && deployment.Find(deployment.provider) == nullptr) {
    root.Fail("provider", "'" + deployment.provider + "', expected the name of a process");
  }
  for (std::size_t i = 0; i < sections.size(); ++i) {
    for (const std::string& name : deployment.processes[i].after) {
      if (deployment.Find(name) == nullptr) {
        sections[i].Fail("after", "'" + name + "', expected the name of a process");
      }
      if (deployment.Find(name)->host != deployment.processes[i].host) {
        sections[i].Fail("after", "'" + name + "' is of another host, expected one of host '" +
                                      deployment.processes[i].host +
                                      "': participants wait for those elsewhere by themselves");
      }
    }
  }
  CheckOrder(sections, deployment.processes);
  const Process* provider = deployment.Find(deployment.provider);
  if (provider != nullptr && !provider->vital) {
    throw UsageError(file.string() + ": provider: '" + provider->name +
                     "' has vital: false, expected true");
  }
  if (here != nullptr) {
    const auto first = std::stable_partition(
        deployment.processes.begin(), deployment.processes.end(),
        [here](const Process& process) { return process.host == here->name; });
    deployment.elsewhere.assign(first, deployment.processes.end());
    deployment.processes.erase(first, deployment.processes.end());
  }

  for (const std::string& name : overrides.without) RemoveProcess(name, &deployment);
  for (const std::string& setting : overrides.settings) {
    ApplySetting(setting, program_folder, &deployment);
  }
  if (!overrides.record.empty()) Record(overrides.record, program_folder, &deployment);
  if (overrides.overwrite) Overwrite(&deployment);
  std::vector<std::string> composed = overrides.compose;
  if (overrides.compose_all) composed = WhatComposes(deployment);
  if (overrides.compose_all || !composed.empty()) Compose(composed, program_folder, &deployment);
  deployment.isolated = deployment.isolated || overrides.isolate;
  if (deployment.isolated) Isolate(network, moved, program_folder, &deployment);
  for (const std::string& text : overrides.arguments) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      FailOption("--arg", text, "PROCESS=ARGUMENT");
    }
    FindMutable(&deployment, text.substr(0, equals), "--arg", text)
        ->arguments.push_back(text.substr(equals + 1));
  }
  for (Process& process : deployment.processes) {
    // In lockstep the provider waits for observers too.
    process.vital = process.vital || deployment.lockstep;
  }
  if (deployment.processes.empty()) {
    throw UsageError(file.string() + ": processes: none is of host '" + deployment.host +
                     "', expected 'host: " + deployment.host + "' at one, or --record");
  }
  if (std::any_of(deployment.processes.begin(), deployment.processes.end(), IsLogger)) {
    for (const DeploymentFile& attached : FilesOf(deployment)) {
      deployment.attachments.push_back(attached.name + "=" + attached.path.string());
    }
  }
  return deployment;
}

fs::path QosOf(const Deployment& deployment, const std::string& certificate) {
  if (deployment.security.empty()) return deployment.qos;
  return deployment.security / certificate / kQosOfCertificate;
}

void CheckCertificates(const Deployment& deployment) {
  if (deployment.security.empty()) return;
  for (const Process& process : deployment.processes) {
    const fs::path qos = QosOf(deployment, process.certificate);
    std::error_code error;
    if (process.plain || fs::is_regular_file(qos, error)) continue;
    throw UsageError(qos.string() + ": no certificate of process '" + process.name +
                     "', expected one of 'sinew security init' or 'sinew security add ROLE " +
                     process.certificate + " HOST'");
  }
}

std::vector<std::string> CommandLine(const Deployment& deployment, const Process& process,
                                     int restarts) {
  std::vector<std::string> line{process.program.string()};
  if (!process.plain) {
    line.insert(line.end(),
                {"--name", process.name, "--domain", std::to_string(deployment.domain_id), "--seed",
                 std::to_string(deployment.seed)});
    AddNetwork(deployment, process, &line);
    if (deployment.lockstep) line.push_back("--lockstep");
    if (deployment.realtime_priority) line.push_back("--realtime");
    if (!process.config.empty()) line.insert(line.end(), {"--config", process.config.string()});
    if (process.name == deployment.provider) AddProviderOptions(deployment, &line);
    if (IsLogger(process)) {
      line.insert(line.end(), {"--note", "deployment=" + deployment.name});
      for (const std::string& file : deployment.attachments) {
        line.insert(line.end(), {"--attach", file});
      }
    }
  }
  line.insert(line.end(), process.arguments.begin(), process.arguments.end());
  if (IsLogger(process) && restarts > 0) {
    const auto out = std::find(line.begin(), line.end(), "--out");
    if (out != line.end() && out + 1 != line.end()) {
      const fs::path first = *(out + 1);
      const std::string name = first.stem().string() + "-" + std::to_string(restarts + 1);
      *(out + 1) = (first.parent_path() / (name + first.extension().string())).string();
    }
  }
  return line;
}

}  // namespace sinew::launch
