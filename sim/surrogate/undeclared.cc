#include "sim/surrogate/undeclared.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/base/types/angle.h"

namespace sinew::surrogate {
namespace {

struct CurvePoint {
  double x;
  double share;
};
// Share of the extra friction left at a speed, rad/s, as a lubrication film builds up (read off a
// curve).
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

using types::kTwoPi;

// Bearing grease, without pressure on it.
constexpr std::array<double, 5> kBearingYield_rad{0.01, 0.02, 0.04, 0.07, 0.12};
constexpr std::array<double, 5> kBearingShare{0.15, 0.2, 0.25, 0.25, 0.15};

// Cable: pressed against the link from 0.25 rad on, whole at 0.6 rad.
constexpr std::array<double, 3> kCableYield_rad{0.01, 0.03, 0.06};
constexpr std::array<double, 3> kCableShare{0.3, 0.4, 0.3};
constexpr std::array<CurvePoint, 5> kCableCurve{
    {{0.25, 0.0}, {0.32, 0.3}, {0.4, 0.6}, {0.5, 0.85}, {0.6, 1.0}}};

// A lip turns over within this speed.
constexpr double kLipTurns_rad_s = 0.01;

// Friction over temperature, degC, in units of the size: grease stiff when cold, thin when warm.
constexpr std::array<CurvePoint, 8> kGreaseCurve{{{5.0, 2.1},
                                                  {15.0, 0.8},
                                                  {25.0, 0.0},
                                                  {32.0, -0.4},
                                                  {40.0, -0.72},
                                                  {50.0, -1.0},
                                                  {65.0, -1.3},
                                                  {90.0, -1.5}}};
constexpr double kGreaseViscous_s_rad = 0.5;  // viscous part over the dry part

// Torque lost in the iron over current, A, in units of what is lost at 25 A.
constexpr std::array<CurvePoint, 8> kIronCurve{{{0.0, 0.0},
                                                {2.0, 0.006},
                                                {4.0, 0.03},
                                                {7.0, 0.1},
                                                {10.0, 0.22},
                                                {14.0, 0.42},
                                                {19.0, 0.7},
                                                {25.0, 1.0}}};

// A hand's push over time, s.
constexpr std::array<CurvePoint, 7> kBumpCurve{
    {{0.0, 0.0}, {0.1, 0.3}, {0.2, 0.85}, {0.3, 1.0}, {0.45, 0.75}, {0.6, 0.3}, {0.8, 0.0}}};

// Torque that a folding vane loses over gauge pressure, bar, in units of what it loses at 0.
constexpr std::array<CurvePoint, 7> kFoldCurve{
    {{0.0, 1.0}, {0.6, 0.97}, {1.0, 0.85}, {1.4, 0.6}, {1.8, 0.3}, {2.2, 0.1}, {2.6, 0.0}}};

// A bad tooth: the place in turns of the first stage's wheel, and its bump around that place.
constexpr double kFirstStage = 10.0;  // motor turns per turn of that wheel
constexpr double kBadToothPlace = 0.37;
constexpr std::array<CurvePoint, 7> kBadToothCurve{{{-0.05, 0.0},
                                                    {-0.03, 0.35},
                                                    {-0.01, 1.0},
                                                    {0.0, 0.7},
                                                    {0.01, -0.5},
                                                    {0.03, -0.25},
                                                    {0.05, 0.0}}};

// Supply over time, s: another load for 1.5 s of every 7.
constexpr double kSagPeriod_s = 7.0;
constexpr std::array<CurvePoint, 4> kSagCurve{{{3.0, 0.0}, {3.1, 1.0}, {4.4, 1.0}, {4.5, 0.0}}};

constexpr double kMagnetSlips_rad_s = 0.7;
constexpr double kMagnetPhase_rad = 0.9;  // the magnet's centre lies there

// Torque of a spring roller on the rim of an oval wheel, over one turn, largest magnitude 1.
constexpr int kWheelTableSize = 720;

std::vector<double> MakeWheelTable() {
  const auto rim = [](double angle_rad) {
    const double c = std::cos(angle_rad - 0.5), s = std::sin(angle_rad - 0.5);
    return 1.0 / std::sqrt(c * c + 1.3 * s * s);
  };
  std::vector<double> table(kWheelTableSize + 1, 0.0);
  constexpr double kStep_rad = kTwoPi / kWheelTableSize;
  double largest = 0.0;
  for (int i = 0; i <= kWheelTableSize; ++i) {
    const double angle_rad = kStep_rad * (i % kWheelTableSize);
    table[i] = rim(angle_rad + 0.5 * kStep_rad) - rim(angle_rad - 0.5 * kStep_rad);
    largest = std::max(largest, std::abs(table[i]));
  }
  for (double& value : table) value /= largest;
  return table;
}

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

double Interpolate(std::span<const CurvePoint> curve, double x) noexcept {
  if (x <= curve.front().x) return curve.front().share;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (x >= curve[i].x) continue;
    const double place = (x - curve[i - 1].x) / (curve[i].x - curve[i - 1].x);
    return curve[i - 1].share + place * (curve[i].share - curve[i - 1].share);
  }
  return curve.back().share;
}

// Value of a closed table (its last entry repeats the first) at a place in turns.
double AroundTurn(const std::vector<double>& table, double turns) noexcept {
  const int cells = static_cast<int>(table.size()) - 1;
  const double place = (turns - std::floor(turns)) * cells;
  const int cell = std::min(static_cast<int>(place), cells - 1);
  const double x = place - cell;
  return (1.0 - x) * table[cell] + x * table[cell + 1];
}

// Moves elements that slip at their yield rotations; returns the sum of their shares of the torque,
// -1 to 1.
template <std::size_t kElements>
double SlipElements(const std::array<double, kElements>& yield_rad,
                    const std::array<double, kElements>& share, double moved_rad,
                    std::vector<double>* deflection_rad) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < kElements; ++i) {
    double& deflection = (*deflection_rad)[i];
    deflection = std::clamp(deflection + moved_rad, -yield_rad[i], yield_rad[i]);
    sum += share[i] * deflection / yield_rad[i];
  }
  return sum;
}

