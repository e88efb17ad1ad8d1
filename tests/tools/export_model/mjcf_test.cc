// MuJoCo reads what is written, and has the values of the model file. Oracle: the balance of the
// model in closed form; mass and its centre from the bodies of the URDF one by one.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "components/model/payloads/payloads.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/export_model/exported.h"

namespace sinew::export_model {
namespace {

// MuJoCo's own numerics: quaternions are normalised, inertias diagonalised.
constexpr double kMujocoRounding = 1e-9;

class Mujoco {
 public:
  explicit Mujoco(const std::string& xml) {
    const std::string path = folder_.Write("robot.xml", xml);
    char error[1000] = "";
    model_.reset(mj_loadXML(path.c_str(), nullptr, error, sizeof error));
    EXPECT_NE(model_, nullptr) << error << "\n" << xml;
    if (model_ != nullptr) data_.reset(mj_makeData(model_.get()));
  }
  explicit operator bool() const { return model_ != nullptr; }
  const mjModel& model() const { return *model_; }
  mjData& data() { return *data_; }
  void Forward() { mj_forward(model_.get(), data_.get()); }
  int Id(mjtObj kind, const std::string& name) const {
    const int id = mj_name2id(model_.get(), kind, name.c_str());
    EXPECT_GE(id, 0) << name;
    return id;
  }
  int Dof(const std::string& joint) const { return model_->jnt_dofadr[Id(mjOBJ_JOINT, joint)]; }
  std::vector<double> MassMatrix() {
    std::vector<double> full(static_cast<std::size_t>(model_->nv) *
                             static_cast<std::size_t>(model_->nv));
    mj_fullM(model_.get(), full.data(), data_->qM);
    return full;
  }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  testing::TemporaryFolder folder_;
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
};

TEST(Mjcf, OfTheRigHasTheValuesOfTheModelFile) {
  const actuator::RobotModel rig = RigRobot();
  Mujoco mujoco(WriteMjcf(Described(rig), {"a remark -- with dashes"}));
  ASSERT_TRUE(mujoco);
  const mjModel& model = mujoco.model();
  const int dof = mujoco.Dof("joint");
  EXPECT_EQ(model.nv, 1);
  EXPECT_EQ(model.dof_armature[dof], rig.joints[0].Parameter("rotor_inertia", "rotor_inertia"));
  EXPECT_EQ(model.dof_damping[dof], rig.joints[0].Parameter("motor_viscous", "viscous"));
  EXPECT_EQ(model.dof_frictionloss[dof], rig.joints[0].Parameter("coulomb", "coulomb"));
  const int actuator = mujoco.Id(mjOBJ_ACTUATOR, "joint");
  EXPECT_DOUBLE_EQ(model.actuator_gear[6 * actuator],
                   100.0 * rig.joints[0].Parameter("drive_current", "efficiency"));
  EXPECT_EQ(model.actuator_ctrlrange[2 * actuator + 1], rig.joints[0].motor_torque_limit_Nm);
  EXPECT_EQ(model.jnt_range[0], -2.2);
  EXPECT_EQ(model.jnt_range[1], 2.2);
}

// One joint: M q'' + bias = gear u - friction, all known in closed form.
void ExpectBalance(const actuator::RobotModel& robot, double inertia, double weight_Nm) {
  Mujoco mujoco(WriteMjcf(Described(robot), {}));
  ASSERT_TRUE(mujoco);
  for (const double q : {-1.3, 0.0, 0.4, 1.9}) {
    mujoco.data().qpos[0] = q;
    mujoco.data().qvel[0] = 0.0;
    mujoco.Forward();
    EXPECT_NEAR(mujoco.MassMatrix()[0], inertia, kMujocoRounding * inertia);
    // qfrc_bias is on the left of the equation: gravity pulls by -Tg cos q.
    EXPECT_NEAR(mujoco.data().qfrc_bias[0], weight_Nm * std::cos(q), kMujocoRounding * weight_Nm);
  }
}

TEST(Mjcf, OfTheRigMovesByTheModelsBalance) {
  const actuator::RobotModel rig = RigRobot();
  const actuator::JointModel& joint = rig.joints[0];
  ExpectBalance(rig,
                joint.Parameter("rotor_inertia", "rotor_inertia") +
                    joint.Parameter("link_inertia", "link_inertia"),
                joint.Parameter("gravity", "gravity_torque"));
}

TEST(Mjcf, APayloadThatCloseLoopFoundIsInertiaOfTheBody) {
  actuator::RobotModel rig = RigRobot();
  actuator::JointModel& joint = rig.joints[0];
  const double inertia = joint.Parameter("rotor_inertia", "rotor_inertia") +
                         joint.Parameter("link_inertia", "link_inertia");
  const double weight_Nm = joint.Parameter("gravity", "gravity_torque");
  joint.terms.push_back(actuator::MakeTerm("payload", joint.constants));
  joint.terms.back().linear[0].value = 0.5 * actuator::DriveShare(joint, effects::Balance::kMotion);
  const double payload_kg =
      actuator::PhysicalValue(joint, static_cast<int>(joint.terms.size()) - 1, 0);
  const double length_m = joint.constants.link_length_m;
  ExpectBalance(rig, inertia + payload_kg * length_m * length_m,
                weight_Nm + payload_kg * 9.81 * length_m);
}

TEST(Mjcf, AJointThatMimicsAnotherIsAnEquality) {
  const actuator::RobotModel rig = RigOfBodies();
  Mujoco mujoco(WriteMjcf(Describe(rig, RigWithFinger(rig)), {}));
  ASSERT_TRUE(mujoco);
  const mjModel& model = mujoco.model();
  ASSERT_EQ(model.neq, 1);
  EXPECT_EQ(model.eq_type[0], mjEQ_JOINT);
  EXPECT_EQ(model.eq_obj1id[0], mujoco.Id(mjOBJ_JOINT, "bend"));
  EXPECT_EQ(model.eq_obj2id[0], mujoco.Id(mjOBJ_JOINT, "joint"));
  EXPECT_EQ(model.eq_data[0], 0.25);
  EXPECT_EQ(model.eq_data[1], -0.5);
}

TEST(Mjcf, AServoOfTheModelFileIsAnActuatorWithItsGains) {
  actuator::RobotModel rig = RigRobot();
  rig.joints[0].controller = actuator::Servo{
      .gain_per_rad = 40.0, .velocity_gain_s_rad = 2.0, .limit = 10.0, .share_of_supply = false};
  Mujoco mujoco(WriteMjcf(Described(rig), {}));
  ASSERT_TRUE(mujoco);
  mujoco.data().qpos[0] = 0.1;
  mujoco.data().qvel[0] = 0.3;
  mujoco.data().ctrl[0] = 0.2;
  mujoco.Forward();
  const double torque_Nm_A = 100.0 * 0.0159155 * 0.77;
  EXPECT_NEAR(mujoco.data().actuator_force[0], torque_Nm_A * (40.0 * 0.1 - 2.0 * 0.3), 1e-9);
  mujoco.data().ctrl[0] = 2.0;
  mujoco.Forward();
  EXPECT_NEAR(mujoco.data().actuator_force[0], torque_Nm_A * 10.0, 1e-9) << "the limit";
}

TEST(Mjcf, OfTheBipedHasItsJointsItsMassAndThePayload) {
  const actuator::RobotModel biped = LoadedBiped();
  Mujoco mujoco(WriteMjcf(Described(biped), {}));
  ASSERT_TRUE(mujoco);
  const mjModel& model = mujoco.model();
  for (const actuator::JointModel& joint : biped.joints) {
    const int dof = mujoco.Dof(joint.name);
    EXPECT_EQ(model.dof_armature[dof], joint.Parameter("rotor_inertia", "rotor_inertia"));
    EXPECT_EQ(model.dof_damping[dof], joint.Parameter("motor_viscous", "viscous"));
    EXPECT_EQ(model.dof_frictionloss[dof], joint.Parameter("coulomb", "coulomb"));
    EXPECT_DOUBLE_EQ(
        model.actuator_gear[6 * mujoco.Id(mjOBJ_ACTUATOR, joint.name)],
        joint.constants.gear_ratio * actuator::DriveShare(joint, effects::Balance::kMotion));
  }
  mujoco.Id(mjOBJ_SITE, "imu");
  mujoco.Id(mjOBJ_SITE, biped.floating_base->force_links[0]);

  // Mass and its centre with all joints at 0, from the bodies of the URDF one by one.
  const arm::Chain chain = arm::WithPayloads(UrdfChain(biped), biped.payloads);
  double mass = chain.base.mass_kg;
  Eigen::Vector3d moment = chain.base.mass_kg * chain.base.com_m;
  std::vector<Eigen::Isometry3d> frames;
  for (const arm::Body& body : chain.bodies) {
    const Eigen::Isometry3d parent = body.parent < 0
                                         ? Eigen::Isometry3d::Identity()
                                         : frames[static_cast<std::size_t>(body.parent)];
    frames.push_back(parent * body.parent_from_joint);
    mass += body.mass_kg;
    moment += body.mass_kg * (frames.back() * body.com_m);
  }
  mujoco.Forward();
  EXPECT_NEAR(mj_getTotalmass(&model), mass, kMujocoRounding * mass);
  const int base = mujoco.Id(mjOBJ_BODY, chain.base.link_name);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(mujoco.data().subtree_com[3 * base + axis], moment[axis] / mass, kMujocoRounding);
  }
}

}  // namespace
}  // namespace sinew::export_model
