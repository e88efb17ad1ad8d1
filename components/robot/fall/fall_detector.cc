#include "components/robot/fall/fall_detector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::fall {
namespace {

constexpr double kDetection_s = 0.100;  // what is required of the whole detector
// Times are whole ticks: a hold of 20 ms is four ticks of 5 ms, whatever their rounding.
constexpr double kTickSlack = 1e-6;

void RequireWithin(double value, double largest, const char* name) {
  if (!std::isfinite(value) || value <= 0.0 || value > largest) {
    throw std::invalid_argument(std::string(name) + " is positive and at most " +
                                std::to_string(largest) + ", got " + std::to_string(value));
  }
}

}  // namespace

std::string_view UnknownName(Unknown unknown) noexcept {
  switch (unknown) {
    case Unknown::kNone:
      return "none";
    case Unknown::kStarting:
      return "starting";
    case Unknown::kImu:
      return "imu";
    case Unknown::kSpecificForce:
      return "specific_force";
    case Unknown::kKinematics:
      return "kinematics";
    case Unknown::kReference:
      return "reference";
    case Unknown::kFeet:
      return "feet";
    case Unknown::kTicks:
      return "ticks";
  }
  return "";
}

FallDetector::FallDetector(const FallConfig& config, double period_s)
    : config_(config),
      period_s_(period_s),
      filter_(config.tilt, period_s),
      check_(config.tilt.imu),
      tilt_threshold_rad_(config.tilt.limit_rad - filter_.error_bound_rad()) {
  RequireWithin(config.height_share, 1.0, "height_share");
  RequireWithin(config.free_fall_share, 1.0, "free_fall_share");
  RequireWithin(config.unloaded_share, 1.0, "unloaded_share");
  RequireWithin(config.mass_kg, 1e6, "mass_kg");
  RequireWithin(config.height_hold_s, kDetection_s - period_s, "height_hold_s");
  RequireWithin(config.unloaded_hold_s, kDetection_s - period_s, "unloaded_hold_s");
  RequireWithin(config.free_fall_hold_s, kDetection_s - period_s, "free_fall_hold_s");
  RequireWithin(config.lost_after_s, kDetection_s - period_s, "lost_after_s");
  if (config.lost_after_s < period_s) {
    throw std::invalid_argument("lost_after_s is at least a period, got " +
                                std::to_string(config.lost_after_s));
  }
  if (filter_.error_bound_rad() >= 0.5 * config.tilt.limit_rad) {
    throw std::invalid_argument("the tilt's error bound must be below half of the limit, it is " +
                                std::to_string(filter_.error_bound_rad()) + " rad");
  }
}

void FallDetector::Reset() noexcept {
  filter_.Reset();
  has_tick_ = false;
  tilt_ = height_ = unloaded_ = free_fall_ = Hold{};
  const std::uint64_t repeated_ticks = output_.repeated_ticks;
  output_ = FallOutput{};
  output_.repeated_ticks = repeated_ticks;
}

double FallDetector::Since_s(std::uint64_t tick) const noexcept {
  return static_cast<double>(tick_ - tick) * period_s_;
}

bool FallDetector::Holds(Hold* hold, bool known, bool beyond, double for_s) noexcept {
  if (!known) return false;
  if (!beyond) {
    hold->holds = false;
    return false;
  }
  if (!hold->holds) *hold = {true, tick_};
  return Since_s(hold->since_tick) >= for_s - kTickSlack * period_s_;
}

void FallDetector::Lose(Unknown unknown, std::uint64_t since_tick) noexcept {
  output_.state = FallState::kUnknown;
  output_.unknown = unknown;
  output_.since_tick = since_tick;
}

