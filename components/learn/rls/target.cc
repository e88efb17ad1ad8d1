#include "components/learn/rls/target.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/state_archive.h"

namespace sinew::rls {
namespace {

constexpr std::array<esn::Signal, 3> kReference = {esn::Signal::kReferencePosition,
                                                   esn::Signal::kReferenceVelocity,
                                                   esn::Signal::kReferenceAcceleration};

int FeatureOf(const esn::Weights& weights, esn::Input input, const char* name) {
  const auto found = std::find(weights.inputs.begin(), weights.inputs.end(), input);
  if (found == weights.inputs.end()) {
    throw std::invalid_argument(std::string(name) + ": no input " +
                                std::string(esn::SignalName(input.signal)) + " of joint " +
                                std::to_string(input.joint) +
                                ", which carry_over needs; add it, or switch carry_over off");
  }
  return 1 + static_cast<int>(found - weights.inputs.begin());
}

}  // namespace

TargetEquation::TargetEquation(const TargetConfig& config, const actuator::RobotModel& robot,
                               const std::optional<esn::Weights>& sea,
                               const std::optional<esn::Weights>& pea)
    : config_(config), half_(config.carry_over ? config.half_window_ticks : 0) {
  if (config.carry_over && (config.half_window_ticks < 1 || config.half_window_ticks > 100)) {
    throw std::invalid_argument("half_window_ticks: " + std::to_string(config.half_window_ticks) +
                                ", expected 1 .. 100");
  }
  int most_features = 0;
  int most_outputs = 0;
  const std::optional<esn::Weights>* const both[] = {&sea, &pea};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!*both[i]) continue;
    const esn::Weights& weights = **both[i];
    const char* name = i == 0 ? "sea" : "pea";
    Network network;
    network.outputs = weights.output_count();
    network.features = weights.feature_count();
    network.input_limit = weights.hyper.input_limit;
    network.normalisation = weights.input;
    if (static_cast<std::size_t>(network.outputs) > robot.joints.size()) {
      throw std::invalid_argument(std::string(name) + ": " + std::to_string(network.outputs) +
                                  " outputs, expected at most the model's " +
                                  std::to_string(robot.joints.size()) + " joints");
    }
    if (config.carry_over) {
      for (int joint = 0; joint < network.outputs; ++joint) {
        network.reference.push_back({FeatureOf(weights, {kReference[0], joint}, name),
                                     FeatureOf(weights, {kReference[1], joint}, name),
                                     FeatureOf(weights, {kReference[2], joint}, name)});
      }
    }
    most_features = std::max(most_features, network.features);
    most_outputs = std::max(most_outputs, network.outputs);
    networks_[i] = std::move(network);
  }
  if (most_features == 0)
    throw std::invalid_argument("weights: none, expected a SEA or a PEA network");
  for (const actuator::JointModel& joint : robot.joints)
    gear_ratio_.push_back(joint.constants.gear_ratio);
  if (config.carry_over) {
    const esn::InverseDynamicsConfig inverse{
        .robot = robot, .smoothing_rad_s = config.smoothing_rad_s, .stance = config.stance};
    at_reference_.emplace(inverse);
    at_motion_.emplace(inverse);
  }
  ring_.resize(static_cast<std::size_t>(2 * half_ + 1));
  for (Slot& slot : ring_) slot.features = Eigen::VectorXd::Zero(most_features);
  features_ = Eigen::VectorXd::Zero(most_features);
  target_Nm_ = Eigen::VectorXd::Zero(most_outputs);
}

void TargetEquation::Reset() noexcept {
  filled_ = 0;
  if (at_reference_) at_reference_->Reset();
  if (at_motion_) at_motion_->Reset();
}

const TargetEquation::Slot& TargetEquation::At(int ticks_ago) const noexcept {
  return ring_[(newest_ + ring_.size() - static_cast<std::size_t>(ticks_ago)) % ring_.size()];
}

