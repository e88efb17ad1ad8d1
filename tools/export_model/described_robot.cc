#include "tools/export_model/described_robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "components/model/payloads/payloads.h"
#include "tools/export_model/xml_text.h"

namespace sinew::export_model {
namespace {

using actuator::JointModel;
using actuator::Term;

struct EffectPlace {
  std::string_view effect;
  Place place;
};

// Effects of the motion's balance; all others are nowhere, those of the kinematic balance are what
// encoders read.
constexpr EffectPlace kPlaces[] = {
    {"rotor_inertia", Place::kArmature}, {"viscous", Place::kDamping},
    {"motor_viscous", Place::kDamping},  {"coulomb", Place::kFriction},
    {"spring", Place::kSpring},          {"inertia", Place::kBody},
    {"link_inertia", Place::kBody},      {"gravity", Place::kBody},
    {"payload", Place::kBody},           {"rigid_body", Place::kBody},
    {"drive_current", Place::kActuator}, {"drive_voltage", Place::kActuator},
    {"drive_torque", Place::kActuator},  {"declared_payload", Place::kInput},
    {"load_force", Place::kInput},
};

struct FormatPlaces {
  Format format;
  std::string_view name;
  std::array<Place, 6> carried;  // besides kInput and kEncoder, which are no part of a description
};

// MuJoCo 2.2 XML reference: joint armature, damping, frictionloss, stiffness, springref; actuator
// gear. URDF specification, joint: dynamics damping and friction, limit effort, transmission. SDF
// 1.9, joint axis: dynamics damping, friction, spring_stiffness, spring_reference; limit effort.
constexpr FormatPlaces kFormats[] = {
    {Format::kMjcf,
     "MJCF",
     {Place::kArmature, Place::kDamping, Place::kFriction, Place::kSpring, Place::kBody,
      Place::kActuator}},
    {Format::kUrdf,
     "URDF",
     {Place::kDamping, Place::kFriction, Place::kBody, Place::kActuator, Place::kBody,
      Place::kBody}},
    {Format::kSdf,
     "SDF",
     {Place::kDamping, Place::kFriction, Place::kSpring, Place::kBody, Place::kActuator,
      Place::kBody}},
};

const FormatPlaces& Of(Format format) { return kFormats[static_cast<std::size_t>(format)]; }

std::string ParametersOf(const Term& term, types::JointKind kind) {
  const effects::EffectInfo& info = term.effect->info();
  std::string text;
  const auto add = [&](const std::vector<effects::ParameterInfo>& infos,
                       const std::vector<actuator::ParameterValue>& values) {
    for (std::size_t i = 0; i < infos.size(); ++i) {
      text += (text.empty() ? "" : ", ") + effects::ParameterKey(infos[i], kind) + " = " +
              ShortNumber(values[i].value);
    }
  };
  add(info.linear, term.linear);
  add(info.nonlinear, term.nonlinear);
  return text;
}

// Terms of the model for the body behind a joint; nothing: as in the URDF.
struct BodyTerms {
  std::optional<double> inertia_kg_m2;  // about the joint
  std::optional<double> gravity_Nm;     // at position 0, against +position
};

BodyTerms BodyTermsOf(const JointModel& joint) {
  BodyTerms out;
  double payload_kg = 0.0;
  for (std::size_t i = 0; i < joint.terms.size(); ++i) {
    const effects::EffectInfo& info = joint.terms[i].effect->info();
    if (info.balance != effects::Balance::kMotion || info.linear.empty()) continue;
    const double value = actuator::PhysicalValue(joint, static_cast<int>(i), 0);
    if (info.name == "inertia" || info.name == "link_inertia") {
      out.inertia_kg_m2 = out.inertia_kg_m2.value_or(0.0) + value;
    }
    if (info.name == "gravity") out.gravity_Nm = out.gravity_Nm.value_or(0.0) + value;
    if (info.name == "payload") payload_kg += value;
  }
  if (payload_kg != 0.0) {
    const double length_m = joint.constants.link_length_m;
    if (!out.inertia_kg_m2 || !out.gravity_Nm) {
      throw std::invalid_argument("joint '" + joint.name +
                                  "': a payload needs the terms link_inertia and gravity");
    }
    *out.inertia_kg_m2 += payload_kg * length_m * length_m;
    *out.gravity_Nm += payload_kg * joint.constants.gravity_m_s2 * length_m;
  }
  return out;
}

// Torque of the body's weight about its joint on the fixed base, at a position.
double WeightTorque(const arm::Body& body, double position_rad, double gravity_m_s2) {
  const Eigen::Vector3d axis = body.parent_from_joint.linear() * body.axis;
  const Eigen::Vector3d com =
      body.parent_from_joint.linear() * Eigen::AngleAxisd(position_rad, body.axis) * body.com_m;
  return axis.dot(com.cross(Eigen::Vector3d(0.0, 0.0, -body.mass_kg * gravity_m_s2)));
}

double InertiaAboutJoint(const arm::Body& body) {
  const Eigen::Vector3d lever = body.com_m - body.axis.dot(body.com_m) * body.axis;
  return body.axis.dot(body.inertia_kg_m2 * body.axis) + body.mass_kg * lever.squaredNorm();
}

// The body scaled in mass and length: mass times mu, lengths times s. Weight's torque scales with
// mu s, inertia with mu s^2.
void ScaleBody(const JointModel& joint, const BodyTerms& terms, double gravity_m_s2,
               arm::Body* body) {
  const std::string name = "joint '" + joint.name + "'";
  if (body->prismatic) {
    if (terms.inertia_kg_m2) {
      const double factor = *terms.inertia_kg_m2 / body->mass_kg;
      body->mass_kg *= factor;
      body->inertia_kg_m2 *= factor;
    }
    return;
  }
  const double inertia = InertiaAboutJoint(*body);
  const double weight = -WeightTorque(*body, 0.0, gravity_m_s2);
  const double quarter = WeightTorque(*body, std::acos(0.0), gravity_m_s2);
  if (terms.gravity_Nm && !(weight > 0.0 && std::abs(quarter) < 1e-6 * weight)) {
    throw std::invalid_argument(name +
                                ": the model's gravity is -Tg cos q, the URDF's centre of mass "
                                "is not level with the joint at position 0");
  }
  const double inertia_factor = terms.inertia_kg_m2.value_or(inertia) / inertia;
  const double weight_factor = terms.gravity_Nm ? *terms.gravity_Nm / weight : 1.0;
  if (!(inertia_factor > 0.0 && weight_factor > 0.0)) {
    throw std::invalid_argument(name + ": inertia or weight of the model is not above 0");
  }
  const double length = inertia_factor / weight_factor;
  body->mass_kg *= weight_factor / length;
  body->com_m *= length;
  body->inertia_kg_m2 *= inertia_factor;
}

DescribedJoint DescribeJoint(const JointModel& joint) {
  DescribedJoint out;
  out.name = joint.name;
  out.prismatic = joint.kind == types::JointKind::kPrismatic;
  out.gear_ratio = joint.constants.gear_ratio;
  out.motor_torque_limit_Nm = joint.motor_torque_limit_Nm;
  for (std::size_t i = 0; i < joint.terms.size(); ++i) {
    const auto value = [&](int parameter) {
      return actuator::PhysicalValue(joint, static_cast<int>(i), parameter);
    };
    switch (PlaceOf(joint.terms[i])) {
      case Place::kArmature:
        out.armature_kg_m2 += value(0);
        break;
      case Place::kDamping:
        out.damping_Nm_s_rad += value(0);
        break;
      case Place::kFriction:
        out.friction_Nm += value(0);
        break;
      case Place::kSpring:
        out.spring_Nm_rad += value(0);
        out.spring_rest_rad = value(0) != 0.0 ? value(1) / value(0) : 0.0;
        break;
      case Place::kActuator:
        out.gear =
            joint.constants.gear_ratio * actuator::DriveShare(joint, effects::Balance::kMotion);
        break;
      default:
        break;
    }
  }
  for (const auto& [what, number] : {std::pair{"armature", out.armature_kg_m2},
                                     {"damping", out.damping_Nm_s_rad},
                                     {"dry friction", out.friction_Nm},
                                     {"spring", out.spring_Nm_rad}}) {
    if (!(number >= 0.0)) {
      throw std::invalid_argument("joint '" + joint.name + "': " + what + " " +
                                  ShortNumber(number) + ", expected at least 0");
    }
  }
  if (joint.controller && joint.controller->gain_per_rad > 0.0 &&
      !joint.controller->share_of_supply) {
    const double torque = effects::IdealDriveGain(joint.constants) *
                          actuator::DriveShare(joint, effects::Balance::kMotion);
    out.servo = {joint.controller->gain_per_rad * torque,
                 joint.controller->velocity_gain_s_rad * torque, joint.controller->limit * torque};
  }
  return out;
}

}  // namespace

Place PlaceOf(const Term& term) {
  const effects::EffectInfo& info = term.effect->info();
  if (info.balance == effects::Balance::kKinematic) return Place::kEncoder;
  if (info.balance != effects::Balance::kMotion) return Place::kNowhere;
  const auto* found = std::find_if(std::begin(kPlaces), std::end(kPlaces),
                                   [&](const EffectPlace& row) { return row.effect == info.name; });
  return found == std::end(kPlaces) ? Place::kNowhere : found->place;
}

bool Carries(Format format, Place place) {
  if (place == Place::kInput || place == Place::kEncoder) return true;  // nothing to carry
  const auto& carried = Of(format).carried;
  return std::find(carried.begin(), carried.end(), place) != carried.end();
}

std::string_view FormatName(Format format) { return Of(format).name; }

DescribedRobot Describe(const actuator::RobotModel& robot, const arm::Chain& chain) {
  DescribedRobot out;
  out.name = robot.name;
  out.floating = robot.floating_base.has_value();
  const arm::Chain loaded = arm::WithPayloads(chain, robot.payloads);
  out.links = arm::MergeFixedLinks(loaded);
  if (const arm::Base& base = out.links.chain.base; out.floating && !(base.mass_kg > 0.0)) {
    throw std::invalid_argument("base link '" + base.link_name + "': mass " +
                                ShortNumber(base.mass_kg) +
                                ", expected kg above 0 for a floating base");
  }
  for (const actuator::Payload& payload : robot.payloads) {
    LinkInertia changed{loaded.base.mass_kg, loaded.base.com_m, loaded.base.inertia_kg_m2};
    for (const arm::Body& body : loaded.bodies) {
      if (body.link_name != payload.link) continue;
      changed = {body.mass_kg, body.com_m, body.inertia_kg_m2};
    }
    out.changed[payload.link] = changed;
  }
  for (const JointModel& joint : robot.joints) {
    const int index = arm::FindJoint(out.links.chain, joint.name);
    if (index < 0) {
      throw std::invalid_argument("joint '" + joint.name + "' is not in the URDF '" + chain.name +
                                  "'");
    }
    arm::RequireFree(out.links.chain.bodies[static_cast<std::size_t>(index)]);
    out.joints.push_back(DescribeJoint(joint));
    const BodyTerms terms = BodyTermsOf(joint);
    if (!terms.inertia_kg_m2 && !terms.gravity_Nm) continue;
    arm::Body& body = out.links.chain.bodies[static_cast<std::size_t>(index)];
    const bool carries = std::any_of(
        out.links.chain.bodies.begin(), out.links.chain.bodies.end(), [&](const arm::Body& other) {
          return other.parent == index || (other.mimic && other.mimic->joint_name == joint.name);
        });
    if (body.parent >= 0 || carries || out.floating) {
      throw std::invalid_argument("joint '" + joint.name +
                                  "': inertia and gravity as terms need a joint on the fixed base "
                                  "that carries and moves no other");
    }
    out.gravity_m_s2 = joint.constants.gravity_m_s2;
    ScaleBody(joint, terms, out.gravity_m_s2, &body);
    for (const arm::LinkFrame& frame : out.links.frames) {
      if (frame.body == index) out.changed[frame.link_name] = std::nullopt;
    }
    out.changed[body.link_name] = LinkInertia{body.mass_kg, body.com_m, body.inertia_kg_m2};
  }
  return out;
}

DescribedJoint JointOf(const DescribedRobot& robot, const arm::Body& body) {
  DescribedJoint joint;
  for (const DescribedJoint& described : robot.joints) {
    if (described.name == body.joint_name) joint = described;
  }
  if (body.passive) {
    joint.spring_Nm_rad += body.passive->stiffness_Nm_rad;
    joint.damping_Nm_s_rad += body.passive->damping_Nms_rad;
  }
  return joint;
}

std::vector<Dropped> DroppedBy(Format format, const actuator::RobotModel& robot) {
  std::vector<Dropped> dropped;
  for (const JointModel& joint : robot.joints) {
    for (const Term& term : joint.terms) {
      const Place place = PlaceOf(term);
      if (Carries(format, place)) continue;
      dropped.push_back(
          {joint.name, term.effect->info().name, ParametersOf(term, joint.kind), place});
    }
    if (joint.backlash_rad > 0.0) {
      const bool rotary = joint.kind == types::JointKind::kRevolute;
      dropped.push_back(
          {joint.name, "backlash",
           (rotary ? "backlash_rad = " : "backlash_m = ") + ShortNumber(joint.backlash_rad),
           Place::kNowhere});
    }
  }
  return dropped;
}

JointModel Without(JointModel joint, const std::string& effect) {
  if (effect == "backlash") {
    joint.backlash_rad = 0.0;
    std::erase_if(joint.terms,
                  [](const Term& term) { return term.effect->info().name == "free_play"; });
    return joint;
  }
  if (effect == "rotor_inertia") joint = Without(std::move(joint), "backlash");
  std::erase_if(joint.terms, [&effect](const Term& term) {
    const effects::EffectInfo& info = term.effect->info();
    return info.name == effect && info.balance != effects::Balance::kKinematic;
  });
  return joint;
}

}  // namespace sinew::export_model
