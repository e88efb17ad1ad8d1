// The standing biped in MuJoCo (Todorov, Erez, Tassa: MuJoCo: a physics engine for model-based
// control, IROS 2012): the same bodies, joints and contact points as FloatingWorld, written as
// MJCF, MuJoCo's own contacts and solver. For measurements only. Allocates.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstring>
#include <iomanip>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bench/floating_world/floating_world.h"

namespace sinew::world {

class MujocoWorld {
 public:
  explicit MujocoWorld(const FloatingWorldConfig& config) : model_(Load(ToMjcf(config))) {
    data_.reset(mj_makeData(model_.get()));
    for (const arm::Body& body : config.chain.bodies) {
      if (!body.moves) continue;
      const int joint = mj_name2id(model_.get(), mjOBJ_JOINT, body.joint_name.c_str());
      positions_.push_back(model_->jnt_qposadr[joint]);
      velocities_.push_back(model_->jnt_dofadr[joint]);
    }
    state_.joint_position_rad = Eigen::VectorXd::Zero(joint_count());
    state_.velocity = Eigen::VectorXd::Zero(6 + joint_count());
  }

  Eigen::Index joint_count() const { return static_cast<Eigen::Index>(positions_.size()); }
  double mass_kg() const { return mj_getTotalmass(model_.get()); }

  // At rest; velocities are not read.
  void Reset(const FloatingState& state) {
    mj_resetData(model_.get(), data_.get());
    const Eigen::Quaterniond& q = state.orientation;
    const std::array<double, 7> base = {state.position_m.x(),
                                        state.position_m.y(),
                                        state.position_m.z(),
                                        q.w(),
                                        q.x(),
                                        q.y(),
                                        q.z()};
    std::copy(base.begin(), base.end(), data_->qpos);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      data_->qpos[positions_[i]] = state.joint_position_rad[static_cast<Eigen::Index>(i)];
    }
    ReadState();
  }

  void Step(const Eigen::VectorXd& torque_Nm) {
    for (std::size_t i = 0; i < velocities_.size(); ++i) {
      data_->qfrc_applied[velocities_[i]] = torque_Nm[static_cast<Eigen::Index>(i)];
    }
    mj_step(model_.get(), data_.get());
    ReadState();
  }

  // Accelerations of the present state, without contacts.
  void Solve() {
    model_->opt.disableflags = mjDSBL_CONTACT;
    mj_forward(model_.get(), data_.get());
  }
  const double* acceleration() const { return data_->qacc; }

  // Joints only: what HoldPosture reads.
  const FloatingState& state() const { return state_; }

  double normal_N() const {
    double sum = 0.0;
    for (int i = 0; i < data_->ncon; ++i) {
      std::array<mjtNum, 6> force{};  // in the contact's axes, the normal first
      mj_contactForce(model_.get(), data_.get(), i, force.data());
      sum += force[0];
    }
    return sum;
  }

 private:
  struct Free {
    void operator()(mjModel* model) const { mj_deleteModel(model); }
    void operator()(mjData* data) const { mj_deleteData(data); }
  };
  using ModelPtr = std::unique_ptr<mjModel, Free>;

  static std::string Text(const Eigen::VectorXd& v) {
    std::ostringstream out;
    out << std::setprecision(17);
    for (Eigen::Index i = 0; i < v.size(); ++i) out << (i > 0 ? " " : "") << v[i];
    return out.str();
  }

  // A body of MuJoCo: a moving link (or the base) and what is fixed to it, in the link's frame.
  struct Rigid {
    double mass_kg = 0.0;
    Eigen::Vector3d moment_kg_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  // about the link's origin
    std::string points, children;                             // MJCF

    // place: of the part's frame in the link's.
    void Add(const Eigen::Isometry3d& place, double part_kg, const Eigen::Vector3d& com_m,
             const Eigen::Matrix3d& inertia) {
      const Eigen::Vector3d c = place * com_m;
      mass_kg += part_kg;
      moment_kg_m += part_kg * c;
      inertia_kg_m2 +=
          place.linear() * inertia * place.linear().transpose() +
          part_kg * (c.squaredNorm() * Eigen::Matrix3d::Identity() - c * c.transpose());
    }

