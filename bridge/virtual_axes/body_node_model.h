// One foot or IMU node that exists only as frames (bridge/can/body_node.h): it sends its heartbeat
// and samples cyclically. Readings are the plant's provider::BodySensors; of a plant without them
// the samples are zero and not valid. With its mounting R (axes_config.h), and S the housing, B the
// torso, W the world, an IMU measures
//
//     f_S = R^T f_B        w_S = R^T w_B        q_WS = q_WB q_BS,  q_BS the quaternion of R
//
// and to f_S and w_S of each sample noise is added (axes_config.h).
//
// Pure: the plant's sensors, the time and the noise's seed come in. One thread; allocates nothing.
#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "bridge/can/body_node.h"
#include "bridge/virtual_axes/axes_config.h"
#include "bridge/virtual_axes/schedule.h"
#include "components/robot/provider/plant.h"

namespace sinew::virtual_axes {

class BodyNodeModel {
 public:
  static constexpr std::size_t kCyclicMessages = 4;

  // Nodes of one seed have noise of their own, by bus and number.
  explicit BodyNodeModel(const BodyNodeConfig& config, std::uint64_t seed = 1);

  int bus() const { return config_.bus; }
  int node() const { return config_.node; }

  void Start(std::int64_t now_ns, std::int64_t spread_ns);
  // The cyclic messages of this time. `body`: the plant's, or nullptr.
  DueFrames<kCyclicMessages> Due(const provider::BodySensors* body, std::int64_t now_ns);

  // For tests and for tools that stage failures; kNone ends one.
  void Falsify(const BodyFault& fault) { config_.fault = fault; }

 private:
  void MeasureFoot(const provider::BodySensors& body);
  void MeasureImu(const provider::BodySensors& body);
  std::array<double, 3> Noisy(std::array<double, 3> values, double standard_deviation);

  BodyNodeConfig config_;
  Schedule heartbeat_, samples_;
  std::int64_t started_ns_ = 0;
  std::mt19937_64 random_;
  std::normal_distribution<double> gaussian_;
  // The last sample.
  std::uint8_t sequence_ = 0;
  can::FootForces foot_;
  can::ImuForce force_;
  can::ImuRate rate_;
  can::ImuOrientation orientation_;
};

}  // namespace sinew::virtual_axes
