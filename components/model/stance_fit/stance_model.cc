#include "components/model/stance_fit/stance_model.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::stance_fit {

namespace {

constexpr Eigen::Index kUnknownsPerFoot = 3;
constexpr Eigen::Index kBaseRows = arm::kBaseFreedom;
// Rows of the base in (1): moments about x, y, z, forces along x, y, z.
constexpr Eigen::Index kMomentX = 0, kMomentY = 1, kForceZ = 5;
// The row of the base that each kind of unknown, f_x, f_y, m_z, enters by itself.
constexpr std::array<Eigen::Index, kUnknownsPerFoot> kOwnRow = {3, 4, 2};
// Signals have noise of this share of their rms at least (processing_settings.cc).
constexpr double kQuietest = 6e-4;
// Low-pass where no joint moves: four times the sway of a pendulum of 1 m, sqrt(g / l) / 2 pi.
constexpr double kSway_Hz = 2.0;
// Low-pass at the widest: ten harmonics of squats of 2 s, and more than twice the 2 Hz at which
// robots/biped rocks on its feet. The angles of the joints would often allow more, but not the
// rates of the IMU, differentiated: their noise is in the column of a payload and in the declared
// bodies' part of the balance at once, so that a fit cancels it by a payload that is not there.
constexpr double kWidest_Hz = 5.0;
// An angle by which a derivative with respect to the tilt of the IMU is taken; the equations are
// linear in it to 1e-4 of their size.
constexpr double kSmallTilt_rad = 1e-4;

bool IsDriveTerm(const actuator::JointModel& joint, const actuator::Term& term) {
  return joint.Counts(term) && term.effect->info().role == effects::Role::kDrive;
}

const actuator::Term& DriveTerm(const actuator::JointModel& joint) {
  for (const actuator::Term& term : joint.terms) {
    if (IsDriveTerm(joint, term)) return term;
  }
  throw std::invalid_argument("joint '" + joint.name + "' has no drive term");
}

// Joints that the model does not name do not move.
arm::Chain WithRigidToes(arm::Chain chain, const actuator::RobotModel& robot) {
  for (arm::Body& body : chain.bodies) {
    body.moves = body.moves && std::any_of(robot.joints.begin(), robot.joints.end(),
                                           [&](const actuator::JointModel& joint) {
                                             return joint.name == body.joint_name;
                                           });
  }
  return chain;
}

arm::Carried FindLink(const arm::Chain& chain, const arm::MovingLinks& links,
                      const std::string& name) {
  for (std::size_t i = 0; i < chain.bodies.size(); ++i) {
    if (chain.bodies[i].link_name == name) return links.bodies[i];
  }
  throw std::invalid_argument("robot '" + chain.name + "' has no link '" + name + "'");
}

// Low-pass and derivative as those of the angles of joints (identify/processing.h), of columns of a
// matrix whose rows are on an even grid.
Eigen::MatrixXd SmoothColumns(const Eigen::MatrixXd& x, const identify::ProcessingOptions& options,
                              double rate_Hz) {
  Eigen::MatrixXd out(x.rows(), x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    out.col(c) = identify::Smooth(x.col(c), options.state_order, options.state_cutoff_Hz, rate_Hz);
  }
  return out;
}

Eigen::MatrixXd RateOfColumns(const Eigen::MatrixXd& x, double period_s) {
  Eigen::MatrixXd out(x.rows(), x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    out.col(c) = identify::WideDifference(x.col(c), period_s);
  }
  return out;
}

// A joint that travels less than this many steps of its encoder stands: its direction is rounding.
constexpr double kLeastCounts = 50.0;

// Returns whether a joint travels by more than rounding.
bool Travels(const std::vector<types::Run>& runs) {
  double low = HUGE_VAL, high = -HUGE_VAL, step = 0.0;
  for (const types::Run& run : runs) {
    const Eigen::VectorXd& q = run.At(types::Signal::kPosition);
    low = std::min(low, q.minCoeff());
    high = std::max(high, q.maxCoeff());
    step = std::max(step, identify::Resolution(q));
  }
  return high - low > kLeastCounts * step;
}

// Without the turn about the vertical.
Eigen::Quaterniond WithoutHeading(const Eigen::Quaterniond& orientation) {
  const Eigen::Vector3d forward = orientation * Eigen::Vector3d::UnitX();
  const double heading = std::atan2(forward.y(), forward.x());
  return Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * orientation;
}

[[noreturn]] void Fail(const StanceRecording& recording, const std::string& what) {
  throw std::invalid_argument("recording " + recording.name + ": " + what);
}

void CheckRows(const StanceRecording& recording, std::size_t joints) {
  const Eigen::Index rows = recording.size();
  if (recording.joints.size() != joints) {
    Fail(recording,
         std::to_string(recording.joints.size()) + " joints, expected " + std::to_string(joints));
  }
  if (recording.foot_force_N.cols() != kFootSensors || recording.orientation_wxyz.rows() != rows ||
      recording.orientation_wxyz.cols() != 4 || recording.angular_velocity_rad_s.rows() != rows ||
      recording.angular_velocity_rad_s.cols() != 3) {
    Fail(recording, "forces of the feet and IMU do not have the same rows");
  }
  if (!recording.foot_force_N.allFinite() || !recording.orientation_wxyz.allFinite() ||
      !recording.angular_velocity_rad_s.allFinite()) {
    Fail(recording, "a force of the feet or a value of the IMU is not finite");
  }
}

}  // namespace

