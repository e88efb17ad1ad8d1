#include "bridge/virtual_axes/virtual_axes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace sinew::virtual_axes {
namespace {

constexpr std::int64_t kLongestCatchUp_ns = 50 * kMs_ns;
constexpr std::int64_t kSpread_ns = 130'000;  // about a frame
constexpr int kMostBatches = 8;               // taken from a bus at once

}  // namespace

VirtualAxes::VirtualAxes(const VirtualAxesConfig& config, provider::SimulatedPlant& plant,
                         std::vector<can::Transport*> transports)
    : config_(config), plant_(plant), transports_(std::move(transports)) {
  CheckVirtualAxesConfig(config, plant.joint_count(), static_cast<int>(transports_.size()));
  for (const AxisConfig& axis : config.axes) axes_.emplace_back(axis);
  for (const SensorNodeConfig& node : config.nodes) nodes_.emplace_back(node);
  for (const GatewayConfig& gateway : config.gateways) {
    std::vector<std::size_t> behind;
    for (const int node : gateway.axes) {
      const auto axis = std::find_if(axes_.begin(), axes_.end(), [&](const AxisModel& a) {
        return a.bus() == gateway.bus && a.node() == node;
      });
      behind.push_back(static_cast<std::size_t>(axis - axes_.begin()));
    }
    gateways_.emplace_back(gateway, std::move(behind));
  }
  for (const BodyNodeConfig& node : config.body_nodes) body_nodes_.emplace_back(node, config.seed);
  step_ns_ = std::llround(1e9 * config.step_s);
  held_ = config.hold_start_s.has_value();
  plant_.Reset(&sensors_);
}

void VirtualAxes::Start(std::int64_t now_ns) {
  next_step_ns_ = now_ns + step_ns_;
  // Nodes of a real bus are not in step with each other: spread their first messages over a period.
  std::int64_t spread_ns = 0;
  for (AxisModel& axis : axes_) {
    axis.Start(now_ns, spread_ns);
    spread_ns += kSpread_ns;
  }
  for (SensorNodeModel& node : nodes_) {
    node.Start(now_ns, spread_ns);
    spread_ns += kSpread_ns;
  }
  for (BodyNodeModel& node : body_nodes_) {
    node.Start(now_ns, spread_ns);
    spread_ns += kSpread_ns;
  }
}

void VirtualAxes::Run(std::int64_t now_ns) {
  if (now_ns - next_step_ns_ > kLongestCatchUp_ns) next_step_ns_ = now_ns;
  Answer(now_ns);
  while (next_step_ns_ <= now_ns) {
    for (AxisModel& axis : axes_) axis.CheckWatchdog(next_step_ns_);
    for (SensorNodeModel& node : nodes_) node.CheckWatchdog(next_step_ns_);
    if (held_) WatchHold();
    if (!held_) StepPlant();
    for (AxisModel& axis : axes_) axis.CheckSpeed(axis.MotorOf(sensors_));
    next_step_ns_ += step_ns_;
    ++steps_;
  }
  SendDue(now_ns);
}

void VirtualAxes::WatchHold() {
  const bool driven = std::all_of(axes_.begin(), axes_.end(), [](const AxisModel& axis) {
    return axis.state() == can::AxisState::kClosedLoopControl;
  });
  if (!driven) {
    hold_ends_ns_ = next_step_ns_ + std::llround(1e9 * *config_.hold_start_s);
  } else if (next_step_ns_ >= hold_ends_ns_) {
    held_ = false;
  }
}

void VirtualAxes::StepPlant() {
  for (AxisModel& axis : axes_) axis.Drive(axis.MotorOf(sensors_), &command_);
  for (const SensorNodeModel& node : nodes_) node.Drive(&command_);
  plant_.Step(command_, config_.step_s, &sensors_);
}

void VirtualAxes::Answer(std::int64_t now_ns) {
  for (std::size_t bus = 0; bus < transports_.size(); ++bus) {
    std::array<can::Received, can::kFramesAtOnce> waiting;
    for (int batch = 0; batch < kMostBatches; ++batch) {
      const std::size_t count = transports_[bus]->TakeWaiting(waiting);
      for (std::size_t i = 0; i < count; ++i) {
        Take(static_cast<int>(bus), waiting[i].frame, now_ns);
      }
      if (count < waiting.size()) break;
    }
  }
}

void VirtualAxes::Take(int bus, const can::Frame& frame, std::int64_t now_ns) {
  const auto address = can::AddressOf(frame);
  if (!address) return;
  ++frames_taken_;
  const auto find = [&](auto& models) {
    const auto found = std::find_if(models.begin(), models.end(), [&](const auto& model) {
      return model.bus() == bus && model.node() == address->node;
    });
    return found == models.end() ? nullptr : &*found;
  };
  if (AxisModel* axis = find(axes_)) {
    if (const auto answer = axis->Take(frame, axis->Reported(sensors_, now_ns), now_ns))
      Send(bus, *answer);
  } else if (SensorNodeModel* node = find(nodes_)) {
    node->Take(frame, now_ns);
  } else if (GatewayModel* gateway = find(gateways_)) {
    if (!gateway->Take(frame, axes_, now_ns)) return;
    for (const can::Frame& sent : gateway->State(axes_, sensors_, plant_.body_sensors(), now_ns)) {
      Send(bus, sent);
    }
  }
}

void VirtualAxes::SendDue(std::int64_t now_ns) {
  for (AxisModel& axis : axes_) {
    for (const can::Frame& frame : axis.Due(axis.Reported(sensors_, now_ns), now_ns)) {
      Send(axis.bus(), frame);
    }
  }
  for (SensorNodeModel& node : nodes_) {
    for (const can::Frame& frame : node.Due(sensors_, command_, now_ns)) Send(node.bus(), frame);
  }
  for (BodyNodeModel& node : body_nodes_) {
    for (const can::Frame& frame : node.Due(plant_.body_sensors(), now_ns)) Send(node.bus(), frame);
  }
}

void VirtualAxes::Send(int bus, const can::Frame& frame) {
  // A frame that finds no space is counted there; the next one follows.
  (void)transports_[static_cast<std::size_t>(bus)]->Send(frame);
}

void VirtualAxes::SetHand(int joint, double force_N) {
  disturbance_.hand_force_N.at(static_cast<std::size_t>(joint)) =
      std::isfinite(force_N) ? force_N : 0.0;
  plant_.Disturb(disturbance_);
}

}  // namespace sinew::virtual_axes
