#include "sim/surrogate/undeclared.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <stdexcept>

namespace sinew::surrogate {
namespace {

// Share of the extra friction left at a speed, as a lubrication film builds up (read off a curve).
struct CurvePoint {
  double velocity_rad_s;
  double share;
};
constexpr std::array<CurvePoint, 9> kStribeckCurve{{{0.0, 1.0},
                                                    {0.02, 0.93},
                                                    {0.05, 0.72},
                                                    {0.09, 0.45},
                                                    {0.14, 0.24},
                                                    {0.2, 0.11},
                                                    {0.28, 0.04},
                                                    {0.4, 0.01},
                                                    {0.6, 0.0}}};

// Seal lip: elements that slip at these rotations of the output, with their share of the torque.
constexpr std::array<double, 6> kSealYield_rad{0.01, 0.025, 0.05, 0.09, 0.15, 0.24};
constexpr std::array<double, 6> kSealShare{0.1, 0.15, 0.2, 0.2, 0.2, 0.15};

// 14 magnets over 12 slots, one magnet pair weak, slots unevenly wound: the pull of every magnet on
// every slot opening, summed over one turn. Gives orders 7 (pole pairs), 14 (magnets), 28 and a
// trace of 12.
constexpr int kCoggingTableSize = 1024;
constexpr int kMagnets = 14;

std::vector<double> MakeCoggingTable() {
  std::vector<double> table(kCoggingTableSize + 1, 0.0);
  double largest = 0.0;
  for (int i = 0; i <= kCoggingTableSize; ++i) {
    const double turn = static_cast<double>(i % kCoggingTableSize) / kCoggingTableSize;
    double sum = 0.0;
    for (int magnet = 0; magnet < kMagnets; ++magnet) {
      const double strength = magnet % 2 == 0 ? 1.0 : 0.9;  // north faces are ground thinner
      double distance = turn * kMagnets - magnet;
      distance -= kMagnets * std::round(distance / kMagnets);
      // Pull toward the middle of a magnet, strongest at a third of the pole pitch.
      sum += strength * -distance * std::exp(-4.5 * distance * distance);
    }
    sum *= 1.0 + 0.12 * std::sin(2.0 * std::numbers::pi * turn + 0.7);  // rotor runs slightly out
    table[i] = sum;
    largest = std::max(largest, std::abs(sum));
  }
  for (double& value : table) value /= largest;
  return table;
}

double AtSpeed(double speed_rad_s) noexcept {
  for (std::size_t i = 1; i < kStribeckCurve.size(); ++i) {
    const CurvePoint& left = kStribeckCurve[i - 1];
    const CurvePoint& right = kStribeckCurve[i];
    if (speed_rad_s < right.velocity_rad_s) {
      const double x =
          (speed_rad_s - left.velocity_rad_s) / (right.velocity_rad_s - left.velocity_rad_s);
      return left.share + x * (right.share - left.share);
    }
  }
  return 0.0;
}

std::string Names() {
  std::string names;
  for (const EffectInfo& info : UndeclaredEffects()) {
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  return names;
}

const EffectInfo& Find(const std::string& name) {
  for (const EffectInfo& info : UndeclaredEffects()) {
    if (info.name == name) return info;
  }
  throw std::invalid_argument("effect '" + name +
                              "' is not known, expected none or one of: " + Names());
}

double ParseNumber(const std::string& text, const std::string& what) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size() || !std::isfinite(value)) {
    throw std::invalid_argument(what + " '" + text + "' is not a finite number");
  }
  return value;
}

}  // namespace

const std::vector<EffectInfo>& UndeclaredEffects() {
  static const std::vector<EffectInfo> kEffects{
      {"stribeck", "N m", 0.07, 2.0,
       "extra dry friction of the output at creep, lost as a film builds up (table over speed)"},
      {"direction_dependent_viscous", "N m s/rad", 0.09, 2.0,
       "seal lip drags more going up than down: viscous coefficient +size/2 up, -size/2 down"},
      {"cogging", "N m", 1.9e-3, 0.02,
       "motor torque ripple of 14 magnets over 12 slots (table over one turn), peak at the rotor"},
      {"seal_hysteresis", "N m/bar", 0.012, 1.0,
       "seal lip of slip elements, 0.01 to 0.24 rad, pressed on by the chamber's pressure"},
      {"payload", "kg", 0.5, 5.0,
       "mass at the load cell that nobody declared; from the start a refit takes it up whole as "
       "inertia "
       "and gravity, so give it a time: payload=0.5@30"},
      {"quadratic_viscous", "N m s2/rad2", 0.1, 1.0,
       "gear oil churned by the rotor: torque grows with speed squared (size at 1 rad/s of "
       "output)"},
  };
  return kEffects;
}

