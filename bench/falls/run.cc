#include "bench/falls/run.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/bodies/leg/geometry.h"
#include "components/learn/esn/file/esn_config.h"
#include "components/robot/control/robot_controller.h"
#include "components/robot/provider/participant/provider_options.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/robot/reference/file/reference_file.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::falls {

namespace {

constexpr double kPeriod_s = 1.0 / kRate_Hz;

struct Truth {
  double tilt_rad = 0.0, share = 1.0;
  bool fallen() const { return tilt_rad > kFallenTilt_rad || share < kFallenShare; }
};

// The height of the base over flat ground that a posture of the left leg means.
class NominalHeight {
 public:
  NominalHeight(const arm::Chain& chain, const actuator::RobotModel& model) {
    const leg::LegJointNames names = leg::NamesOfSide("left");
    geometry_ = leg::GeometryOf(chain, names, "left_sole");
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto found = std::find_if(model.joints.begin(), model.joints.end(),
                                      [&](const auto& joint) { return joint.name == names[i]; });
      if (found == model.joints.end()) {
        throw std::invalid_argument("joint '" + names[i] + "' of the leg is not in the model");
      }
      joint_[i] = static_cast<std::size_t>(found - model.joints.begin());
    }
  }

  double Of(const types::JointArray<reference::Point>& points) const {
    leg::LegAngles q;
    for (std::size_t i = 0; i < joint_.size(); ++i) {
      q[static_cast<Eigen::Index>(i)] = points[joint_[i]].position_rad;
    }
    const Eigen::Isometry3d sole = leg::Forward(geometry_, q);
    return -sole.linear().col(2).dot(sole.translation());
  }

 private:
  leg::LegGeometry geometry_;
  std::array<std::size_t, leg::kLegJoints> joint_{};
};

class Session {
 public:
  explicit Session(const RunConfig& config)
      : config_(config),
        plant_(world::MakeWorld(config.world, "world")),
        cycle_(MakeCycle(config, plant_->joint_count())),
        reference_(config.reference),
        controller_(config.control.joints),
        nominal_(config.world.config.chain, config.world.config.model) {
    if (config.inverse_dynamics) inverse_.emplace(*config.inverse_dynamics);
    if (plant_->body_truth() == nullptr) {
      throw std::invalid_argument("the world's robot has a fixed base, expected a floating one");
    }
    plant_->Reset(&sensors_);
    cycle_.ArmAtStart();
  }