Effect Find(const std::string& name, double size) {
  const std::span<const EffectInfo> all = UndeclaredEffects();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].name != name) continue;
    if (!std::isfinite(size) || size < all[i].smallest_size || size > all[i].largest_size) {
      throw std::invalid_argument("size of effect '" + name + "' is out of range");
    }
    return static_cast<Effect>(i);
  }
  throw std::invalid_argument("effect '" + name + "' is not known");
}

}  // namespace

Undeclared::Undeclared(const std::vector<EffectSpec>& effects, double gear_ratio)
    : gear_ratio_(gear_ratio),
      seal_deflection_rad_(kSealYield_rad.size(), 0.0),
      bearing_deflection_rad_(kBearingYield_rad.size(), 0.0),
      cable_deflection_rad_(kCableYield_rad.size(), 0.0) {
  for (const EffectSpec& spec : effects) {
    const Effect effect = Find(spec.name, spec.size);
    if (effect == Effect::kCogging && cogging_table_.empty()) cogging_table_ = MakeCoggingTable();
    if (effect == Effect::kGearEccentricity && wheel_table_.empty()) {
      wheel_table_ = MakeWheelTable();
    }
    effects_.push_back({spec, effect});
  }
  Reset();
}

void Undeclared::Reset() noexcept {
  std::fill(seal_deflection_rad_.begin(), seal_deflection_rad_.end(), 0.0);
  std::fill(bearing_deflection_rad_.begin(), bearing_deflection_rad_.end(), 0.0);
  std::fill(cable_deflection_rad_.begin(), cable_deflection_rad_.end(), 0.0);
  size_.fill(0.0);
  magnet_slip_rad_ = bump_start_s_ = 0.0;
  magnet_armed_ = true;
  for (Active& effect : effects_) effect.on = false;
  SetTime(0.0);
}

void Undeclared::SetTime(double time_s) noexcept {
  time_s_ = time_s;
  for (Active& active : effects_) {
    if (active.on || time_s < active.spec.from_s) continue;
    active.on = true;
    size_[static_cast<std::size_t>(active.effect)] += active.spec.size;
    if (active.effect == Effect::kExternalBump) bump_start_s_ = active.spec.from_s;
  }
}

double Undeclared::ExtraFriction_Nm(const EffectState& state) const noexcept {
  double extra_Nm = 0.0;
  const double velocity_rad_s = state.output_velocity_rad_s;
  if (const double stribeck_Nm = size(Effect::kStribeck); stribeck_Nm != 0.0) {
    extra_Nm += stribeck_Nm * Interpolate(kStribeckCurve, std::abs(velocity_rad_s));
  }
  if (const double lip_Nm = size(Effect::kDirectionDependentCoulomb); lip_Nm != 0.0) {
    extra_Nm += 0.5 * lip_Nm * std::clamp(velocity_rad_s / kLipTurns_rad_s, -1.0, 1.0);
  }
  if (const double grease_Nm = size(Effect::kTemperatureFriction); grease_Nm != 0.0) {
    extra_Nm += grease_Nm * Interpolate(kGreaseCurve, state.motor_temperature_degC);
  }
  return extra_Nm;
}

