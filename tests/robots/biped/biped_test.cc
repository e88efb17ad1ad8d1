// robots/biped: the URDF describes a body that can exist.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tinyxml.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "components/bodies/leg/geometry.h"
#include "components/bodies/leg/squat.h"
#include "components/bodies/links/file/urdf_file.h"
#include "tests/components/bodies/leg/declared_branch.h"

namespace sinew {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kFolder = SINEW_SOURCE_DIR "/robots/biped/";
constexpr double kRounding = 1e-9;

std::string ReadUrdf() {
  std::ifstream in(kFolder + "biped.urdf", std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

arm::Chain Biped() { return arm::ParseUrdf(ReadUrdf(), "biped.urdf"); }

const arm::Body* FindLink(const arm::Chain& chain, const std::string& name) {
  for (const arm::Body& body : chain.bodies) {
    if (body.link_name == name) return &body;
  }
  return nullptr;
}

using Angles = std::map<std::string, double>;  // joint name -> rad; absent: 0

// A link's frame in the base's.
Eigen::Isometry3d FrameOf(const arm::Chain& chain, const arm::Body* body,
                          const Angles& angles = {}) {
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  while (body != nullptr) {
    const auto angle = angles.find(body->joint_name);
    if (angle != angles.end()) frame = Eigen::AngleAxisd(angle->second, body->axis) * frame;
    frame = body->parent_from_joint * frame;
    body = body->parent < 0 ? nullptr : &chain.bodies[static_cast<std::size_t>(body->parent)];
  }
  return frame;
}

Eigen::Vector3d Place(const arm::Chain& chain, const std::string& link, const Angles& angles = {}) {
  return FrameOf(chain, FindLink(chain, link), angles).translation();
}

Eigen::Vector3d CentreOfMass(const arm::Chain& chain, const Angles& angles = {}) {
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double mass_kg = 0.0;
  for (const arm::Body& body : chain.bodies) {
    moment += body.mass_kg * (FrameOf(chain, &body, angles) * body.com_m);
    mass_kg += body.mass_kg;
  }
  return moment / mass_kg;
}

TEST(Biped, WeighsWhatThePrototypeWeighs) {
  double mass_kg = 0.0;
  const arm::Chain chain = Biped();
  for (const arm::Body& body : chain.bodies) mass_kg += body.mass_kg;
  EXPECT_NEAR(mass_kg, 17.1, 1e-6);
  const std::string text = ReadUrdf();  // the reader leaves out a root's inertia: there is none
  EXPECT_NE(text.find("<link name=\"base\"/>"), std::string::npos);
}

TEST(Biped, TwelveJointsAreDrivenInTheirOrderAndTwoToesAreNot) {
  std::vector<std::string> driven, passive;
  for (const arm::Body& body : Biped().bodies) {
    if (!body.moves) continue;
    (body.effort > 0.0 ? driven : passive).push_back(body.joint_name);
    EXPECT_EQ(body.passive.has_value(), body.effort == 0.0) << body.joint_name;
  }
  EXPECT_THAT(driven, ElementsAre("left_hip_yaw", "left_hip_roll", "left_hip_pitch", "left_knee",
                                  "left_ankle_pitch", "left_ankle_roll", "right_hip_yaw",
                                  "right_hip_roll", "right_hip_pitch", "right_knee",
                                  "right_ankle_pitch", "right_ankle_roll"));
  EXPECT_THAT(passive, ElementsAre("left_toe_passive", "right_toe_passive"));

  TiXmlDocument document;
  document.Parse(ReadUrdf().c_str());
  std::vector<std::string> transmissions, joints;
  for (const TiXmlElement* e = document.RootElement()->FirstChildElement("transmission");
       e != nullptr; e = e->NextSiblingElement("transmission")) {
    transmissions.emplace_back(e->FirstChildElement("joint")->Attribute("name"));
  }
  EXPECT_EQ(transmissions, driven);
  for (const TiXmlElement* e = document.RootElement()->FirstChildElement("passive"); e != nullptr;
       e = e->NextSiblingElement("passive")) {
    joints.emplace_back(e->Attribute("joint"));
    EXPECT_GT(std::stod(e->Attribute("stiffness_Nm_rad")), 0.0);
  }
  EXPECT_EQ(joints, passive);
}

struct TablePart {
  std::string link, name, shape, size, material;
};

// Of shapes.csv, both legs.
std::vector<TablePart> PartsOfTheTable() {
  std::vector<TablePart> parts;
  std::ifstream in(kFolder + "shapes.csv");
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line.front() == '#' || line.rfind("link,", 0) == 0) continue;
    std::array<std::string, 7> cells;
    std::istringstream row(line);
    for (std::string& cell : cells) std::getline(row, cell, ',');
    const bool of_leg = cells[0].find("{side}") != std::string::npos;
    for (const std::string side : {"left", "right"}) {
      TablePart part{cells[0], cells[1], cells[2], cells[5], of_leg ? side : "body"};
      if (of_leg) part.link.replace(part.link.find("{side}"), 6, side);
      if (part.shape == "cylinder") part.material = "actuator";
      if (part.name == "rear_segment" || part.name == "front_segment") part.material = "sole";
      parts.push_back(part);
      if (!of_leg) break;
    }
  }
  return parts;
}

std::vector<double> NumbersIn(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<double>(in), {}};
}