struct StanceModel::Motion {
  Eigen::MatrixXd q, v, a;               // rows x joints of the dynamics
  std::vector<Eigen::Quaterniond> turn;  // base to world, without heading
  Eigen::MatrixXd w, dw;                 // rows x 3, world axes
  Eigen::MatrixXd origin_v, origin_a;    // of the base, rows x 3, world axes
  Eigen::MatrixXd force_N;               // rows x 8, as measured
  Eigen::RowVectorXd mean_force_N;       // over the rows in use
  Eigen::MatrixXd drive_Nm;              // rows x joints of the model, as measured
  std::vector<std::vector<effects::JointSample>> samples;  // [joint][row]
  std::vector<std::vector<char>> usable;                   // [joint][row]
};

struct StanceModel::Instant {
  std::vector<Eigen::Matrix3d> R;  // of every link, to the base's axes
  std::vector<Eigen::Vector3d> p, axis;
  std::array<Eigen::Vector3d, kFootSensors> sensor;  // from the base's origin, base axes
};

struct StanceModel::Equation {
  Eigen::VectorXd left;                 // S' tau + J' f - Y phi_nominal, 6 + n rows
  Eigen::VectorXd forces, mean_forces;  // J' f
  Eigen::MatrixXd unknown;              // J_t', 6 + n rows x 6
  Eigen::Matrix3d to_ground;            // Cross(G from the base's origin)
  arm::FloatingMotion motion;
};

StanceModel::StanceModel(const arm::Chain& chain, const actuator::RobotModel& robot,
                         const StanceConfig& config)
    : robot_(robot),
      dynamics_(WithRigidToes(chain, robot), Eigen::Vector3d(0.0, 0.0, -config.gravity_m_s2)),
      links_(arm::MovingLinksOf(WithRigidToes(chain, robot))),
      gravity_m_s2_(config.gravity_m_s2) {
  for (const actuator::JointModel& joint : robot.joints) {
    DriveTerm(joint);
    const auto& names = dynamics_.joint_names();
    const auto found = std::find(names.begin(), names.end(), joint.name);
    if (found == names.end()) {
      throw std::invalid_argument("joint '" + joint.name + "' of the model moves nothing in '" +
                                  chain.name + "'");
    }
    joint_.push_back(found - names.begin());
  }
  carries_.assign(links_.links.size(), {false, false});
  std::array<int, kFeet> foot{};
  for (std::size_t k = 0; k < kFootSensors; ++k) {
    sensors_[k] = FindLink(chain, links_, config.force_links[k]);
    const std::size_t side = k / kSensorsPerFoot;
    if (k % kSensorsPerFoot == 0) foot[side] = sensors_[k].link;
    if (sensors_[k].link != foot[side] || sensors_[k].link == arm::kBaseLink) {
      throw std::invalid_argument("link '" + config.force_links[k] +
                                  "' is not on the same foot as '" +
                                  config.force_links[side * kSensorsPerFoot] + "'");
    }
  }
  if (foot[0] == foot[1]) {
    throw std::invalid_argument("links '" + config.force_links.front() + "' and '" +
                                config.force_links.back() + "' are on one foot, expected two");
  }
  for (std::size_t side = 0; side < kFeet; ++side) {
    for (int l = foot[side]; l >= 0; l = links_.links[static_cast<std::size_t>(l)].parent) {
      carries_[static_cast<std::size_t>(l)][side] = true;
    }
  }
  const arm::Carried imu = FindLink(chain, links_, config.imu_link);
  if (imu.link != arm::kBaseLink) {
    throw std::invalid_argument("link '" + config.imu_link + "' is not fixed to the base");
  }
  base_from_imu_ = imu.link_from_body.linear();
  const Instant at = At(Eigen::VectorXd::Zero(dynamics_.joints()));
  for (const Eigen::Vector3d& p : at.p) reach_m_ = std::max(reach_m_, p.norm());
  for (const Eigen::Vector3d& p : at.sensor) reach_m_ = std::max(reach_m_, p.norm());
}

