#include "components/record/recording/signal_fields.h"

namespace sinew::recording {

const std::vector<SignalField>& SignalFields() {
  using types::Signal;
  static const std::vector<SignalField> kFields = {
      {Signal::kPosition, "joint_state", "position_rad"},
      {Signal::kVelocity, "joint_state", "velocity_rad_s"},
      {Signal::kMotorPosition, "actuator_state", "motor_position_rad"},
      {Signal::kMotorVelocity, "actuator_state", "motor_velocity_rad_s"},
      {Signal::kMotorCurrent, "actuator_state", "motor_current_A"},
      {Signal::kDriveVoltage, "actuator_state", "drive_voltage_V"},
      {Signal::kTorque, "joint_state", "torque_Nm"},
      {Signal::kChamberPressure, "actuator_state", "chamber_pressure_bar"},
      {Signal::kReservoirPressure, "actuator_state", "reservoir_pressure_bar"},
      {Signal::kLoadForce, "actuator_state", "load_force_N"},
      {Signal::kValveOpen, "actuator_state", "valve_open"},
      {Signal::kPayload, "actuator_state", "declared_payload_kg"},
      {Signal::kTemperature, "actuator_state", "motor_temperature_degC"},
      {Signal::kReferencePosition, "reference", "position_rad"},
  };
  return kFields;
}

}  // namespace sinew::recording
