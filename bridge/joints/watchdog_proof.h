// Proof that an axis' own watchdog idles it when setpoints stop coming: what nothing on this
// computer can do after a crash. Made once at bring-up, kept by serial number and node (the axes of
// one controller have one serial number, and a watchdog each), required for arming hardware.
//
// How it is measured: every frame to an axis feeds its watchdog, so nothing can be asked while it
// is withheld. The axis' own heartbeats are the witness, ten a second. The last setpoint is
// therefore timed so that a heartbeat follows kWatchdogLimit_s and half of kWatchdogResolution_s
// later: if it reports idle and the expiry of the watchdog, the axis was idle by then.
//
// No clock but the transport's, and no file. One thread; TryWatchdog waits in the transport.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bridge/can/transport/transport.h"
#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

// The axis is idle this long after its last setpoint (docs/bring-up.md: watchdog_timeout).
inline constexpr double kWatchdogLimit_s = 0.1;
// Error of the measurement: the controller's timer is set to the limit itself, its heartbeats come
// within some milliseconds of their period, this process within some of its times.
inline constexpr double kWatchdogResolution_s = 0.01;

struct WatchdogProof {
  std::string joint;  // for people; not compared
  std::string serial_number;
  int node = 0;
  can::Firmware firmware = can::Firmware::k0_5_6;
  double idle_after_ms = 0.0;  // at the latest
  std::string made;            // UTC
};

struct WatchdogTrial {
  bool proven = false;
  bool refuted = false;        // it was seen not to fire; neither: nothing is known
  double idle_after_ms = 0.0;  // first heartbeat in idle; 0: none came
  double runs_after_ms = 0.0;  // last heartbeat in closed loop, after the last setpoint
  std::string why;             // not proven
};

// Listens; nothing is sent where another program commands the axis. Arms it with zero torque, feeds
// it, withholds, watches. Whatever happens then, the axis has been requested to idle when this
// returns. `stopped`: asked again and again; true ends the trial.
WatchdogTrial TryWatchdog(const JointConfig& joint, const BridgeTiming& timing, can::Transport& bus,
                          const std::function<bool()>& stopped);

bool Proves(const WatchdogProof& proof, const JointConfig& joint);
// The same axis: its older proof is replaced.
bool SameAxis(const WatchdogProof& proof, const JointConfig& joint);

// Why these joints may not be armed: names joint, node, serial number and the command that makes
// the proof. Empty: all have theirs.
std::string MissingProofs(const std::vector<JointConfig>& joints,
                          const std::vector<WatchdogProof>& proofs, const std::string& command);

}  // namespace sinew::bridge
