#include <algorithm>
#include <cmath>

#include "components/model/report/section.h"
#include "tools/export_model/write_model.h"
#include "tools/export_model/xml_text.h"

namespace sinew::export_model {
namespace {

constexpr double kLockedRange = 1e-9;  // rad or m

class MjcfText {
 public:
  explicit MjcfText(const DescribedRobot& robot) : robot_(robot) {}

  std::string Write(const Remarks& remarks) {
    text_ = "<mujoco model=\"" + report::Escape(robot_.name) + "\">\n";
    for (const std::string& remark : remarks) text_ += "  " + XmlComment(remark) + "\n";
    text_ += "  <compiler angle=\"radian\" balanceinertia=\"false\" inertiafromgeom=\"false\"/>\n";
    text_ += "  <option gravity=\"" + XmlNumbers({0.0, 0.0, -robot_.gravity_m_s2}) + "\"/>\n";
    text_ += "  <worldbody>\n    <body name=\"" + report::Escape(Chain().base.link_name) + "\">\n";
    if (robot_.floating) {
      text_ += "      <freejoint/>\n";
      Inertial(Chain().base, "      ");
    }
    Sites(-1, "      ");
    Children(-1, "      ");
    text_ += "    </body>\n  </worldbody>\n  <actuator>\n";
    for (const DescribedJoint& joint : robot_.joints) Actuator(joint);
    text_ += "  </actuator>\n  <equality>\n";
    for (const arm::Body& body : Chain().bodies) {
      if (!body.mimic) continue;
      text_ += "    <joint joint1=\"" + report::Escape(body.joint_name) + "\" joint2=\"" +
               report::Escape(body.mimic->joint_name) + "\" polycoef=\"" +
               XmlNumbers({body.mimic->offset, body.mimic->multiplier, 0.0, 0.0, 0.0}) + "\"/>\n";
    }
    return text_ + "  </equality>\n</mujoco>\n";
  }

 private:
  const arm::Chain& Chain() const { return robot_.links.chain; }

  static std::string Pose(const Eigen::Isometry3d& frame) {
    const Eigen::Quaterniond q(frame.linear());
    return "pos=\"" + XmlVector(frame.translation()) + "\" quat=\"" +
           XmlNumbers({q.w(), q.x(), q.y(), q.z()}) + "\"";
  }

  template <class Link>
  void Inertial(const Link& link, const std::string& indent) {
    const Eigen::Matrix3d& i = link.inertia_kg_m2;
    text_ += indent + "<inertial pos=\"" + XmlVector(link.com_m) + "\" mass=\"" +
             XmlNumber(link.mass_kg) + "\" fullinertia=\"" +
             XmlNumbers({i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2)}) + "\"/>\n";
  }

  void Sites(int body, const std::string& indent) {
    for (const arm::LinkFrame& frame : robot_.links.frames) {
      const std::string& carrier = body < 0
                                       ? Chain().base.link_name
                                       : Chain().bodies[static_cast<std::size_t>(body)].link_name;
      if (frame.body != body || frame.link_name == carrier) continue;
      text_ += indent + "<site name=\"" + report::Escape(frame.link_name) + "\" " +
               Pose(frame.body_from_link) + "/>\n";
    }
  }

  void Children(int parent, const std::string& indent) {
    for (std::size_t i = 0; i < Chain().bodies.size(); ++i) {
      const arm::Body& body = Chain().bodies[i];
      if (body.parent != parent) continue;
      text_ += indent + "<body name=\"" + report::Escape(body.link_name) + "\" " +
               Pose(body.parent_from_joint) + ">\n";
      Inertial(body, indent + "  ");
      Joint(body, indent + "  ");
      Sites(static_cast<int>(i), indent + "  ");
      Children(static_cast<int>(i), indent + "  ");
      text_ += indent + "</body>\n";
    }
  }

  void Joint(const arm::Body& body, const std::string& indent) {
    const DescribedJoint joint = JointOf(robot_, body);
    text_ += indent + "<joint name=\"" + report::Escape(body.joint_name) + "\" type=\"" +
             (body.prismatic ? "slide" : "hinge") + "\" axis=\"" + XmlVector(body.axis) + "\"";
    if (std::isfinite(body.lower) && std::isfinite(body.upper)) {
      // MuJoCo wants a range, where a URDF locks the joint.
      const double upper = std::max(body.upper, body.lower + kLockedRange);
      text_ += " limited=\"true\" range=\"" + XmlNumbers({body.lower, upper}) + "\"";
    }
    const auto add = [this](const char* name, double value) {
      if (value != 0.0) text_ += std::string(" ") + name + "=\"" + XmlNumber(value) + "\"";
    };
    add("armature", joint.armature_kg_m2);
    add("damping", joint.damping_Nm_s_rad);
    add("frictionloss", joint.friction_Nm);
    add("stiffness", joint.spring_Nm_rad);
    add("springref", joint.spring_rest_rad);
    text_ += "/>\n";
  }

  void Actuator(const DescribedJoint& joint) {
    if (joint.gear == 0.0) return;
    const std::string name = report::Escape(joint.name);
    if (joint.servo) {
      // force = gain (control - q) - velocity_gain q'
      text_ += "    <general name=\"" + name + "\" joint=\"" + name + "\" gainprm=\"" +
               XmlNumber(joint.servo->gain_Nm_rad) + "\" biastype=\"affine\" biasprm=\"" +
               XmlNumbers({0.0, -joint.servo->gain_Nm_rad, -joint.servo->velocity_gain_Nm_s_rad}) +
               "\"";
      if (joint.servo->limit_Nm > 0.0) {
        text_ += " forcelimited=\"true\" forcerange=\"" +
                 XmlNumbers({-joint.servo->limit_Nm, joint.servo->limit_Nm}) + "\"";
      }
    } else {
      text_ += "    <motor name=\"" + name + "\" joint=\"" + name + "\" gear=\"" +
               XmlNumber(joint.gear) + "\"";
      if (joint.motor_torque_limit_Nm > 0.0) {
        text_ += " ctrllimited=\"true\" ctrlrange=\"" +
                 XmlNumbers({-joint.motor_torque_limit_Nm, joint.motor_torque_limit_Nm}) + "\"";
      }
    }
    text_ += "/>\n";
  }

  const DescribedRobot& robot_;
  std::string text_;
};

}  // namespace

std::string WriteMjcf(const DescribedRobot& robot, const Remarks& remarks) {
  return MjcfText(robot).Write(remarks);
}

}  // namespace sinew::export_model
