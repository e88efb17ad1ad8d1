// Configuration of the bridge: the joints, their limits, the gateways, the body nodes and the time
// limits; its check; the identifiers that the bridge reads.
//
// Position limits and velocity limit are those of the output, torque and current those of the
// motor. Pure; Check and ReceiveFilters allocate and are for the start only.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bridge/can/body_node.h"
#include "bridge/can/codec.h"
#include "bridge/can/transport/transport.h"

namespace sinew::bridge {

inline std::int64_t ToNs(double seconds) {
  return static_cast<std::int64_t>(std::llround(1e9 * seconds));
}

// Data of the stop before a position limit (braking.h); at the output.
struct Braking {
  double reflected_inertia_kg_m2 = 0.0;  // of the rotor: the least that moves
  double max_inertia_kg_m2 = 0.0;        // rotor, link and the heaviest payload
  double load_torque_Nm = 0.0;           // gravity and other loads, the most towards a limit
  // From the measurement to the torque: estimates up to 2 ms old, 2 ms on the bus, 1 ms of drive.
  double command_delay_s = 0.005;
};

struct JointLimits {
  double motor_torque_Nm = 0.0;
  double current_A = 0.0;
  double velocity_rad_s = 0.0;  // output
  double lower_rad = 0.0;       // output
  double upper_rad = 0.0;
  double margin_rad = 0.2;  // beyond a position limit by more than this: fault
  double motor_temperature_degC = std::numeric_limits<double>::infinity();
  std::optional<Braking> braking = {};  // without it torque is only taken away near a limit
};

struct OutputNode {
  int node = 0;
  int direction = 1;
  double zero_rad = 0.0;
};

// Motor encoder against output encoder.
struct ZeroCheck {
  double play_rad = 0.0;  // full width, output
  double tolerance_rad = 0.0;

  // Largest disagreement of the two encoders, at the output.
  double largest_rad() const { return 0.5 * play_rad + tolerance_rad; }
};

struct JointConfig {
  std::string name;
  int bus = 0;
  int node = 0;
  can::Firmware firmware = can::Firmware::k0_5_6;
  // Serial number of the controller, hexadecimal digits in capitals; empty: not declared. No
  // message of these firmwares carries it, so it is read over USB (docs/bring-up.md).
  std::string serial_number = {};
  int direction = 1;
  double gear_ratio = 1.0;
  double zero_rev = 0.0;
  double torque_constant_Nm_A = 0.0;             // of the motor
  double controller_torque_constant_Nm_A = 0.0;  // as configured in the controller
  double torque_efficiency = 1.0;                // of the gear, for the reported joint torque
  double declared_payload_kg = 0.0;
  JointLimits limits;
  std::optional<OutputNode> output;
  std::optional<ZeroCheck> zero_check;  // needs the output node
  // Gear and shafts between the encoders under the largest torque: the rig's 20 kNm/rad yield
  // 0.0015 rad to 30 Nm, and the mounts of the encoders are not stiffer.
  double compliance_rad = 0.005;
  bool home_by_whole_turns = false;  // needs the zero check
};

// A gateway serves joints of one bus. The first gateway also carries foot forces and IMU, unless it
// is declared not to.
struct GatewayConfig {
  int bus = 0;
  int node = 0;
  std::vector<int> joints;  // in the order of its fields, at most can::kCompactJoints
  bool carries_feet = true;
  bool carries_imu = true;
};

// A foot or the IMU as a node of its own (bridge/can/body_node.h). Nothing of it is a joint's: what
// it reports, or that it is silent, is no fault of a joint.
struct BodyNodeConfig {
  int bus = 0;
  int node = 0;
  can::BodyPart part = can::BodyPart::kRightFoot;
  // Mounting of an IMU: its housing in the torso (x forward, y left, z up), as the rotation R that
  // takes vectors of the housing to the torso, v_torso = R v_housing; roll about x, then pitch
  // about y, then yaw about z of the torso.
  std::array<double, 3> mounting_rpy_rad = {};
};

enum class Estimates { kCyclic, kRequested };

struct BridgeTiming {
  Estimates estimates = Estimates::kCyclic;
  // Each joint is asked for Iq every so many cycles, the joints of a bus in turn; 0: the
  // controllers send it by themselves.
  int iq_every_cycles = 1;
  double answer_window_s = 0.0015;    // requested estimates are awaited so long within a cycle
  double estimate_timeout_s = 0.02;   // older: the joint, or a sensor of the body, is not valid
  double lost_after_s = 0.06;         // older: fault; of a body node: it counts as lost
  double heartbeat_timeout_s = 0.35;  // 10 Hz, three missed
  double closed_loop_timeout_s = 1.0;
  double start_timeout_s = 5.0;
  int valve_timeout_ms = 60;  // of the nodes' own watchdogs
};

struct BridgeConfig {
  bool live = false;  // hardware: only live commands count
  std::vector<JointConfig> joints;
  std::vector<GatewayConfig> gateways;
  std::vector<BodyNodeConfig> body_nodes = {};
  std::vector<double> bitrate_bit_s;  // per bus, for the load
  bool short_frames = true;           // setpoints of 4 bytes: 95 bit times instead of 135
  BridgeTiming timing;
  std::string arm_refusal = {};  // why the joints may not be armed; empty: they may
};

// Throws std::invalid_argument naming joint, gateway or body node and value.
void CheckBridgeConfig(const BridgeConfig& config);

// The identifiers that the transport of this bus has to pass: exactly those that the bridge reads.
// masters: also those that only another master of the same nodes sends; a log has its own master's.
std::vector<can::IdFilter> ReceiveFilters(const BridgeConfig& config, int bus, bool masters = true);

}  // namespace sinew::bridge
