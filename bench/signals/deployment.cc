#include "bench/signals/deployment.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "bench/signals/bus_watch.h"
#include "tests/support/edited_config.h"

namespace sinew::signals {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Program;

const std::string kRig = SINEW_SOURCE_DIR "/robots/rig/";
const std::string kBin = SINEW_BIN_DIR "/";
constexpr std::size_t kLogEnd = 4000;  // characters that are worth showing

std::string ProcessText(const std::string& name, const std::string& program,
                        const std::string& config, bool vital = false) {
  const std::string restarts =
      vital ? "" : ", vital: false, restart: on_failure, max_restarts: 1000, back_off_s: 0.2";
  return "  - {name: " + name + ", program: " + program + ", config: " + config + restarts + "}\n";
}

// Arguments of a process, as its command line says them.
std::vector<std::string> CommandLine(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/cmdline");
  std::vector<std::string> words;
  std::string word;
  while (std::getline(file, word, '\0')) words.push_back(word);
  return words;
}

std::string NameOf(pid_t pid) {
  const std::vector<std::string> words = CommandLine(pid);
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == "--name") return words[i + 1];
  }
  return "";
}

}  // namespace

Deployment::Deployment(int domain, bool realtime)
    : domain_(domain), bus_path_((folder_.path() / "bus").string()) {
  StartOrdinaryProcesses();
  std::filesystem::copy_file(kRig + "surrogate.yaml", folder_.path() / "surrogate.yaml");
  const std::string axes =
      folder_.Write("virtual_axes.yaml", testing::RigConfigOnBus("virtual_axes.yaml", bus_path_));
  // A link whose motor is idle comes to its end stops, and back from there fast: neither faults nor
  // limits then, so that the setpoints are those that were commanded.
  const std::string bridge = folder_.Write(
      "can_bridge.yaml", testing::RigConfigOnBus("can_bridge.yaml", bus_path_,
                                                 {{"velocity_rad_s: 8.0", "velocity_rad_s: 80"},
                                                  {"lower_rad: -1.9", "lower_rad: -6"},
                                                  {"upper_rad: 1.9", "upper_rad: 6"}}));
  const std::string reference = folder_.Write(
      "reference.yaml", testing::EditedRigConfig("reference_benchmark.yaml",
                                                 {{"duration_s: 10", "duration_s: 36000"}}));
  deployment_ = folder_.Write(
      "deploy.yaml",
      "schema: sinew-deployment/1\nname: signals\nmode: realtime\nduration_s: 0\nseed: 1\n"
      "provider: can_bridge\nrealtime_priority: " +
          std::string(realtime ? "true" : "false") + "\nprocesses:\n" +
          ProcessText("can_bridge", "sinew-can-bridge", bridge, true) +
          ProcessText("pneumatics", "sinew-pneumatics", kRig + "pneumatics.yaml") +
          ProcessText("regime", "sinew-regime", kRig + "regime.yaml") +
          ProcessText("reference", "sinew-reference", reference) +
          ProcessText("esn", "sinew-esn", kRig + "esn_adaptive.yaml") +
          ProcessText("rls", "sinew-rls", kRig + "rls.yaml") +
          ProcessText("control", "sinew-control", kRig + "control_pid_esn.yaml") +
          ProcessText("standby", "sinew-control", kRig + "control_pid_model.yaml"));
  const std::vector<std::string> fifo =
      realtime ? std::vector<std::string>{"--realtime"} : std::vector<std::string>{};
  std::vector<std::string> bus_line{kBin + "sinew-can-bus", "--bus", bus_path_};
  bus_line.insert(bus_line.end(), fifo.begin(), fifo.end());
  hardware_bus_ = std::make_unique<Program>(bus_line);
  std::vector<std::string> axes_line{kBin + "sinew-virtual-axes", "--config", axes};
  axes_line.insert(axes_line.end(), fifo.begin(), fifo.end());
  axes_ = std::make_unique<Program>(axes_line);
}

Deployment::~Deployment() { (void)Stop(); }

void Deployment::Launch() {
  // Each recording is gone with the next: an hour of them does not fit on small disks.
  const std::string recording = (folder_.path() / "run.mcap").string();
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
    if (entry.path().extension() == ".mcap") std::filesystem::remove(entry.path());
  }
  launch_ = std::make_unique<Program>(
      std::vector<std::string>{kBin + "sinew", "launch", deployment_, "--domain",
                               std::to_string(domain_), "--record", recording});
}

std::vector<Target> Deployment::Targets() const {
  std::vector<Target> targets;
  if (!launched()) return targets;
  targets.push_back({launch_->pid(), "launcher"});
  for (const auto& task :
       std::filesystem::directory_iterator("/proc/" + std::to_string(launch_->pid()) + "/task")) {
    std::ifstream children(task.path() / "children");
    pid_t pid = 0;
    while (children >> pid) {
      const std::string name = NameOf(pid);
      if (!name.empty() && testing::IsRunning(pid)) targets.push_back({pid, name});
    }
  }
  return targets;
}

std::vector<Target> Deployment::Hardware() const {
  return {{hardware_bus_->pid(), "can_bus"}, {axes_->pid(), "virtual_axes"}};
}

std::vector<Target> Deployment::LeftBehind(std::vector<Target> known, milliseconds limit) const {
  const auto give_up = std::chrono::steady_clock::now() + limit;
  std::erase_if(known, [&](const Target& target) {
    const auto now = std::chrono::steady_clock::now();
    const auto left = std::chrono::duration_cast<milliseconds>(give_up - now);
    return testing::WaitUntilGone(target.pid, std::max(left, milliseconds(0)));
  });
  return known;
}

bool Deployment::Stop() {
  if (launch_ == nullptr) return true;
  launch_->Signal(SIGCONT);
  launch_->Signal(SIGINT);
  return launch_->Wait(seconds(30)) != Program::kTimeout;
}

std::string Deployment::Log() const {
  const std::string log = launch_ == nullptr ? "" : launch_->output() + launch_->error();
  return log.substr(log.size() - std::min(log.size(), kLogEnd));
}

}  // namespace sinew::signals
