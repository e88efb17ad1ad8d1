#include "bench/rigs/drawn/declared.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bench/rigs/drawn/random.h"

namespace sinew::rigs {
namespace {

constexpr double kGravity = 9.81;
constexpr double kTolerance = 0.15;
constexpr double kAtmosphere_bar = 1.01325;
constexpr double kGasWindow_s = 10.0;
constexpr double kAfterShutting_s = 0.3;

// A nominal value 5 to 15 % off.
Parameter About(Random& random, std::string key, double truth) {
  const double off = random.Uniform(0.05, 0.15) * random.Sign();
  return {std::move(key), truth, truth * (1.0 + off), kTolerance, false};
}
Parameter Exactly(std::string key, double truth) {
  return {std::move(key), truth, truth, 0.0, true};
}

// How well the drive's scale is known: some data sheets are better than others.
Term DriveTerm(const Rig& rig, Random& random, const std::string& gain_key) {
  const double tolerance = random.Chance(0.5) ? 0.05 : kTolerance;
  const auto about = [&](const std::string& key, double truth) {
    Parameter p = About(random, key, truth);
    p.tolerance = tolerance;
    p.nominal = p.truth + (p.nominal - p.truth) * tolerance / kTolerance;
    return p;
  };
  switch (rig.drive) {
    case Drive::kCurrent: {
      const Parameter p = about("efficiency", rig.efficiency);
      const bool rigid = rig.coupling == Coupling::kRigid;
      return {"drive_current", "", {rigid ? Exactly("efficiency", rig.efficiency) : p}};
    }
    case Drive::kCommand:
      return {"drive_voltage", "", {Exactly(gain_key, rig.command_gain)}};
    case Drive::kWinding:
      return {"drive_voltage", "", {about(gain_key, rig.winding_gain)}};
    case Drive::kSensor:
      return {"drive_torque", "", {Exactly("gain", 1.0)}};
  }
  return {};
}

}  // namespace

std::vector<Term> Declare(const Rig& rig) {
  Random random(rig.number, 500);
  std::vector<Term> terms;
  const std::string force = rig.linear ? "N" : "Nm", length = rig.linear ? "m" : "rad";
  const std::string mass = rig.linear ? "kg" : "kg_m2";
  const bool two_bodies = rig.drive == Drive::kCurrent && rig.motor_encoder && rig.output_encoder;
  terms.push_back(DriveTerm(rig, random, "gain_" + force + "_V"));
  if (two_bodies && rig.coupling != Coupling::kRigid) {
    terms.push_back(
        {"rotor_inertia", "", {About(random, "rotor_inertia_" + mass, rig.rotor_inertia)}});
    terms.push_back(
        {"link_inertia", "", {About(random, "link_inertia_" + mass, rig.link_inertia)}});
  } else {
    const double moved = rig.drive == Drive::kSensor ? rig.link_inertia : rig.total_inertia();
    terms.push_back({"inertia", "", {About(random, "inertia_" + mass, moved)}});
  }
  if (rig.payloads) terms.push_back({"declared_payload", "", {Exactly("share", 1.0)}});
  if (rig.motor_viscous > 0.0 && rig.drive != Drive::kSensor) {
    terms.push_back({"motor_viscous",
                     "",
                     {About(random, "viscous_" + force + "_s_" + length, rig.motor_viscous)}});
  }
  if (rig.link_viscous > 0.0) {
    terms.push_back(
        {"viscous", "", {About(random, "viscous_" + force + "_s_" + length, rig.link_viscous)}});
  }
  terms.push_back({"coulomb", "", {About(random, "coulomb_" + force, rig.coulomb)}});
  if (rig.gravity_torque > 0.0) {
    terms.push_back({"gravity", "", {About(random, "gravity_torque_Nm", rig.gravity_torque)}});
  }
  if (rig.offset != 0.0) {
    terms.push_back({"offset", "", {About(random, "offset_" + force, rig.offset)}});
    terms.back().parameters[0].tolerance = 1.0;
  }
  if (rig.pressure) {
    const double slope = rig.pneumatic_slope;
    terms.push_back(
        {"pneumatic_torque", "", {About(random, "pneumatic_torque_" + force + "_bar", slope)}});
    if (rig.pneumatic_stiffness > 0.0) {
      Parameter rest = About(random, "rest_angle_rad", rig.rest_position);
      rest.nominal = rig.rest_position;  // where it pulls nowhere is easily found
      rest.fixed = true;
      terms.push_back(
          {"pneumatic_stiffness",
           "",
           {About(random, "pneumatic_stiffness_Nm_rad_bar", rig.pneumatic_stiffness), rest}});
    }
  }
  if (rig.load_cell) terms.push_back({"load_force", "", {Exactly("share", 1.0)}});
  if (rig.gas_balance) {
    terms.push_back({"chamber_pressure", "gas", {Exactly("share", 1.0)}});
    Parameter p = About(random, "share", 1.0);  // the volume is stated 5 to 15 % off: gas_volume_m3
    std::swap(p.truth, p.nominal);
    terms.push_back({"gas_compression", "gas", {p}});
    terms.push_back({"valve_flow", "gas", {Exactly("share", 1.0)}});
  }
  if (rig.kinematic) {
    terms.push_back({"encoder_difference", "kinematic", {Exactly("share", 1.0)}});
    terms.push_back(
        {"free_play",
         "kinematic",
         {Exactly("width_rad", rig.play), Exactly("compliance_rad_Nm", 1.0 / rig.stiffness)}});
    terms.push_back({"encoder_offset", "kinematic", {{"offset_rad", 0.0, 0.0, 0.0, false}}});
  }
  return terms;
}

Smooth Differentiate(const Eigen::VectorXd& values, double rate_Hz, double width_rows) {
  const int half = std::max(2, static_cast<int>(std::ceil(3.5 * width_rows)));
  Eigen::VectorXd g(2 * half + 1), g1(2 * half + 1), g2(2 * half + 1);
  const double w2 = width_rows * width_rows;
  for (int i = -half; i <= half; ++i) g[i + half] = std::exp(-0.5 * i * i / w2);
  // Kernels that are exact for a constant, a line and a parabola.
  double s0 = 0, s2 = 0, s4 = 0;
  for (int i = -half; i <= half; ++i) {
    const double x = i, k = g[i + half];
    s0 += k, s2 += k * x * x, s4 += k * x * x * x * x;
  }
  const double det = s0 * s4 - s2 * s2;
  for (int i = -half; i <= half; ++i) {
    const double x = i, k = g[i + half];
    g1[i + half] = k * x / s2 * rate_Hz;
    g2[i + half] = 2.0 * k * (s0 * x * x - s2) / det * rate_Hz * rate_Hz;
    g[i + half] = k * (s4 - s2 * x * x) / det;
  }
  const auto n = values.size();
  Smooth out{values, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (Eigen::Index k = half; k + half < n; ++k) {
    const auto piece = values.segment(k - half, 2 * half + 1);
    out.value[k] = g.dot(piece);
    out.velocity[k] = g1.dot(piece);
    out.acceleration[k] = g2.dot(piece);
  }
  return out;
}

std::vector<bool> Usable(const Rig& rig, const std::vector<TrueRow>& rows, Shows shows) {
  const int n = static_cast<int>(rows.size());
  std::vector<bool> use(rows.size(), true);
  const double rest = shows == Shows::kLocked ? 0.0 : 0.012 * rig.speed();
  const int guard = std::max(2, static_cast<int>(0.02 / rig.frequency_Hz * rig.rate_Hz));
  int blocked = -1;
  if (shows == Shows::kGas) {
    int shut_since = 0;
    for (int i = 0; i < n; ++i) {
      if (rows[i].valve_open) shut_since = i + 1;
      use[i] = i - shut_since > kAfterShutting_s * rig.rate_Hz;
    }
    for (int i = 0; i < std::min(n, 60); ++i) use[i] = use[n - 1 - i] = false;
    return use;
  }
  for (int i = 0; i < n; ++i) {
    const bool reverses = i > 0 && rows[i].velocity * rows[i - 1].velocity < 0.0;
    const bool still = std::abs(rows[i].velocity) < rest;
    if (still || (reverses && shows != Shows::kLocked)) {
      for (int k = std::max(0, i - guard); k <= i; ++k) use[k] = false;
      blocked = std::max(blocked, i + guard);
    }
    // Teeth that part or touch again.
    if (rig.play > 0.0 && i > 0 && shows != Shows::kLocked &&
        (rows[i].tooth_force == 0.0) != (rows[i - 1].tooth_force == 0.0)) {
      const int knock = std::max(3, static_cast<int>(0.015 * rig.rate_Hz));
      for (int k = std::max(0, i - knock); k <= i; ++k) use[k] = false;
      blocked = std::max(blocked, i + knock);
    }
    if (i <= blocked) use[i] = false;
    if (shows == Shows::kKinematic && std::abs(rows[i].tooth_force) < 0.05 * rig.force_scale()) {
      use[i] = false;
    }
  }
  const int border = std::min(n / 8, std::max(60, static_cast<int>(0.5 * rig.rate_Hz)));
  for (int i = 0; i < border; ++i) use[i] = use[n - 1 - i] = false;
  return use;
}

namespace {

using ReadingAt = std::vector<const Reading*>;  // by grid point; null: the row is lost

void FillKinematic(const Rig& rig, const std::vector<int>& rows, const ReadingAt& at,
                   Balance* out) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  out->response.resize(count);
  out->columns.setOnes(count, 1);
  out->prior_sd.setConstant(1, std::numeric_limits<double>::infinity());
  for (Eigen::Index k = 0; k < count; ++k) {
    const Reading& r = *at[static_cast<std::size_t>(rows[static_cast<std::size_t>(k)])];
    const double side = r.tooth_force > 0.0 ? 1.0 : -1.0;
    out->response[k] = r.motor_rad / rig.gear_ratio - r.position -
                       (0.5 * side * rig.play + r.tooth_force / rig.stiffness);
  }
}

// Pressure against the integral of isothermal compression, each freed of its window's mean.
void FillGas(const Rig& rig, const std::vector<int>& rows, const ReadingAt& at,
             const Eigen::VectorXd& position, const Eigen::VectorXd& pressure_bar, Balance* out) {
  const auto count = static_cast<Eigen::Index>(rows.size());
  Eigen::VectorXd compressed = Eigen::VectorXd::Zero(rig.rows);
  auto volume = [&rig, &position](int i) {
    const double s = position[i] - rig.rest_position;
    return rig.gas_volume_m3 +
           1e-5 * (rig.pneumatic_slope * s - 0.5 * rig.pneumatic_stiffness * s * s);
  };
  for (int i = 1; i < rig.rows; ++i) {
    const double change = (volume(i) - volume(i - 1)) / volume(i);
    compressed[i] = compressed[i - 1] - (pressure_bar[i] + kAtmosphere_bar) * change;
  }
  out->response.resize(count);
  out->columns.resize(count, 1);
  out->prior_sd.setConstant(1, std::numeric_limits<double>::infinity());
  for (Eigen::Index first = 0, k = 0; k < count; ++k) {
    const int i = rows[static_cast<std::size_t>(k)];
    out->response[k] = at[static_cast<std::size_t>(i)]->pressure_bar;
    out->columns(k, 0) = compressed[i];
    const bool ends = k + 1 == count || rows[static_cast<std::size_t>(k + 1)] - i > 10 ||
                      i - rows[static_cast<std::size_t>(first)] > kGasWindow_s * rig.rate_Hz;
    if (!ends) continue;
    out->response.segment(first, k + 1 - first).array() -=
        out->response.segment(first, k + 1 - first).mean();
    out->columns.col(0).segment(first, k + 1 - first).array() -=
        out->columns.col(0).segment(first, k + 1 - first).mean();
    first = k + 1;
  }
}

double DriveForce(const Rig& rig, const Reading& r, double velocity) {
  const double unit = rig.drive == Drive::kCommand   ? rig.command_gain
                      : rig.drive == Drive::kWinding ? rig.winding_gain
                      : rig.drive == Drive::kSensor
                          ? 1.0
                          : rig.efficiency * rig.gear_ratio * rig.torque_constant_Nm_A;
  double drive = unit * r.drive;
  if (rig.drive == Drive::kWinding) {
    drive -= unit * rig.back_emf_V_s_rad * rig.gear_ratio * velocity;
  }
  return drive;
}

// What a declared payload and the hand take of it.
double HeldForce(const Rig& rig, bool known, const Reading& r, const Smooth& link, int i) {
  const double arm = rig.link_length_m;
  double held = 0.0;
  if (known && rig.payloads) {
    held += r.payload_kg * arm * (arm * link.acceleration[i] + kGravity * std::cos(link.value[i]));
  }
  if (rig.load_cell) held += arm * r.load_force_N;
  return held;
}

// Regressor of a declared effect.
double ValueOf(const std::string& name, const Rig& rig, const Smooth& link, const Smooth& motor,
               const Smooth& gas, int i) {
  double value = 0.0;
  if (name == "rotor_inertia") value = motor.acceleration[i];
  if (name == "link_inertia" || name == "inertia") value = link.acceleration[i];
  if (name == "motor_viscous") value = motor.velocity[i];
  if (name == "viscous") value = link.velocity[i];
  if (name == "coulomb") value = link.velocity[i] > 0.0 ? 1.0 : -1.0;
  if (name == "gravity") value = std::cos(link.value[i]);
  if (name == "offset") value = -1.0;
  if (name == "pneumatic_torque") value = -gas.value[i];
  if (name == "pneumatic_stiffness") value = gas.value[i] * (link.value[i] - rig.rest_position);
  return value;
}

}  // namespace

Balance MakeBalance(const Rig& rig, const std::vector<Reading>& readings,
                    const std::vector<bool>& usable, Shows shows, double width_rows,
                    int recording) {
  const int n = rig.rows;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n), q = x, pressure = x, supply_motor = x;
  std::vector<const Reading*> at(static_cast<std::size_t>(n), nullptr);
  for (const Reading& r : readings) at[static_cast<std::size_t>(r.index)] = &r;
  const Reading* last = readings.empty() ? nullptr : &readings.front();
  for (int i = 0; i < n; ++i) {  // a lost row holds the one before
    if (at[i] != nullptr) last = at[i];
    if (last == nullptr) break;
    x[i] = last->motor_rad / rig.gear_ratio;
    q[i] = last->position;
    pressure[i] = last->pressure_bar;
  }
  const bool separate = rig.motor_encoder && rig.output_encoder;
  const Smooth link = Differentiate(q, rig.rate_Hz, width_rows);
  const Smooth motor = separate ? Differentiate(x, rig.rate_Hz, width_rows) : link;
  const Smooth gas = rig.pressure ? Differentiate(pressure, rig.rate_Hz, width_rows) : link;