TEST(Biped, EveryPartIsDrawnWithItsShapeAndTheColourOfItsSide) {
  TiXmlDocument document;
  document.Parse(ReadUrdf().c_str());
  std::map<std::string, const TiXmlElement*> visuals;  // "link/part"
  for (const TiXmlElement* link = document.RootElement()->FirstChildElement("link");
       link != nullptr; link = link->NextSiblingElement("link")) {
    for (const TiXmlElement* e = link->FirstChildElement("visual"); e != nullptr;
         e = e->NextSiblingElement("visual")) {
      visuals[std::string(link->Attribute("name")) + "/" + e->Attribute("name")] = e;
    }
  }
  std::map<std::string, std::string> colours;
  for (const TiXmlElement* e = document.RootElement()->FirstChildElement("material"); e != nullptr;
       e = e->NextSiblingElement("material")) {
    colours[e->Attribute("name")] = e->FirstChildElement("color")->Attribute("rgba");
  }
  const std::vector<TablePart> parts = PartsOfTheTable();
  EXPECT_EQ(parts.size(), visuals.size());
  for (const TablePart& part : parts) {
    const auto found = visuals.find(part.link + "/" + part.name);
    ASSERT_NE(found, visuals.end()) << part.link << '/' << part.name;
    const TiXmlElement* form = found->second->FirstChildElement("geometry")->FirstChildElement();
    EXPECT_EQ(form->ValueStr(), part.shape);
    const std::string size = part.shape == "box" ? form->Attribute("size")
                                                 : std::string(form->Attribute("radius")) + " " +
                                                       form->Attribute("length");
    EXPECT_EQ(NumbersIn(size), NumbersIn(part.size)) << found->first;
    const std::string material = found->second->FirstChildElement("material")->Attribute("name");
    EXPECT_EQ(material, part.material) << found->first;
    EXPECT_EQ(NumbersIn(colours[material]).size(), 4u) << material;
  }
  EXPECT_NE(colours["left"], colours["right"]);
}

TEST(Biped, EffortIsMotorTimesReductionTimesEfficiency) {
  const std::map<std::string, double> published = {{"hip_yaw", 14.9},     {"hip_roll", 35.8},
                                                   {"hip_pitch", 35.8},   {"knee", 29.8},
                                                   {"ankle_pitch", 29.8}, {"ankle_roll", 14.9}};
  constexpr double kPrinted = 0.05;  // the source prints one decimal
  const arm::Chain chain = Biped();
  for (const std::string side : {"left_", "right_"}) {
    for (const auto& [name, effort_Nm] : published) {
      const int body = arm::FindJoint(chain, side + name);
      ASSERT_GE(body, 0);
      EXPECT_NEAR(chain.bodies[static_cast<std::size_t>(body)].effort, effort_Nm, kPrinted) << name;
    }
  }
}

