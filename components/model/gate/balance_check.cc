// Sign and units by the declared model: is there a reading of one channel (reversed, in another
// unit) with which it fits far better?
//
//     min over theta in [nominal / k, nominal k]:  || eta D + sum theta_i phi_i + c ||^2,  k^2 = 10
//
// D: drive, phi: the effects of the declared terms at locally smoothed states; drive and states
// pass the same local cubics. Friction and inertia stay positive by the bounds: a drive that does
// no work against them cannot be fitted, which is the balance of energy.
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "components/base/types/angle.h"
#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"
#include "components/model/identify/processing.h"

namespace sinew::gate {

namespace {

using actuator::JointModel;
using types::Run;
using types::Signal;

constexpr std::size_t kMostInstants = 4000;

enum class Channel { kNone, kDrive, kAngles, kPressure, kLoad, kPayload, kTime };

struct Reading {
  const char* rule;
  Channel channel;
  double factor;  // what is recorded times this is what the mapping declares
  const char* words;
  bool rotary_only = false;
};
using types::kPi;
constexpr Reading kReadings[] = {
    {"drive_sign", Channel::kDrive, -1.0, "with its sign reversed"},
    {"units", Channel::kAngles, kPi / 180.0, "as degrees", true},
    {"units", Channel::kAngles, 2.0 * kPi, "as turns", true},
    {"units", Channel::kAngles, 180.0 / kPi, "as radians declared in degrees", true},
    {"units", Channel::kAngles, 1e-3, "as thousandths (mm, mrad)"},
    {"units", Channel::kAngles, 0.01, "as hundredths (cm)"},
    {"units", Channel::kAngles, 1e3, "as a thousand times the declared unit"},
    {"units", Channel::kDrive, 1e-3, "as thousandths (mA, mV, mNm)"},
    {"units", Channel::kDrive, 0.01, "as hundredths (per cent, cNm)"},
    {"units", Channel::kDrive, 1e3, "as thousands (kN, kV)"},
    {"units", Channel::kDrive, 100.0, "as a hundred times the declared unit"},
    {"units", Channel::kPressure, 0.01, "as kPa"},
    {"units", Channel::kPressure, 1e-5, "as Pa"},
    {"units", Channel::kPressure, 0.0689476, "as psi"},
    {"units", Channel::kPressure, 10.0, "as MPa"},
    {"units", Channel::kLoad, 9.80665, "as kgf"},
    {"units", Channel::kLoad, 1e-3, "as mN"},
    {"units", Channel::kLoad, 1e3, "as kN"},
    {"units", Channel::kLoad, -1.0, "with its sign reversed"},
    {"units", Channel::kPayload, 1e-3, "as grams"},
    {"units", Channel::kTime, 1e-3, "as milliseconds"},
    {"units", Channel::kTime, 1e3, "as thousands of seconds"},
};

// Locally smoothed channels of the recordings, at the instants where the joint moves.
struct States {
  std::vector<effects::JointSample> samples;  // drive_input: as recorded
  Eigen::VectorXd weight;
};

std::optional<States> MakeStates(const Run& run, Signal drive, double gear_ratio) {
  std::vector<Signal> signals;
  for (const Signal signal :
       {Signal::kPosition, Signal::kMotorPosition, drive, Signal::kChamberPressure,
        Signal::kLoadForce, Signal::kPayload, Signal::kTemperature}) {
    if (run.Has(signal)) signals.push_back(signal);
  }
  if (!run.Has(drive) || !run.Has(Signal::kPosition)) return std::nullopt;
  const double half = HalfWidth_s(run, Signal::kPosition);
  const std::vector<double> at = Centres(run, half, kMostInstants);
  if (at.size() < 50) return std::nullopt;
  const auto local = LocalCubics(run, signals, half, at);
  const Eigen::VectorXd& rate = local.at(Signal::kPosition).rate;
  const double least = 0.1 * std::sqrt(rate.squaredNorm() / static_cast<double>(rate.size()));
  States out;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    if (!(std::abs(rate[i]) > least)) continue;
    effects::JointSample x;
    const auto value = [&](Signal signal, double otherwise) {
      const auto found = local.find(signal);
      return found == local.end() ? otherwise : found->second.value[i];
    };
    x.time_s = at[k];
    x.position_rad = value(Signal::kPosition, 0.0);
    x.velocity_rad_s = rate[i];
    x.acceleration_rad_s2 = local.at(Signal::kPosition).acceleration[i];
    if (const auto motor = local.find(Signal::kMotorPosition); motor != local.end()) {
      x.motor_position_rad = motor->second.value[i];
      x.motor_velocity_rad_s = motor->second.rate[i];
      x.motor_acceleration_rad_s2 = motor->second.acceleration[i];
    } else {
      x.motor_position_rad = gear_ratio * x.position_rad;
      x.motor_velocity_rad_s = gear_ratio * x.velocity_rad_s;
      x.motor_acceleration_rad_s2 = gear_ratio * x.acceleration_rad_s2;
    }
    x.drive_input = value(drive, 0.0);
    x.pressure_bar = value(Signal::kChamberPressure, 0.0);
    x.load_force_N = value(Signal::kLoadForce, 0.0);
    x.payload_kg = value(Signal::kPayload, 0.0);
    x.temperature_degC = value(Signal::kTemperature, 25.0);
    out.samples.push_back(x);
  }
  if (out.samples.size() < 30) return std::nullopt;
  return out;
}

effects::JointSample Read(effects::JointSample x, Channel channel, double factor) {
  switch (channel) {
    case Channel::kNone:
      break;
    case Channel::kDrive:
      x.drive_input *= factor;
      break;
    case Channel::kAngles:
      for (double* value :
           {&x.position_rad, &x.velocity_rad_s, &x.acceleration_rad_s2, &x.motor_position_rad,
            &x.motor_velocity_rad_s, &x.motor_acceleration_rad_s2}) {
        *value *= factor;
      }
      break;
    case Channel::kPressure:
      x.pressure_bar *= factor;
      break;
    case Channel::kLoad:
      x.load_force_N *= factor;
      break;
    case Channel::kPayload:
      x.payload_kg *= factor;
      break;
    case Channel::kTime:
      x.velocity_rad_s /= factor;
      x.motor_velocity_rad_s /= factor;
      x.acceleration_rad_s2 /= factor * factor;
      x.motor_acceleration_rad_s2 /= factor * factor;
      break;
  }
  return x;
}

struct Box {
  double low = 0.0, high = 0.0;
};

// Half an order of magnitude about the declared value, more where its tolerance is wider.
Box BoxOf(const actuator::ParameterValue& value, const effects::ParameterInfo& info) {
  const double k = std::sqrt(10.0);
  const double size = std::abs(value.value);
  if (value.value == 0.0) return {value.fixed ? 0.0 : info.lower, value.fixed ? 0.0 : info.upper};
  if (!value.fixed && value.tolerance >= 0.9) {
    const double wide = size * k * (1.0 + value.tolerance);
    return {info.lower < 0.0 ? -wide : 0.0, wide};
  }
  return value.value > 0.0 ? Box{size / k, size * k} : Box{-size * k, -size / k};
}

// Share of the drive's variance that the model leaves within the boxes.
double LeftShare(const std::vector<const States*>& parts, const JointModel& model, Channel channel,
                 double factor) {
  std::vector<const actuator::Term*> terms;
  std::vector<Box> boxes;
  const actuator::Term* drive = nullptr;
  for (const actuator::Term& term : model.terms) {
    if (!model.Counts(term)) continue;
    if (term.effect->info().role == effects::Role::kDrive) {
      drive = &term;
      continue;
    }
    terms.push_back(&term);
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      boxes.push_back(BoxOf(term.linear[i], term.effect->info().linear[i]));
    }
  }
  Eigen::Index rows = 0;
  for (const States* part : parts) rows += static_cast<Eigen::Index>(part->samples.size());
  const auto n = static_cast<Eigen::Index>(boxes.size());
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(rows, n);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(rows);
  std::array<double, effects::kMaxParameters> phi{};
  // As identify does: what the winding sees is left after the back-EMF.
  const double back_emf = identify::DriveSignal(model) == Signal::kDriveVoltage
                              ? model.constants.back_emf_V_s_rad
                              : 0.0;
  Eigen::Index row = 0;
  for (const States* part : parts) {
    std::vector<std::vector<double>> memory;
    memory.reserve(terms.size());
    for (const actuator::Term* term : terms) {
      memory.emplace_back(static_cast<std::size_t>(term->effect->memory_size()));
    }
    bool first = true;
    effects::JointSample last;
    for (const effects::JointSample& sample : part->samples) {
      effects::JointSample at = Read(sample, channel, factor);
      at.drive_input -= back_emf * at.motor_velocity_rad_s;
      const std::vector<double> none = actuator::NonlinearValues(*drive);
      drive->effect->Regressors(at, none, {}, std::span(phi.data(), drive->linear.size()));
      y[row] = -drive->linear.front().value * phi[0];
      Eigen::Index column = 0;
      for (std::size_t t = 0; t < terms.size(); ++t) {
        const std::vector<double> psi = actuator::NonlinearValues(*terms[t]);
        if (first) {
          terms[t]->effect->ResetMemory(at, psi, memory[t]);
        } else {
          terms[t]->effect->Advance(at, at.time_s - last.time_s, psi, memory[t]);
        }
        terms[t]->effect->Regressors(at, psi, memory[t],
                                     std::span(phi.data(), terms[t]->linear.size()));
        for (std::size_t i = 0; i < terms[t]->linear.size(); ++i) x(row, column++) = phi[i];
      }
      last = at;
      first = false;
      ++row;
    }
  }
  if (!x.allFinite() || !y.allFinite()) return 1.0;
  y.array() -= y.mean();
  x.rowwise() -= x.colwise().mean().eval();
  const double all = y.squaredNorm();
  if (!(all > 0.0)) return 1.0;
  const Eigen::MatrixXd gram = x.transpose() * x;
  const Eigen::VectorXd right = x.transpose() * y;
  Eigen::VectorXd theta(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Box& box = boxes[static_cast<std::size_t>(i)];
    theta[i] = std::clamp(0.5 * (box.low + box.high), box.low, box.high);
    if (box.low > 0.0) theta[i] = std::sqrt(box.low * box.high);
  }
  for (int sweep = 0; sweep < 400; ++sweep) {  // coordinate descent: the problem is convex
    for (Eigen::Index i = 0; i < n; ++i) {
      if (!(gram(i, i) > 0.0)) continue;
      const Box& box = boxes[static_cast<std::size_t>(i)];
      const double step = (right[i] - gram.row(i).dot(theta)) / gram(i, i);
      theta[i] = std::clamp(theta[i] + step, box.low, box.high);
    }
  }
  return (y - x * theta).squaredNorm() / all;
}

