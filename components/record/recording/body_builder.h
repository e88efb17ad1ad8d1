// Builds the signals of a robot's body - forces of the feet, IMU - out of a recording's messages.
#pragma once

#include <Eigen/Core>
#include <string>

#include "components/record/recording/mcap_reader.h"

namespace sinew::recording {

inline constexpr int kFootSensors = 8;

// One row for each tick in which all sensors of foot_force and the IMU were valid and finite and
// joint_state had a later stamp than in the row before.
struct BodyRun {
  Eigen::VectorXd time_s;                  // stamp of the tick's joint_state, as Run::time_s
  Eigen::MatrixXd foot_force_N;            // rows x 8, order of the topic, positive when pressed
  Eigen::MatrixXd orientation_wxyz;        // rows x 4, unit quaternions, IMU to world
  Eigen::MatrixXd angular_velocity_rad_s;  // rows x 3, IMU axes
};

// `name` stands for the file. Throws McapError for a broken file, std::invalid_argument for a
// recording without one of the topics joint_state, foot_force and imu, without any row, or of more
// than one session.
BodyRun BodyOfRecording(const McapReader& reader, const std::string& name);

}  // namespace sinew::recording