  RunResult Run() {
    const auto ticks = static_cast<std::uint64_t>(std::llround(config_.duration_s * kRate_Hz));
    double end_s = config_.duration_s;
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      Step(tick);
      const double time_s = static_cast<double>(tick + 1) * kPeriod_s;
      Note(time_s);
      const std::optional<double> over_s = cycle_.falls() ? result_.fault_s : result_.fell_s;
      if (over_s) end_s = std::min(end_s, *over_s + config_.after_s);
      if (time_s >= end_s) break;
    }
    return result_;
  }

 private:
  static provider::ProviderCycle MakeCycle(const RunConfig& config, int joint_count) {
    provider::CycleConfig cycle;
    cycle.guard = config.guard;
    cycle.session_id = provider::SessionFromSeed(config.world.seed);
    cycle.joint_count = joint_count;
    cycle.rate_Hz = kRate_Hz;
    cycle.simulated_time = true;
    return provider::ProviderCycle(cycle);
  }

  void Step(std::uint64_t tick) {
    const types::MessageHeader header = cycle_.Header(tick, 0);
    const bool may_move = types::MayMove(cycle_.state());
    wanted_ = Wanted(tick, may_move);
    provider::JointSetpoints command = Controlled(may_move);
    command.header = header;
    (void)cycle_.Take(command, tick);
    plant_->DisturbBody(config_.schedule.At(tick, kPeriod_s));
    const provider::PlantCommand& passed = cycle_.Command(tick, sensors_);
    if (result_.fault_s) result_.safe = result_.safe && IsSafe(passed);
    plant_->Step(passed, kPeriod_s, &sensors_);
    if (sensors_.fault) throw std::runtime_error(sensors_.message);
    (void)cycle_.Observe(sensors_);
    if (cycle_.falls()) (void)cycle_.ObserveBody(tick, sensors_, *plant_->body_sensors());
  }

  reference::RobotReferenceOutput Wanted(std::uint64_t tick, bool may_move) {
    reference::RobotReferenceInput asked;
    asked.session_id = cycle_.session_id();
    asked.tick = tick;
    asked.period_s = kPeriod_s;
    asked.may_move = may_move;
    asked.joint_count = plant_->joint_count();
    asked.position_rad = sensors_.position_rad;
    asked.valid = sensors_.valid;
    return reference_.Step(asked);
  }

  provider::JointSetpoints Controlled(bool may_move) {
    control::RobotInput input;
    input.session_id = cycle_.session_id();
    input.period_s = kPeriod_s;
    input.armed = may_move;
    input.joint_count = plant_->joint_count();
    input.reference_fresh = true;
    input.reference_late_s = 0.0;
    input.reference_count = wanted_.idle ? 0 : wanted_.joint_count;
    const auto joints = static_cast<std::size_t>(plant_->joint_count());
    for (std::size_t j = 0; j < joints; ++j) {
      input.joint[j] = tune::MeasuredJoint(sensors_, j);
      input.reference[j] = wanted_.joint[j];
    }
    if (inverse_) Predict(&input);
    const control::RobotOutput output = controller_.Step(input);
    provider::JointSetpoints command;
    command.joint_count = output.joint_count;
    for (std::size_t j = 0; j < joints; ++j) {
      command.mode[j] = output.joint[j].mode;
      command.motor_torque_Nm[j] = output.joint[j].motor_torque_Nm;
      command.position_rad[j] = output.joint[j].position_rad;
      command.velocity_rad_s[j] = output.joint[j].velocity_rad_s;
    }
    return command;
  }

  void Predict(control::RobotInput* input) {
    esn::Frame frame;
    for (int j = 0; j < plant_->joint_count(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      const reference::Point& point = wanted_.joint[at];
      frame.Set(esn::Signal::kReferencePosition, j, point.position_rad);
      frame.Set(esn::Signal::kReferenceVelocity, j, point.velocity_rad_s);
      frame.Set(esn::Signal::kReferenceAcceleration, j, point.acceleration_rad_s2);
      frame.Set(esn::Signal::kPosition, j, sensors_.position_rad[at]);
      frame.Set(esn::Signal::kVelocity, j, sensors_.velocity_rad_s[at]);
      frame.Set(esn::Signal::kMotorVelocity, j, sensors_.motor_velocity_rad_s[at]);
      frame.Set(esn::Signal::kChamberPressure, j, sensors_.chamber_pressure_bar[at]);
      frame.Set(esn::Signal::kTemperature, j, sensors_.motor_temperature_degC[at]);
    }
    const esn::Prediction prediction = inverse_->Step(frame, kPeriod_s);
    input->prediction_fresh = true;
    input->prediction_late_s = 0.0;
    for (std::size_t j = 0; j < prediction.valid.size(); ++j) {
      input->prediction[j] = {prediction.valid[j], prediction.sea_torque_Nm[j],
                              prediction.pea_torque_Nm[j], prediction.torque_Nm[j]};
    }
  }

  bool IsSafe(const provider::PlantCommand& command) const {
    if (cycle_.state() != types::RobotState::kFault) return false;
    const auto joints = static_cast<std::size_t>(plant_->joint_count());
    for (std::size_t j = 0; j < joints; ++j) {
      const bool idle = command.mode[j] == types::ControlMode::kIdle;
      const double damping_Nm = -config_.guard.damping_Nm_s_rad * sensors_.motor_velocity_rad_s[j];
      const bool damped = command.mode[j] == types::ControlMode::kTorque &&
                          command.motor_torque_Nm[j] == damping_Nm;
      if (config_.guard.on_fall == provider::FallPolicy::kDamp ? !damped : !idle) return false;
    }
    return true;
  }

  Truth TruthNow() const {
    const provider::BodyTruth& body = *plant_->body_truth();
    const double ground_m = config_.world.floating_base->ground.height_m;
    return {.tilt_rad = types::Tilt(body.orientation_wxyz),
            .share = (body.position_m[2] - ground_m) / nominal_.Of(wanted_.joint)};
  }

  void Note(double time_s) {
    const Truth truth = TruthNow();
    if (result_.upright_s < 0.0 && cycle_.upright()) result_.upright_s = time_s;
    if (!result_.fault_s) {
      result_.largest_tilt_rad = std::max(result_.largest_tilt_rad, truth.tilt_rad);
      result_.least_share = std::min(result_.least_share, truth.share);
      // Once the joints idle the reference follows what is measured: it says nothing any more.
      if (truth.fallen() && !result_.fell_s) result_.fell_s = time_s;
    }
    const provider::BodyTruth& body = *plant_->body_truth();
    if (body.position_m[2] > kLying_m) {
      result_.largest_descent_m_s = std::max(result_.largest_descent_m_s, -body.velocity_m_s[2]);
    }
    if (cycle_.state() == types::RobotState::kFault && !result_.fault_s) {
      result_.fault_s = time_s;
      result_.message = cycle_.fall_message();
      result_.safe = true;
    }
  }

  const RunConfig& config_;
  std::unique_ptr<provider::SimulatedPlant> plant_;
  provider::ProviderCycle cycle_;
  reference::RobotReference reference_;
  control::RobotController controller_;
  std::optional<esn::InverseDynamics> inverse_;
  NominalHeight nominal_;
  provider::PlantSensors sensors_;
  reference::RobotReferenceOutput wanted_;
  RunResult result_;
};

// Ten times the bias that taring in the air leaves of robots/biped's force sensors, and a scale
// that nobody has calibrated.
constexpr world::SensorErrors kUncalibratedFoot{.bandwidth_Hz = 50.0,
                                                .noise_density = 0.056,
                                                .bias = 2.0,
                                                .scale_error = 0.02,
                                                .step = 0.061,
                                                .range = 250.0};

}  // namespace

RunConfig LoadRun(const RunFiles& files) {
  RunConfig config;
  config.world = world::LoadWorldFile(files.world);
  if (config.world.floating_base) {
    config.world.floating_base->imu_errors = world::kMpu6050;
    config.world.floating_base->foot_errors = kUncalibratedFoot;
  }
  config.guard = provider::LoadGuardConfig(config.world.guard);
  config.world.guard.RejectUnknownKeys();
  if (config.guard.fall == nullptr) {
    throw UsageError(files.world.string() + ": key 'guard.fall': missing, nobody looks for falls");
  }
  config.reference = reference::LoadReference(files.reference).config;
  config.control = control::LoadControl(files.control);
  if (config.control.needs_prediction()) {
    config.inverse_dynamics = esn::LoadEsnConfig(files.inverse_dynamics).inverse_dynamics;
  }
  return config;
}

RunConfig Unguarded(RunConfig config) {
  config.guard.fall = nullptr;
  return config;
}

RunResult Run(const RunConfig& config) { return Session(config).Run(); }

}  // namespace sinew::falls
