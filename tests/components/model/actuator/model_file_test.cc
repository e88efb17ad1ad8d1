#include "components/model/actuator/file/model_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/skip.h"

namespace sinew::actuator {
namespace {

using ::testing::HasSubstr;

class ModelFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("sinew_model_file_" + std::to_string(::getpid()) + "_" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path Write(const std::string& text, const std::string& name = "model.yaml") {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  std::string ErrorOf(const std::string& text, const std::string& name = "model.yaml") {
    try {
      LoadRobotModel(Write(text, name));
    } catch (const UsageError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      EXPECT_THAT(what, HasSubstr(name));
      return what;
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

std::string Joint(const std::string& terms, const std::string& more = "") {
  return "schema: sinew-model/1\nname: r\njoints:\n  - name: j\n    kind: rotary\n    terms:\n" +
         terms + more;
}

std::string RigPath() { return SINEW_SOURCE_DIR "/robots/rig/model.yaml"; }

TEST_F(ModelFileTest, ReadsTheRig) {
  const RobotModel robot = LoadRobotModel(RigPath());
  ASSERT_EQ(robot.joints.size(), 1u);
  const JointModel& joint = robot.joints[0];
  EXPECT_EQ(joint.kind, types::JointKind::kRevolute);
  EXPECT_EQ(joint.constants.gear_ratio, 100.0);
  EXPECT_EQ(joint.Parameter("drive_current", "efficiency"), 0.77);
  EXPECT_EQ(joint.Parameter("pneumatic_stiffness", "rest_angle"), 0.16);
  EXPECT_EQ(joint.terms[0].linear[0].tolerance, 0.15);
  EXPECT_TRUE(joint.terms[static_cast<std::size_t>(joint.Find("load_force"))].linear[0].fixed);
  EXPECT_TRUE(std::filesystem::exists(robot.urdf_path));
}

TEST_F(ModelFileTest, ReadsTheLinearAxis) {
  const RobotModel robot = LoadRobotModel(SINEW_SOURCE_DIR "/robots/emps/model.yaml");
  const JointModel& joint = robot.joints.at(0);
  EXPECT_EQ(joint.kind, types::JointKind::kPrismatic);
  EXPECT_EQ(joint.Parameter("drive_voltage", "gain"), 35.1506518825);
  EXPECT_TRUE(joint.terms[0].linear[0].fixed);
}

// A force and a payload on a linear joint count as they are: there is no lever to state.
TEST_F(ModelFileTest, ALinearJointHasTheLeverOne) {
  const auto text = [](const std::string& constants) {
    return "schema: sinew-model/1\nname: r\njoints:\n  - name: j\n    kind: linear\n    constants: "
           "{" +
           constants +
           "}\n    terms:\n      - {effect: drive_torque, gain: 1}\n"
           "      - {effect: load_force, share: {value: 1, fixed: true}}\n"
           "      - {effect: declared_payload, share: {value: 1, fixed: true}}\n";
  };
  for (const char* constants : {"gear_ratio: 1", "link_length_m: 1", "link_length_m: 0"}) {
    const RobotModel robot = LoadRobotModel(Write(text(constants)));
    const JointModel& joint = robot.joints.at(0);
    effects::JointSample x;
    x.position_rad = 0.7;
    x.acceleration_rad_s2 = 3.0;
    x.load_force_N = 11.0;
    x.payload_kg = 2.0;
    EXPECT_DOUBLE_EQ(joint.TermTorque(joint.Find("load_force"), x, {}), -11.0) << constants;
    EXPECT_DOUBLE_EQ(joint.TermTorque(joint.Find("declared_payload"), x, {}), -6.0) << constants;
    const std::string written = FormatModel(robot, {}, folder_);
    EXPECT_EQ(written.find("link_length_m"), std::string::npos) << written;
    SaveRobotModel(folder_ / "out.yaml", robot);
    EXPECT_EQ(FormatModel(LoadRobotModel(folder_ / "out.yaml"), {}, folder_), written);
  }
  EXPECT_THAT(ErrorOf(text("link_length_m: 0.3")), HasSubstr("no lever"));
}

TEST_F(ModelFileTest, SavesAndReadsBackTheSame) {
  ModelFile file = LoadModelFile(RigPath());
  JointModel& joint = file.robot.joints[0];
  Term term = MakeTerm("stribeck", joint.constants);
  term.declared = false;
  term.linear[0] = {
      .value = 0.1 + 1e-17, .tolerance = 0.0, .fixed = false, .half_width_95 = 1.0 / 3.0};
  term.nonlinear[0].value = 0.1 / 3.0;
  term.nonlinear[0].fixed = true;
  joint.terms.push_back(term);
  joint.history.push_back({"2026-01-01T00:00:00Z", "stribeck", "a \"b\".csv", "gain: 12 %, #1"});
  const std::filesystem::path path = folder_ / "deeper" / "model.yaml";
  std::filesystem::create_directories(path.parent_path());
  SaveModelFile(path, file);
  const ModelFile again = LoadModelFile(path);
  const JointModel& read = again.robot.joints.at(0);
  EXPECT_EQ(again.robot.name, file.robot.name);
  EXPECT_EQ(again.robot.urdf_path, file.robot.urdf_path);
  ASSERT_EQ(read.terms.size(), joint.terms.size());
  for (std::size_t i = 0; i < joint.terms.size(); ++i) {
    EXPECT_EQ(read.terms[i].effect->info().name, joint.terms[i].effect->info().name);
    EXPECT_EQ(read.terms[i].declared, joint.terms[i].declared);
    const auto same = [](const ParameterValue& a, const ParameterValue& b) {
      return a.value == b.value && a.tolerance == b.tolerance &&
             a.tolerance_absolute == b.tolerance_absolute && a.fixed == b.fixed &&
             a.half_width_95 == b.half_width_95;
    };
    for (std::size_t k = 0; k < joint.terms[i].linear.size(); ++k) {
      EXPECT_TRUE(same(read.terms[i].linear[k], joint.terms[i].linear[k]));
    }
    for (std::size_t k = 0; k < joint.terms[i].nonlinear.size(); ++k) {
      EXPECT_TRUE(same(read.terms[i].nonlinear[k], joint.terms[i].nonlinear[k]));
    }
  }
  ASSERT_EQ(read.history.size(), 1u);
  EXPECT_EQ(read.history[0].recording, joint.history[0].recording);
  EXPECT_EQ(read.history[0].note, joint.history[0].note);
  EXPECT_EQ(read.backlash_rad, joint.backlash_rad);
  EXPECT_EQ(read.motor_torque_limit_Nm, joint.motor_torque_limit_Nm);
  EXPECT_EQ(read.constants.torque_constant_Nm_A, joint.constants.torque_constant_Nm_A);
  // Written a second time it is the same text.
  EXPECT_EQ(FormatModel(again.robot, again.foreign_text, path.parent_path()),
            config::ReadFile(path));
}

TEST_F(ModelFileTest, AToleranceIsRelativeOrAbsolute) {
  const auto path = Write(
      Joint("      - {effect: viscous, viscous_Nm_s_rad: {value: 0, tolerance: {absolute: 0.05}}}\n"
            "      - {effect: coulomb, coulomb_Nm: {value: -2, tolerance: 0.1}}\n"
            "      - {effect: offset, offset_Nm: 1}\n"));
  const RobotModel robot = LoadRobotModel(path);
  const auto& terms = robot.joints[0].terms;
  EXPECT_EQ(terms[0].linear[0].tolerance_absolute, 0.05);
  EXPECT_EQ(terms[0].linear[0].tolerance, 0.0);
  EXPECT_EQ(PriorSpread(terms[0].linear[0]), 0.05);
  EXPECT_EQ(PriorSpread(terms[1].linear[0]), 0.2);
  EXPECT_EQ(PriorSpread(terms[2].linear[0]), 0.0);  // flat
  const std::string text = FormatModel(robot, {}, folder_);
  EXPECT_THAT(text, HasSubstr("viscous_Nm_s_rad: {value: 0, tolerance: {absolute: 0.05}}"));
  EXPECT_THAT(text, HasSubstr("coulomb_Nm: {value: -2, tolerance: 0.1}"));
  SaveRobotModel(folder_ / "out.yaml", robot);
  EXPECT_EQ(FormatModel(LoadRobotModel(folder_ / "out.yaml"), {}, folder_), text);
  const auto error = [&](const std::string& tolerance) {
    return ErrorOf(
        Joint("      - {effect: offset, offset_Nm: {value: 1, tolerance: " + tolerance + "}}\n"));
  };
  EXPECT_THAT(error("{absolute: 0}"), HasSubstr("offset_Nm.tolerance.absolute"));
  EXPECT_THAT(error("{absolut: 1}"), HasSubstr("absolute"));
  EXPECT_THAT(error("{absolute: 1, relative: 1}"), HasSubstr("relative"));
  EXPECT_THAT(error("-0.1"), HasSubstr("offset_Nm.tolerance"));
}

TEST_F(ModelFileTest, ASpringsPreloadAndAnOffsetAreNotBothFree) {
  const auto with = [](const std::string& preload, const std::string& offset) {
    return Joint("      - {effect: spring, stiffness_Nm_rad: 2, preload_Nm: " + preload +
                 "}\n      - {effect: offset, offset_Nm: " + offset + "}\n");
  };
  EXPECT_THAT(ErrorOf(with("0.1", "0")), HasSubstr("same torque"));
  EXPECT_EQ(ErrorOf(with("{value: 0, fixed: true}", "0")), "no error");
  EXPECT_EQ(ErrorOf(with("0.1", "{value: 0, fixed: true}")), "no error");
}

TEST_F(ModelFileTest, KeepsTheBlocksOfOthers) {
  const auto path =
      Write(Joint("      - {effect: coulomb, coulomb_Nm: 0.2}\n") +
            "processing:\n  cut_off_Hz: 10\n  list: [1, 2]\ndata_gate: {a: {b: 1}}\n");
  ModelFile file = LoadModelFile(path);
  EXPECT_EQ(file.root.Child("processing").Number("cut_off_Hz"), 10.0);
  SaveModelFile(folder_ / "out.yaml", file);
  const ModelFile again = LoadModelFile(folder_ / "out.yaml");
  EXPECT_EQ(again.root.Child("processing").Numbers("list"), (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(again.root.Child("data_gate").Child("a").Number("b"), 1.0);
  EXPECT_FALSE(again.root.Has("as_published"));
}

TEST_F(ModelFileTest, KeepsTheServoAndTheBackEmf) {
  const std::string text =
      "schema: sinew-model/1\nname: r\njoints:\n  - name: j\n    kind: rotary\n"
      "    constants: {force_constant_N_V: 0.07, back_emf_V_s_rad: 0.32}\n"
      "    controller: {law: proportional, command: share_of_supply, limit: 1}\n"
      "    terms:\n      - {effect: coulomb, coulomb_Nm: 0.2}\n";
  SaveRobotModel(folder_ / "out.yaml", LoadRobotModel(Write(text)));
  const JointModel joint = LoadRobotModel(folder_ / "out.yaml").joints[0];
  EXPECT_EQ(joint.constants.back_emf_V_s_rad, 0.32);
  ASSERT_TRUE(joint.controller.has_value());
  EXPECT_TRUE(joint.controller->share_of_supply);
  EXPECT_EQ(joint.controller->limit, 1.0);
  EXPECT_EQ(joint.controller->gain_per_rad, 0.0);
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1}\n",
                            "    controller: {law: fuzzy}\n")),
              HasSubstr("proportional"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1}\n",
                            "    controller: {law: proportional, gain_per_m: 3}\n")),
              HasSubstr("gain_per_m"));
}

TEST_F(ModelFileTest, ReportsAnErrorInOneLine) {
  EXPECT_THAT(ErrorOf(Joint("      - {effect: strybeck}\n")),
              ::testing::AllOf(HasSubstr("model.yaml:7"), HasSubstr("strybeck"),
                               HasSubstr("coulomb, offset, gravity")));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: viscous, viscous_Nm: 1}\n")),
              ::testing::AllOf(HasSubstr(":7"), HasSubstr("viscous_Nm'"),
                               HasSubstr("expected 'viscous_Nm_s_rad'")));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: viscous, viscous_N_s_m: 1}\n")),
              HasSubstr("expected 'viscous_Nm_s_rad'"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: viscous}\n")),
              ::testing::AllOf(HasSubstr("viscous_Nm_s_rad"), HasSubstr("missing")));
  EXPECT_THAT(
      ErrorOf(Joint("      - {effect: stribeck, stribeck_velocity_rad_s: 0.1}\n")),
      ::testing::AllOf(HasSubstr("'joints[0].terms[0].stribeck_Nm'"), HasSubstr("missing")));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: .nan}\n")),
              ::testing::AllOf(HasSubstr("coulomb_Nm"), HasSubstr("finite")));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: {value: 1, tolerence: 0.1}}\n")),
              HasSubstr("tolerence"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1, colour: red}\n")),
              HasSubstr("colour"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1}\n"
                            "      - {effect: coulomb, coulomb_Nm: 2}\n")),
              HasSubstr("twice"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1}\n", "urdf: none.urdf\n")),
              HasSubstr("none.urdf"));
  EXPECT_THAT(ErrorOf(Joint("      - {effect: coulomb, coulomb_Nm: 1}\n", "speed: 3\n")),
              HasSubstr("speed"));
  EXPECT_THAT(ErrorOf(Joint("      []\n")), HasSubstr("terms"));
  EXPECT_THAT(ErrorOf("schema: sinew-model/2\n"), HasSubstr("sinew-model/1"));
  EXPECT_THAT(ErrorOf("schema: sinew-model/1\nname: r\njoints: []\n"), HasSubstr("joints"));
  EXPECT_THROW(LoadRobotModel(folder_ / "absent.yaml"), UsageError);
}