TEST(Biped, InertiasArePositiveAndKeepTheTriangleInequality) {
  int massive = 0;
  for (const arm::Body& body : Biped().bodies) {
    if (body.mass_kg == 0.0) {
      EXPECT_EQ(body.inertia_kg_m2.norm(), 0.0) << body.link_name;
      continue;
    }
    ++massive;
    const Eigen::Vector3d principal =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(body.inertia_kg_m2).eigenvalues();
    EXPECT_GT(principal[0], 0.0) << body.link_name;
    EXPECT_GT(principal[0] + principal[1], principal[2]) << body.link_name;
    // No part lies further from its centre than the robot is high.
    EXPECT_LT(principal[2], body.mass_kg * 0.3 * 0.3) << body.link_name;
  }
  EXPECT_EQ(massive, 16);
}

// Against shapes.csv by hand: thigh = box 0.75 kg (0.05 0.06 0.20) at -0.139 and cylinder 0.5 kg
// (r 0.035, l 0.06, along y) at (0, 0.03, -0.278).
TEST(Biped, AnInertiaIsThatOfItsParts) {
  const arm::Chain chain = Biped();
  const arm::Body* thigh = FindLink(chain, "left_thigh");
  ASSERT_NE(thigh, nullptr);
  const double y = 0.5 * 0.03 / 1.25, z = -(0.75 * 0.139 + 0.5 * 0.278) / 1.25;
  EXPECT_LT((thigh->com_m - Eigen::Vector3d(0.0, y, z)).norm(), kRounding);
  const double box = 0.75 * (0.06 * 0.06 + 0.20 * 0.20) / 12.0;
  const double cylinder = 0.5 * (3.0 * 0.035 * 0.035 + 0.06 * 0.06) / 12.0;
  const double xx = box + 0.75 * (y * y + std::pow(-0.139 - z, 2)) + cylinder +
                    0.5 * (std::pow(0.03 - y, 2) + std::pow(-0.278 - z, 2));
  EXPECT_NEAR(thigh->inertia_kg_m2(0, 0), xx, kRounding);
}

TEST(Biped, TheLegsAreThoseOfTable31AndMirrored) {
  const arm::Chain chain = Biped();
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0.0 ? "left" : "right";
    const leg::LegGeometry g = leg::GeometryOf(chain, leg::NamesOfSide(name), name + "_sole");
    EXPECT_LT((g.hip_in_pelvis_m - Eigen::Vector3d(0.0, side * 0.075, 0.0)).norm(), kRounding);
    EXPECT_NEAR(g.thigh_m, 0.278, kRounding);
    EXPECT_NEAR(g.shank_m, 0.260, kRounding);
    EXPECT_NEAR(g.ankle_offset_m, 0.104, kRounding);
    EXPECT_LT((g.sole_in_ankle_m - Eigen::Vector3d(0.0, 0.0, -0.134)).norm(), kRounding);
  }
  for (const arm::Body& left : chain.bodies) {
    if (left.link_name.rfind("left_", 0) != 0) continue;
    const arm::Body* right = FindLink(chain, "right_" + left.link_name.substr(5));
    ASSERT_NE(right, nullptr) << left.link_name;
    const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
    EXPECT_LT((right->com_m - mirror * left.com_m).norm(), kRounding) << left.link_name;
    EXPECT_LT((right->inertia_kg_m2 - mirror * left.inertia_kg_m2 * mirror).norm(), kRounding);
    EXPECT_EQ(right->mass_kg, left.mass_kg);
  }
}

