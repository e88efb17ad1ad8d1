// A robot that stands on two flat feet: its recordings, and the equations of the floating base that
// they close.
//
//     Y(q, nu, nu') phi = S' tau + S' e(theta) + J' f + J_t' lambda        (6 + n rows)       (1)
//
// Y phi: what bodies and gravity need (arm/floating_dynamics.h); tau: measured drive torque of the
// n joints; e: friction and other effects of the joints' models, positive in +position; f: the
// measured normal forces of the feet; lambda = (f_x, f_y, m_z) of each foot, which no sensor
// measures. Rows of the base in world axes of the base's heading: moments about the point G on the
// ground midway between the feet, then forces.
//
// (1) is multiplied by a basis of what is orthogonal to W J_t' (W: one over the noise of each row),
// so that lambda leaves it. Rows in use: every moving joint away from rest and reversals
// (identify/processing.h), and both feet flat: a foot that carries less than kLeastLoad of the
// weight, or whose centre of pressure is outside of kCentral of the span of its sensors, tips.
// The motion of the base is that of the IMU and of feet that do not slide. Derivation: README.md.
//
// SI; joints rad and Nm. Pure; allocates. Throws std::invalid_argument for what does not fit
// together, identify::TooLittleData where no row is left.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/base/types/run.h"
#include "components/bodies/dynamics/floating_dynamics.h"
#include "components/bodies/links/links.h"
#include "components/model/actuator/model.h"
#include "components/model/effects/sample.h"
#include "components/model/identify/processing_settings.h"
#include "components/model/trace/noise_model.h"

namespace sinew::stance_fit {

inline constexpr int kFeet = 2;
inline constexpr int kSensorsPerFoot = 4;
inline constexpr int kFootSensors = kFeet * kSensorsPerFoot;
inline constexpr int kPayloadColumns = 4;  // m, m x, m y, m z

// Shares of the weight, on each foot; of the span of a foot's sensors, about its middle; of the
// reach. A foot with less tips at the next sway; the third is above what roll and yaw of 0.05 rad
// turn of a lever arm as long as the reach.
inline constexpr double kLeastLoad = 0.15;
inline constexpr double kCentral = 0.9;
inline constexpr double kWeakest = 0.1;

// Turn of a link against the vertical that a payload's place along the vertical needs to show, rms.
// The moment of a place c along it is m g c sin(turn); below this, what the noise of the IMU puts
// into the same column, and into the declared bodies' part of the balance, is as large: the
// estimate would cancel that noise by a payload far below the ground.
inline constexpr double kLeastTurn_rad = 0.1;

// A joint moves when it is in use in this share of the rows; else it stands. Guards about reversals
// leave a third of the strokes of one that moves all the time (identify/processing_settings.cc),
// the borders of a recording half of that; of one that stands noise leaves none.
inline constexpr double kLeastMoving = 0.1;

// Links of the chain, in the order of the topic foot_force: right 0-3, left 4-7; a foot's sensors
// are at the corners of a rectangle, in any order.
struct StanceConfig {
  std::array<std::string, kFootSensors> force_links = {
      "right_force_rear_outer",  "right_force_rear_inner", "right_force_front_outer",
      "right_force_front_inner", "left_force_rear_outer",  "left_force_rear_inner",
      "left_force_front_outer",  "left_force_front_inner"};
  std::string imu_link = "imu";
  double gravity_m_s2 = types::kGravity_m_s2;
};

// On an even grid of time.
struct StanceRecording {
  std::string name;
  double period_s = 0.0;
  std::vector<types::Run> joints;          // in the order of the model: angle and drive
  Eigen::MatrixXd foot_force_N;            // rows x 8, normal, positive when pressed
  Eigen::MatrixXd orientation_wxyz;        // rows x 4, unit quaternions, IMU to world
  Eigen::MatrixXd angular_velocity_rad_s;  // rows x 3, IMU axes

  Eigen::Index size() const { return foot_force_N.rows(); }
};

// Links that no moving joint parts.
struct RigidGroup {
  int link = arm::kBaseLink;            // nearest to the base, whose frame counts
  std::string name;                     // of that link
  std::vector<std::string> link_names;  // all of them, links on fixed joints apart
  // Centre of mass of the first link, in its frame; and how far the farthest link or joint of the
  // group is from it, joints at 0.
  Eigen::Vector3d center_m = Eigen::Vector3d::Zero();
  double size_m = 0.0;
  // Axes of the place of a payload on it, an orthonormal basis in the first link's frame; the last
  // axis is the mean direction of the vertical. The first `excited` of them show: the last only
  // where the vertical turns against the link by kLeastTurn_rad, rms.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  int excited = 2;
};

// Properties that all recordings of one analysis share: found from those that are trained on.
struct StanceLayout {
  std::vector<identify::ProcessingOptions> processing;  // of each joint, one low-pass for all
  double rate_Hz = 0.0;
  std::vector<char> moves;         // of each joint of the model
  std::vector<RigidGroup> groups;  // the base's first
  // Rows of (1) that are used: m_x, m_y and f_z first, then others of the base, then moving joints,
  // numbered as joints of the model from 6 on.
  std::vector<Eigen::Index> rows;
  Eigen::VectorXd noise;      // of each of them, N or Nm: 1 / W
  Eigen::MatrixXd start;      // N_0, rows x channels
  Eigen::Index unknowns = 0;  // of lambda