StanceModel::Instant StanceModel::At(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  Instant out;
  const std::size_t count = links_.links.size();
  out.R.resize(count);
  out.p.resize(count);
  out.axis.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const arm::MovingLink& link = links_.links[i];
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    if (link.parent >= 0) {
      R = out.R[static_cast<std::size_t>(link.parent)];
      p = out.p[static_cast<std::size_t>(link.parent)];
    }
    p += R * link.parent_from_joint.translation();
    R = R * link.parent_from_joint.linear();
    const double angle = q[static_cast<Eigen::Index>(i)];
    out.axis[i] = R * link.axis;
    if (link.prismatic) {
      p += angle * out.axis[i];
    } else {
      R = R * Eigen::AngleAxisd(angle, link.axis).toRotationMatrix();
    }
    out.R[i] = R;
    out.p[i] = p;
  }
  for (std::size_t k = 0; k < kFootSensors; ++k) {
    const auto l = static_cast<std::size_t>(sensors_[k].link);
    out.sensor[k] = out.p[l] + out.R[l] * sensors_[k].link_from_body.translation();
  }
  return out;
}

// In the foot's own frame: x and y of the sensors' rectangle.
bool StanceModel::FeetFlat(const Instant& at,
                           const Eigen::Ref<const Eigen::VectorXd>& force_N) const {
  const double least = kLeastLoad * mass_kg() * gravity_m_s2_;
  for (std::size_t side = 0; side < kFeet; ++side) {
    const std::size_t first = side * kSensorsPerFoot;
    const auto l = static_cast<std::size_t>(sensors_[first].link);
    Eigen::Vector2d low = Eigen::Vector2d::Constant(HUGE_VAL), high = -low;
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    double total = 0.0;
    for (std::size_t k = first; k < first + kSensorsPerFoot; ++k) {
      const Eigen::Vector2d here = (at.R[l].transpose() * (at.sensor[k] - at.p[l])).head<2>();
      low = low.cwiseMin(here);
      high = high.cwiseMax(here);
      moment += force_N[static_cast<Eigen::Index>(k)] * here;
      total += force_N[static_cast<Eigen::Index>(k)];
    }
    if (!(total > least)) return false;
    const Eigen::Vector2d off = moment / total - 0.5 * (low + high);
    if (!((off.cwiseAbs() - 0.5 * kCentral * (high - low)).maxCoeff() < 0.0)) return false;
  }
  return true;
}

