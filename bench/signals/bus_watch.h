// What the bus says of the axis: every torque setpoint against the joint commands that were
// published, and how long the axis was in closed loop without a new one. By the bus' own stamps
// (CLOCK_MONOTONIC).
#pragma once

#include <sinew_idl/joint.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "bridge/can/transport/virtual_can.h"
#include "tests/support/witness.h"

namespace sinew::signals {

// The calling thread, and those that it starts, run before the processes that are watched, where
// the system lets them: what comes too late here would look like a finding.
void BecomeWatcher();
// What the calling thread starts from now on does not.
void StartOrdinaryProcesses();

// The published commands by the value that their torque has on the bus, and when the states were
// measured that they answer.
class Published {
 public:
  void Add(const msg::JointState& state, std::int64_t now_ns);
  void Add(const msg::JointCommand& command);

  // When the state of the newest command of this value was measured (CLOCK_MONOTONIC); 0: no
  // command has it.
  std::int64_t MeasuredAt_ns(float torque_Nm) const;
  // The last time, up to this one, at which the provider said that it was armed: that it had a
  // fresh command.
  std::int64_t ArmedUntil_ns(std::int64_t at_ns) const;

 private:
  using Tick = std::pair<std::uint64_t, std::uint64_t>;  // session and tick
  std::map<Tick, std::int64_t> measured_ns_;
  std::deque<Tick> states_;
  std::deque<std::int64_t> armed_ns_;
  // A command may come here before the state that it answers.
  std::map<float, Tick> newest_;
  std::deque<std::pair<float, Tick>> commands_;
};

struct Findings {
  std::uint64_t setpoints = 0, matched = 0;
  double oldest_ms = 0.0;  // age of a command that was executed, beyond what the machine was late
  // Longest time in closed loop without a new command or the provider's word that it has one,
  // beyond what the machine was late.
  double longest_without_ms = 0.0;
  std::uint64_t windows = 0, late_windows = 0;  // of 5 ms; a witness was over 1 ms late
  std::vector<std::string> violations;
};

class BusWatch {
 public:
  explicit BusWatch(const std::string& bus);
  ~BusWatch();

  // Assesses the frames that are older than the slowest way of a message over DDS.
  void Assess(const Published& published, std::int64_t now_ns);
  const Findings& findings() const { return findings_; }
  bool in_closed_loop() const { return closed_loop_; }
  // Since when no command was executed.
  double WithoutCommand_ms(std::int64_t now_ns) const;
  std::uint64_t matched() const { return findings_.matched; }

 private:
  struct Frame {
    std::int64_t stamp_ns;
    bool heartbeat, closed_loop;  // a heartbeat, and what it says; else a setpoint
    float torque_Nm;
  };
  void Receive();
  void AssessSetpoint(const Frame& frame, const Published& published);
  void AssessHeartbeat(const Frame& frame, const Published& published);
  double Late_ms(std::int64_t from_ns, std::int64_t to_ns) const;
  void Violate(const Frame& frame, const std::string& what);

  can::VirtualCan bus_;
  testing::Witness witness_;
  std::deque<std::pair<std::int64_t, double>> late_ms_;  // by the time at which it was read
  std::mutex mutex_;
  std::deque<Frame> frames_;
  std::atomic<bool> stop_{false};

  Findings findings_;
  bool closed_loop_ = false;
  std::int64_t closed_since_ns_ = 0, command_ns_ = 0, measured_ns_ = 0;
  std::thread thread_;
};

}  // namespace sinew::signals
