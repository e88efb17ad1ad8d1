#include "tools/tune_pid/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"

namespace sinew::tune {
namespace {

void CheckScored(const std::vector<int>& scored_joints, int joint_count) {
  const bool good = std::all_of(scored_joints.begin(), scored_joints.end(),
                                [joint_count](int j) { return j >= 0 && j < joint_count; });
  if (good && !scored_joints.empty()) return;
  throw std::invalid_argument("scored joints: expected one at least, each 0 .. " +
                              std::to_string(joint_count - 1));
}

// Inputs of reference and control at a tick, as the topics would carry them.
control::RobotInput InputAt(std::uint64_t tick, double period_s, int joints,
                            const provider::PlantSensors& sensors,
                            reference::RobotReference* generator) {
  reference::RobotReferenceInput asked;
  asked.session_id = 1;
  asked.tick = tick;
  asked.period_s = period_s;
  asked.may_move = true;
  asked.joint_count = joints;
  asked.position_rad = sensors.position_rad;
  asked.valid = sensors.valid;
  const reference::RobotReferenceOutput wanted = generator->Step(asked);
  control::RobotInput input;
  input.session_id = 1;
  input.period_s = period_s;
  input.armed = true;
  input.joint_count = joints;
  input.reference_fresh = true;
  input.reference_count = wanted.idle ? 0 : wanted.joint_count;
  for (int j = 0; j < joints; ++j) {
    input.joint[j] = MeasuredJoint(sensors, static_cast<std::size_t>(j));
    input.reference[j] = wanted.joint[j];
  }
  return input;
}

}  // namespace

bool HasFallen(const provider::SimulatedPlant& plant, const FallLimits& limits) noexcept {
  const provider::BodyTruth* body = plant.body_truth();
  if (body == nullptr) return false;
  const double tilt_rad = types::Tilt(body->orientation_wxyz);
  return !(body->position_m[2] >= limits.least_height_m) || !(tilt_rad <= limits.most_tilt_rad);
}

control::MeasuredJointState MeasuredJoint(const provider::PlantSensors& sensors,
                                          std::size_t joint) noexcept {
  control::MeasuredJointState measured;
  measured.valid = measured.actuator_valid = sensors.valid[joint];
  measured.position_rad = sensors.position_rad[joint];
  measured.velocity_rad_s = sensors.velocity_rad_s[joint];
  measured.motor_position_rad = sensors.motor_position_rad[joint];
  measured.motor_velocity_rad_s = sensors.motor_velocity_rad_s[joint];
  measured.pressure_bar = sensors.chamber_pressure_bar[joint];
  measured.load_force_N = sensors.load_force_N[joint];
  measured.payload_kg = sensors.declared_payload_kg[joint];
  measured.temperature_degC = sensors.motor_temperature_degC[joint];
  measured.valve_open = sensors.valve_open[joint];
  return measured;
}

ClosedLoopScore RunClosedLoop(const ClosedLoopConfig& config, provider::Plant& plant,
                              std::vector<ClosedLoopTick>* trace) {
  const double period_s = 1.0 / config.rate_Hz;
  const int joints = plant.joint_count();
  CheckScored(config.scored_joints, joints);
  control::RobotController controller(config.control);
  reference::RobotReference generator(config.reference);
  std::vector<pneumatics::PressureManager> managers;
  for (const auto& joint : config.pneumatics) managers.emplace_back(joint);
  provider::PlantSensors sensors;
  provider::PlantCommand command;
  std::deque<provider::PlantCommand> waiting;
  plant.Reset(&sensors);
  ClosedLoopScore score;
  types::JointArray<double> torque_before_Nm{};
  long scored = 0, saturated = 0;
  double squares = 0.0, torque_squares = 0.0, change_squares = 0.0;
  const auto ticks = static_cast<std::uint64_t>(std::llround(config.duration_s * config.rate_Hz));
  for (std::uint64_t tick = 0; tick < ticks; ++tick) {
    const double time_s = static_cast<double>(tick) * period_s;
    if (config.each_tick) config.each_tick(time_s, sensors);
    const control::RobotInput input = InputAt(tick, period_s, joints, sensors, &generator);
    const bool idle = input.reference_count == 0;
    const control::RobotOutput output = controller.Step(input);
    score.faulted = score.faulted || output.fault != control::Fault::kNone || sensors.fault;
    if (trace != nullptr) {
      const auto j = static_cast<std::size_t>(config.scored_joints.front());
      trace->push_back({time_s, idle, input.reference[j].position_rad, sensors.position_rad[j],
                        output.joint[j].motor_torque_Nm, output.joint[j].compensation_Nm});
    }
    const bool scores = !idle && time_s >= config.score_from_s && time_s < config.score_to_s;
    for (const int joint : config.scored_joints) {
      const auto j = static_cast<std::size_t>(joint);
      const double torque_Nm = output.joint[j].motor_torque_Nm;
      const double change_Nm = torque_Nm - torque_before_Nm[j];
      torque_before_Nm[j] = torque_Nm;
      if (!scores) continue;
      const double error_rad = input.reference[j].position_rad - sensors.position_rad[j];
      squares += error_rad * error_rad;
      score.worst_rad = std::max(score.worst_rad, std::abs(error_rad));
      torque_squares += torque_Nm * torque_Nm;
      change_squares += change_Nm * change_Nm;
      saturated += output.joint[j].saturated;
      ++scored;
    }
    for (int j = 0; j < joints; ++j) {
      command.mode[j] = output.joint[j].mode;
      command.motor_torque_Nm[j] = output.joint[j].motor_torque_Nm;
      command.position_rad[j] = output.joint[j].position_rad;
      command.velocity_rad_s[j] = output.joint[j].velocity_rad_s;
      if (static_cast<std::size_t>(j) >= managers.size()) continue;
      pneumatics::ManagerInput air;
      air.period_s = period_s;
      air.active = true;
      air.valid = sensors.valid[j];
      air.chamber_bar = sensors.chamber_pressure_bar[j];
      air.reservoir_bar = sensors.reservoir_pressure_bar[j];
      air.valve_is_open = sensors.valve_open[j];
      const pneumatics::ManagerOutput relays = managers[j].Step(air);
      command.valve_open[j] = relays.valve_open;
      command.compressor_on[j] = relays.compressor_on;
      command.vent_open[j] = relays.vent_open;
    }
    waiting.push_back(command);
    plant.Step(waiting.front(), period_s, &sensors);
    if (waiting.size() > static_cast<std::size_t>(config.delay_ticks)) waiting.pop_front();
    if (config.fallen && config.fallen()) {
      score.fell_at_s = static_cast<double>(tick + 1) * period_s;
      break;
    }
  }
  const auto count = static_cast<double>(std::max(scored, 1L));
  score.mse_rad2 = squares / count;
  score.torque_rms_Nm = std::sqrt(torque_squares / count);
  score.torque_change_rms_Nm = std::sqrt(change_squares / count);
  score.saturated_share = static_cast<double>(saturated) / count;
  return score;
}

}  // namespace sinew::tune