StanceModel::Motion StanceModel::MotionOf(
    const StanceRecording& recording,
    const std::vector<identify::ProcessingOptions>& processing) const {
  const Eigen::Index rows = recording.size();
  CheckRows(recording, robot_.joints.size());
  Motion out;
  out.force_N = recording.foot_force_N;
  out.mean_force_N = out.force_N.colwise().mean();
  out.q = out.v = out.a = Eigen::MatrixXd::Zero(rows, dynamics_.joints());
  out.drive_Nm.resize(rows, static_cast<Eigen::Index>(robot_.joints.size()));
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    const actuator::JointModel& joint = robot_.joints[j];
    identify::StateSet states = identify::MakeStates({recording.joints[j]}, joint, processing[j]);
    if (states.segments.size() != 1 || states.segments.front().size() != rows) {
      Fail(recording, "rows of joint '" + joint.name + "' are not on an even grid of time");
    }
    identify::StateSegment& segment = states.segments.front();
    const actuator::Term& drive = DriveTerm(joint);
    const std::vector<double> psi = actuator::NonlinearValues(drive);
    for (Eigen::Index i = 0; i < rows; ++i) {
      effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
      out.q(i, joint_[j]) = x.position_rad;
      out.v(i, joint_[j]) = x.velocity_rad_s;
      out.a(i, joint_[j]) = x.acceleration_rad_s2;
      effects::JointSample measured = x;
      measured.drive_input = segment.drive_input[i];
      std::array<double, effects::kMaxParameters> phi{};
      drive.effect->Regressors(measured, psi, {}, phi);
      out.drive_Nm(i, static_cast<Eigen::Index>(j)) = drive.linear.front().value * phi[0];
    }
    out.samples.push_back(std::move(segment.samples));
    out.usable.push_back(std::move(segment.usable));
  }
  const identify::ProcessingOptions& low_pass = processing.front();
  const double rate_Hz = 1.0 / recording.period_s;
  // Small turns against the first orientation, so that they can be filtered.
  std::vector<Eigen::Quaterniond> read;
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto q = recording.orientation_wxyz.row(i);
    const Eigen::Quaterniond world_from_imu(q[0], q[1], q[2], q[3]);
    if (!(std::abs(world_from_imu.norm() - 1.0) < 1e-3))
      Fail(recording, "an orientation is no unit quaternion");
    read.push_back(WithoutHeading(world_from_imu.normalized() *
                                  Eigen::Quaterniond(base_from_imu_).conjugate()));
  }
  Eigen::MatrixXd turn(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::AngleAxisd from_first(read[static_cast<std::size_t>(i)] *
                                       read.front().conjugate());
    turn.row(i) = from_first.angle() * from_first.axis().transpose();
  }
  turn = SmoothColumns(turn, low_pass, rate_Hz);
  const Eigen::MatrixXd w_imu = SmoothColumns(recording.angular_velocity_rad_s, low_pass, rate_Hz);
  out.w.resize(rows, 3);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(rows, 3);  // place of the force sensors, base axes
  for (Eigen::Index i = 0; i < rows; ++i) {
    const double angle = turn.row(i).norm();
    Eigen::Quaterniond now = read.front();
    if (angle > 0.0) now = Eigen::AngleAxisd(angle, turn.row(i).transpose() / angle) * now;
    out.turn.push_back(now);
    out.w.row(i) = now * (base_from_imu_ * w_imu.row(i).transpose());
    const Instant at = At(out.q.row(i).transpose());
    for (const Eigen::Vector3d& sensor : at.sensor)
      mean.row(i) += sensor.transpose() / kFootSensors;
  }
  // Angles and rates are filtered already.
  out.dw = RateOfColumns(out.w, recording.period_s);
  const Eigen::MatrixXd mean_v = RateOfColumns(mean, recording.period_s);
  const Eigen::MatrixXd mean_a = RateOfColumns(mean_v, recording.period_s);
  out.origin_v = out.origin_a = Eigen::MatrixXd::Zero(rows, 3);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const Eigen::Quaterniond& R = out.turn[static_cast<std::size_t>(i)];
    const Eigen::Vector3d w = out.w.row(i), dw = out.dw.row(i);
    const Eigen::Vector3d c = R * mean.row(i).transpose(), v = R * mean_v.row(i).transpose();
    out.origin_v.row(i) = -(w.cross(c) + v);
    out.origin_a.row(i) =
        -(dw.cross(c) + w.cross(w.cross(c)) + 2.0 * w.cross(v) + R * mean_a.row(i).transpose());
  }
  return out;
}