  Eigen::Index channels() const { return start.cols(); }
};

// Rows in use of one recording. Entry [i * channels + c] of a stacked column is channel c of the
// i-th used row.
struct StanceRows {
  std::string name;
  Eigen::VectorXd time_s;                 // of the used rows
  std::vector<trace::Stretch> stretches;  // of used rows that follow each other
  std::vector<Eigen::MatrixXd> project;   // N' W, channels x layout.rows, per used row
  std::vector<std::vector<effects::JointSample>> joints;  // [joint][used row]
  Eigen::MatrixXd drive;   // used rows x joints, measured torque at the declared drive factor
  Eigen::VectorXd target;  // S' tau + J' f - Y phi_nominal, stacked
  Eigen::MatrixXd bodies;  // Y of m, m x, m y, m z of each group's first link, stacked
  // -J' of the recording's mean forces: all sensors read too high by the same share, stacked. Not
  // of the forces themselves: their noise is in the target as well.
  Eigen::MatrixXd forces;
  Eigen::MatrixXd tilt;       // of target per rad by which the IMU is turned about x, y, stacked
  Eigen::MatrixXd base;       // target of the three rows that close alone: m_x, m_y, f_z
  Eigen::Index recorded = 0;  // rows of the recording

  Eigen::Index size() const { return time_s.size(); }
  Eigen::Index stacked() const { return target.size(); }
  // A torque at a joint of the model, per used row, as a stacked column; zero for one that stands.
  Eigen::VectorXd AtJoint(const StanceLayout& layout, std::size_t joint,
                          const Eigen::Ref<const Eigen::VectorXd>& torque_Nm) const;
};

class StanceModel {
 public:
  // Throws std::invalid_argument naming the link or joint: one that the chain lacks, a force link
  // that is not on one of two feet, an IMU that is not fixed to the base, a joint without a drive.
  StanceModel(const arm::Chain& chain, const actuator::RobotModel& robot,
              const StanceConfig& config = {});

  const actuator::RobotModel& robot() const { return robot_; }
  double mass_kg() const { return dynamics_.mass_kg(); }
  // Nominal mass of a group, kg.
  double MassOf(const RigidGroup& group) const;

  // Throws identify::TooLittleData where no recording has a row with flat feet.
  StanceLayout Layout(const std::vector<StanceRecording>& train) const;
  StanceRows Rows(const StanceRecording& recording, const StanceLayout& layout) const;

 private:
  struct Motion;    // of one recording: base and joints at every row
  struct Instant;   // kinematics at one row
  struct Equation;  // (1) at one row
  Motion MotionOf(const StanceRecording& recording,
                  const std::vector<identify::ProcessingOptions>& processing) const;
  Instant At(const Eigen::Ref<const Eigen::VectorXd>& q) const;
  bool FeetFlat(const Instant& at, const Eigen::Ref<const Eigen::VectorXd>& force_N) const;
  Equation EquationAt(const Motion& motion, Eigen::Index i, const Eigen::Matrix3d& turned) const;
  std::vector<RigidGroup> Groups(const std::vector<char>& moves) const;
  // Middle and size; group_of: of each moving link.
  void Measure(const std::vector<std::size_t>& group_of, std::vector<RigidGroup>* groups) const;
  std::vector<Eigen::Index> RowsInUse(const Motion& motion, const StanceLayout& layout) const;
  // Axes of the groups, from the vertical in the rows in use.
  void FindAxes(const std::vector<StanceRecording>& train, StanceLayout* layout) const;
  // Numbers of the layout's rows in the order of the dynamics.
  std::vector<Eigen::Index> OfDynamics(const StanceLayout& layout) const;
  // Columns of J_t' that the layout's rows contain.
  static std::vector<Eigen::Index> UnknownsOf(const StanceLayout& layout);
  // Noise, unknowns and start of a layout, and the rows that the unknowns enter by themselves.
  void FindBasis(const std::vector<StanceRecording>& train, StanceLayout* layout) const;

  actuator::RobotModel robot_;
  mutable arm::FloatingDynamics dynamics_;  // its scratch
  arm::MovingLinks links_;
  std::vector<Eigen::Index> joint_;  // of the dynamics, for each joint of the model
  std::array<arm::Carried, kFootSensors> sensors_;
  std::vector<std::array<bool, kFeet>> carries_;  // [link]: is it on the way to that foot?
  Eigen::Matrix3d base_from_imu_ = Eigen::Matrix3d::Identity();
  double gravity_m_s2_;
  // Largest distance of a joint or force sensor from the base's origin, joints at 0.
  double reach_m_ = 0.0;
};

}  // namespace sinew::stance_fit
