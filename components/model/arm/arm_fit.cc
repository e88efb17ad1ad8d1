#include "components/model/arm/arm_fit.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/model/identify/block_regression.h"
#include "components/model/identify/statistics.h"

namespace sinew::arm {

namespace {

constexpr double kBlock_s = 2.0;  // of the scores behind the intervals

bool IsRigid(const actuator::Term& term) { return term.effect->info().name == "rigid_body"; }
// Normal equations of the first `rigid` unknowns, the others fitted as well (Schur complement).
identify::Moments OfBodies(const identify::Moments& sums, Eigen::Index rigid) {
  const Eigen::Index rest = sums.m.size() - rigid;
  const Eigen::MatrixXd cross = sums.G.topRightCorner(rigid, rest);
  const auto freed = [&](const Eigen::VectorXd& of_rest) {
    return identify::Solve(sums.G.bottomRightCorner(rest, rest), of_rest);
  };
  identify::Moments out{sums.G.topLeftCorner(rigid, rigid),
                        sums.m.head(rigid) - cross * freed(sums.m.tail(rest))};
  for (Eigen::Index c = 0; c < rigid; ++c) out.G.col(c) -= cross * freed(cross.row(c).transpose());
  return out;
}

// Estimate of the first `rigid` unknowns by normal equations, against a fit b of all. scale: a size
// of each unknown's information; louder: standard deviation of the rows' noise.
RigidPrior PriorFrom(const identify::Moments& sums, const Eigen::VectorXd& b, Eigen::Index rigid,
                     const Eigen::VectorXd& scale, double louder) {
  // A direction about which others know less than this part of what all know is open.
  constexpr double kOpen = 1e-6;
  const identify::Moments own = OfBodies(sums, rigid);
  const Eigen::VectorXd unit = (scale.array() > 0.0).select(scale.cwiseInverse(), 1.0);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(unit.asDiagonal() * own.G *
                                                             unit.asDiagonal());
  RigidPrior out;
  out.directions = unit.asDiagonal() * eigen.eigenvectors();
  out.mean = Eigen::VectorXd::Zero(rigid);
  out.spread = Eigen::VectorXd::Zero(rigid);
  const Eigen::VectorXd known = out.directions.transpose() * (own.m - own.G * b.head(rigid));
  for (Eigen::Index k = 0; k < rigid; ++k) {
    const double information = eigen.eigenvalues()[k];
    if (information < kOpen) continue;
    out.mean[k] = known[k] / information;
    out.spread[k] = louder / std::sqrt(information);
  }
  return out;
}

// T + known - Y phi_urdf = Y_independent dbeta - friction theta, a block per joint.
struct Stack {
  Eigen::Index unknowns = 0;
  std::vector<const identify::Rows*> rows{};
  std::vector<Eigen::MatrixXd> X{};
  std::vector<Eigen::VectorXd> y{};

