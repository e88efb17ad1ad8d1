// A robot of a model file in the terms that other simulators share: bodies with mass and inertia,
// joints with armature, damping, dry friction, a spring and limits, a drive with its gear.
//
// What a term of the model becomes is one table (kPlaces); what no place of a format carries is
// listed as dropped. SI units at the output of the gear, N and m for a prismatic joint. Pure.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/gravity.h"
#include "components/bodies/links/bodies.h"
#include "components/bodies/links/fixed_links.h"
#include "components/model/actuator/model.h"

namespace sinew::export_model {

enum class Format { kMjcf, kUrdf, kSdf };

// The place of a term in a format.
enum class Place {
  kArmature,  // inertia on the joint's own acceleration
  kDamping,   // - c q'
  kFriction,  // - f sign(q')
  kSpring,    // - k (q - q0)
  kBody,      // mass and inertia of the link
  kActuator,  // gear, efficiency and limit of the drive
  kInput,     // follows a signal from outside, 0 without it
  kEncoder,   // what an encoder reads: moves nothing
  kNowhere,
};

Place PlaceOf(const actuator::Term& term);
// Has the format an element for it?
bool Carries(Format format, Place place);
// "MJCF", for people.
std::string_view FormatName(Format format);

struct DescribedJoint {
  std::string name;
  bool prismatic = false;
  double armature_kg_m2 = 0.0;
  double damping_Nm_s_rad = 0.0;
  double friction_Nm = 0.0;
  double spring_Nm_rad = 0.0, spring_rest_rad = 0.0;
  // Output torque per torque at the motor shaft, the drive's factor included; 0: no drive.
  double gear = 0.0;
  double gear_ratio = 1.0;             // motor turns per output turn
  double motor_torque_limit_Nm = 0.0;  // at the shaft; 0: none stated
  // The servo of the model file, torque per error at the output; none: torque is the command.
  struct Servo {
    double gain_Nm_rad, velocity_gain_Nm_s_rad, limit_Nm;  // limit: 0: none
  };
  std::optional<Servo> servo;
};

// A term, or the play of a gear, that the format has no element for.
struct Dropped {
  std::string joint;
  std::string effect;      // name in the catalogue; "backlash"
  std::string parameters;  // "stribeck_Nm = 0.1, stribeck_velocity_rad_s = 0.05"
  Place place = Place::kNowhere;
};

// Inertia of a link about its centre of mass, in the link's axes.
struct LinkInertia {
  double mass_kg = 0.0;
  Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
};

struct DescribedRobot {
  std::string name;
  bool floating = false;                       // the base moves freely
  double gravity_m_s2 = types::kGravity_m_s2;  // along -z of the world
  arm::MergedChain links;              // payloads of the model added; links on fixed joints merged
  std::vector<DescribedJoint> joints;  // in the model's order
  // Links whose inertia is another than in the URDF; nothing: it has gone into the link that
  // carries it.
  std::map<std::string, std::optional<LinkInertia>> changed;
};

// chain: the URDF of the model, without its payloads. Where a joint has inertia, link_inertia,
// gravity or payload, the body is the URDF's, scaled in mass and length so that its inertia about
// the joint and its weight's torque are the model's. Throws std::invalid_argument naming the joint:
// one that the URDF lacks, a payload on a link that it lacks, a body on a moving base that the
// model describes, gravity along another direction than the URDF's, negative inertia or friction, a
// joint that mimics another, a floating base without mass.
DescribedRobot Describe(const actuator::RobotModel& robot, const arm::Chain& chain);

// The joint of a body, with the spring and damper that the URDF declares; one that the model does
// not describe has these alone.
DescribedJoint JointOf(const DescribedRobot& robot, const arm::Body& body);

// In the order of the model's joints and terms.
std::vector<Dropped> DroppedBy(Format format, const actuator::RobotModel& robot);

// The joint without what was dropped, for a simulation: the term, or the play, taken out. The play
// goes with the rotor's inertia: nothing would hold a rotor without inertia between the teeth.
actuator::JointModel Without(actuator::JointModel joint, const std::string& effect);

}  // namespace sinew::export_model
