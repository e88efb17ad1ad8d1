// The frames to one joint's controller: setpoints, neutral setpoints, requests.
//
// Two implementations: DirectExchange sends CANSimple to the controller. GatewayExchange collects
// position setpoints as references of the compact exchange (bridge/can/compact.h), in steps of 0.01
// motor turns; all else is CANSimple and passes the gateway as it is.
//
// A neutral setpoint moves nothing in any mode and feeds the controller's watchdog.
//
// Frames collect in a FrameOutbox and leave together. One thread; allocates nothing after the
// constructor while a cycle has at most kFramesOfCycle frames for a bus.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bridge/can/codec.h"
#include "bridge/can/transport/transport.h"
#include "bridge/joints/compact_link.h"
#include "bridge/joints/joint_measurement.h"
#include "components/base/types/control_mode.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {

// The frames of a cycle, per bus, in the order in which they were posted.
class FrameOutbox {
 public:
  static constexpr std::size_t kFramesOfCycle = 256;

  explicit FrameOutbox(std::size_t buses);
  void Post(int bus, const can::Frame& frame) {
    frames_[static_cast<std::size_t>(bus)].push_back(frame);
  }
  std::span<const can::Frame> frames(int bus) const {
    return frames_[static_cast<std::size_t>(bus)];
  }
  // One transport per bus. Frames that find no space are counted by the transport; the next cycle's
  // are newer. A node that has lost one gets no further data of this cycle, so that it is never set
  // in motion with a part of what that needs; requests, and what stops it, are sent.
  void Flush(std::span<can::Transport* const> transports);

 private:
  std::vector<std::vector<can::Frame>> frames_;
};

class JointExchange {
 public:
  // Joint and outbox must outlive it.
  JointExchange(const JointConfig& joint, bool short_frames, FrameOutbox* outbox)
      : joint_(joint), short_frames_(short_frames), outbox_(outbox) {}
  virtual ~JointExchange() = default;
  JointExchange(const JointExchange&) = delete;
  JointExchange& operator=(const JointExchange&) = delete;

  // The controller is asked for estimates and Iq; false: they come with the gateway's states.
  virtual bool is_polled() const = 0;
  // False, and nothing is sent, where the position does not fit into the exchange's field.
  [[nodiscard]] virtual bool SendPosition(double position_rev, double feed_forward_rev_s) = 0;
  // Does the measured position fit into the exchange's field? What does not cannot be held there.
  virtual bool Holds(const JointMeasurement& measured) const = 0;
  // Neutral in this mode; kIdle: for an axis that should be idle. False: the measured position does
  // not fit into the exchange's field.
  [[nodiscard]] virtual bool SendNeutral(types::ControlMode mode,
                                         const JointMeasurement& measured) = 0;

  void RequestIdle() { Send(can::SetAxisState{can::AxisState::kIdle}); }
  // Mode, limits, closed-loop control.
  void RequestClosedLoop(types::ControlMode mode, const JointMeasurement& measured);
  void RequestMode(types::ControlMode mode);
  // In front of position control: an axis goes to the setpoint it has, however old.
  void SendMeasuredPosition(const JointMeasurement& measured);
  void RequestData(can::Command command);

  template <class Message>
  void Send(const Message& message) {
    const can::Frame frame = can::Encode(joint_.node, message, joint_.firmware);
    outbox_->Post(joint_.bus, short_frames_ ? can::Trim(frame) : frame);
  }

 protected:
  void SendNeutralFrame(types::ControlMode mode, const JointMeasurement& measured);

 private:
  const JointConfig& joint_;
  bool short_frames_;
  FrameOutbox* outbox_;
};

class DirectExchange final : public JointExchange {
 public:
  using JointExchange::JointExchange;
  bool is_polled() const override { return true; }
  bool Holds(const JointMeasurement& /*measured*/) const override { return true; }
  bool SendPosition(double position_rev, double feed_forward_rev_s) override;
  bool SendNeutral(types::ControlMode mode, const JointMeasurement& measured) override;
};

class GatewayExchange final : public JointExchange {
 public:
  // The link must outlive it; `field` is the joint's place in its states and references.
  GatewayExchange(const JointConfig& joint, bool short_frames, FrameOutbox* outbox,
                  CompactLink* link, int field)
      : JointExchange(joint, short_frames, outbox), link_(link), field_(field) {}
  bool is_polled() const override { return false; }
  bool Holds(const JointMeasurement& measured) const override {
    return CompactLink::Fits(measured.estimates.position_rev);
  }
  bool SendPosition(double position_rev, double feed_forward_rev_s) override;
  bool SendNeutral(types::ControlMode mode, const JointMeasurement& measured) override;

 private:
  CompactLink* link_;
  int field_;
};

}  // namespace sinew::bridge