  // Normal equations of a block, or of all rows, with a weight per joint.
  identify::Moments Sums(const identify::Block* block, const std::vector<double>& weight) const {
    identify::Moments total{Eigen::MatrixXd::Zero(unknowns, unknowns),
                            Eigen::VectorXd::Zero(unknowns)};
    for (std::size_t j = 0; j < X.size(); ++j) {
      identify::Block used;
      if (block == nullptr) {
        used = rows[j]->UsedRows();
      } else {
        for (const Eigen::Index i : *block) {
          if (rows[j]->used[static_cast<std::size_t>(i)]) used.push_back(i);
        }
      }
      if (used.empty()) continue;
      const identify::Moments part = identify::MomentsOf(used, X[j], y[j]);
      const double w = weight[j] * weight[j];
      total.G += w * part.G;
      total.m += w * part.m;
      total.yy += w * part.yy;
      total.rows += part.rows;
    }
    return total;
  }
};

// One over the residual rms of each joint in a first pass; b: solution of the second.
std::vector<double> Weigh(const Stack& stack, Eigen::VectorXd* b) {
  std::vector<double> weight(stack.X.size(), 1.0);
  for (int pass = 0; pass < 2; ++pass) {
    const identify::Moments total = stack.Sums(nullptr, weight);
    if (total.rows < 2.0 * static_cast<double>(stack.unknowns)) {
      throw std::invalid_argument("recordings have " +
                                  std::to_string(static_cast<int>(total.rows)) +
                                  " moving rows of all joints, too few to fit " +
                                  std::to_string(stack.unknowns) + " parameters");
    }
    *b = identify::Solve(total.G, total.m);
    for (std::size_t j = 0; pass == 0 && j < stack.X.size(); ++j) {
      const identify::Block used = stack.rows[j]->UsedRows();
      double squares = 0.0;
      for (const Eigen::Index i : used) {
        squares += std::pow(stack.y[j][i] - stack.X[j].row(i).dot(*b), 2);
      }
      const double rms =
          std::sqrt(squares / std::max<double>(1.0, static_cast<double>(used.size())));
      weight[j] = rms > 0.0 ? 1.0 / rms : 1.0;
    }
  }
  return weight;
}

}  // namespace

// One joint's part of the regression.
struct Arm::Joint {
  identify::Rows rows;
  identify::Balance balance;  // its rigid bodies need nothing
  Eigen::MatrixXd rigid;      // rows x all inertial parameters
};

Arm::Arm(const Chain& chain, const actuator::RobotModel& robot)
    : dynamics_(chain), base_(FindBaseParameters(dynamics_)) {
  const std::vector<std::string>& names = dynamics_.joint_names();
  for (const actuator::JointModel& joint : robot.joints) {
    const auto found = std::find(names.begin(), names.end(), joint.name);
    if (found == names.end()) {
      std::string list;
      for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
      throw std::invalid_argument("joint '" + joint.name + "' of the model is no moving joint of " +
                                  "the URDF '" + chain.name + "', expected one of: " + list);
    }
    row_.push_back(static_cast<int>(found - names.begin()));
    const int body = FindJoint(chain, joint.name);
    effort_.push_back(chain.bodies[static_cast<std::size_t>(body)].effort);
    if (joint.Find("rigid_body") < 0) {
      throw std::invalid_argument("joint '" + joint.name +
                                  "' has no term rigid_body, expected it on every joint of an arm");
    }
  }
  if (row_.size() != names.size()) {
    throw std::invalid_argument("the model describes " + std::to_string(row_.size()) +
                                " joints, the URDF '" + chain.name + "' has " +
                                std::to_string(names.size()) + " that move");
  }
}

std::vector<identify::StateSet> Arm::States(
    const ArmRuns& runs, const actuator::RobotModel& robot,
    const std::vector<identify::ProcessingOptions>& processing) const {
  std::vector<identify::StateSet> states;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    std::vector<types::Run> bare = runs.at(j);
    for (types::Run& run : bare) {
      run.rigid_torque.clear();
      run.rigid_torque_later = true;
    }
    states.push_back(identify::MakeStates(bare, robot.joints[j], processing[j]));
    const identify::StateSet& first = states.front();
    bool same = states[j].segments.size() == first.segments.size();
    for (std::size_t s = 0; same && s < first.segments.size(); ++s) {
      same = states[j].segments[s].size() == first.segments[s].size();
    }
    if (!same) {
      throw std::invalid_argument("recordings of joint '" + robot.joints[j].name +
                                  "' have other pieces than those of joint '" +
                                  robot.joints[0].name + "', expected the same rows for all");
    }
  }
  return states;
}

void Arm::StateAt(const std::vector<identify::StateSet>& states, std::size_t segment,
                  Eigen::Index i, Eigen::VectorXd* q, Eigen::VectorXd* v,
                  Eigen::VectorXd* a) const {
  for (std::size_t j = 0; j < states.size(); ++j) {
    const effects::JointSample& x =
        states[j].segments[segment].samples[static_cast<std::size_t>(i)];
    const auto row = static_cast<Eigen::Index>(row_[j]);
    (*q)[row] = x.position_rad;
    (*v)[row] = x.velocity_rad_s;
    (*a)[row] = x.acceleration_rad_s2;
  }
}

std::vector<std::vector<Eigen::MatrixXd>> Arm::Regressors(
    const std::vector<identify::StateSet>& states) const {
  const Eigen::Index n = dynamics_.joints();
  std::vector<std::vector<Eigen::MatrixXd>> out(states.size());
  Eigen::VectorXd q(n), v(n), a(n);
  for (std::size_t s = 0; s < states.front().segments.size(); ++s) {
    const Eigen::Index samples = states.front().segments[s].size();
    for (auto& of_joint : out) of_joint.emplace_back(samples, dynamics_.parameters());
    for (Eigen::Index i = 0; i < samples; ++i) {
      StateAt(states, s, i, &q, &v, &a);
      const Eigen::MatrixXd Y = dynamics_.Regressor(q, v, a);
      for (std::size_t j = 0; j < states.size(); ++j) out[j][s].row(i) = Y.row(row_[j]);
    }
  }
  return out;
}