bool Reads(const JointModel& model, const std::vector<Run>& runs, Channel channel) {
  const auto has = [&](Signal signal) {
    return std::any_of(runs.begin(), runs.end(), [&](const Run& run) {
      return run.Has(signal) && Range(run.At(signal)) > 0.0;
    });
  };
  switch (channel) {
    case Channel::kPressure:
      return has(Signal::kChamberPressure) && model.Find("pneumatic_torque") >= 0;
    case Channel::kLoad:
      return has(Signal::kLoadForce) && model.Find("load_force") >= 0;
    case Channel::kPayload:
      return has(Signal::kPayload) && model.Find("declared_payload") >= 0;
    default:
      return true;
  }
}

std::string ChannelName(Channel channel, Signal drive) {
  switch (channel) {
    case Channel::kAngles:
      return "position";
    case Channel::kPressure:
      return "chamber_pressure";
    case Channel::kLoad:
      return "load_force";
    case Channel::kPayload:
      return "payload";
    case Channel::kTime:
      return "time";
    default:
      return std::string(types::SignalName(drive));
  }
}

struct Best {
  const Reading* reading = nullptr;
  double statistic = 0.0, as_declared = 0.0, otherwise = 0.0;
};

constexpr double kHalf = 0.5;   // a reading that leaves more explains nothing
constexpr double kTenth = 0.1;  // of the drive: less than this no declared model need leave

