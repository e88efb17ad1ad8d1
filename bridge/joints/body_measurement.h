// The last report of one body node (bridge/can/body_node.h), and how new it is.
//
// A measurement is new when its sequence number differs from that of the last one: a number that
// stands still is a measurement that stands still. With the age t of the last new one:
//
//     valid   valid bits of the sample, no value at an end of its field (can::AtFieldEnd), t <=
//             estimate_timeout, and the node's last heartbeat has the version of our frames (before
//             the first heartbeat nothing is valid)
//     lost    t > lost_after; counted once, until a new measurement comes
//
// Of an IMU the three frames of a sample count together, when the last of them has come; the age is
// that of the first. With its mounting R (joint_config.h), and S the housing, B the torso, W the
// world:
//
//     f_B = R f_S        w_B = R w_S        q_WB = q_WS q_BS^-1,  q_BS the quaternion of R
//
// Times are of the transport's clock and come in. One thread; allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "bridge/can/body_node.h"
#include "bridge/can/transport/transport.h"
#include "bridge/joints/bus_statistics.h"
#include "bridge/joints/joint_config.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

// The time of the newest sample, by its sequence number.
class SampleClock {
 public:
  // True: a new one. A step forward of less than half of the 256 numbers counts what is missing
  // in between; a larger one is a node that has started again.
  bool Take(std::uint8_t sequence, std::int64_t stamp_ns);
  std::optional<std::int64_t> newest_ns() const { return newest_ns_; }
  std::uint64_t missed() const { return missed_; }

 private:
  std::optional<std::int64_t> newest_ns_;
  std::uint8_t sequence_ = 0;
  std::uint64_t missed_ = 0;
};

class BodyMeasurement {
 public:
  // Both must outlive it.
  BodyMeasurement(const BodyNodeConfig& config, const BridgeTiming& timing);

  const BodyNodeConfig& config() const { return config_; }

  // As after the constructor; from now on its silence counts.
  void Reset(std::int64_t now_ns);

  enum class Taken { kUnused, kStored, kMalformed };
  Taken Take(const can::Received& received);

  // The sensors of this node, the others' stay. To be called once a cycle: a loss is counted here.
  void Fill(std::int64_t now_ns, provider::BodySensors* body);

  bool lost() const { return lost_; }
  BodyCounts counts() const { return {clock_.missed(), losses_}; }
  // The last one; nothing before it came.
  const std::optional<can::NodeHeartbeat>& heartbeat() const { return heartbeat_; }

 private:
  enum ImuPart : unsigned { kForce = 1, kRate = 2, kOrientation = 4, kWhole = 7 };
  struct ImuSample {
    std::uint8_t sequence = 0;
    unsigned parts = 0;  // those that came
    std::int64_t stamp_ns = 0;
    std::array<double, 3> force_m_s2{};
    std::array<double, 3> rate_rad_s{};
    std::array<double, 4> orientation_wxyz{1.0, 0.0, 0.0, 0.0};
    bool valid = false;
    bool saturated = false;  // a value of it is at an end of its field
  };

  Taken TakeFoot(const can::Received& received);
  Taken TakeImu(const can::Received& received);
  // The sample that a frame with this number belongs to.
  ImuSample* Coming(std::uint8_t sequence, std::int64_t stamp_ns);
  void Complete(ImuPart part);
  void FillFoot(bool fresh, provider::BodySensors* body) const;
  void FillImu(bool fresh, provider::BodySensors* body) const;

  const BodyNodeConfig& config_;
  const BridgeTiming& timing_;
  SampleClock clock_;
  std::int64_t reset_ns_ = 0;
  bool lost_ = false;
  std::uint64_t losses_ = 0;
  std::optional<can::NodeHeartbeat> heartbeat_;
  can::FootForces foot_;
  ImuSample coming_, imu_;
};

}  // namespace sinew::bridge
