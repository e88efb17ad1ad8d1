#include "components/bodies/links/file/urdf_file.h"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "components/base/config/config.h"
#include "components/bodies/links/file/xml_text.h"

namespace sinew::arm {

namespace {

// Keeps what the parser says, instead of letting it write to the terminal.
class CapturedMessages : public console_bridge::OutputHandler {
 public:
  CapturedMessages() { console_bridge::useOutputHandler(this); }
  ~CapturedMessages() override { console_bridge::restorePreviousOutputHandler(); }
  CapturedMessages(const CapturedMessages&) = delete;
  CapturedMessages& operator=(const CapturedMessages&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR || !first_error_.empty()) return;
    first_error_ = text.substr(0, text.find('\n'));
  }
  const std::string& first_error() const { return first_error_; }

 private:
  std::string first_error_;
};

class Where {
 public:
  Where(const TiXmlDocument& document, std::string file)
      : document_(document), file_(std::move(file)) {}

  // attribute: by which the element is named.
  [[noreturn]] void Fail(const std::string& element, const std::string& name,
                         const std::string& message, const char* attribute = "name") const {
    int row = 0;
    const TiXmlElement* root = document_.RootElement();
    for (const TiXmlElement* e = root->FirstChildElement(element.c_str()); e != nullptr;
         e = e->NextSiblingElement(element.c_str())) {
      if (e->Attribute(attribute) != nullptr && name == e->Attribute(attribute)) row = e->Row();
    }
    throw UsageError(file_ + (row > 0 ? ":" + std::to_string(row) : "") + ": " + element + " '" +
                     name + "': " + message);
  }
  const std::string& file() const { return file_; }

 private:
  const TiXmlDocument& document_;
  std::string file_;
};

Eigen::Isometry3d ToIsometry(const urdf::Pose& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translate(Eigen::Vector3d(pose.position.x, pose.position.y, pose.position.z));
  out.rotate(Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z)
                 .normalized());
  return out;
}

// body: a Body or a Base.
template <typename Inertial>
void ReadInertial(const urdf::Link& link, const Where& where, Inertial* body) {
  if (!link.inertial) return;
  const urdf::Inertial& in = *link.inertial;
  const double all[] = {in.mass, in.ixx, in.ixy, in.ixz, in.iyy, in.iyz, in.izz};
  if (!std::all_of(std::begin(all), std::end(all), [](double v) { return std::isfinite(v); })) {
    where.Fail("link", link.name, "mass or inertia is not finite");
  }
  // A frame that weighs nothing, as exporters write it: the same as no inertial element.
  if (std::all_of(std::begin(all), std::end(all), [](double v) { return v == 0.0; })) return;
  if (!(in.mass > 0.0)) {
    where.Fail("link", link.name, "mass " + std::to_string(in.mass) + ", expected kg above 0");
  }
  Eigen::Matrix3d inertia;
  inertia << in.ixx, in.ixy, in.ixz, in.ixy, in.iyy, in.iyz, in.ixz, in.iyz, in.izz;
  const Eigen::Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia).eigenvalues();
  const double slack = 1e-9 * std::abs(principal[2]);
  if (principal[0] < -slack) {
    where.Fail("link", link.name,
               "inertia has the principal moment " + std::to_string(principal[0]) +
                   ", expected none below 0");
  }
  if (principal[0] + principal[1] < principal[2] * (1.0 - 1e-3) - slack) {
    where.Fail("link", link.name,
               "inertia breaks the triangle inequality: no body has these moments");
  }
  const Eigen::Isometry3d frame = ToIsometry(in.origin);
  body->mass_kg = in.mass;
  body->com_m = frame.translation();
  body->inertia_kg_m2 = frame.linear() * inertia * frame.linear().transpose();
}

void ReadJoint(const urdf::Joint& joint, const Where& where, Body* body) {
  using urdf::Joint;
  body->joint_name = joint.name;
  body->parent_from_joint = ToIsometry(joint.parent_to_joint_origin_transform);
  if (joint.type == Joint::FIXED) return;
  if (joint.type != Joint::REVOLUTE && joint.type != Joint::CONTINUOUS &&
      joint.type != Joint::PRISMATIC) {
    where.Fail("joint", joint.name,
               "type is not simulated, expected revolute, continuous, prismatic or fixed");
  }
  body->moves = true;
  body->prismatic = joint.type == Joint::PRISMATIC;
  body->axis = {joint.axis.x, joint.axis.y, joint.axis.z};
  const double length = body->axis.norm();
  if (!(length > 1e-6) || !std::isfinite(length)) {
    where.Fail("joint", joint.name, "axis has no direction");
  }
  body->axis /= length;
  if (joint.mimic) {
    body->mimic = Mimic{.joint_name = joint.mimic->joint_name,
                        .multiplier = joint.mimic->multiplier,
                        .offset = joint.mimic->offset};
  }
  if (joint.limits) body->effort = joint.limits->effort;
  if (joint.limits && joint.type != Joint::CONTINUOUS) {
    if (!(joint.limits->lower <= joint.limits->upper)) {
      where.Fail("joint", joint.name, "lower limit above upper limit");
    }
    // Equal: locked. 0 and 0 is what urdfdom reads where none is stated.
    if (joint.limits->lower != 0.0 || joint.limits->upper != 0.0) {
      body->lower = joint.limits->lower;
      body->upper = joint.limits->upper;
    }
  }
}