TEST_F(ModelFileTest, LeavesNothingHalfWritten) {
  const ModelFile file = LoadModelFile(RigPath());
  EXPECT_THROW(SaveModelFile(folder_ / "no_such_folder" / "model.yaml", file), UsageError);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
}

TEST_F(ModelFileTest, ReadsALaboratorysRigJson) {
  const std::filesystem::path path = SINEW_SHARED_DIR "/data/rig_examples/clean/rig.json";
  SKIP_WITHOUT_DATA(path);
  const RobotModel robot = LoadRobotModel(path);
  const JointModel& joint = robot.joints.at(0);
  EXPECT_EQ(joint.Parameter("drive_current", "efficiency"), 0.704938);
  EXPECT_EQ(joint.terms[0].linear[0].tolerance, 0.10);  // "about 5-15 % off"
  EXPECT_EQ(joint.Parameter("rotor_inertia", "rotor_inertia"), 0.115034);
  EXPECT_EQ(joint.Parameter("pneumatic_stiffness", "rest_angle"), 0.158334);
  EXPECT_EQ(joint.constants.torque_constant_Nm_A, 0.0159155);
  EXPECT_EQ(joint.backlash_rad, 0.0464258);
  EXPECT_NEAR(joint.motor_torque_limit_Nm, 0.3979, 1e-4);
  EXPECT_EQ(joint.constants.encoder_counts_per_turn, 16384.0);
  EXPECT_TRUE(joint.Declares(effects::Balance::kKinematic));
  EXPECT_EQ(joint.Parameter("free_play", "width"), joint.backlash_rad);
  // It becomes a model file like any other.
  SaveRobotModel(folder_ / "model.yaml", robot);
  EXPECT_EQ(LoadRobotModel(folder_ / "model.yaml").joints[0].terms.size(), joint.terms.size());
}

