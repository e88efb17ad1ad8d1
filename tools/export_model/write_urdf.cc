#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/bodies/links/file/xml_text.h"
#include "tools/export_model/write_model.h"
#include "tools/export_model/xml_text.h"

namespace sinew::export_model {
namespace {

constexpr double kNoLimit = 1e16;  // of SDF 1.9, joint limit

TiXmlElement* Named(TiXmlElement* root, const char* kind, const std::string& name) {
  for (TiXmlElement* e = root->FirstChildElement(kind); e != nullptr;
       e = e->NextSiblingElement(kind)) {
    const char* found = e->Attribute("name");
    if (found != nullptr && name == found) return e;
  }
  return nullptr;
}

TiXmlElement* ChildOf(TiXmlElement* parent, const char* name) {
  if (TiXmlElement* child = parent->FirstChildElement(name)) return child;
  return parent->LinkEndChild(new TiXmlElement(name))->ToElement();  // the parent owns it
}

void Set(TiXmlElement* element, const char* name, const std::string& value) {
  element->SetAttribute(name, value.c_str());
}

void SetInertial(const std::optional<LinkInertia>& inertia, TiXmlElement* link) {
  if (TiXmlElement* old = link->FirstChildElement("inertial")) link->RemoveChild(old);
  if (!inertia) return;
  TiXmlElement* inertial = ChildOf(link, "inertial");
  TiXmlElement* origin = ChildOf(inertial, "origin");
  Set(origin, "xyz", XmlVector(inertia->com_m));
  Set(origin, "rpy", "0 0 0");
  Set(ChildOf(inertial, "mass"), "value", XmlNumber(inertia->mass_kg));
  TiXmlElement* tensor = ChildOf(inertial, "inertia");
  const Eigen::Matrix3d& i = inertia->inertia_kg_m2;
  Set(tensor, "ixx", XmlNumber(i(0, 0)));
  Set(tensor, "ixy", XmlNumber(i(0, 1)));
  Set(tensor, "ixz", XmlNumber(i(0, 2)));
  Set(tensor, "iyy", XmlNumber(i(1, 1)));
  Set(tensor, "iyz", XmlNumber(i(1, 2)));
  Set(tensor, "izz", XmlNumber(i(2, 2)));
}

}  // namespace

std::string WriteUrdf(const DescribedRobot& robot, const std::string& urdf,
                      const Remarks& remarks) {
  TiXmlDocument document;
  arm::ParseXml(urdf, "the URDF", &document);
  TiXmlElement* root = document.RootElement();
  if (root == nullptr) throw std::invalid_argument("the URDF has no root element");
  arm::DefineMaterials("the URDF", root);
  for (const DescribedJoint& joint : robot.joints) {
    TiXmlElement* element = Named(root, "joint", joint.name);
    if (element == nullptr) {
      throw std::invalid_argument("the URDF has no joint '" + joint.name + "'");
    }
    TiXmlElement* dynamics = ChildOf(element, "dynamics");
    Set(dynamics, "damping", XmlNumber(joint.damping_Nm_s_rad));
    Set(dynamics, "friction", XmlNumber(joint.friction_Nm));
    if (joint.gear > 0.0 && joint.motor_torque_limit_Nm > 0.0) {
      TiXmlElement* limit = ChildOf(element, "limit");
      Set(limit, "effort", XmlNumber(joint.gear * joint.motor_torque_limit_Nm));
      if (limit->Attribute("velocity") == nullptr) Set(limit, "velocity", XmlNumber(kNoLimit));
    }
  }
  for (const arm::Body& body : robot.links.chain.bodies) {
    TiXmlElement* element = Named(root, "joint", body.joint_name);
    if (element == nullptr || std::string(element->Attribute("type")) == "continuous") continue;
    if (!body.prismatic && !std::isfinite(body.upper)) {
      Set(element, "type", "continuous");
      continue;
    }
    TiXmlElement* limit = ChildOf(element, "limit");
    Set(limit, "lower", XmlNumber(std::max(body.lower, -kNoLimit)));
    Set(limit, "upper", XmlNumber(std::min(body.upper, kNoLimit)));
  }
  for (const auto& [name, inertia] : robot.changed) {
    TiXmlElement* link = Named(root, "link", name);
    if (link == nullptr) throw std::invalid_argument("the URDF has no link '" + name + "'");
    SetInertial(inertia, link);
  }
  TiXmlNode* first = root->FirstChild();
  for (const std::string& remark : remarks) {
    const std::string comment = XmlComment(remark);  // "<!-- text -->"
    TiXmlComment node(comment.substr(4, comment.size() - 7).c_str());
    if (first != nullptr) {
      root->InsertBeforeChild(first, node);
    } else {
      root->InsertEndChild(node);
    }
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  document.Accept(&printer);
  return printer.CStr();
}

}  // namespace sinew::export_model