std::vector<Measurement> Compare(const std::vector<const States*>& parts, const JointModel& model,
                                 const std::vector<Run>& runs, Signal drive, const Run* run) {
  const double declared = LeftShare(parts, model, Channel::kNone, 1.0);
  Best best[2];
  for (const Reading& reading : kReadings) {
    if (!Reads(model, runs, reading.channel)) continue;
    if (reading.rotary_only && model.kind == types::JointKind::kLinear) continue;
    const double left = LeftShare(parts, model, reading.channel, reading.factor);
    const double statistic = left > kHalf ? 0.0 : declared / (left + kTenth);
    Best& at = best[std::string_view(reading.rule) == "units"];
    if (statistic > at.statistic) at = {&reading, statistic, declared, left};
  }
  // The better of the two rules speaks.
  std::vector<Measurement> out;
  for (const int which : {0, 1}) {
    const Best& at = best[which];
    if (at.reading == nullptr) continue;
    const bool second = at.statistic < best[1 - which].statistic;
    Measurement measured;
    measured.rule = at.reading->rule;
    measured.signal = ChannelName(at.reading->channel, drive);
    if (run != nullptr) {
      measured.recording = run->name;
      measured.last_row = run->size() - 1;
      measured.from_s = run->time_s[0];
      measured.to_s = run->time_s[run->size() - 1];
    }
    measured.statistic = second ? std::min(at.statistic, 1.0) : at.statistic;
    measured.reason = "read " + std::string(at.reading->words) + " the declared model leaves " +
                      Number(100.0 * at.otherwise) + " % of the drive, as it is mapped " +
                      Number(100.0 * at.as_declared) + " %.";
    measured.remedy =
        at.reading->factor < 0.0
            ? "Turn the sign of this channel in the mapping (or of the angles, if they are wrong)."
            : "Correct the unit of this channel in the mapping, or the declared values.";
    out.push_back(std::move(measured));
  }
  return out;
}

}  // namespace

