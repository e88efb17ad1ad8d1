// A recording of one joint as rows: a time for each row and a column for each measured signal.
#pragma once

#include <Eigen/Core>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "components/base/types/joint_kind.h"
#include "components/base/types/signal.h"

namespace sinew::types {

struct Run {
  std::string name;  // file it came from
  JointKind kind = JointKind::kRevolute;
  Eigen::VectorXd time_s;                     // strictly increasing, not necessarily uniform
  std::map<Signal, Eigen::VectorXd> signals;  // units as in signal.h; each as long as time_s
  std::string content_hash;                   // of the samples, for the history of a model
  // Every row is a separate measurement at standstill: nothing is known between two rows.
  bool held = false;
  // By how much the recording's clock was set back while it ran; time_s goes on.
  double clock_set_back_s = 0.0;
  // Interpolated rows of the file that were left out (identify/interpolated.h).
  Eigen::Index interpolated_rows = 0;
  // Angles whose encoder starts each recording at an arbitrary zero: the true angle is the reading
  // plus an unknown constant, which differs between recordings. Changes and derivatives of such an
  // angle are valid. What depends on its absolute value (phase of gravity, rest angles, the offset
  // between two encoders, curves over the angle) holds for this recording only.
  std::set<Signal> zero_unknown;
  // Torque that the rigid bodies of the arm need at this joint (components/model/arm): one vector
  // per piece of identify::MakeStates, one entry per sample, Nm. Empty: the joint belongs to no
  // arm.
  std::vector<Eigen::VectorXd> rigid_torque;
  // Derivative of that torque with respect to directions of the body parameters, samples x
  // directions; may be empty. The amount of each direction has a normal prior from the other joints
  // of the arm, with this mean and standard deviation; a deviation of 0 means no prior.
  std::vector<Eigen::MatrixXd> rigid_columns;
  Eigen::VectorXd rigid_mean, rigid_spread;
  double rigid_inertia = 0.0;       // kg m^2, of the bodies about the joint, rms over the motion
  bool rigid_torque_later = false;  // rigid_torque is empty because it is computed later

  Eigen::Index size() const { return time_s.size(); }
  bool Has(Signal signal) const { return signals.contains(signal); }
  // Throws std::invalid_argument that names the run and the missing signal.
  const Eigen::VectorXd& At(Signal signal) const;
};

}  // namespace sinew::types