    std::string Mjcf() const {
      const Eigen::Vector3d com_m = moment_kg_m / mass_kg;
      const Eigen::Matrix3d i =
          inertia_kg_m2 -
          mass_kg * (com_m.squaredNorm() * Eigen::Matrix3d::Identity() - com_m * com_m.transpose());
      Eigen::VectorXd six(6);
      six << i(0, 0), i(1, 1), i(2, 2), i(0, 1), i(0, 2), i(1, 2);
      return "<inertial pos='" + Text(com_m) + "' mass='" +
             Text(Eigen::VectorXd::Constant(1, mass_kg)) + "' fullinertia='" + Text(six) + "'/>\n" +
             points + children;
    }
  };

  // Points are spheres of a radius that is small beside the robot; they touch the ground only.
  static void AddCarried(const FloatingWorldConfig& config, int link,
                         const Eigen::Isometry3d& place, Rigid* rigid) {
    constexpr double kRadius_m = 1e-3;
    for (const ContactPoint& contact : config.contacts) {
      if (contact.body != link) continue;
      rigid->points += "<geom type='sphere' size='" +
                       Text(Eigen::VectorXd::Constant(1, kRadius_m)) + "' pos='" +
                       Text(place * contact.point_m) + "' contype='1' conaffinity='0'/>\n";
    }
    for (std::size_t i = 0; i < config.chain.bodies.size(); ++i) {
      const arm::Body& body = config.chain.bodies[i];
      if (body.parent != link) continue;
      const Eigen::Isometry3d child = place * body.parent_from_joint;
      if (!body.moves) {
        rigid->Add(child, body.mass_kg, body.com_m, body.inertia_kg_m2);
        AddCarried(config, static_cast<int>(i), child, rigid);
        continue;
      }
      Rigid moved;
      moved.Add(Eigen::Isometry3d::Identity(), body.mass_kg, body.com_m, body.inertia_kg_m2);
      AddCarried(config, static_cast<int>(i), Eigen::Isometry3d::Identity(), &moved);
      const Eigen::Quaterniond q(child.linear());
      rigid->children += "<body pos='" + Text(child.translation()) + "' quat='" +
                         Text(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())) + "'><joint name='" +
                         body.joint_name + "' type='" + (body.prismatic ? "slide" : "hinge") +
                         "' axis='" + Text(body.axis) + "'/>\n" + moved.Mjcf() + "</body>\n";
    }
  }

  static std::string ToMjcf(const FloatingWorldConfig& config) {
    const arm::Base& link = config.chain.base;
    Rigid base;
    base.Add(Eigen::Isometry3d::Identity(), link.mass_kg, link.com_m, link.inertia_kg_m2);
    AddCarried(config, kBaseBody, Eigen::Isometry3d::Identity(), &base);
    return "<mujoco><compiler angle='radian' boundmass='0' boundinertia='0'/>\n"
           "<option timestep='" +
           Text(Eigen::VectorXd::Constant(1, config.substep_s)) + "' gravity='" +
           Text(config.gravity_m_s2) +
           "'/>\n"
           "<worldbody><geom type='plane' size='10 10 1' contype='0' conaffinity='1'/>\n"
           "<body><freejoint/>\n" +
           base.Mjcf() + "</body></worldbody></mujoco>\n";
  }

  static ModelPtr Load(const std::string& mjcf) {
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    constexpr const char* kName = "biped.xml";
    mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(mjcf.size()));
    const int index = mj_findFileVFS(files.get(), kName);
    std::memcpy(files->filedata[index], mjcf.data(), mjcf.size());
    std::array<char, 512> error{};
    ModelPtr model(mj_loadXML(kName, files.get(), error.data(), static_cast<int>(error.size())));
    mj_deleteVFS(files.get());
    if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
    return model;
  }

  void ReadState() {
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const auto joint = static_cast<Eigen::Index>(i);
      state_.joint_position_rad[joint] = data_->qpos[positions_[i]];
      state_.velocity[6 + joint] = data_->qvel[velocities_[i]];
    }
  }

  ModelPtr model_;
  std::unique_ptr<mjData, Free> data_;
  std::vector<int> positions_, velocities_;  // of the chain's joints in qpos and qvel
  FloatingState state_;
};

}  // namespace sinew::world