void FallDetector::FindFall(const FallInput& input, const ImuUse& use) noexcept {
  const bool light = input.imu.force_m_s2.norm() < config_.free_fall_share * types::kGravity_m_s2;
  const bool unloaded =
      output_.feet.total_N() < config_.unloaded_share * config_.mass_kg * types::kGravity_m_s2;
  struct Row {
    Criterion criterion;
    Hold* hold;
    bool known, beyond;
    double for_s;
  };
  const Row rows[] = {
      {Criterion::kTilt, &tilt_, true, output_.tilt_rad > tilt_threshold_rad_, 0.0},
      {Criterion::kBaseHeight, &height_, output_.share_known,
       output_.height_share < config_.height_share, config_.height_hold_s},
      {Criterion::kFreeFall, &unloaded_, use.force_usable && output_.feet.complete(),
       light && unloaded, config_.unloaded_hold_s},
      {Criterion::kFreeFall, &free_fall_, use.force_usable, light, config_.free_fall_hold_s},
  };
  for (const Row& row : rows) {
    const bool falls = Holds(row.hold, row.known, row.beyond, row.for_s);
    if (!falls || output_.state == FallState::kFalling) continue;
    output_.state = FallState::kFalling;
    output_.criterion = row.criterion;
    output_.since_tick = row.hold->since_tick;
  }
}

void FallDetector::FindLoss(std::uint64_t missing) noexcept {
  constexpr std::array<Unknown, kSources> kUnknown = {Unknown::kImu, Unknown::kKinematics,
                                                      Unknown::kReference, Unknown::kFeet};
  const double lost_s = config_.lost_after_s + kTickSlack * period_s_;
  if (static_cast<double>(missing) * period_s_ > lost_s) {
    Lose(Unknown::kTicks, tick_ - missing);
    return;
  }
  for (std::size_t i = 0; i < kUnknown.size(); ++i) {
    if (Since_s(seen_tick_[i]) <= lost_s) continue;
    Lose(kUnknown[i], seen_tick_[i] + 1);
    return;
  }
  if (filter_.coasting_s() > filter_.coast_s()) {
    const auto ticks = static_cast<std::uint64_t>(filter_.coasting_s() / period_s_);
    Lose(Unknown::kSpecificForce, tick_ - std::min(tick_, ticks));
  }
}

FallOutput FallDetector::Step(const FallInput& input) noexcept {
  if (has_tick_ && input.tick <= tick_) {
    ++output_.repeated_ticks;
    return output_;
  }
  if (!has_tick_) seen_tick_.fill(input.tick);
  const std::uint64_t elapsed = has_tick_ ? input.tick - tick_ : 1;
  has_tick_ = true;
  tick_ = input.tick;

  const ImuUse use = check_.Step(input.imu);
  filter_.Step(input.imu, use, static_cast<double>(elapsed) * period_s_);
  output_.feet = LoadsOf(input.feet);
  output_.tilt_rad = filter_.started() ? filter_.tilt_rad() : 0.0;
  const bool kinematics = input.foot_to_base_m.allFinite();
  const bool reference = std::isfinite(input.reference_height_m) && input.reference_height_m > 0.0;
  const bool height_known = kinematics && filter_.started();
  output_.base_height_m = height_known ? filter_.up().dot(input.foot_to_base_m) : 0.0;
  output_.share_known = height_known && reference;
  output_.height_share =
      output_.share_known ? output_.base_height_m / input.reference_height_m : 0.0;
  const std::array<bool, kSources> seen = {use.rate_usable, kinematics, reference,
                                           !output_.feet.lost()};
  for (std::size_t i = 0; i < kSources; ++i) {
    if (seen[i]) seen_tick_[i] = tick_;
  }

  if (output_.unknown == Unknown::kStarting && filter_.started() &&
      std::all_of(seen.begin(), seen.end(), [](bool there) { return there; })) {
    output_.state = FallState::kUpright;
    output_.unknown = Unknown::kNone;
  }
  if (output_.state == FallState::kUpright) FindFall(input, use);
  if (output_.state == FallState::kUpright) FindLoss(elapsed - 1);
  output_.motors_off = output_.state != FallState::kUpright;
  return output_;
}

}  // namespace sinew::fall
