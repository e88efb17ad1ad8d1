// The performance of a robot from the messages of its topics: what sinew-performance publishes, and
// what `sinew performance` computes from a recording.
//
// A tick without a reference, or with one that asks for nothing (idle), has no error; a joint that
// is not valid has no sample at all; without an actuator_state there is no current. A new session
// begins anew. Thread: one.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/performance.h>
#include <sinew_idl/reference.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "components/robot/performance/file/performance_file.h"

namespace sinew::performance {

// Messages of one tick; a null pointer: it did not come.
struct TickMessages {
  const msg::JointState* state = nullptr;  // always there
  const msg::Reference* reference = nullptr;
  const msg::ActuatorState* actuator = nullptr;
};

class RobotMeter {
 public:
  explicit RobotMeter(PerformanceConfig config) : config_(std::move(config)) {}

  // Electrical energies are computed: the actuators' state is read.
  bool reads_actuators() const;
  // Session, tick and period are those of the state. A period with which nothing can be counted
  // makes the robot unfit until another message has one.
  void Step(const TickMessages& tick);
  const RobotPerformanceOutput& output() const { return output_; }
  const PerformanceConfig& config() const { return config_; }
  // The header is the caller's.
  msg::PerformanceState ToMessage() const;
  // Why nothing is measured, one line; empty: it is.
  const std::string& unfit() const { return unfit_; }

 private:
  void Begin(const msg::JointState& state);

  PerformanceConfig config_;
  std::optional<RobotPerformance> robot_;
  RobotPerformanceOutput output_;
  std::uint64_t session_id_ = 0, since_tick_ = 0, state_tick_ = 0;
  bool stale_ = false;
  std::string unfit_;
};

}  // namespace sinew::performance
