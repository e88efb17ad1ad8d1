#include "components/robot/provider/participant/state_publisher.h"

#include "components/base/types/clock/clock.h"
#include "components/base/types/joint_kind.h"
#include "components/robot/provider/participant/simulation_messages.h"

namespace sinew::provider {

StatePublisher::StatePublisher(node::Node& node, const Plant& plant)
    : plant_(plant),
      simulated_(dynamic_cast<const SimulatedPlant*>(&plant)),
      joint_state_(node.MakeWriter(node::kJointState)),
      actuator_state_(node.MakeWriter(node::kActuatorState)) {
  if (plant.bus_report() != nullptr) bus_status_.emplace(node.MakeWriter(node::kBusStatus));
  if (plant.body_sensors() != nullptr) {
    foot_force_.emplace(node.MakeWriter(node::kFootForce));
    imu_.emplace(node.MakeWriter(node::kImu));
  }
  if (simulated_ != nullptr) sim_truth_.emplace(node.MakeWriter(node::kSimTruth));
  if (simulated_ != nullptr && simulated_->body_truth() != nullptr) {
    sim_body_truth_.emplace(node.MakeWriter(node::kSimBodyTruth));
  }
  const auto joints = static_cast<std::size_t>(plant.joint_count());
  joints_.joint_count = static_cast<std::uint8_t>(joints);
  actuators_.joint_count = static_cast<std::uint8_t>(joints);
  for (std::size_t j = 0; j < joints; ++j) {
    joints_.joint_kind[j] = plant.prismatic(static_cast<int>(j)) ? types::JointKind::kPrismatic
                                                                 : types::JointKind::kRevolute;
  }
}

void StatePublisher::Publish(const types::MessageHeader& header, types::RobotState state,
                             const types::Fault& fault, bool last_tick, double period_s,
                             const PlantSensors& sensors) {
  FillActuatorState(header, sensors);
  Count(actuator_state_.Write(actuators_));
  if (foot_force_) PublishBody(header, *plant_.body_sensors());
  if (sim_truth_) {
    Count(sim_truth_->Write(ToMessage(header, plant_.joint_count(), simulated_->gear_truth())));
  }
  if (sim_body_truth_) Count(sim_body_truth_->Write(ToMessage(header, *simulated_->body_truth())));
  joints_.robot_state = state;
  joints_.fault = types::ToMessage(fault);
  joints_.last_tick = last_tick;
  joints_.period_s = period_s;
  joints_.measured_period_s =
      last_stamp_ns_ ? 1e-9 * static_cast<double>(header.stamp_ns - *last_stamp_ns_) : period_s;
  last_stamp_ns_ = header.stamp_ns;
  FillJointState(header, sensors);
  written_ns_ = types::MonotonicNow_ns();
  Count(joint_state_.Write(joints_));
  if (bus_status_) PublishBus(header, *plant_.bus_report());
}

void StatePublisher::FillJointState(const msg::Header& header, const PlantSensors& sensors) {
  joints_.header = header;
  joints_.position_rad = sensors.position_rad;
  joints_.velocity_rad_s = sensors.velocity_rad_s;
  joints_.torque_Nm = sensors.torque_Nm;
  joints_.age_us = sensors.age_us;
  joints_.valid = sensors.valid;
  for (std::size_t j = 0; j < sensors.joint_fault.size(); ++j) {
    joints_.joint_fault[j] = sensors.joint_fault[j].cause;
  }
}

void StatePublisher::FillActuatorState(const msg::Header& header, const PlantSensors& sensors) {
  actuators_.header = header;
  actuators_.motor_position_rad = sensors.motor_position_rad;
  actuators_.motor_velocity_rad_s = sensors.motor_velocity_rad_s;
  actuators_.motor_current_A = sensors.motor_current_A;
  actuators_.drive_voltage_V = sensors.drive_voltage_V;
  actuators_.motor_temperature_degC = sensors.motor_temperature_degC;
  actuators_.chamber_pressure_bar = sensors.chamber_pressure_bar;
  actuators_.reservoir_pressure_bar = sensors.reservoir_pressure_bar;
  actuators_.load_force_N = sensors.load_force_N;
  actuators_.declared_payload_kg = sensors.declared_payload_kg;
  actuators_.valve_open = sensors.valve_open;
  actuators_.valid = sensors.valid;
  actuators_.measured_flags = plant_.measured_flags();
}

void StatePublisher::PublishBody(const msg::Header& header, const BodySensors& body) {
  msg::FootForce feet;
  feet.header = header;
  feet.force_N = body.foot_force_N;
  feet.valid = body.foot_valid;
  Count(foot_force_->Write(feet));
  msg::Imu imu;
  imu.header = header;
  imu.acceleration_m_s2 = body.acceleration_m_s2;
  imu.angular_velocity_rad_s = body.angular_velocity_rad_s;
  imu.orientation_wxyz = body.orientation_wxyz;
  imu.valid = body.imu_valid;
  Count(imu_->Write(imu));
}

void StatePublisher::PublishBus(const msg::Header& header, const BusReport& report) {
  msg::BusStatus status;
  status.header = header;
  status.bus_count = static_cast<std::uint8_t>(report.bus_count);
  status.up = report.up;
  status.frames_sent = report.frames_sent;
  status.frames_received = report.frames_received;
  status.frames_dropped = report.frames_dropped;
  status.frames_lost = report.frames_lost;
  status.error_frames = report.error_frames;
  status.body_samples_missed = report.body_samples_missed;
  status.body_nodes_lost = report.body_nodes_lost;
  status.load_percent = report.load_percent;
  status.answer_p50_us = report.answer_p50_us;
  status.answer_max_us = report.answer_max_us;
  status.cycle_p50_us = report.cycle_p50_us;
  status.cycle_max_us = report.cycle_max_us;
  Count(bus_status_->Write(status));
}

}  // namespace sinew::provider