std::vector<Arm::Joint> Arm::Prepare(const ArmRuns& runs, const actuator::RobotModel& robot,
                                     const identify::ProcessingOptions& processing) const {
  std::vector<identify::StateSet> states =
      States(runs, robot, std::vector(robot.joints.size(), processing));
  const std::vector<std::vector<Eigen::MatrixXd>> full = Regressors(states);
  std::vector<Joint> out;
  for (std::size_t j = 0; j < states.size(); ++j) {
    actuator::JointModel model = robot.joints[j];
    for (actuator::Term& term : model.terms) {
      if (IsRigid(term)) term.linear.front().fixed = true;
    }
    const identify::Design design(std::move(states[j]), processing);
    Joint joint = {design.rows(), identify::MakeBalance(design, model, false),
                   Eigen::MatrixXd(design.rows().size(), dynamics_.parameters())};
    std::vector<Eigen::VectorXd> column(full[j].size());
    for (Eigen::Index c = 0; c < joint.rigid.cols(); ++c) {
      for (std::size_t s = 0; s < full[j].size(); ++s) column[s] = full[j][s].col(c);
      joint.rigid.col(c) = design.ThroughFilter(column);
    }
    out.push_back(std::move(joint));
  }
  return out;
}

ArmFit Arm::Fit(const ArmRuns& runs, const actuator::RobotModel& robot,
                const identify::ProcessingOptions& processing) const {
  const std::vector<Joint> joints = Prepare(runs, robot, processing);
  const auto rigid = static_cast<Eigen::Index>(base_.independent.size());
  Stack stack{.unknowns = rigid};
  std::vector<Eigen::Index> first;
  for (const Joint& joint : joints) {
    first.push_back(stack.unknowns);
    stack.unknowns += joint.balance.columns.cols();
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(joint.rigid.rows(), stack.unknowns);
    for (Eigen::Index c = 0; c < rigid; ++c) {
      columns.col(c) = joint.rigid.col(base_.independent[static_cast<std::size_t>(c)]);
    }
    columns.middleCols(first[j], joint.balance.columns.cols()) = joint.balance.columns;
    stack.y.emplace_back(joint.balance.target - joint.rigid * dynamics_.nominal());
    stack.X.push_back(std::move(columns));
    stack.rows.push_back(&joint.rows);
  }
  Eigen::VectorXd b;
  const std::vector<double> weight = Weigh(stack, &b);
  // Blocks of time, all joints together.
  identify::Rows all = joints.front().rows;
  std::fill(all.used.begin(), all.used.end(), 1);
  const std::vector<identify::Block> blocks = identify::MakeBlocks(all, kBlock_s, 0.0, 4);
  std::vector<identify::Moments> parts;
  parts.reserve(blocks.size());
  for (const identify::Block& block : blocks) parts.push_back(stack.Sums(&block, weight));
  const Eigen::MatrixXd covariance = identify::BlockCovariance(parts, b);
  const double quantile =
      identify::StudentQuantile(0.975, std::max(1.0, static_cast<double>(parts.size()) - 1.0));
  const auto half_width = [&](Eigen::Index i) {
    return quantile * std::sqrt(std::max(0.0, covariance(i, i)));
  };
  ArmFit out;
  out.robot = robot;
  out.phi = dynamics_.nominal();
  const Eigen::VectorXd nominal = base_.Of(dynamics_.nominal());
  for (Eigen::Index c = 0; c < rigid; ++c) {
    const int at = base_.independent[static_cast<std::size_t>(c)];
    out.phi[at] += b[c];
    out.base.push_back({dynamics_.parameter_names()[static_cast<std::size_t>(at)], nominal[c],
                        nominal[c] + b[c], half_width(c)});
  }
  // Residuals are correlated: a row carries less information by the factor by which the sums of
  // blocks vary more than independent rows would.
  double of_rows = 0.0, of_blocks = 0.0;
  for (std::size_t j = 0; j < stack.X.size(); ++j) {
    const Eigen::VectorXd e = weight[j] * (stack.y[j] - stack.X[j] * b);
    for (const identify::Block& block : blocks) {
      double sum = 0.0;
      for (const Eigen::Index i : block) {
        if (!stack.rows[j]->used[static_cast<std::size_t>(i)]) continue;
        sum += e[i];
        of_rows += e[i] * e[i];
      }
      of_blocks += sum * sum;
    }
  }
  const double louder = of_rows > 0.0 ? std::sqrt(std::max(1.0, of_blocks / of_rows)) : 1.0;
  const identify::Moments total = stack.Sums(nullptr, weight);
  out.information = OfBodies(total, rigid).G / (louder * louder);
  for (std::size_t j = 0; j < joints.size(); ++j) {
    std::vector<double> others = weight;
    others[j] = 0.0;
    out.by_others.push_back(PriorFrom(stack.Sums(nullptr, others), b, rigid,
                                      total.G.diagonal().head(rigid).cwiseSqrt(), louder));
    const identify::Balance& balance = joints[j].balance;
    for (Eigen::Index k = 0; k < balance.columns.cols(); ++k) {
      actuator::ParameterValue& value = balance.ParameterOf(k).In(&out.robot.joints[j]);
      value.value = b[first[j] + k];
      value.half_width_95 = half_width(first[j] + k);
    }
  }
  out.train = ErrorOf(runs, out.robot, out.phi, processing);
  return out;
}