StanceModel::Equation StanceModel::EquationAt(const Motion& motion, Eigen::Index i,
                                              const Eigen::Matrix3d& turned) const {
  Equation out;
  const Instant at = At(motion.q.row(i).transpose());
  const Eigen::Quaterniond orientation(turned *
                                       motion.turn[static_cast<std::size_t>(i)].toRotationMatrix());
  const Eigen::Matrix3d R = orientation.toRotationMatrix();
  const Eigen::Index n = dynamics_.joints();
  out.motion = dynamics_.Rest();
  out.motion.orientation = orientation;
  out.motion.joint_position_rad = motion.q.row(i).transpose();
  out.motion.velocity << motion.w.row(i).transpose(), motion.origin_v.row(i).transpose(),
      motion.v.row(i).transpose();
  out.motion.acceleration << motion.dw.row(i).transpose(), motion.origin_a.row(i).transpose(),
      motion.a.row(i).transpose();

  std::array<Eigen::Vector3d, kFeet> foot;
  foot.fill(Eigen::Vector3d::Zero());
  for (std::size_t k = 0; k < kFootSensors; ++k) {
    foot[k / kSensorsPerFoot] += R * at.sensor[k] / kSensorsPerFoot;
  }
  const Eigen::Vector3d ground = 0.5 * (foot[0] + foot[1]);
  out.to_ground = arm::Cross(ground);
  // A force on a foot at a point: its part in every row.
  const auto add = [&](std::size_t side, const Eigen::Vector3d& point, const Eigen::Vector3d& force,
                       const Eigen::Vector3d& moment, Eigen::Ref<Eigen::VectorXd> rows) {
    rows.head<3>() += (point - ground).cross(force) + moment;
    rows.segment<3>(3) += force;
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto l = static_cast<std::size_t>(j);
      if (!carries_[l][side]) continue;
      const Eigen::Vector3d axis = R * at.axis[l];
      rows[kBaseRows + j] += links_.links[l].prismatic
                                 ? axis.dot(force)
                                 : axis.dot((point - R * at.p[l]).cross(force) + moment);
    }
  };
  out.forces = out.mean_forces = Eigen::VectorXd::Zero(dynamics_.freedom());
  for (std::size_t k = 0; k < kFootSensors; ++k) {
    const auto sensor = static_cast<Eigen::Index>(k);
    const Eigen::Vector3d point = R * at.sensor[k], zero = Eigen::Vector3d::Zero();
    const Eigen::Vector3d measured(0.0, 0.0, motion.force_N(i, sensor));
    const Eigen::Vector3d mean(0.0, 0.0, motion.mean_force_N[sensor]);
    add(k / kSensorsPerFoot, point, measured, zero, out.forces);
    add(k / kSensorsPerFoot, point, mean, zero, out.mean_forces);
  }
  out.unknown = Eigen::MatrixXd::Zero(dynamics_.freedom(), kFeet * kUnknownsPerFoot);
  for (std::size_t side = 0; side < kFeet; ++side) {
    const auto first = static_cast<Eigen::Index>(side) * kUnknownsPerFoot;
    const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
    add(side, foot[side], Eigen::Vector3d::UnitX(), zero, out.unknown.col(first));
    add(side, foot[side], Eigen::Vector3d::UnitY(), zero, out.unknown.col(first + 1));
    add(side, foot[side], zero, Eigen::Vector3d::UnitZ(), out.unknown.col(first + 2));
  }
  // The ground is level: both feet have the height of G.
  out.unknown.topRows<2>().setZero();
  Eigen::VectorXd needed(dynamics_.freedom());
  dynamics_.Force(out.motion, dynamics_.nominal(), needed);
  needed.head<3>() -= out.to_ground * needed.segment<3>(3);
  out.left = out.forces - needed;
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    out.left[kBaseRows + joint_[j]] += motion.drive_Nm(i, static_cast<Eigen::Index>(j));
  }
  return out;
}

