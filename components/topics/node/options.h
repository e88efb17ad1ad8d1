// Options that every participant shares, and the frame of its main().
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/config.h"

namespace CLI {
class App;
}

namespace sinew::node {

class Composition;

enum class TimeMode { kRealtime, kLockstep };

struct Options {
  std::string component;                // kind of participant, e.g. "regime"
  std::string name;                     // of this instance; the component's name unless --name
  std::string role;                     // what it can be handed over as; the component unless set
  int domain_id = 0;                    // --domain or SINEW_DOMAIN
  std::vector<std::string> interfaces;  // --interface or SINEW_INTERFACE; none: loopback alone
  std::filesystem::path config_path;    // --config; may be empty
  std::string log_level = "info";       // --log-level
  TimeMode mode = TimeMode::kRealtime;  // --lockstep
  bool realtime_priority = false;       // --realtime: realtime.h
  std::vector<int> cpus;                // --cpu or SINEW_CPU: of --realtime; none: DefaultCpu
  std::uint64_t seed = 1;               // --seed
  std::filesystem::path qos_path;       // --qos: XML profiles instead of the built-in ones
  std::string deployment = {};          // --deployment or SINEW_DEPLOYMENT: isolation.h
  std::filesystem::path key_path = {};  // --key or SINEW_KEY: of the deployment; empty: none
  // --open: where a participant without the key may join by DDS security.
  std::vector<std::string> open_interfaces = {};
  int copies = 2;  // --copies or SINEW_COPIES: of a datagram to another host, against losses
  // The other nodes of this thread, where there are some: composition.h. Outlives the nodes.
  Composition* composition = nullptr;
  std::optional<int> chosen_domain = {};  // domain_id, where --domain or SINEW_DOMAIN gives it
};

inline constexpr int kMostCopies = 4;

// The participant that one can stand in for.
inline const std::string& RoleOf(const Options& options) {
  return options.role.empty() ? options.component : options.role;
}

// Set by SIGINT and SIGTERM, and when the launcher that has started this process dies. Make it
// before any thread exists, one at a time: what was requested ends with it.
class StopFlag {
 public:
  StopFlag();
  ~StopFlag();
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;
  bool requested() const noexcept;
  void Request() noexcept;
};

// --domain, --deployment, --interface, --qos, --key, --open and --copies, of every program that
// joins a DDS domain.
void AddDomainOptions(CLI::App& app, Options* options);

// Into the network of the chosen deployment, where one is isolated. Before any thread exists.
void EnterDeployment(const Options& options);

// Adds a participant's own options to the common ones; called before parsing.
using AddOptions = std::function<void(CLI::App&)>;
// Opens what a participant needs of the host's own network, after parsing.
using OnHost = std::function<void(const Options&)>;
using Body = std::function<void(const Options&, StopFlag&)>;

// Adds an option without CLI11's header, whose inline code every program would compile again.
void AddOption(CLI::App& app, const std::string& name, std::string* value, const std::string& help);
void AddOption(CLI::App& app, const std::string& name, std::filesystem::path* value,
               const std::string& help);
void AddOption(CLI::App& app, const std::string& name, std::vector<std::string>* values,
               const std::string& help);  // may be repeated
void AddFlag(CLI::App& app, const std::string& name, bool* value, const std::string& help);

// Parses, enters the deployment, starts the log, runs the body, logs the end. Exit code: 0, 2 for
// UsageError (one line on stderr), 1 for any other exception.
int RunParticipant(int argc, char** argv, const std::string& component,
                   const std::string& description, const Body& body,
                   const AddOptions& add_options = {}, const OnHost& on_host = {});

}  // namespace sinew::node
