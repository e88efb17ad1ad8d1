// Watches what the bridge's plant receives and sends, and compares every frame that leaves with
// what the commands allow. For the fuzz harness, the soak run and the speed measurement; allocates
// nothing after its setup.
//
// The rules, from docs/participants/can_bridge.md ("What may move a joint") and by hand from bytes,
// not with the codec:
//   - a frame goes only to a node of the joint map, on that joint's bus, and is of a kind the
//   bridge
//     has;
//   - a joint that is idle, has a fault, or has not said closed loop since it was armed gets only
//     neutral setpoints: no torque, no velocity, the position it measured last;
//   - a torque is the commanded one within torque and current limit, tapered near the velocity
//     from which the joint stops within the margin of a position limit, the velocity limit at most;
//     or nothing;
//   - a velocity is the commanded one, towards a position limit within that velocity; or nothing;
//   - a position leaves the measured or the last one by no more than the velocity limit allows, and
//     ends within the limits;
//   - a reference through a gateway is the same as a position, rounded to 0.01 turns; that of a
//   joint
//     that is not in position mode is the measured position, now or when it was last sent;
//   - relays are the commanded ones;
//   - every joint gets a setpoint in every cycle.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "bridge/joints/can_plant.h"
#include "tests/fuzz/property.h"

namespace sinew::fuzz {

struct WatchCounts {
  std::uint64_t received = 0;    // frames the plant took from a bus
  std::uint64_t sent = 0;        // frames the plant sent
  std::uint64_t setpoints = 0;   // of these, setpoints
  std::uint64_t moving = 0;      // setpoints that ask for a torque, a velocity, a new position
  std::uint64_t violations = 0;  // frames or cycles that break a rule
};

class PlantWatch {
 public:
  explicit PlantWatch(const bridge::BridgeConfig& config);

  // The plant takes this frame from this bus now.
  void Received(int bus, const can::Frame& frame, std::int64_t now_ns);
  // Call before and after each Act (or Step that sends).
  void Begin(const bridge::CanPlant& plant, const provider::PlantCommand& command, double period_s);
  void End();
  // The plant sends this frame.
  void Sent(int bus, const can::Frame& frame, std::int64_t now_ns);

  const WatchCounts& counts() const { return counts_; }
  const std::string& first_violation() const { return first_violation_; }
  // The joint got, in its last setpoint, exactly what was commanded: a torque or velocity within
  // limits.
  bool moved_as_commanded(int joint) const { return joints_[std::size_t(joint)].as_commanded; }

 private:
  struct Joint {
    // Received.
    double position_rev = 0.0;
    double velocity_rev_s = 0.0;
    bool measured = false;
    double output_rad = 0.0;        // the node's angle, as it came
    double valid_output_rad = 0.0;  // the last that the node called valid
    bool closed_loop = false;
    std::int64_t heartbeat_ns = 0;
    // The plant's arming, followed from outside.
    bool armed = false;
    bool closed_since_armed = false;
    bool looked_at = false;  // in this cycle
    std::int64_t armed_ns = 0;
    double last_position_rev = 0.0;  // of the setpoints since armed
    bool has_last_position = false;
    double last_reference_rev = 0.0;
    int setpoints = 0;  // in this cycle
    bool as_commanded = false;
  };

  void Break(const char* rule, int bus, const can::Frame& frame);
  void LookAt(std::size_t joint, std::int64_t now_ns);
  bool MayMove(std::size_t joint) const;
  void AssessTorque(std::size_t joint, int bus, const can::Frame& frame);
  void AssessVelocity(std::size_t joint, int bus, const can::Frame& frame);
  void AssessPosition(std::size_t joint, int bus, const can::Frame& frame);
  void AssessReferences(std::size_t gateway, int bus, const can::Frame& frame, std::int64_t now_ns);
  void AssessStep(std::size_t joint, double wire_rev, double rounding_rev, int bus,
                  const can::Frame& frame);
  void ReceivedState(std::size_t gateway, const can::Frame& frame);
  void AssessValves(std::size_t joint, int bus, const can::Frame& frame);
  // The largest velocity towards the upper or the lower position limit of a joint whose inertia is
  // not declared, which moves there at forward_rad_s.
  double Fastest(std::size_t joint, bool up, bool valid_only, double forward_rad_s) const;
  // Is this what the plant may send, by either position?
  template <class Allowed>
  bool IsAllowed(std::size_t joint, double wire, Allowed allowed);
  // Position at the output, from the last frame or from the last one that was valid.
  double OutputPosition(std::size_t joint, bool valid_only) const;

  bridge::BridgeConfig config_;
  std::vector<Joint> joints_;
  std::array<std::array<int, 64>, provider::BusReport::kMaxBuses> axis_of_{};
  std::array<std::array<int, 64>, provider::BusReport::kMaxBuses> node_of_{};
  struct Gateway {
    std::array<double, 12> position_rev{};
    std::array<double, 12> velocity_rev_s{};
    std::uint32_t next_kind = 0;  // of the state that is coming
  };
  std::vector<Gateway> gateways_;
  const bridge::CanPlant* plant_ = nullptr;
  provider::PlantCommand command_;
  double period_s_ = 0.0;
  bool in_cycle_ = false;
  WatchCounts counts_;
  std::string first_violation_;
};

}  // namespace sinew::fuzz
