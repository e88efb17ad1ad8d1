#include <algorithm>
#include <cmath>

#include "components/model/report/section.h"
#include "tools/export_model/write_model.h"
#include "tools/export_model/xml_text.h"

namespace sinew::export_model {
namespace {

std::string SdfPose(const Eigen::Isometry3d& frame) {
  return XmlVector(frame.translation()) + " " + XmlVector(RollPitchYaw(frame.linear()));
}

std::string SdfElement(const char* name, double value) {
  return std::string("<") + name + ">" + XmlNumber(value) + "</" + name + ">";
}

template <class Link>
std::string SdfInertial(const Link& link) {
  const Eigen::Matrix3d& i = link.inertia_kg_m2;
  return "      <inertial>\n        <pose>" + XmlVector(link.com_m) + " 0 0 0</pose>\n        " +
         SdfElement("mass", link.mass_kg) + "\n        <inertia>" + SdfElement("ixx", i(0, 0)) +
         SdfElement("ixy", i(0, 1)) + SdfElement("ixz", i(0, 2)) + SdfElement("iyy", i(1, 1)) +
         SdfElement("iyz", i(1, 2)) + SdfElement("izz", i(2, 2)) +
         "</inertia>\n      </inertial>\n";
}

// Torque at the output that the drive can give; 0: no limit is known.
double SdfEffort(const DescribedJoint& joint) { return joint.gear * joint.motor_torque_limit_Nm; }

std::string SdfJoint(const DescribedRobot& robot, const arm::Body& body,
                     const std::string& parent) {
  const DescribedJoint joint = JointOf(robot, body);
  std::string text = "    <joint name=\"" + report::Escape(body.joint_name) + "\" type=\"" +
                     (body.prismatic ? "prismatic" : "revolute") + "\">\n";
  text += "      <pose relative_to=\"" + parent + "\">" + SdfPose(body.parent_from_joint) +
          "</pose>\n      <parent>" + parent + "</parent>\n      <child>" +
          report::Escape(body.link_name) + "</child>\n      <axis>\n        <xyz>" +
          XmlVector(body.axis) + "</xyz>\n        <limit>";
  if (std::isfinite(body.lower)) text += SdfElement("lower", body.lower);
  if (std::isfinite(body.upper)) text += SdfElement("upper", body.upper);
  if (SdfEffort(joint) > 0.0) text += SdfElement("effort", SdfEffort(joint));
  text += "</limit>\n        <dynamics>" + SdfElement("damping", joint.damping_Nm_s_rad) +
          SdfElement("friction", joint.friction_Nm) +
          SdfElement("spring_reference", joint.spring_rest_rad) +
          SdfElement("spring_stiffness", joint.spring_Nm_rad) + "</dynamics>\n";
  if (body.mimic) {
    text += "        <mimic joint=\"" + report::Escape(body.mimic->joint_name) + "\">" +
            SdfElement("multiplier", body.mimic->multiplier) +
            SdfElement("offset", body.mimic->offset) + SdfElement("reference", 0.0) + "</mimic>\n";
  }
  return text + "      </axis>\n    </joint>\n";
}

}  // namespace

std::string WriteSdf(const DescribedRobot& robot, const Remarks& remarks) {
  const arm::Chain& chain = robot.links.chain;
  const std::string base = report::Escape(chain.base.link_name);
  const auto link_name = [&](int body) {
    return body < 0 ? base : report::Escape(chain.bodies[static_cast<std::size_t>(body)].link_name);
  };
  const bool mimics = std::any_of(chain.bodies.begin(), chain.bodies.end(),
                                  [](const arm::Body& body) { return body.mimic.has_value(); });
  std::string text = std::string("<?xml version=\"1.0\"?>\n<sdf version=\"") +
                     (mimics ? "1.11" : "1.9") + "\">\n  <model name=\"" +
                     report::Escape(robot.name) + "\">\n";
  for (const std::string& remark : remarks) text += "    " + XmlComment(remark) + "\n";
  text += "    <link name=\"" + base + "\">\n" +
          (robot.floating ? SdfInertial(chain.base) : std::string()) + "    </link>\n";
  if (!robot.floating) {
    text += "    <joint name=\"" + base + "_to_world\" type=\"fixed\">\n      <parent>world" +
            "</parent>\n      <child>" + base + "</child>\n    </joint>\n";
  }
  for (const arm::Body& body : chain.bodies) {
    text += "    <link name=\"" + report::Escape(body.link_name) +
            "\">\n      <pose relative_to=\"" + report::Escape(body.joint_name) + "\"/>\n" +
            SdfInertial(body) + "    </link>\n" + SdfJoint(robot, body, link_name(body.parent));
  }
  for (const arm::LinkFrame& frame : robot.links.frames) {
    if (report::Escape(frame.link_name) == link_name(frame.body)) continue;
    text += "    <frame name=\"" + report::Escape(frame.link_name) + "\" attached_to=\"" +
            link_name(frame.body) + "\">\n      <pose>" + SdfPose(frame.body_from_link) +
            "</pose>\n    </frame>\n";
  }
  return text + "  </model>\n</sdf>\n";
}

}  // namespace sinew::export_model