double Undeclared::OutputTorque_Nm(const EffectState& state, double dt_s) noexcept {
  double torque_Nm = 0.0;
  const double velocity_rad_s = state.output_velocity_rad_s;
  const double moved_rad = velocity_rad_s * dt_s;
  if (const double lip_Nm_s_rad = size(Effect::kDirectionDependentViscous); lip_Nm_s_rad != 0.0) {
    torque_Nm -= 0.5 * lip_Nm_s_rad * std::abs(velocity_rad_s);
  }
  if (const double seal_Nm_bar = size(Effect::kSealHysteresis); seal_Nm_bar != 0.0) {
    torque_Nm -= seal_Nm_bar * std::max(0.0, state.chamber_gauge_bar) *
                 SlipElements(kSealYield_rad, kSealShare, moved_rad, &seal_deflection_rad_);
  }
  if (const double bearing_Nm = size(Effect::kPresliding); bearing_Nm != 0.0) {
    torque_Nm -= bearing_Nm * SlipElements(kBearingYield_rad, kBearingShare, moved_rad,
                                           &bearing_deflection_rad_);
  }
  if (const double cable_Nm = size(Effect::kCableDrag); cable_Nm != 0.0) {
    torque_Nm -= cable_Nm * Interpolate(kCableCurve, state.output_angle_rad) *
                 SlipElements(kCableYield_rad, kCableShare, moved_rad, &cable_deflection_rad_);
  }
  if (const double grease_Nm = size(Effect::kTemperatureFriction); grease_Nm != 0.0) {
    torque_Nm -= kGreaseViscous_s_rad * grease_Nm *
                 Interpolate(kGreaseCurve, state.motor_temperature_degC) * velocity_rad_s;
  }
  if (const double wheel_Nm = size(Effect::kGearEccentricity); wheel_Nm != 0.0) {
    torque_Nm += wheel_Nm * AroundTurn(wheel_table_, state.output_angle_rad / kTwoPi);
  }
  return torque_Nm;
}

double Undeclared::Bump_N() const noexcept {
  const double push_N = size(Effect::kExternalBump);
  if (push_N == 0.0) return 0.0;
  return push_N * Interpolate(kBumpCurve, time_s_ - bump_start_s_);
}

double Undeclared::RotorTorque_Nm(const EffectState& state) const noexcept {
  double torque_Nm = 0.0;
  if (const double cogging_Nm = size(Effect::kCogging); cogging_Nm != 0.0) {
    torque_Nm += cogging_Nm * AroundTurn(cogging_table_, state.motor_angle_rad / kTwoPi);
  }
  if (const double oil_Nm = size(Effect::kQuadraticViscous); oil_Nm != 0.0) {
    const double output_side_rad_s = state.motor_velocity_rad_s / gear_ratio_;
    torque_Nm -= oil_Nm * output_side_rad_s * std::abs(output_side_rad_s) / gear_ratio_;
  }
  if (const double tooth_Nm = size(Effect::kBadTooth); tooth_Nm != 0.0) {
    double turn = state.motor_angle_rad / (kTwoPi * kFirstStage) - kBadToothPlace;
    turn -= std::round(turn);
    torque_Nm += tooth_Nm * Interpolate(kBadToothCurve, turn);
  }
  return torque_Nm;
}

double Undeclared::TorqueShare(double current_A) const noexcept {
  double share = 1.0 + size(Effect::kTorqueConstantGain);
  if (const double lost = size(Effect::kTorqueConstantSaturation); lost != 0.0) {
    share *= 1.0 - lost * Interpolate(kIronCurve, std::abs(current_A));
  }
  return share;
}

double Undeclared::SupplyShare() const noexcept {
  const double lost = size(Effect::kSupplySag);
  if (lost == 0.0) return 1.0;
  return 1.0 - lost * Interpolate(kSagCurve, std::fmod(time_s_, kSagPeriod_s));
}

double Undeclared::Tilt_rad() const noexcept {
  return size(Effect::kGravityPhase) + size(Effect::kSlowTilt) * time_s_ / 60.0;
}

double Undeclared::PneumaticShare(double chamber_gauge_bar) const noexcept {
  const double lost = size(Effect::kStiffnessCollapse);
  return lost == 0.0 ? 1.0 : 1.0 - lost * Interpolate(kFoldCurve, chamber_gauge_bar);
}

void Undeclared::MoveMagnet(double output_velocity_rad_s, double /*dt_s*/) noexcept {
  const double slip_rad = size(Effect::kSlippingMagnet);
  if (slip_rad == 0.0) return;
  if (magnet_armed_ && output_velocity_rad_s > kMagnetSlips_rad_s) {
    magnet_slip_rad_ += slip_rad;
    magnet_armed_ = false;
  } else if (output_velocity_rad_s < 0.0) {
    magnet_armed_ = true;
  }
}

double Undeclared::OutputEncoder_rad(double output_rad) const noexcept {
  double seen_rad = output_rad;
  // A sensor beside the axis, at the distance `off` in units of the magnet's radius, sees the
  // direction to the magnet's pole under another angle.
  if (const double off = size(Effect::kEncoderEccentricity); off != 0.0) {
    const double angle_rad = output_rad + kMagnetPhase_rad;
    seen_rad += std::atan2(off * std::sin(angle_rad), 1.0 + off * std::cos(angle_rad));
  }
  return seen_rad - magnet_slip_rad_;
}

double Undeclared::LoadCell_N(double force_N, double output_rad) const noexcept {
  double seen_N = force_N;
  if (const double turned_rad = size(Effect::kLoadCellMisalignment); turned_rad != 0.0) {
    // force_N is the part of a vertical push that turns the link: push * cos(angle).
    const double cosine = std::max(0.2, std::cos(output_rad));
    seen_N *= std::cos(output_rad + turned_rad) / cosine;
  }
  return seen_N * (1.0 + size(Effect::kLoadCellGain));
}

}  // namespace sinew::surrogate
