// Compliant contact of points with flat, horizontal ground.
//
// Normal force of a point at depth d below the ground, dd its rate (Hunt, Crossley: Coefficient of
// restitution interpreted as damping in vibroimpact, J. Applied Mechanics 42 (1975) 440, with a
// linear spring, as of a flat pad):
//
//     N = max(0, k d (1 + a dd)) for d > 0, else 0
//
// It begins at 0 and never pulls. k = static load / static sink. a from the restitution e at the
// impact speed v: with no other force the law gives, whatever k and the mass are (integrate
// dv/dd = -k d (1 + a v) / (m v) over the contact),
//
//     (1 + e) x = ln((1 + x) / (1 - e x)),   x = a v,   0 < x < 1/e
//
// (Marhefka, Orin: A compliant contact model with nonlinear damping for simulation of robotic
// systems, IEEE Trans. Systems, Man and Cybernetics A 29 (1999) 566).
//
// Tangential force: a bristle from an anchor on the ground to the point, with damping, limited by
// Coulomb's law; the anchor follows where the bristle's force alone reaches the limit (elastic part
// of Dupont, Armstrong, Hayward: Elasto-plastic friction model, American Control Conference (2000)
// 1072, without its presliding plasticity, so that sticking contacts do not creep):
//
//     T = -k_t (p - anchor) - c_t p',   |T| <= mu N
//
// k_t = 2/3 k: tangential over normal compliance of an incompressible pad, 2 (1 - nu) / (2 - nu) at
// nu = 1/2 (Johnson: Contact Mechanics (1985), 7.2). c_t = 2 zeta sqrt(k_t m), m the mass that the
// static load holds up.
//
// Pure; nothing allocates or throws but GroundLaw's constructor. Any thread. SI units; world axes,
// z up.
#pragma once

#include <Eigen/Core>

namespace sinew::world {

// The defaults of load and sink are those of a robot of 16 kg on eight points, each a rubber pad of
// 1 cm^2, 5 mm thick, with a modulus of 2 MPa: 20 N are 0.2 MPa, strain 0.1. Friction, restitution,
// its speed and zeta are assumptions for rubber on a dry floor, to be replaced by measurements on
// the robot's feet.
struct GroundConfig {
  double height_m = 0.0;
  double friction = 0.8;          // mu
  double static_load_N = 20.0;    // on one point, robot standing
  double static_sink_m = 0.5e-3;  // depth of a point under that load
  double restitution = 0.3;       // at the impact speed; 0 < e < 1
  double impact_speed_m_s = 0.5;
  double tangential_damping_ratio = 0.3;  // zeta
};

// State of a point that is kept between steps.
struct ContactMemory {
  Eigen::Vector2d anchor_m = Eigen::Vector2d::Zero();  // x, y
  bool touches = false;
};

struct ContactForce {
  double normal_N = 0.0;                                   // up, at least 0
  Eigen::Vector2d tangential_N = Eigen::Vector2d::Zero();  // x, y, on the robot
};

class GroundLaw {
 public:
  // Throws std::invalid_argument, with the value: not finite; friction or damping ratio below 0;
  // load, sink or speed not above 0; restitution outside (0, 1).
  explicit GroundLaw(const GroundConfig& config);

  // Force on a point at position and velocity, and the memory that follows: the argument's stays as
  // it is. Damping: how much the force falls with the point's velocity, -dN/dv up and -dT/dv along;
  // 0 where the force does not touch, where it is cut off at 0, and along where it slides.
  struct Result {
    ContactForce force;
    ContactMemory memory;
    double normal_damping_N_s_m = 0.0, tangential_damping_N_s_m = 0.0;
  };
  Result Force(const Eigen::Vector3d& position_m, const Eigen::Vector3d& velocity_m_s,
               const ContactMemory& memory) const noexcept;

  double height_m() const { return height_m_; }
  double stiffness_N_m() const { return stiffness_N_m_; }
  double tangential_stiffness_N_m() const { return tangential_stiffness_N_m_; }
  double tangential_damping_N_s_m() const { return tangential_damping_N_s_m_; }

 private:
  double height_m_, friction_, stiffness_N_m_, damping_s_m_, tangential_stiffness_N_m_,
      tangential_damping_N_s_m_;
};

// x of the equation above for 0 < e < 1.
double DampingOfRestitution(double restitution);

}  // namespace sinew::world