// Refuses what urdfdom refuses without a line.
void CheckJoint(const TiXmlElement& joint, const Where& where) {
  constexpr struct {
    const char *element, *attribute;
    bool required;
  } kNumbers[] = {{"limit", "effort", true},      {"limit", "velocity", true},
                  {"limit", "lower", false},      {"limit", "upper", false},
                  {"mimic", "multiplier", false}, {"mimic", "offset", false}};
  const auto text = [](const char* given) { return std::string(given == nullptr ? "" : given); };
  const std::string name = text(joint.Attribute("name")), type = text(joint.Attribute("type"));
  for (const auto& [element, attribute, required] : kNumbers) {
    const TiXmlElement* e = joint.FirstChildElement(element);
    if (e == nullptr || (!required && e->Attribute(attribute) == nullptr)) continue;
    double value = std::numeric_limits<double>::quiet_NaN();
    e->QueryDoubleAttribute(attribute, &value);
    if (std::isfinite(value)) continue;
    where.Fail("joint", name,
               std::string(element) + " has " + attribute + " = '" + text(e->Attribute(attribute)) +
                   "', expected a number");
  }
  if ((type == "revolute" || type == "prismatic") && joint.FirstChildElement("limit") == nullptr) {
    where.Fail("joint", name, type + " without limit, expected lower, upper, effort and velocity");
  }
  const TiXmlElement* mimic = joint.FirstChildElement("mimic");
  if (mimic != nullptr && mimic->Attribute("joint") == nullptr) {
    where.Fail("joint", name, "mimic has no attribute 'joint', expected the name of a joint");
  }
}

// Makes every joint that mimics another follow one that has a position of its own, whose stops are
// narrowed to what both allow.
void ResolveMimics(const Where& where, Chain* chain) {
  std::map<std::string, Body*> moving;
  for (Body& body : chain->bodies) {
    if (body.moves) moving[body.joint_name] = &body;
  }
  for (Body& body : chain->bodies) {
    if (!body.mimic) continue;
    Mimic& mimic = *body.mimic;
    const auto fail = [&](const std::string& message) {
      where.Fail("joint", body.joint_name, "mimics '" + mimic.joint_name + "', " + message);
    };
    Body* followed = &body;
    for (std::size_t steps = 0; followed->mimic; ++steps) {
      const auto found = moving.find(mimic.joint_name);
      if (found == moving.end()) fail("expected the name of a joint that moves");
      if (steps == moving.size()) fail("which follows itself");
      followed = found->second;
      if (!followed->mimic) break;
      const Mimic next = *followed->mimic;
      mimic = {.joint_name = next.joint_name,
               .multiplier = mimic.multiplier * next.multiplier,
               .offset = mimic.multiplier * next.offset + mimic.offset};
    }
    // A multiplier of 0 gives infinity, or not a number at the stop itself: no bound.
    const auto [low, high] = std::minmax({(body.lower - mimic.offset) / mimic.multiplier,
                                          (body.upper - mimic.offset) / mimic.multiplier});
    const double lower = std::max(followed->lower, low), upper = std::min(followed->upper, high);
    if (!std::isfinite(mimic.multiplier) || !std::isfinite(mimic.offset) || lower > upper ||
        (lower == upper && followed->lower < followed->upper)) {
      fail("whose limits and its own leave no range");
    }
    followed->lower = lower;
    followed->upper = upper;
  }
}

// Elements of the robot, which urdfdom leaves out:
//   <passive joint="toe" stiffness_Nm_rad="78" damping_Nms_rad="0.62"/>
void ReadPassive(const TiXmlDocument& document, const Where& where, Chain* chain) {
  const TiXmlElement* root = document.RootElement();
  for (const TiXmlElement* e = root->FirstChildElement("passive"); e != nullptr;
       e = e->NextSiblingElement("passive")) {
    const char* joint = e->Attribute("joint");
    if (joint == nullptr) {
      throw UsageError(where.file() + ":" + std::to_string(e->Row()) +
                       ": passive: no attribute 'joint', expected the name of a joint");
    }
    const auto fail = [&](const std::string& message) {
      where.Fail("passive", joint, message, "joint");
    };
    const auto number = [&](const char* attribute) {
      double value = 0.0;
      if (e->QueryDoubleAttribute(attribute, &value) != TIXML_SUCCESS || !std::isfinite(value) ||
          value < 0.0) {
        const char* text = e->Attribute(attribute);
        fail(std::string(attribute) + (text != nullptr ? " = '" + std::string(text) + "'" : "") +
             ", expected a number of at least 0");
      }
      return value;
    };
    const int index = FindJoint(*chain, joint);
    if (index < 0) fail("no moving joint has this name");
    Body& body = chain->bodies[static_cast<std::size_t>(index)];
    if (body.passive) fail("given twice");
    if (body.mimic) fail("the joint mimics '" + body.mimic->joint_name + "'");
    if (body.effort > 0.0) {
      fail("the joint's effort is " + std::to_string(body.effort) +
           ", expected 0 where no drive is");
    }
    for (const TiXmlElement* t = root->FirstChildElement("transmission"); t != nullptr;
         t = t->NextSiblingElement("transmission")) {
      const TiXmlElement* driven = t->FirstChildElement("joint");
      const char* name = driven != nullptr ? driven->Attribute("name") : nullptr;
      if (name != nullptr && body.joint_name == name) fail("the joint has a transmission");
    }
    body.passive = Passive{.stiffness_Nm_rad = number("stiffness_Nm_rad"),
                           .damping_Nms_rad = number("damping_Nms_rad")};
  }
}

