// One gateway that exists only as frames: takes the references of the compact exchange
// (bridge/can/compact.h) for the axes behind it, and answers the last frame of them with a state.
// Foot forces and IMU are the plant's. An axis that is silent keeps its last values in the state.
//
// Pure; one thread; allocates in the constructor only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bridge/can/compact.h"
#include "bridge/virtual_axes/axis_model.h"

namespace sinew::virtual_axes {

class GatewayModel {
 public:
  // `axes`: indices of the axes behind it, in the order of its fields.
  GatewayModel(const GatewayConfig& config, std::vector<std::size_t> axes)
      : config_(config), axes_(std::move(axes)) {}

  int bus() const { return config_.bus; }
  int node() const { return config_.node; }

  // Hands a frame of references to the axes. True: it was the last of them, and State is the
  // answer.
  bool Take(const can::Frame& frame, std::span<AxisModel> axes, std::int64_t now_ns);
  // `body`: the plant's, or nullptr.
  std::array<can::Frame, can::kCompactStateFrames> State(std::span<AxisModel> axes,
                                                         const provider::PlantSensors& sensors,
                                                         const provider::BodySensors* body,
                                                         std::int64_t now_ns);

 private:
  GatewayConfig config_;
  std::vector<std::size_t> axes_;
  can::CompactReferences references_;
  can::CompactState state_;  // the last that was sent
};

// Angles of a unit quaternion, body to world: about x, then y, then z of the world.
std::array<double, 3> RollPitchYaw(const std::array<double, 4>& orientation_wxyz);

}  // namespace sinew::virtual_axes
