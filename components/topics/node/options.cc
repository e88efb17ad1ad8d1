#include "components/topics/node/options.h"

#include <sched.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "components/base/types/printable.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/log.h"
#include "components/topics/node/realtime.h"
#include "components/topics/node/version.h"

namespace sinew::node {

namespace {

std::atomic<bool> g_stop{false};

// The process of the launcher that has started this one, and sends SIGTERM when it dies: but not to
// a program with capabilities or a user of its own (setcap, set-user-ID). 0: none.
pid_t Launcher() {
  const char* text = std::getenv("SINEW_LAUNCHER");
  const pid_t parent = ::getppid();
  return text != nullptr && std::to_string(parent) == text ? parent : 0;
}
const pid_t kLauncher = Launcher();

extern "C" void OnStopSignal(int) { g_stop.store(true); }

void LogStart(const Options& options) {
  spdlog::info("{} {}, domain {}, {}{}", options.component, kVersion, options.domain_id,
               options.mode == TimeMode::kLockstep ? "lockstep" : "real time",
               options.config_path.empty() ? "" : ", config " + options.config_path.string());
  if (!options.realtime_priority) return;
  const PriorityRule& rule = PriorityOf(options.component);
  if (rule.priority == 0) spdlog::info("--realtime: SCHED_OTHER ({})", rule.reason);
}

// The longest wait at an end for the reader of the log.
constexpr std::chrono::milliseconds kLogAtEnd{500};

}  // namespace

StopFlag::StopFlag() {
  struct sigaction action {};
  action.sa_handler = &OnStopSignal;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::sigaction(SIGQUIT, &action, nullptr);  // Ctrl-\: no core file is worth motors that go on
  // The terminal has gone: an end in order. A process under nohup is to ignore it.
  struct sigaction hang_up {};
  ::sigaction(SIGHUP, nullptr, &hang_up);
  if (hang_up.sa_handler != SIG_IGN) ::sigaction(SIGHUP, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

StopFlag::~StopFlag() { g_stop.store(false); }

bool StopFlag::requested() const noexcept {
  return g_stop.load(std::memory_order_relaxed) || (kLauncher != 0 && ::getppid() != kLauncher);
}
void StopFlag::Request() noexcept { g_stop.store(true); }

void AddOption(CLI::App& app, const std::string& name, std::string* value,
               const std::string& help) {
  app.add_option(name, *value, help);
}

void AddOption(CLI::App& app, const std::string& name, std::filesystem::path* value,
               const std::string& help) {
  app.add_option(name, *value, help);
}

void AddOption(CLI::App& app, const std::string& name, std::vector<std::string>* values,
               const std::string& help) {
  app.add_option(name, *values, help);
}

void AddFlag(CLI::App& app, const std::string& name, bool* value, const std::string& help) {
  app.add_flag(name, *value, help);
}

void AddDomainOptions(CLI::App& app, Options* options) {
  app.add_option("--domain", options->domain_id, "DDS domain, 0 to 232")
      ->envname("SINEW_DOMAIN")
      ->check(CLI::Range(0, 232))
      ->each([options](const std::string& text) { options->chosen_domain = std::stoi(text); });
  app.add_option("--deployment", options->deployment,
                 "Isolated deployment whose network is entered: by default the one that runs in "
                 "the domain; none: the host's network")
      ->envname("SINEW_DEPLOYMENT")
      ->type_name("NAME");
  app.add_option("--interface", options->interfaces,
                 "Network interface to be reached on, beside loopback; may be repeated")
      ->envname("SINEW_INTERFACE")
      ->delimiter(',')
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--qos", options->qos_path,
                 "XML file with QoS profiles instead of the built-in ones, DDS security among them")
      ->envname("SINEW_QOS");
  app.add_option(
         "--key", options->key_path,
         "File with the deployment's key: datagrams without its authentication tag are not read")
      ->envname("SINEW_KEY");
  app.add_option("--open", options->open_interfaces,
                 "Interface where DDS security does instead of the key; may be repeated")
      ->delimiter(',')
      ->type_name("NAME")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  app.add_option("--copies", options->copies,
                 "Times that a datagram is sent to another host: against losses on the way")
      ->envname("SINEW_COPIES")
      ->check(CLI::Range(1, kMostCopies))
      ->capture_default_str();
}

void EnterDeployment(const Options& options) {
  if (const auto holder = isolation::Chosen(options.deployment, options.domain_id)) {
    isolation::Enter(*holder);
  }
}

int RunParticipant(int argc, char** argv, const std::string& component,
                   const std::string& description, const Body& body, const AddOptions& add_options,
                   const OnHost& on_host) {
  StopFlag stop;  // before any thread exists
  Options options;
  options.component = component;
  CLI::App app(description, "sinew-" + component);
  app.set_version_flag("--version", std::string(kVersion));
  app.add_option("--name", options.name, "Name of this instance; the component's name by default");
  AddDomainOptions(app, &options);
  app.add_option("--config", options.config_path, "Configuration file");
  app.add_option("--log-level", options.log_level, "trace, debug, info, warning, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warning", "error", "off"}));
  app.add_option("--seed", options.seed, "Seed of everything random");
  bool lockstep = false;
  auto* lockstep_flag =
      app.add_flag("--lockstep", lockstep, "Simulated time: a tick waits for all replies");
  app.add_flag("--realtime", options.realtime_priority,
               "SCHED_FIFO and locked memory, as the kind of participant asks for")
      ->excludes(lockstep_flag);
  app.add_option("--cpu", options.cpus,
                 "Cores of the threads in real time, by default the last one it may use")
      ->envname("SINEW_CPU")
      ->check(CLI::Range(0, CPU_SETSIZE - 1))
      ->delimiter(',')
      ->type_name("NUMBER")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (add_options) add_options(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& error) {
    std::cerr << "sinew-" << component << ": " << types::Printable(error.what())
              << " (see --help)\n";
    return 2;
  }
  if (options.name.empty()) options.name = component;
  options.mode = lockstep ? TimeMode::kLockstep : TimeMode::kRealtime;
  try {
    if (on_host) on_host(options);
    EnterDeployment(options);
    if (options.realtime_priority) PrepareRealtime(component, options.cpus);
    internal::StartLog(options.name, options.log_level);
    LogStart(options);
    body(options, stop);
    spdlog::info("stopped");
    internal::FlushLog(kLogAtEnd);
    return EXIT_SUCCESS;
  } catch (const UsageError& error) {
    if (internal::FlushLog(kLogAtEnd)) {  // else nobody reads it, and it could not be written
      std::cerr << "sinew-" << component << ": " << types::Printable(error.what()) << '\n';
    }
    return 2;
  } catch (const std::exception& error) {
    spdlog::critical("{}", error.what());
    internal::FlushLog(kLogAtEnd);
    return EXIT_FAILURE;
  }
}

}  // namespace sinew::node