StanceLayout StanceModel::Layout(const std::vector<StanceRecording>& train) const {
  if (train.empty()) throw std::invalid_argument("no recording given");
  StanceLayout out;
  out.rate_Hz = 1.0 / train.front().period_s;
  out.moves.assign(robot_.joints.size(), 0);
  for (std::size_t j = 0; j < robot_.joints.size(); ++j) {
    std::vector<types::Run> runs;
    runs.reserve(train.size());
    for (const StanceRecording& recording : train) runs.push_back(recording.joints.at(j));
    out.processing.push_back(
        identify::FromMotion(runs, robot_.joints[j], identify::ProcessingOptions().longest_gap_s));
    double used = 0.0, all = 0.0;
    for (const identify::StateSegment& segment :
         identify::MakeStates(runs, robot_.joints[j], out.processing.back()).segments) {
      used += static_cast<double>(std::count(segment.usable.begin(), segment.usable.end(), 1));
      all += static_cast<double>(segment.size());
    }
    out.moves[j] = used > kLeastMoving * all && Travels(runs);
  }
  // One low-pass for all: the widest of those that move.
  double widest_Hz = 0.0;
  for (std::size_t j = 0; j < out.moves.size(); ++j) {
    const double cutoff_Hz = out.processing[j].state_cutoff_Hz;
    if (out.moves[j]) widest_Hz = std::max(widest_Hz, cutoff_Hz);
  }
  for (identify::ProcessingOptions& options : out.processing) {
    options.state_cutoff_Hz = widest_Hz > 0.0 ? std::min(widest_Hz, kWidest_Hz) : kSway_Hz;
    options.border_s = 2.0 / options.state_cutoff_Hz;
  }
  out.groups = Groups(out.moves);
  out.rows = {kMomentX, kMomentY, kForceZ};
  for (std::size_t j = 0; j < joint_.size(); ++j) {
    if (out.moves[j]) out.rows.push_back(kBaseRows + static_cast<Eigen::Index>(j));
  }
  FindBasis(train, &out);
  FindAxes(train, &out);
  return out;
}

void StanceModel::FindAxes(const std::vector<StanceRecording>& train, StanceLayout* layout) const {
  std::vector<Eigen::Vector3d> sum(layout->groups.size(), Eigen::Vector3d::Zero());
  double count = 0.0;
  for (const StanceRecording& recording : train) {
    const Motion motion = MotionOf(recording, layout->processing);
    for (const Eigen::Index i : RowsInUse(motion, *layout)) {
      const Instant at = At(motion.q.row(i).transpose());
      const Eigen::Vector3d up =
          motion.turn[static_cast<std::size_t>(i)].conjugate() * Eigen::Vector3d::UnitZ();
      for (std::size_t g = 0; g < sum.size(); ++g) {
        const int link = layout->groups[g].link;
        sum[g] += link < 0 ? up : at.R[static_cast<std::size_t>(link)].transpose() * up;
      }
      count += 1.0;
    }
  }
  for (std::size_t g = 0; g < sum.size(); ++g) {
    RigidGroup& group = layout->groups[g];
    // The mean of unit vectors has the length sqrt(1 - mean square of their distances to it).
    const Eigen::Vector3d mean = sum[g] / std::max(1.0, count);
    const double turn_rad = std::sqrt(std::max(0.0, 1.0 - mean.squaredNorm()));
    group.excited = turn_rad > kLeastTurn_rad ? 3 : 2;
    group.axes.col(2) = mean.normalized();
    const Eigen::Vector3d other = std::abs(group.axes(1, 2)) < std::abs(group.axes(0, 2))
                                      ? Eigen::Vector3d::UnitY()
                                      : Eigen::Vector3d::UnitX();
    group.axes.col(1) = group.axes.col(2).cross(other).normalized();
    group.axes.col(0) = group.axes.col(1).cross(group.axes.col(2));
  }
}

std::vector<Eigen::Index> StanceModel::RowsInUse(const Motion& motion,
                                                 const StanceLayout& layout) const {
  std::vector<Eigen::Index> out;
  const Eigen::Index rows = motion.q.rows();
  const auto border =
      static_cast<Eigen::Index>(std::lround(layout.processing.front().border_s * layout.rate_Hz));
  for (Eigen::Index i = border; i < rows - border; ++i) {
    bool used = true;
    for (std::size_t j = 0; j < layout.moves.size() && used; ++j) {
      used = !layout.moves[j] || motion.usable[j][static_cast<std::size_t>(i)] != 0;
    }
    if (used && FeetFlat(At(motion.q.row(i).transpose()), motion.force_N.row(i).transpose())) {
      out.push_back(i);
    }
  }
  return out;
}

