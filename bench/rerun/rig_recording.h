// A recording of the rig, made in one process without DDS: surrogate, reference, regime,
// esn, control, pneumatics and rls, written by the recorder of sinew-logger.
//
// The same classes and configuration files as the processes of robots/rig/deploy_esn.yaml. Thread:
// the caller's; the recorder has its own.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "tools/compose/chain.h"

namespace sinew::rerun {

struct RigRecordingOptions {
  std::filesystem::path rig;  // the folder robots/rig
  std::filesystem::path out;
  std::uint64_t ticks = 0;  // of 240 Hz
  std::uint64_t seed = 1;
  node::TimeMode mode = node::TimeMode::kLockstep;
  std::uint64_t joining_ticks = 0;  // real time: in the first ones all stand by (Tick::settled)
  // Called before each tick, if given: what an operator sends.
  std::function<void(node::Node& operators, std::uint64_t session_id, std::uint64_t tick)> before{};
  // A participant that misses this tick, if given: real time, where the others go on without it.
  std::function<bool(const std::string& name, std::uint64_t tick)> misses{};
};

// The six components, by robots/rig/deploy_esn.yaml.
std::vector<compose::Part> PartsOfTheRig(const std::filesystem::path& rig);

// Replaces what is there. Throws UsageError for a configuration, std::runtime_error when the file
// cannot be written.
void RecordRig(const RigRecordingOptions& options);

}  // namespace sinew::rerun