ArmError Arm::ErrorOf(const ArmRuns& runs, const actuator::RobotModel& robot,
                      const Eigen::VectorXd& phi,
                      const identify::ProcessingOptions& processing) const {
  const std::vector<Joint> joints = Prepare(runs, robot, processing);
  ArmError out;
  double all_error = 0.0, all_power = 0.0, nrms = 0.0;
  bool limits = true;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    const Joint& joint = joints[j];
    const identify::Balance& balance = joint.balance;
    const Eigen::VectorXd torque = balance.drive_factor * balance.drive_torque;
    const Eigen::VectorXd residual =
        balance.target - balance.columns * balance.nominal - joint.rigid * phi;
    double error = 0.0, power = 0.0;
    const identify::Block used = joint.rows.UsedRows();
    for (const Eigen::Index i : used) {
      error += residual[i] * residual[i];
      power += torque[i] * torque[i];
    }
    all_error += error;
    all_power += power;
    out.rms_Nm.push_back(
        std::sqrt(error / std::max<double>(1.0, static_cast<double>(used.size()))));
    out.relative_percent.push_back(power > 0.0 ? 100.0 * std::sqrt(error / power) : 0.0);
    if (effort_[j] > 0.0) {
      nrms += 100.0 * out.rms_Nm.back() / (2.0 * effort_[j]) / static_cast<double>(joints.size());
    } else {
      limits = false;
    }
  }
  out.all_relative_percent = all_power > 0.0 ? 100.0 * std::sqrt(all_error / all_power) : 0.0;
  out.nrms_percent = limits ? nrms : 0.0;
  return out;
}

Eigen::VectorXd Arm::Inertia(const Eigen::VectorXd& phi, const ArmRuns& runs,
                             const actuator::RobotModel& robot,
                             const identify::ProcessingOptions& processing) const {
  constexpr Eigen::Index kPoses = 100;
  const std::vector<identify::StateSet> states =
      States(runs, robot, std::vector(robot.joints.size(), processing));
  const Eigen::Index n = dynamics_.joints(), rows = states.front().segments.front().size();
  Eigen::VectorXd q(n), v(n), a(n), sum = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(n);
  for (Eigen::Index k = 0; k < kPoses; ++k) {
    StateAt(states, 0, k * (rows - 1) / kPoses, &q, &v, &a);
    const Eigen::VectorXd gravity = dynamics_.Torque(q, zero, zero, phi);
    for (std::size_t j = 0; j < states.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(row_[j]);
      const Eigen::VectorXd torque = dynamics_.Torque(q, zero, Eigen::VectorXd::Unit(n, row), phi);
      sum[static_cast<Eigen::Index>(j)] += std::pow(torque[row] - gravity[row], 2);
    }
  }
  return (sum / static_cast<double>(kPoses)).cwiseSqrt();
}

void Arm::AddRigidTorque(const ArmFit& fit,
                         const std::vector<identify::ProcessingOptions>& processing,
                         const actuator::RobotModel& robot, ArmRuns* runs) const {
  const std::vector<identify::StateSet> states = States(*runs, robot, processing);
  for (std::size_t j = 0; j < states.size(); ++j) {
    for (types::Run& run : (*runs)[j]) {
      run.rigid_torque.clear();
      run.rigid_columns.clear();
      run.rigid_mean = fit.by_others[j].mean;
      run.rigid_spread = fit.by_others[j].spread;
    }
  }
  const std::vector<std::vector<Eigen::MatrixXd>> full = Regressors(states);
  for (std::size_t s = 0; s < states.front().segments.size(); ++s) {
    const auto number = static_cast<std::size_t>(states.front().segments[s].run);
    for (std::size_t j = 0; j < states.size(); ++j) {
      types::Run& run = (*runs)[j][number];
      run.rigid_torque.emplace_back(full[j][s] * fit.phi);
      run.rigid_columns.emplace_back(full[j][s](Eigen::all, base_.independent) *
                                     fit.by_others[j].directions);
    }
  }
}

}  // namespace sinew::arm