std::vector<Eigen::Index> StanceModel::OfDynamics(const StanceLayout& layout) const {
  std::vector<Eigen::Index> out = layout.rows;
  for (Eigen::Index& row : out) {
    if (row >= kBaseRows) row = kBaseRows + joint_[static_cast<std::size_t>(row - kBaseRows)];
  }
  return out;
}

std::vector<Eigen::Index> StanceModel::UnknownsOf(const StanceLayout& layout) {
  std::vector<Eigen::Index> out;
  for (Eigen::Index c = 0; c < kFeet * kUnknownsPerFoot; ++c) {
    const Eigen::Index row = kOwnRow[static_cast<std::size_t>(c % kUnknownsPerFoot)];
    if (std::find(layout.rows.begin(), layout.rows.end(), row) != layout.rows.end()) {
      out.push_back(c);
    }
  }
  return out;
}

void StanceModel::FindBasis(const std::vector<StanceRecording>& train, StanceLayout* layout) const {
  std::map<Eigen::Index, std::vector<Eigen::VectorXd>> signals;  // of rows of (1)
  std::map<Eigen::Index, double> power;                          // of what the feet measure there
  double used = 0.0;
  std::optional<Equation> first;
  for (const StanceRecording& recording : train) {
    const Motion motion = MotionOf(recording, layout->processing);
    const std::vector<Eigen::Index> rows = OfDynamics(*layout);
    for (const Eigen::Index row : rows) signals[row].emplace_back(recording.size());
    for (Eigen::Index i = 0; i < recording.size(); ++i) {
      const Equation equation = EquationAt(motion, i, Eigen::Matrix3d::Identity());
      for (const Eigen::Index row : rows) {
        signals[row].back()[i] = equation.left[row];
        power[row] += std::pow(equation.forces[row], 2);
      }
    }
    used += static_cast<double>(recording.size());
    const std::vector<Eigen::Index> in_use = RowsInUse(motion, *layout);
    if (in_use.empty() || first) continue;
    first = EquationAt(motion, in_use.front(), Eigen::Matrix3d::Identity());
  }
  if (!first) {
    throw identify::TooLittleData(
        "no row of the recordings has both feet flat and all moving "
        "joints in motion");
  }
  const auto noise_of = [&](Eigen::Index row) {
    return std::max(identify::WhiteNoise(signals.at(row)),
                    kQuietest * std::sqrt(power.at(row) / used));
  };
  // Kinds of unknowns that the moving joints feel.
  const std::vector<Eigen::Index> joints = OfDynamics(*layout);
  for (Eigen::Index kind = 0; kind < kUnknownsPerFoot; ++kind) {
    const Eigen::Index row = kOwnRow[static_cast<std::size_t>(kind)];
    double largest = 0.0;
    for (Eigen::Index c = kind; c < kFeet * kUnknownsPerFoot; c += kUnknownsPerFoot) {
      for (const Eigen::Index joint : joints) {
        if (joint >= kBaseRows) largest = std::max(largest, std::abs(first->unknown(joint, c)));
      }
    }
    const bool moment = row < 3;
    if (largest > kWeakest * (moment ? 1.0 : reach_m_)) layout->rows.push_back(row);
  }
  std::sort(layout->rows.begin() + 3, layout->rows.end());
  const std::vector<Eigen::Index> rows = OfDynamics(*layout);
  const auto count = static_cast<Eigen::Index>(rows.size());
  layout->noise.resize(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const Eigen::Index row = rows[static_cast<std::size_t>(r)];
    // Rows without a sensor of their own have the noise of their like.
    layout->noise[r] = row == 3 || row == 4 ? noise_of(kForceZ)
                       : row == 2           ? std::max(noise_of(kMomentX), noise_of(kMomentY))
                                            : noise_of(row);
  }
  if (!(layout->noise.minCoeff() > 0.0)) {
    throw identify::TooLittleData("a joint that moves or the feet carry no load");
  }
  const std::vector<Eigen::Index> unknown = UnknownsOf(*layout);
  layout->unknowns = static_cast<Eigen::Index>(unknown.size());
  const Eigen::MatrixXd scaled =
      layout->noise.cwiseInverse().asDiagonal() * first->unknown(rows, unknown);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled * scaled.transpose());
  layout->start = eigen.eigenvectors().leftCols(count - layout->unknowns);
}