  const std::vector<Term> terms = Declare(rig);
  double drive_sd = 0.0;
  std::vector<double> sd;
  std::vector<std::string> columns;
  bool known = false;
  for (const Term& term : terms) {
    if (!term.balance.empty()) continue;
    const Parameter& p = term.parameters[0];
    if (term.effect.rfind("drive", 0) == 0) {
      drive_sd = p.fixed ? 0.0 : p.tolerance;
    } else if (p.fixed) {
      known = true;
    } else {
      columns.push_back(term.effect);
      sd.push_back(std::max(1e-12, std::abs(p.nominal) * p.tolerance));
    }
  }
  Balance out;
  std::vector<int> rows;
  for (int i = 0; i < n; ++i) {
    if (usable[static_cast<std::size_t>(i)] && at[static_cast<std::size_t>(i)] != nullptr)
      rows.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(rows.size());
  out.row.reserve(rows.size());
  for (const int i : rows) out.row.push_back(i + kGridStride * recording);
  if (shows == Shows::kKinematic) {
    FillKinematic(rig, rows, at, &out);
    return out;
  }
  if (shows == Shows::kGas) {
    FillGas(rig, rows, at, link.value, gas.value, &out);
    return out;
  }

  // The drive's own scale is a column of the declared force where it is not exact.
  const bool scaled = shows == Shows::kTorque && drive_sd > 0.0;
  const auto width = static_cast<Eigen::Index>(columns.size()) + (scaled ? 1 : 0);
  out.response.resize(count);
  out.columns.setZero(count, width);
  out.prior_sd.resize(width);
  for (std::size_t c = 0; c < columns.size(); ++c)
    out.prior_sd[static_cast<Eigen::Index>(c)] = sd[c];
  if (scaled) out.prior_sd[width - 1] = drive_sd;
  for (Eigen::Index k = 0; k < count; ++k) {
    const int i = rows[static_cast<std::size_t>(k)];
    const Reading& r = *at[static_cast<std::size_t>(i)];
    const double held = HeldForce(rig, known, r, link, i);
    const double drive = shows == Shows::kLocked ? 0.0 : DriveForce(rig, r, link.velocity[i]);
    out.response[k] = drive - held;
    double force = 0.0;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double value = ValueOf(columns[c], rig, link, motor, gas, i);
      out.columns(k, static_cast<Eigen::Index>(c)) = value;
      force += value * sd[c] / kTolerance;
    }
    if (scaled) out.columns(k, width - 1) = force + held;
  }
  return out;
}

Balance Stack(const std::vector<Balance>& parts) {
  Balance out;
  Eigen::Index rows = 0;
  for (const Balance& part : parts) rows += part.response.size();
  out.response.resize(rows);
  out.columns.resize(rows, parts.front().columns.cols());
  out.prior_sd = parts.front().prior_sd;
  Eigen::Index at = 0;
  for (const Balance& part : parts) {
    out.response.segment(at, part.response.size()) = part.response;
    out.columns.middleRows(at, part.response.size()) = part.columns;
    out.row.insert(out.row.end(), part.row.begin(), part.row.end());
    at += part.response.size();
  }
  return out;
}

}  // namespace sinew::rigs
