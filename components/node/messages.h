// The list of all message types, for explicit instantiation. Internal to this module.
#pragma once

#define SINEW_FOR_EACH_MESSAGE(X) \
  X(JointState)                   \
  X(JointCommand)                 \
  X(ActuatorState)                \
  X(FootForce)                    \
  X(Imu)                          \
  X(BusStatus)                    \
  X(ValveCommand)                 \
  X(PneumaticState)               \
  X(StiffnessRequest)             \
  X(RegimeState)                  \
  X(TorquePrediction)             \
  X(ReservoirState)               \
  X(Readout)                      \
  X(AdaptationState)              \
  X(ResidualState)                \
  X(Reference)                    \
  X(OperatorCommand)              \
  X(MotionRequest)                \
  X(ComponentStatus)              \
  X(SimDisturbance)               \
  X(RecordingProgress)