// True when `body` is `root` or fixed to it.
bool IsCarried(const Chain& chain, int body, int root) {
  while (body > root) body = chain.bodies[static_cast<std::size_t>(body)].parent;
  return body == root;
}

// Before urdfdom, which frees links by recursion.
void RequireFewLinks(const TiXmlElement& robot, const Where& where) {
  int count = 0;
  for (const TiXmlElement* e = robot.FirstChildElement("link"); e != nullptr;
       e = e->NextSiblingElement("link")) {
    if (++count <= kMostLinks) continue;
    throw UsageError(where.file() + ":" + std::to_string(e->Row()) + ": more than " +
                     std::to_string(kMostLinks) + " links, expected fewer");
  }
}

// urdfdom leaves out what stands inside of elements that it does not know.
void RefuseXacro(TiXmlElement& robot, const std::string& file) {
  for (const TiXmlElement* e : ElementsIn(robot)) {
    if (!e->ValueStr().starts_with("xacro:")) continue;
    throw UsageError(file + ":" + std::to_string(e->Row()) + ": '" + e->ValueStr() +
                     "': expand it with xacro first, expected a URDF");
  }
}

}  // namespace

Chain ParseUrdf(const std::string& xml, const std::string& file_name) {
  TiXmlDocument document;
  ParseXml(xml, file_name, &document);
  if (document.RootElement() == nullptr || document.RootElement()->ValueStr() != "robot") {
    throw UsageError(file_name + ":1: expected a URDF, whose root element is 'robot'");
  }
  const Where where(document, file_name);
  RequireFewLinks(*document.RootElement(), where);
  RefuseXacro(*document.RootElement(), file_name);
  for (const TiXmlElement* e = document.RootElement()->FirstChildElement("joint"); e != nullptr;
       e = e->NextSiblingElement("joint")) {
    CheckJoint(*e, where);
  }
  DefineMaterials(file_name, document.RootElement());
  TiXmlPrinter defined;
  document.Accept(&defined);
  urdf::ModelInterfaceSharedPtr model;
  std::string complaint;
  {
    CapturedMessages messages;
    try {
      model = urdf::parseURDF(defined.Str());
    } catch (const std::exception& error) {
      complaint = error.what();
    }
    if (!messages.first_error().empty()) complaint = messages.first_error();
  }
  if (!model || !complaint.empty()) {
    throw UsageError(file_name + ": no valid URDF: " +
                     (complaint.empty() ? "the parser gives no reason" : complaint));
  }

  Chain chain;
  chain.name = model->getName();
  chain.base.link_name = model->getRoot()->name;
  ReadInertial(*model->getRoot(), where, &chain.base);
  const std::function<void(const urdf::LinkConstSharedPtr&, int)> add =
      [&](const urdf::LinkConstSharedPtr& link, int parent) {
        std::vector<urdf::LinkSharedPtr> children = link->child_links;
        std::sort(children.begin(), children.end(),
                  [](const auto& a, const auto& b) { return a->name < b->name; });
        for (const urdf::LinkSharedPtr& child : children) {
          Body body;
          body.link_name = child->name;
          body.parent = parent;
          ReadJoint(*child->parent_joint, where, &body);
          ReadInertial(*child, where, &body);
          chain.bodies.push_back(std::move(body));
          add(child, static_cast<int>(chain.bodies.size()) - 1);
        }
      };
  add(model->getRoot(), -1);
  ResolveMimics(where, &chain);
  ReadPassive(document, where, &chain);

  bool any_moves = false;
  for (int i = 0; i < static_cast<int>(chain.bodies.size()); ++i) {
    const Body& body = chain.bodies[static_cast<std::size_t>(i)];
    if (!body.moves) continue;
    any_moves = true;
    double mass = 0.0;
    for (int k = i; k < static_cast<int>(chain.bodies.size()); ++k) {
      if (IsCarried(chain, k, i)) mass += chain.bodies[static_cast<std::size_t>(k)].mass_kg;
    }
    if (!(mass > 0.0)) {
      where.Fail("link", body.link_name,
                 "moves but neither it nor what it carries has an inertial element with a mass");
    }
  }
  if (!any_moves) throw UsageError(file_name + ": no joint moves");
  return chain;
}

}  // namespace sinew::arm