std::optional<TargetEquation::Sample> TargetEquation::Push(const TickData& data) noexcept {
  if (filled_ > 0 && data.tick != last_tick_ + 1)
    Reset();  // a hole: the positions are no longer even in time
  last_tick_ = data.tick;
  newest_ = (newest_ + 1) % ring_.size();
  filled_ = std::min(filled_ + 1, static_cast<int>(ring_.size()));
  Slot& slot = ring_[newest_];
  slot.network = data.network;
  const bool known =
      data.network >= 0 && data.network <= 1 && networks_[static_cast<std::size_t>(data.network)];
  slot.usable = data.usable && known &&
                data.features.size() == networks_[static_cast<std::size_t>(data.network)]->features;
  if (slot.usable) slot.features.head(data.features.size()) = data.features;
  slot.positions_valid = data.positions_valid;
  slot.position_rad = data.position_rad;
  slot.drive_torque_Nm = data.drive_torque_Nm;
  slot.measured = data.measured;
  for (std::size_t j = 0; j < gear_ratio_.size(); ++j)
    slot.motor_rad[j] = data.motor_position_rad[j] / gear_ratio_[j];

  if (filled_ < static_cast<int>(ring_.size())) return std::nullopt;
  const Slot& centre = At(half_);
  if (!centre.usable) return std::nullopt;
  for (const Slot& any : ring_) {
    if (config_.carry_over && !any.positions_valid) return std::nullopt;
  }
  const Network& network = *networks_[static_cast<std::size_t>(centre.network)];
  features_.head(network.features) = centre.features.head(network.features);
  for (int o = 0; o < network.outputs; ++o) {
    target_Nm_(o) = centre.drive_torque_Nm[static_cast<std::size_t>(o)];
  }
  double fastest_rad_s = 0.0;
  if (config_.carry_over && !CarryOver(centre, network, data.period_s, &fastest_rad_s))
    return std::nullopt;
  return Sample{centre.network, features_.head(network.features), target_Nm_.head(network.outputs),
                fastest_rad_s};
}

bool TargetEquation::CarryOver(const Slot& centre, const Network& network, double period_s,
                               double* fastest_rad_s) noexcept {
  // Parabola through the window: with i = -h .. h, S2 = sum i^2, S4 = sum i^4, n = 2 h + 1,
  //   x'  = sum(i x) / (S2 dt),   x'' = 2 sum((i^2 - S2 / n) x) / ((S4 - S2^2 / n) dt^2)
  double s2 = 0.0;
  double s4 = 0.0;
  for (int i = -half_; i <= half_; ++i) {
    s2 += static_cast<double>(i) * i;
    s4 += static_cast<double>(i) * i * i * i;
  }
  const double n = 2.0 * half_ + 1.0;
  esn::Frame motion = centre.measured;
  esn::Frame reference = centre.measured;
  for (int joint = 0; joint < network.outputs; ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    double velocity = 0.0;
    double acceleration = 0.0;
    for (int i = -half_; i <= half_; ++i) {
      const Slot& slot = At(half_ - i);
      const double x = config_.motion_from_motor ? slot.motor_rad[j] : slot.position_rad[j];
      velocity += i * x;
      acceleration += (static_cast<double>(i) * i - s2 / n) * x;
    }
    velocity /= s2 * period_s;
    acceleration *= 2.0 / ((s4 - s2 * s2 / n) * period_s * period_s);
    motion.Set(kReference[0], joint, centre.position_rad[j]);
    motion.Set(kReference[1], joint, velocity);
    motion.Set(kReference[2], joint, acceleration);
    *fastest_rad_s = std::max(*fastest_rad_s, std::abs(velocity));
    for (std::size_t s = 0; s < kReference.size(); ++s) {
      const int feature = network.reference[j][s];
      const double normalised = centre.features(feature);
      if (!(std::abs(normalised) < network.input_limit))
        return false;  // clipped: the reference is not known
      reference.Set(kReference[s], joint,
                    network.normalisation.offset(feature - 1) +
                        network.normalisation.scale(feature - 1) * normalised);
    }
    *fastest_rad_s = std::max(*fastest_rad_s, std::abs(reference.Get({kReference[1], joint})));
  }
  const esn::Prediction wanted = at_reference_->Step(reference, period_s);
  const esn::Prediction was = at_motion_->Step(motion, period_s);
  for (int o = 0; o < network.outputs; ++o) {
    const auto j = static_cast<std::size_t>(o);
    if (!wanted.valid[j] || !was.valid[j]) return false;
    target_Nm_(o) += wanted.torque_Nm[j] - was.torque_Nm[j];
  }
  return true;
}

void TargetEquation::Slot::Exchange(types::StateArchive& archive) {
  archive(usable, positions_valid, features, position_rad, motor_rad, drive_torque_Nm, measured);
  archive.Bounded(network, 255);  // as messages have it; only 0 and 1 are ever usable
}

void TargetEquation::Exchange(types::StateArchive& archive) {
  archive(ring_, last_tick_, at_reference_, at_motion_);
  archive.Bounded(newest_, ring_.size() - 1);
  archive.Bounded(filled_, static_cast<int>(ring_.size()));
  for (const Slot& slot : ring_) {
    if (slot.usable && (slot.network > 1 || !networks_[static_cast<std::size_t>(slot.network)])) {
      throw std::invalid_argument("state: it has features of a network that is not here");
    }
  }
}

}  // namespace sinew::rls