std::vector<Measurement> CheckBalance(const std::vector<Run>& runs, const JointModel& model) {
  std::vector<Measurement> out;
  if (model.Find("rigid_body") >= 0 || runs.empty()) return out;
  int drives = 0;
  for (const actuator::Term& term : model.terms) {
    drives += model.Counts(term) && term.effect->info().role == effects::Role::kDrive;
  }
  if (drives != 1) return out;
  const Signal drive = identify::DriveSignal(model);
  std::vector<States> states;
  std::vector<const Run*> of;
  for (const Run& run : runs) {
    if (run.held) continue;
    if (std::optional<States> at = MakeStates(run, drive, model.constants.gear_ratio)) {
      states.push_back(std::move(*at));
      of.push_back(&run);
    }
  }
  for (std::size_t k = 0; k < states.size(); ++k) {
    for (Measurement& at : Compare({&states[k]}, model, runs, drive, of[k])) {
      out.push_back(std::move(at));
    }
  }
  // All together only where none of them says it alone.
  const bool said = std::any_of(out.begin(), out.end(), [](const Measurement& at) {
    return at.statistic > FindRule(at.rule).limit;
  });
  if (states.size() > 1 && !said) {
    std::vector<const States*> all;
    all.reserve(states.size());
    for (const States& part : states) all.push_back(&part);
    for (Measurement& at : Compare(all, model, runs, drive, nullptr)) out.push_back(std::move(at));
  }
  return out;
}

}  // namespace sinew::gate
