// Inverse dynamics of a biped with both soles flat and fixed on level ground: the base's motion
// from the joints, the joint torques and the forces under the soles.
//
// Base. Axes of the base link; sole s with pose (R_s, p_s) in the base and, were the base at rest,
// the velocities w_s, v_s and accelerations dw_s, a_s. That it stands still in the world means
//
//     w = -w_s,   v = -v_s - w x p_s,   w' = -dw_s,
//     a = -a_s - w' x p_s - w x (w x p_s) - 2 w x v_s,     up = R_s e_z                         (1)
//
// for the base's angular velocity w, the velocity v and acceleration a of its origin, and the
// vertical. Both soles ask for the same where the joints' motion keeps the closed chain of legs and
// ground; else the mean of both is taken: it has the least sum of squared differences to the two,
// for each vector of (1) (for `up` among unit vectors). StanceMismatch reports the difference.
//
// Forces. F = H nu' + h = (n, f, tau) of the floating base
// (components/bodies/dynamics/floating_dynamics.h) is what base and joints need from outside. The
// ground gives the wrench of the base (n, f) by forces f_k at the points of the soles, r_k from the
// base's origin; N points, c their mean:
//
//     sum f_k = f,   sum r_k x f_k = n                                                         (2)
//
// Two sole wrenches have 6 numbers more than (2) has rows. Taken is the least sum |f_k|^2: a
// quadratic cost of the contact forces (Righetti, Buchli, Mistry, Kalakrishnan, Schaal: Optimal
// distribution of contact forces with inverse-dynamics control, Int. J. Robotics Research 32 (2013)
// 280), here of point forces with equal weights, so that moments need no weight of their own. Its
// solution, from the Lagrangian, is affine in the place:
//
//     f_k = f / N + b x d_k,  G b = n - c x f,  G = sum (|d_k|^2 1 - d_k d_k'),  d_k = r_k - c  (3)
//
// on level ground the pressure of equal springs under one rigid plate. A plate also pulls:
// least_normal_N below 0 means that the soles would not stay flat with these forces. Then
//
//     joint torque = tau - sum J_k' f_k                                                        (4)
//
// in the order of the chain's moving bodies, a passive joint's (the toe of an elastic sole) being
// what its spring has to give.
//
// World axes: z up, the base's heading (turn about z) is 0, the origin is that of the base. SI
// units. Thread: one.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/bodies/dynamics/floating_dynamics.h"
#include "components/bodies/links/bodies.h"

namespace sinew::stance {

inline constexpr int kSoles = 2;

// By names of links; those on fixed joints are frames.
struct SoleConfig {
  std::string frame;                // z is the sole's normal, up
  std::vector<std::string> points;  // where the ground pushes; three at least, not on a line
};

// "left" -> left_sole with left_force_rear_outer, ..._rear_inner, ..._front_outer, ..._front_inner
// (robots/biped).
SoleConfig SoleOfSide(const std::string& side);

struct DoubleSupportConfig {
  std::array<SoleConfig, kSoles> soles = {SoleOfSide("left"), SoleOfSide("right")};
  double gravity_m_s2 = types::kGravity_m_s2;
};

// Difference between what the two soles ask of the base: norms of the differences of (1), and of
// their heights. All 0 where the joints keep the closed chain.
struct StanceMismatch {
  double tilt_rad = 0.0;  // between the normals
  double height_m = 0.0;  // first above second, along `up`
  double angular_velocity_rad_s = 0.0, velocity_m_s = 0.0;
  double angular_acceleration_rad_s2 = 0.0, acceleration_m_s2 = 0.0;
};

// On a sole, about the origin of its frame, in its axes.
struct SoleWrench {
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment_Nm = Eigen::Vector3d::Zero();
};

struct StancePoint {
  int sole = 0;
  std::string name;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();  // from the base's origin, world axes
  Eigen::Vector3d force_N = Eigen::Vector3d::Zero();  // world axes
};

struct DoubleSupportSolution {
  // False: input that is not finite, or soles that face each other. All below is then 0.
  bool ok = false;
  arm::FloatingMotion motion;  // orientation, nu, nu'
  Eigen::VectorXd torque;      // (4): Nm, of a prismatic joint N
  std::array<SoleWrench, kSoles> soles;
  std::vector<StancePoint> points;
  double least_normal_N = 0.0;  // of all points
  StanceMismatch mismatch;
};

class DoubleSupport {
 public:
  // Throws std::invalid_argument, naming link and value: a link that the chain lacks, a sole of
  // fewer than three points or with all on a line, gravity not above 0, what FloatingDynamics
  // refuses.
  explicit DoubleSupport(const arm::Chain& chain, const DoubleSupportConfig& config = {});

  const arm::FloatingDynamics& dynamics() const { return dynamics_; }
  int joints() const { return dynamics_.joints(); }

  // Position, velocity and acceleration of every joint of the chain. The reference stays valid
  // until the next call. Allocates nothing.
  const DoubleSupportSolution& Solve(const Eigen::Ref<const Eigen::VectorXd>& q,
                                     const Eigen::Ref<const Eigen::VectorXd>& v,
                                     const Eigen::Ref<const Eigen::VectorXd>& a) noexcept;
  // Solution of the last Solve; not ok before.
  const DoubleSupportSolution& result() const { return result_; }

 private:
  // A link, the base at rest, in the base's axes and from its origin; v, a of the link's origin.
  struct InBase {
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    Eigen::Vector3d w = Eigen::Vector3d::Zero(), v = Eigen::Vector3d::Zero();
    Eigen::Vector3d dw = Eigen::Vector3d::Zero(), a = Eigen::Vector3d::Zero();
    Eigen::Vector3d axis = Eigen::Vector3d::Zero();  // of its joint
  };
  struct Point {
    int sole = 0;
    arm::Carried on;
  };

  arm::Carried Find(const arm::Chain& chain, const std::string& link) const;
  static InBase Fixed(const InBase& to, const Eigen::Isometry3d& at) noexcept;
  const InBase& LinkOf(int link) const { return in_base_[static_cast<std::size_t>(link + 1)]; }
  void Kinematics(const Eigen::Ref<const Eigen::VectorXd>& q,
                  const Eigen::Ref<const Eigen::VectorXd>& v,
                  const Eigen::Ref<const Eigen::VectorXd>& a) noexcept;
  bool SolveBase() noexcept;
  void Distribute() noexcept;
  void Clear() noexcept;

  arm::FloatingDynamics dynamics_;
  arm::MovingLinks links_;
  std::array<arm::Carried, kSoles> soles_;
  std::vector<Point> points_;
  std::vector<InBase> in_base_;  // base first
  std::array<InBase, kSoles> sole_in_base_;
  Eigen::VectorXd force_;
  DoubleSupportSolution result_;
};

}  // namespace sinew::stance