// Whatever the joint limits admit, the inverse kinematics gives back.
TEST(Biped, TheJointLimitsLieInTheDeclaredBranch) {
  const arm::Chain chain = Biped();
  const leg::LegJointNames names = leg::NamesOfSide("left");
  const leg::LegGeometry g = leg::GeometryOf(chain, names, "left_sole");
  std::array<const arm::Body*, leg::kLegJoints> joints{};
  for (std::size_t j = 0; j < names.size(); ++j) {
    joints[j] = &chain.bodies[static_cast<std::size_t>(arm::FindJoint(chain, names[j]))];
  }
  constexpr int kGrid = 200;
  const auto at = [&joints](leg::LegJoint joint, int i) {
    const arm::Body& body = *joints[static_cast<std::size_t>(joint)];
    return body.lower + (body.upper - body.lower) * i / kGrid;
  };
  for (int i = 0; i <= kGrid; ++i) {
    for (int k = 0; k <= kGrid; ++k) {
      leg::LegAngles q = leg::LegAngles::Zero();
      q[leg::kKnee] = at(leg::kKnee, i);
      q[leg::kAnklePitch] = at(leg::kAnklePitch, k);
      ASSERT_TRUE(leg::InDeclaredBranch(g, q)) << q.transpose();
    }
  }
}

TEST(Biped, IsAMetreHighAndStandsOnItsSensors) {
  const arm::Chain chain = Biped();
  const double ground = Place(chain, "left_sole").z();
  EXPECT_NEAR(Place(chain, "torso").z() + 0.143 - ground, 0.243 + 0.776, kRounding);
  EXPECT_GT(Place(chain, "imu").z(), 0.1);
  // The centre of mass is within the area of the sensors, standing straight.
  const Eigen::Vector3d com = CentreOfMass(chain);
  EXPECT_NEAR(com.y(), 0.0, kRounding);
  for (const std::string side : {"left", "right"}) {
    for (const std::string across : {"_outer", "_inner"}) {
      const Eigen::Vector3d rear = Place(chain, side + "_force_rear" + across);
      const Eigen::Vector3d front = Place(chain, side + "_force_front" + across);
      EXPECT_NEAR(rear.z(), ground, kRounding);
      EXPECT_NEAR(front.z(), ground, kRounding);
      EXPECT_LT(rear.x(), com.x());
      EXPECT_GT(front.x(), com.x());
    }
  }
}

// The published squat down to 0.4 m, feet below the hips, needs no lean of the torso.
TEST(Biped, SquatsOverItsFeet) {
  const arm::Chain chain = Biped();
  const leg::LegGeometry g = leg::GeometryOf(chain, leg::NamesOfSide("left"), "left_sole");
  for (int centimetres = 2; centimetres <= 40; ++centimetres) {
    const double depth_m = 0.01 * centimetres;
    const auto squat = leg::SquatAt(g, 0.0, {leg::StraightHeight(g, 0.0) - depth_m, 0.0, 0.0});
    ASSERT_TRUE(squat.has_value()) << depth_m;
    Angles angles;
    for (const std::string side : {"left_", "right_"}) {
      angles[side + "hip_pitch"] = squat->hip_pitch.position_rad;
      angles[side + "knee"] = squat->knee.position_rad;
      angles[side + "ankle_pitch"] = squat->ankle_pitch.position_rad;
    }
    ASSERT_NEAR(Place(chain, "left_sole", angles).z(), -0.776 + depth_m, kRounding);
    const double com_x = CentreOfMass(chain, angles).x();
    constexpr double kMargin_m = 0.03;
    EXPECT_GT(com_x, Place(chain, "left_force_rear_outer", angles).x() + kMargin_m) << depth_m;
    EXPECT_LT(com_x, Place(chain, "left_force_front_outer", angles).x() - kMargin_m) << depth_m;
  }
}

}  // namespace
}  // namespace sinew
