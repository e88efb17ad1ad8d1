// The same fit with MuJoCo's model of the joint (Todorov, Erez, Tassa: MuJoCo: a physics engine for
// model-based control, IROS 2012) in the plant's place: a hinge with armature, damping and
// frictionloss. Its friction is a soft constraint, the plant's an impulse.
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "components/model/actuator/file/model_file.h"
#include "components/model/shooting/shooting_fit.h"
#include "components/record/recording/file/run_reader.h"
#include "sim/plant/joint_body.h"
#include "tests/components/model/shooting/swing.h"
#include "tests/support/skip.h"

namespace sinew::shooting {
namespace {

double Value(const actuator::JointModel& model, const std::string& effect) {
  const int term = model.Find(effect);
  return term < 0 ? 0.0 : model.terms[static_cast<std::size_t>(term)].linear[0].value;
}

class MujocoJoint final : public free_run::Body {
 public:
  explicit MujocoJoint(const actuator::JointModel& model) : offset_Nm_(Value(model, "offset")) {
    constexpr double kGravity_m_s2 = 9.81;
    const double inertia = Value(model, "inertia"), gravity = Value(model, "gravity");
    if (!(inertia > 0.0)) throw std::invalid_argument("inertia must be positive");
    // Half of the inertia is a point mass that has the gravity, half the armature.
    const double length_m = 0.5 * inertia * kGravity_m_s2 / gravity;
    std::ostringstream xml;
    xml.precision(17);
    xml << "<mujoco><option gravity='0 0 -" << kGravity_m_s2 << "'/><worldbody><body>"
        << "<joint type='hinge' axis='0 -1 0' armature='" << 0.5 * inertia << "' damping='"
        << Value(model, "viscous") << "' frictionloss='" << Value(model, "coulomb") << "'/>"
        << "<inertial pos='" << length_m << " 0 0' mass='" << gravity / (kGravity_m_s2 * length_m)
        << "' diaginertia='1e-9 1e-9 1e-9'/></body></worldbody></mujoco>";
    const std::string text = xml.str();
    mjVFS files;
    mj_defaultVFS(&files);
    mj_makeEmptyFileVFS(&files, "joint.xml", static_cast<int>(text.size()));
    std::memcpy(files.filedata[0], text.data(), text.size());
    char error[300] = "";
    model_.reset(mj_loadXML("joint.xml", &files, error, sizeof error));
    mj_deleteVFS(&files);
    if (!model_) throw std::invalid_argument(error);
    data_.reset(mj_makeData(model_.get()));
  }

  void Start(const effects::JointSample& x, std::span<const double>) override {
    mj_resetData(model_.get(), data_.get());
    data_->qpos[0] = x.position_rad;
    data_->qvel[0] = x.velocity_rad_s;
  }
  void SetSurroundings(const effects::JointSample&) override {}
  void Step(double motor_torque_Nm, double dt_s) override {
    model_->opt.timestep = dt_s;
    data_->qfrc_applied[0] = motor_torque_Nm + offset_Nm_;
    mj_step(model_.get(), data_.get());
  }
  double position_rad() const override { return data_->qpos[0]; }
  double velocity_rad_s() const override { return data_->qvel[0]; }
  double motor_velocity_rad_s() const override { return data_->qvel[0]; }

 private:
  struct Delete {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  std::unique_ptr<mjModel, Delete> model_;
  std::unique_ptr<mjData, Delete> data_;
  double offset_Nm_;
};

// Held-out simulated error of a fit with a body, rad rms, start states fitted.
double HeldOutError(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out,
                    const actuator::JointModel& joint, const free_run::MakeBody& make_body) {
  const identify::ProcessingOptions processing = ProcessingOf(train, joint, 0.25);
  const Recordings trained(train, joint, processing, make_body, {});
  const Recordings tested(held_out, joint, processing, make_body, {});
  return FitStart(tested, FitBySimulation(trained, joint, joint).model).rms;
}

free_run::MakeBody Mujoco() {
  return [](const actuator::JointModel& model) { return std::make_unique<MujocoJoint>(model); };
}

TEST(ShootingWithMujoco, ItsJointMovesAsThePlant) {
  actuator::JointModel smooth = Pendulum();
  smooth.terms.pop_back();  // Coulomb friction
  const std::vector<types::Run> run = {Swing(smooth, {.duration_s = 3.0})};
  const auto angles = [&](const free_run::MakeBody& make_body) {
    const Recordings recordings(run, smooth, ProcessingOf(run, smooth, 0.25), make_body, {});
    return recordings.Stacked(smooth, recordings.Measured());
  };
  // Semi-implicit Euler of first order, 1 ms, beside leapfrog of second order.
  const Eigen::Index rows = 3 * 200 - 1;
  EXPECT_LT((angles(Mujoco()) - angles(plant::JointAlone())).head(rows).cwiseAbs().maxCoeff(),
            0.02);
}

TEST(ShootingWithMujoco, SwingUpsOfTheAk80) {
  const std::filesystem::path folder =
      std::filesystem::path(SINEW_SHARED_DIR) / "data" / "dfki_pendulum_ak80_6";
  SKIP_WITHOUT_DATA(folder);
  const std::filesystem::path robot =
      std::filesystem::path(SINEW_SOURCE_DIR) / "robots" / "dfki_pendulum";
  const actuator::JointModel joint = actuator::LoadRobotModel(robot / "model.yaml").joints.front();
  const auto read = [&](const std::string& file) {
    return recording::ReadRuns(folder / file, robot / "csv_map.yaml", 0);
  };
  const std::vector<types::Run> train = read("ddp_measured.csv");
  // Its soft friction follows the free swings better, with a fit to swing-ups.
  for (const auto& [file, most] :
       {std::pair{"dircol_measured.csv", 1.05}, std::pair{"energy_shaping_measured.csv", 1.4}}) {
    const double ours = HeldOutError(train, read(file), joint, plant::JointAlone());
    const double theirs = HeldOutError(train, read(file), joint, Mujoco());
    std::cout << file << ": held out, rad rms: " << ours << " plant, " << theirs << " MuJoCo\n";
    EXPECT_LT(ours, most * theirs) << file;
  }
}

}  // namespace
}  // namespace sinew::shooting