StanceRows StanceModel::Rows(const StanceRecording& recording, const StanceLayout& layout) const {
  Motion motion = MotionOf(recording, layout.processing);
  const std::vector<Eigen::Index> used = RowsInUse(motion, layout);
  if (!used.empty()) motion.mean_force_N = motion.force_N(used, Eigen::all).colwise().mean();
  const std::vector<Eigen::Index> rows = OfDynamics(layout), unknown = UnknownsOf(layout);
  const auto n = static_cast<Eigen::Index>(used.size());
  const Eigen::Index m = layout.channels();
  const auto groups = static_cast<Eigen::Index>(layout.groups.size());
  StanceRows out;
  out.name = recording.name;
  out.recorded = recording.size();
  out.time_s.resize(n);
  out.joints.resize(robot_.joints.size());
  out.drive.resize(n, motion.drive_Nm.cols());
  out.target.resize(n * m);
  out.forces.resize(n * m, 1);
  out.bodies.resize(n * m, kPayloadColumns * groups);
  out.tilt.resize(n * m, 2);
  out.base.resize(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index at = used[static_cast<std::size_t>(i)];
    out.time_s[i] = recording.period_s * static_cast<double>(at);
    if (i == 0 || used[static_cast<std::size_t>(i - 1)] != at - 1) out.stretches.push_back({i, 0});
    ++out.stretches.back().count;
    for (std::size_t j = 0; j < out.joints.size(); ++j) {
      out.joints[j].push_back(motion.samples[j][static_cast<std::size_t>(at)]);
    }
    out.drive.row(i) = motion.drive_Nm.row(at);
    const Equation equation = EquationAt(motion, at, Eigen::Matrix3d::Identity());
    const Eigen::MatrixXd scaled =
        layout.noise.cwiseInverse().asDiagonal() * equation.unknown(rows, unknown);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_unknown(scaled * scaled.transpose());
    const Eigen::MatrixXd U = of_unknown.eigenvectors().rightCols(layout.unknowns);
    const Eigen::MatrixXd free = layout.start - U * (U.transpose() * layout.start);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> of_free(free.transpose() * free);
    const Eigen::MatrixXd basis = free * of_free.operatorInverseSqrt();
    const Eigen::MatrixXd project = basis.transpose() * layout.noise.cwiseInverse().asDiagonal();
    out.target.segment(i * m, m) = project * equation.left(rows);
    out.forces.block(i * m, 0, m, 1) = -project * equation.mean_forces(rows);
    out.base.row(i) << equation.left[kMomentX], equation.left[kMomentY], equation.left[kForceZ];
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
      const Eigen::Matrix3d turned =
          Eigen::AngleAxisd(kSmallTilt_rad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
      const Equation tilted = EquationAt(motion, at, turned);
      out.tilt.block(i * m, axis, m, 1) =
          project * ((tilted.left - equation.left) / kSmallTilt_rad)(rows);
    }
    Eigen::MatrixXd Y = dynamics_.Regressor(equation.motion);
    Y.topRows<3>() -= equation.to_ground * Y.middleRows<3>(3);
    for (Eigen::Index g = 0; g < groups; ++g) {
      const int link = layout.groups[static_cast<std::size_t>(g)].link;
      const Eigen::Index first = arm::kParametersPerBody * (link + 1);
      out.bodies.block(i * m, kPayloadColumns * g, m, kPayloadColumns) =
          project * Y(rows, Eigen::seqN(first, kPayloadColumns));
    }
    out.project.push_back(project);
  }
  return out;
}

}  // namespace sinew::stance_fit