std::optional<EffectSpec> ParseEffect(std::string_view text) {
  std::string name(text);
  EffectSpec spec;
  const std::size_t at = name.find('@');
  if (at != std::string::npos) {
    spec.from_s = ParseNumber(name.substr(at + 1), "start time of an effect");
    if (spec.from_s < 0.0) throw std::invalid_argument("start time of an effect is negative");
    name.resize(at);
  }
  const std::size_t equals = name.find('=');
  std::optional<double> size;
  if (equals != std::string::npos) {
    size = ParseNumber(name.substr(equals + 1), "size of an effect");
    name.resize(equals);
  }
  if (name == "none" || name.empty()) return std::nullopt;
  const EffectInfo& info = Find(name);
  spec.name = name;
  spec.size = size.value_or(info.default_size);
  if (std::abs(spec.size) > info.largest_size) {
    throw std::invalid_argument("size of effect '" + name + "' is " + std::to_string(spec.size) +
                                ", expected at most " + std::to_string(info.largest_size) + " " +
                                std::string(info.unit));
  }
  return spec;
}

Undeclared::Undeclared(const std::vector<EffectSpec>& effects, double gear_ratio)
    : gear_ratio_(gear_ratio), seal_deflection_rad_(kSealYield_rad.size(), 0.0) {
  for (const EffectSpec& spec : effects) {
    const EffectInfo& info = Find(spec.name);
    if (!std::isfinite(spec.size) || std::abs(spec.size) > info.largest_size) {
      throw std::invalid_argument("size of effect '" + spec.name + "' is out of range");
    }
    if ((spec.name == "payload" || spec.name == "seal_hysteresis" || spec.name == "stribeck") &&
        spec.size < 0.0) {
      throw std::invalid_argument("size of effect '" + spec.name + "' is negative");
    }
    if (spec.name == "cogging" && cogging_table_.empty()) cogging_table_ = MakeCoggingTable();
    effects_.push_back({spec});
  }
  Reset();
}

void Undeclared::Reset() noexcept {
  std::fill(seal_deflection_rad_.begin(), seal_deflection_rad_.end(), 0.0);
  stribeck_Nm_ = direction_Nm_s_rad_ = cogging_Nm_ = seal_Nm_bar_ = payload_kg_ = quadratic_Nm_ =
      0.0;
  for (Active& effect : effects_) effect.on = false;
  SetTime(0.0);
}

void Undeclared::SetTime(double time_s) noexcept {
  for (Active& effect : effects_) {
    if (effect.on || time_s < effect.spec.from_s) continue;
    effect.on = true;
    const std::string& name = effect.spec.name;
    const double size = effect.spec.size;
    if (name == "stribeck") stribeck_Nm_ += size;
    if (name == "direction_dependent_viscous") direction_Nm_s_rad_ += size;
    if (name == "cogging") cogging_Nm_ += size;
    if (name == "seal_hysteresis") seal_Nm_bar_ += size;
    if (name == "payload") payload_kg_ += size;
    if (name == "quadratic_viscous") quadratic_Nm_ += size;
  }
}

double Undeclared::ExtraFriction_Nm(double output_velocity_rad_s) const noexcept {
  return stribeck_Nm_ == 0.0 ? 0.0 : stribeck_Nm_ * AtSpeed(std::abs(output_velocity_rad_s));
}

double Undeclared::OutputTorque_Nm(const EffectState& state, double dt_s) noexcept {
  double torque_Nm = 0.0;
  if (direction_Nm_s_rad_ != 0.0) {
    torque_Nm -= 0.5 * direction_Nm_s_rad_ * std::abs(state.output_velocity_rad_s);
  }
  if (seal_Nm_bar_ != 0.0) {
    const double strength_Nm = seal_Nm_bar_ * std::max(0.0, state.chamber_gauge_bar);
    for (std::size_t i = 0; i < kSealYield_rad.size(); ++i) {
      double& deflection_rad = seal_deflection_rad_[i];
      deflection_rad = std::clamp(deflection_rad + state.output_velocity_rad_s * dt_s,
                                  -kSealYield_rad[i], kSealYield_rad[i]);
      torque_Nm -= strength_Nm * kSealShare[i] * deflection_rad / kSealYield_rad[i];
    }
  }
  return torque_Nm;
}

double Undeclared::RotorTorque_Nm(const EffectState& state) const noexcept {
  double torque_Nm = 0.0;
  if (cogging_Nm_ != 0.0) {
    double turn = state.motor_angle_rad / (2.0 * std::numbers::pi);
    turn -= std::floor(turn);
    const double place = turn * kCoggingTableSize;
    const int cell = std::min(static_cast<int>(place), kCoggingTableSize - 1);
    const double x = place - cell;
    torque_Nm += cogging_Nm_ * ((1.0 - x) * cogging_table_[cell] + x * cogging_table_[cell + 1]);
  }
  if (quadratic_Nm_ != 0.0) {
    const double output_side_rad_s = state.motor_velocity_rad_s / gear_ratio_;
    torque_Nm -= quadratic_Nm_ * output_side_rad_s * std::abs(output_side_rad_s) / gear_ratio_;
  }
  return torque_Nm;
}

}  // namespace sinew::surrogate
