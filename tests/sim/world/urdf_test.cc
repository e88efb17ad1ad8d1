#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "sim/world/chain.h"
#include "tests/support/skip.h"

namespace sinew::world {
namespace {

using arm::ParseUrdf;
using ::testing::HasSubstr;

std::string Robot(const std::string& inertial, const std::string& joint,
                  const std::string& more = "") {
  return "<robot name=\"r\">\n<link name=\"base\"/>\n<link name=\"arm\">" + inertial +
         "</link>\n<joint name=\"j\" " + joint +
         "<parent link=\"base\"/><child link=\"arm\"/></joint>\n" + more + "</robot>\n";
}

const char kInertial[] =
    "<inertial><mass value=\"2\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" "
    "izz=\"1\"/></inertial>";
const char kRevolute[] = "type=\"continuous\"><axis xyz=\"0 0 2\"/>";

std::string ErrorOf(const std::string& xml) {
  try {
    ParseUrdf(xml, "bad.urdf");
  } catch (const UsageError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    EXPECT_THAT(what, ::testing::StartsWith("bad.urdf"));
    return what;
  }
  return "no error";
}

TEST(ParseUrdf, ReadsBodiesJointsAndUnitAxes) {
  const arm::Chain chain = ParseUrdf(Robot(kInertial, kRevolute), "r.urdf");
  ASSERT_EQ(chain.bodies.size(), 1u);
  EXPECT_EQ(chain.bodies[0].link_name, "arm");
  EXPECT_TRUE(chain.bodies[0].moves);
  EXPECT_EQ(chain.bodies[0].axis, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(chain.bodies[0].mass_kg, 2.0);
  EXPECT_EQ(arm::FindJoint(chain, "j"), 0);
  EXPECT_EQ(arm::FindJoint(chain, "k"), -1);
}

// A floating base needs the inertia of the root link; its frame is turned by 90 degrees about z.
TEST(ParseUrdf, ReadsTheInertiaOfTheBase) {
  std::string xml = Robot(kInertial, kRevolute);
  const std::string bare = "<link name=\"base\"/>";
  EXPECT_EQ(ParseUrdf(xml, "r.urdf").base.mass_kg, 0.0);
  EXPECT_EQ(ParseUrdf(xml, "r.urdf").base.link_name, "base");
  const auto with = [&](const std::string& mass) {
    return std::string(xml).replace(
        xml.find(bare), bare.size(),
        "<link name=\"base\"><inertial><origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/>"
        "<mass value=\"" +
            mass +
            "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"2\" iyz=\"0\" izz=\"2.5\"/>"
            "</inertial></link>");
  };
  const arm::Base base = ParseUrdf(with("4"), "r.urdf").base;
  EXPECT_EQ(base.mass_kg, 4.0);
  EXPECT_EQ(base.com_m, Eigen::Vector3d(1.0, 2.0, 3.0));
  const Eigen::Matrix3d expected = Eigen::Vector3d(2.0, 1.0, 2.5).asDiagonal();
  EXPECT_LT((base.inertia_kg_m2 - expected).norm(), 1e-15);
}

TEST(ParseUrdf, ChecksTheInertiaOfEveryLinkTheBaseAmongThem) {
  const auto inertial = [](const std::string& mass, const std::string& izz) {
    return "<inertial><mass value=\"" + mass +
           "\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" "
           "iyz=\"0\" izz=\"" +
           izz + "\"/></inertial>";
  };
  const std::string bare = "<link name=\"base\"/>";
  const auto of_base = [&](const std::string& text) {
    std::string xml = Robot(kInertial, kRevolute);
    return xml.replace(xml.find(bare), bare.size(), "<link name=\"base\">" + text + "</link>");
  };
  for (const auto& [bad, reason] : {std::pair{inertial("-4", "1"), "mass -4"},
                                    {inertial("0", "1"), "mass 0"},
                                    {inertial("2", "3"), "triangle inequality"},
                                    {inertial("2", "-1"), "principal moment -1"}}) {
    const std::string base = ErrorOf(of_base(bad)), arm = ErrorOf(Robot(bad, kRevolute));
    EXPECT_THAT(base, ::testing::AllOf(::testing::StartsWith("bad.urdf:2: link 'base': "),
                                       HasSubstr(reason)));
    // The same line, but for place and name.
    EXPECT_EQ(base.substr(base.find("': ")), arm.substr(arm.find("': ")));
  }
}

// Joints j0, j1, ... on the base, each with `more` of its index.
std::string Joints(const std::vector<std::string>& more) {
  std::string text = "<robot name=\"r\">\n<link name=\"base\"/>\n";
  for (std::size_t i = 0; i < more.size(); ++i) {
    const std::string n = std::to_string(i);
    text += "<link name=\"l" + n + "\">" + kInertial + "</link><joint name=\"j" + n +
            "\" type=\"revolute\"><parent link=\"base\"/><child link=\"l" + n + "\"/>" + more[i] +
            "</joint>\n";
  }
  return text + "</robot>\n";
}

std::string Limit(const std::string& lower, const std::string& upper) {
  return "<limit lower=\"" + lower + "\" upper=\"" + upper + "\" effort=\"3\" velocity=\"1\"/>";
}

const std::string kFree = Limit("0", "0");

std::string MimicOf(const std::string& joint, const std::string& more = "") {
  return "<mimic joint=\"" + joint + "\" " + more + "/>";
}

// j0 follows j1, that one j2, and so on: the last one is free.
TEST(ParseUrdf, AJointThatMimicsOneThatMimicsAnotherFollowsTheLast) {
  for (std::size_t length = 2; length < 6; ++length) {
    std::vector<std::string> more;
    double multiplier = 1.0, offset = 0.0;
    for (std::size_t i = 0; i + 1 < length; ++i) {
      const double factor = -0.5 - static_cast<double>(i), add = 0.25 * static_cast<double>(i);
      more.push_back(kFree + MimicOf("j" + std::to_string(i + 1),
                                     "multiplier=\"" + std::to_string(factor) + "\" offset=\"" +
                                         std::to_string(add) + "\""));
      offset += multiplier * add;
      multiplier *= factor;
    }
    more.push_back(kFree);
    const std::string last = "j" + std::to_string(length - 1);
    const arm::Chain chain = ParseUrdf(Joints(more), "r.urdf");
    for (const arm::Body& body : chain.bodies) {
      EXPECT_EQ(body.mimic.has_value(), body.joint_name != last);
      EXPECT_EQ(arm::IsDriven(body), body.joint_name == last);
      EXPECT_EQ(body.mimic ? body.mimic->joint_name : last, last);
    }
    EXPECT_DOUBLE_EQ(chain.bodies[0].mimic->multiplier, multiplier);
    EXPECT_DOUBLE_EQ(chain.bodies[0].mimic->offset, offset);
    EXPECT_EQ(arm::CoordinatesOf(chain)[0].body, static_cast<int>(length) - 1);
  }
  const arm::Mimic plain =
      *ParseUrdf(Joints({kFree, kFree + MimicOf("j0")}), "r.urdf").bodies[1].mimic;
  EXPECT_EQ(plain.multiplier, 1.0);
  EXPECT_EQ(plain.offset, 0.0);
}

TEST(ParseUrdf, StopsOfAJointThatMimicsAnotherBoundTheOther) {
  struct Case {
    const char *lower, *upper, *multiplier, *offset;
    double expected_lower, expected_upper;
  };
  for (const Case& c : {Case{"-1", "1", "2", "0", -0.5, 0.5}, Case{"-1", "3", "-2", "1", -1.0, 1.0},
                        Case{"-9", "9", "1", "0", -1.5, 2.0}, Case{"0", "0", "2", "7", -1.5, 2.0},
                        Case{"-1", "1", "0", "0.5", -1.5, 2.0}}) {
    const arm::Chain chain = ParseUrdf(
        Joints({Limit("-1.5", "2"), Limit(c.lower, c.upper) +
                                        MimicOf("j0", std::string("multiplier=\"") + c.multiplier +
                                                          "\" offset=\"" + c.offset + "\"")}),
        "r.urdf");
    EXPECT_DOUBLE_EQ(chain.bodies[0].lower, c.expected_lower) << c.multiplier;
    EXPECT_DOUBLE_EQ(chain.bodies[0].upper, c.expected_upper) << c.multiplier;
  }
  for (const std::string& bad :
       {Limit("0", "1") + MimicOf("j0", "multiplier=\"-1\""), Limit("3", "4") + MimicOf("j0"),
        Limit("-1", "1") + MimicOf("j0", "multiplier=\"0\" offset=\"2\"")}) {
    EXPECT_THAT(ErrorOf(Joints({Limit("0", "1"), bad})),
                ::testing::AllOf(HasSubstr("bad.urdf:4: joint 'j1': mimics 'j0'"),
                                 HasSubstr("leave no range")));
  }
}

TEST(ParseUrdf, ReportsAMimicThatNothingCanFollow) {
  const auto refuses = [](const std::string& first, const std::string& second,
                          const std::string& expected) {
    EXPECT_THAT(ErrorOf(Joints({kFree + first, kFree + second})),
                ::testing::AllOf(HasSubstr("bad.urdf:3: joint 'j0': mimic"), HasSubstr(expected)));
  };
  refuses(MimicOf("none"), "", "'none', expected the name of a joint that moves");
  refuses("<mimic/>", "", "no attribute 'joint'");
  refuses(MimicOf("j0"), "", "follows itself");
  refuses(MimicOf("j1"), MimicOf("j0"), "follows itself");
  for (const char* attribute : {"multiplier", "offset"}) {
    for (const char* value : {"two", "", "nan", "inf"}) {
      refuses(MimicOf("j1", std::string(attribute) + "=\"" + value + "\""), "", attribute);
    }
  }
  const std::string huge = "multiplier=\"1e200\"";
  EXPECT_THAT(ErrorOf(Joints({kFree + MimicOf("j1", huge), kFree + MimicOf("j2", huge), kFree})),
              HasSubstr("bad.urdf:3: joint 'j0': mimics 'j2', whose limits and its own"));
}

TEST(ParseUrdf, LimitsMeanWhatTheDocumentSays) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto body = [](const std::string& type, const std::string& limit) {
    return ParseUrdf(Robot(kInertial, "type=\"" + type + "\">" + limit), "r.urdf").bodies[0];
  };
  for (const std::string type : {"revolute", "prismatic", "continuous"}) {
    const bool stops = type != "continuous";
    EXPECT_EQ(body(type, Limit("-1", "2")).lower, stops ? -1.0 : -kInfinity) << type;
    EXPECT_EQ(body(type, Limit("-1", "2")).upper, stops ? 2.0 : kInfinity) << type;
    EXPECT_EQ(body(type, Limit("0", "0")).upper, kInfinity) << type;
    EXPECT_EQ(body(type, "<limit effort=\"1\" velocity=\"1\"/>").lower, -kInfinity) << type;
    EXPECT_EQ(body(type, Limit("0.5", "0.5")).lower, stops ? 0.5 : -kInfinity) << type;
    EXPECT_EQ(body(type, "<limit upper=\"2\" effort=\"1\" velocity=\"1\"/>").lower,
              stops ? 0.0 : -kInfinity)
        << type;
    const std::string without = ErrorOf(Robot(kInertial, "type=\"" + type + "\">"));
    if (stops) {
      EXPECT_THAT(without,
                  HasSubstr("bad.urdf:4: joint 'j': " + type + " without limit, expected"));
    } else {
      EXPECT_EQ(without, "no error");
    }
    for (const char* attribute : {"effort", "velocity"}) {
      const std::string other = attribute == std::string("effort") ? "velocity" : "effort";
      EXPECT_THAT(ErrorOf(Robot(kInertial, "type=\"" + type + "\"><limit " + other + "=\"1\"/>")),
                  HasSubstr(std::string("bad.urdf:4: joint 'j': limit has ") + attribute +
                            " = '', expected a number"));
    }
    for (const char* attribute : {"lower", "upper", "effort", "velocity"}) {
      std::string limit = Limit("-1", "1");
      limit.insert(limit.find(attribute) + std::string(attribute).size() + 2, "x");
      EXPECT_THAT(ErrorOf(Robot(kInertial, "type=\"" + type + "\">" + limit)),
                  HasSubstr(std::string("limit has ") + attribute + " = 'x"));
    }
  }
}

TEST(ParseUrdf, ReportsAnErrorInOneLine) {
  EXPECT_THAT(ErrorOf("<robot name=\"r\">\n<link name=\"base\">\n</robot>"),
              ::testing::AllOf(HasSubstr("bad.urdf:"), HasSubstr("no valid XML")));
  EXPECT_THAT(ErrorOf("hello"), HasSubstr("bad.urdf:1"));
  EXPECT_THAT(ErrorOf(""), HasSubstr("bad.urdf:1"));
  EXPECT_THAT(ErrorOf("<sdf/>"), HasSubstr("'robot'"));
  EXPECT_THAT(
      ErrorOf(Robot("", kRevolute)),
      ::testing::AllOf(HasSubstr("bad.urdf:3"), HasSubstr("link 'arm'"), HasSubstr("mass")));
  EXPECT_THAT(ErrorOf(Robot(kInertial, "type=\"floating\">")),
              ::testing::AllOf(HasSubstr("bad.urdf:4"), HasSubstr("joint 'j'"),
                               HasSubstr("expected revolute")));
  EXPECT_THAT(ErrorOf(Robot(kInertial, "type=\"continuous\"><axis xyz=\"0 0 0\"/>")),
              HasSubstr("axis has no direction"));
  EXPECT_THAT(ErrorOf(Robot(kInertial,
                            "type=\"revolute\"><limit lower=\"1\" upper=\"-1\" "
                            "effort=\"1\" velocity=\"1\"/>")),
              HasSubstr("lower limit above upper"));
  EXPECT_THAT(ErrorOf(Robot("<inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
                            "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>",
                            kRevolute)),
              HasSubstr("expected kg above 0"));
  EXPECT_THAT(ErrorOf(Robot("<inertial><mass value=\"0\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
                            "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>",
                            kRevolute)),
              HasSubstr("expected kg above 0"));
  EXPECT_THAT(ErrorOf(Robot("<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" "
                            "iyy=\"1\" iyz=\"0\" izz=\"3\"/></inertial>",
                            kRevolute)),
              HasSubstr("triangle"));
  EXPECT_THAT(ErrorOf(Robot("<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"2\" ixz=\"0\" "
                            "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>",
                            kRevolute)),
              HasSubstr("principal moment"));
  EXPECT_THAT(ErrorOf(Robot("<inertial><mass value=\"heavy\"/><inertia ixx=\"1\" ixy=\"0\" "
                            "ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>",
                            kRevolute)),
              HasSubstr("no valid URDF"));
  EXPECT_THAT(ErrorOf(Robot(kInertial, kRevolute,
                            "<joint name=\"k\" type=\"fixed\"><parent link=\"arm\"/><child "
                            "link=\"ghost\"/></joint>")),
              ::testing::AllOf(HasSubstr("no valid URDF"), HasSubstr("ghost")));
  EXPECT_THAT(ErrorOf("<robot name=\"r\"><link name=\"base\"/></robot>"),
              HasSubstr("no joint moves"));
}

TEST(ParseUrdf, ReadsPassiveJoints) {
  const std::string free = "type=\"continuous\"><axis xyz=\"0 0 1\"/>";
  const auto with = [&](const std::string& passive, const std::string& joint) {
    return Robot(kInertial, joint, passive);
  };
  const arm::Chain chain = ParseUrdf(
      with("<passive joint=\"j\" stiffness_Nm_rad=\"9.5\" damping_Nms_rad=\"0.25\"/>\n", free),
      "r.urdf");
  ASSERT_TRUE(chain.bodies[0].passive);
  EXPECT_EQ(chain.bodies[0].passive->stiffness_Nm_rad, 9.5);
  EXPECT_EQ(chain.bodies[0].passive->damping_Nms_rad, 0.25);
  EXPECT_FALSE(ParseUrdf(with("", free), "r.urdf").bodies[0].passive);

  const auto refuses = [&](const std::string& passive, const std::string& field,
                           const std::string& joint) {
    EXPECT_THAT(ErrorOf(with(passive + "\n", joint)),
                ::testing::AllOf(HasSubstr("bad.urdf:5: passive"), HasSubstr(field)));
  };
  refuses("<passive stiffness_Nm_rad=\"1\" damping_Nms_rad=\"1\"/>", "'joint'", free);
  refuses("<passive joint=\"k\" stiffness_Nm_rad=\"1\" damping_Nms_rad=\"1\"/>", "'k'", free);
  refuses("<passive joint=\"j\" damping_Nms_rad=\"1\"/>", "stiffness_Nm_rad", free);
  refuses("<passive joint=\"j\" stiffness_Nm_rad=\"stiff\" damping_Nms_rad=\"1\"/>", "'stiff'",
          free);
  refuses("<passive joint=\"j\" stiffness_Nm_rad=\"1\" damping_Nms_rad=\"-1\"/>", "damping_Nms_rad",
          free);
  const std::string good = "<passive joint=\"j\" stiffness_Nm_rad=\"1\" damping_Nms_rad=\"1\"/>";
  refuses(good, "effort",
          "type=\"continuous\"><axis xyz=\"0 0 1\"/><limit effort=\"3\" velocity=\"1\"/>");
  refuses(good + "<transmission name=\"t\"><joint name=\"j\"/></transmission>", "transmission",
          free);
  refuses(good + good, "twice", free);
}

// Two crossed axes in one point, the link between them without mass: each turns the last link
// alone.
TEST(ParseUrdf, ALinkWithoutMassMayCarryOneThatHasSome) {
  for (const std::string& nothing :
       {std::string(),
        std::string("<inertial><mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" "
                    "iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial>")}) {
    const arm::Chain chain = ParseUrdf(
        Robot(
            nothing, "type=\"continuous\"><axis xyz=\"0 0 1\"/>",
            "<link name=\"tip\"><inertial><origin xyz=\"0.5 0 0\"/><mass value=\"2\"/><inertia "
            "ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial></link>"
            "<joint name=\"k\" type=\"continuous\"><parent link=\"arm\"/><child link=\"tip\"/>"
            "<axis xyz=\"0 1 0\"/></joint>"),
        "r.urdf");
    EXPECT_EQ(chain.bodies[0].mass_kg, 0.0);
    RigidChain rigid(chain);
    JointVector q = JointVector::Zero(2), v = JointVector::Zero(2), a(2);
    JointMatrix inverse(2, 2);
    rigid.SetState(q, v);
    rigid.Solve(&a, &inverse);
    EXPECT_NEAR(inverse(0, 0), 1.0 / 0.6, 1e-12);  // 0.1 + 2 x 0.5^2
    EXPECT_NEAR(inverse(1, 1), 1.0 / 0.6, 1e-12);
    EXPECT_NEAR(inverse(0, 1), 0.0, 1e-12);
    EXPECT_NEAR(a[1], 2.0 * 9.81 * 0.5 / 0.6, 1e-12);
  }
}

TEST(OverrideLink, GivesTheJointTheInertiaOfTheModel) {
  for (const bool gravity_elsewhere : {false, true}) {
    arm::Chain chain = ParseUrdf(
        Robot(
            "<inertial><origin xyz=\"0.5 0 0\"/><mass value=\"2\"/><inertia ixx=\"0.1\" ixy=\"0\" "
            "ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/></inertial>",
            "type=\"continuous\"><axis xyz=\"0 1 0\"/>"),
        "r.urdf");
    arm::OverrideLink(chain, 0, 0.9, gravity_elsewhere);
    RigidChain rigid(chain);
    JointVector q = JointVector::Zero(1), v = JointVector::Zero(1), a(1);
    JointMatrix inverse(1, 1);
    rigid.SetState(q, v);
    rigid.Solve(&a, &inverse);
    EXPECT_NEAR(inverse(0, 0), 1.0 / 0.9, 1e-12);
    // The axis +y turns +x down: the weight at 0.5 m accelerates it positively, unless it is
    // elsewhere.
    EXPECT_NEAR(a[0], gravity_elsewhere ? 0.0 : 2.0 * 9.81 * 0.5 / 0.9, 1e-12);
  }
}

TEST(OverrideLink, RefusesAnInertiaThatTheMassCannotHave) {
  arm::Chain chain =
      ParseUrdf(Robot("<inertial><origin xyz=\"0.5 0 0\"/><mass value=\"2\"/><inertia "
                      "ixx=\"0.1\" ixy=\"0\" ixz=\"0\" iyy=\"0.1\" iyz=\"0\" izz=\"0.1\"/>"
                      "</inertial>",
                      kRevolute),
                "r.urdf");
  EXPECT_THROW(arm::OverrideLink(chain, 0, 0.4, false), std::invalid_argument);
}

TEST(ParseUrdf, LoadsRobotsOfOthers) {
  const std::filesystem::path folder = SINEW_SHARED_DIR "/data";
  SKIP_WITHOUT_DATA(folder);
  struct Case {
    const char* file;
    int joints;
  };
  for (const Case& c : {Case{"kuka_lwr4_inverse_dynamics/kuka_lwr4.urdf", 7},
                        Case{"biped_12dof_urdf/berkeley_humanoid_lite_biped.urdf", 12},
                        Case{"biped_12dof_urdf/hightorque_pai_12dof.urdf", 12}}) {
    const std::string path = (folder / c.file).string();
    const arm::Chain chain = ParseUrdf(config::ReadFile(path), path);
    RigidChain rigid(chain);
    ASSERT_EQ(rigid.joint_count(), c.joints) << path;
    JointVector q = JointVector::Constant(c.joints, 0.1), v = JointVector::Constant(c.joints, 0.2);
    JointVector a(c.joints);
    JointMatrix inverse(c.joints, c.joints);
    rigid.SetState(q, v);
    rigid.Solve(&a, &inverse);
    EXPECT_TRUE(a.allFinite());
    EXPECT_LT((inverse - inverse.transpose()).cwiseAbs().maxCoeff(),
              1e-9 * inverse.cwiseAbs().maxCoeff());
  }
}

}  // namespace
}  // namespace sinew::world