TEST_F(ModelFileTest, ReportsAnErrorInARigJson) {
  EXPECT_THAT(ErrorOf("{\n\"constants\": {\n", "rig.json"), HasSubstr("no valid JSON"));
  EXPECT_THAT(ErrorOf("{}", "rig.json"), HasSubstr("'constants.gear_ratio': missing"));
  EXPECT_THAT(ErrorOf("[]", "rig.json"), HasSubstr("missing"));
  EXPECT_THAT(ErrorOf(R"({"constants": {"gear_ratio": {"value": "x"}}})", "rig.json"),
              HasSubstr("expected a number"));
  EXPECT_THAT(ErrorOf(R"({"constants": {"gear_ratio": {"value": 100, "unit": "1"},
                          "link_length": {"value": 300, "unit": "mm"}}})",
                      "rig.json"),
              HasSubstr("'mm', expected 'm'"));
}

constexpr const char* kBareTerms = "      - effect: coulomb\n        coulomb_Nm: 0.2\n";

TEST_F(ModelFileTest, PayloadsAndTheFloatingBaseSurviveSaving) {
  const RobotModel read = LoadRobotModel(
      Write(Joint(kBareTerms,
                  "payloads:\n  - {link: torso, mass_kg: 4, position_m: [0.03, -0.02, 0.07]}\n"
                  "  - link: left_foot\n    declared: false\n"
                  "    mass_kg: {value: 0.5, half_width_95: 0.1}\n    position_m: [0, 0, 0.1]\n"
                  "    position_half_width_95_m: [0.01, 0.02, 0.3]\n"
                  "floating_base: {foot_force: [a, b, c, d, e, f, g, h], imu: i, "
                  "mass_tolerance: 0.02, com_tolerance_m: 0.003, tilt_tolerance_rad: 0.004}\n")));
  SaveRobotModel(folder_ / "saved.yaml", read);
  for (const RobotModel& robot : {read, LoadRobotModel(folder_ / "saved.yaml")}) {
    ASSERT_EQ(robot.payloads.size(), 2u);
    EXPECT_EQ(robot.payloads[0].link, "torso");
    EXPECT_EQ(robot.payloads[0].mass_kg, 4.0);
    EXPECT_EQ(robot.payloads[0].position_m, (std::array<double, 3>{0.03, -0.02, 0.07}));
    EXPECT_TRUE(robot.payloads[0].declared);
    EXPECT_FALSE(robot.payloads[0].half_width_95.has_value());
    EXPECT_FALSE(robot.payloads[1].declared);
    EXPECT_EQ(robot.payloads[1].half_width_95, 0.1);
    EXPECT_EQ(robot.payloads[1].position_half_width_95, (std::array<double, 3>{0.01, 0.02, 0.3}));
    ASSERT_TRUE(robot.floating_base.has_value());
    EXPECT_EQ(robot.floating_base->force_links[7], "h");
    EXPECT_EQ(robot.floating_base->imu_link, "i");
    EXPECT_EQ(robot.floating_base->mass_tolerance, 0.02);
    EXPECT_EQ(robot.floating_base->com_tolerance_m, 0.003);
    EXPECT_EQ(robot.floating_base->tilt_tolerance_rad, 0.004);
  }
}

TEST_F(ModelFileTest, RefusesPayloadsAndFloatingBasesThatCannotBe) {
  const auto error = [&](const std::string& more) { return ErrorOf(Joint(kBareTerms, more)); };
  EXPECT_THAT(error("payloads: [{link: torso, mass_kg: 0, position_m: [0, 0, 0]}]\n"),
              HasSubstr("mass_kg"));
  EXPECT_THAT(error("payloads: [{link: torso, mass_kg: 1, position_m: [0, 0]}]\n"),
              HasSubstr("position_m"));
  EXPECT_THAT(error("payloads: [{link: torso, mass_kg: 1, position_mm: [0, 0, 0]}]\n"),
              HasSubstr("position_m"));
  EXPECT_THAT(error("payloads: [{mass_kg: 1, position_m: [0, 0, 0]}]\n"), HasSubstr("link"));
  EXPECT_THAT(error("floating_base: {foot_force: [a, b], imu: i}\n"), HasSubstr("2 links"));
  EXPECT_THAT(error("floating_base: {foot_force: [a, b, c, d, e, f, g, h]}\n"), HasSubstr("imu"));
}

}  // namespace
}  // namespace sinew::actuator
