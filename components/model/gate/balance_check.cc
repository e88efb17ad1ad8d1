// Sign, units and zero by the declared model: is there a reading of one channel (reversed, in
// another unit, from another zero) with which it fits far better?
//
//     min over theta in [nominal / k, nominal k]:  || eta D + sum theta_i phi_i + c ||^2,  k^2 = 10
//
// D: drive, phi: the effects of the declared terms at locally smoothed states; drive and states
// pass the same local cubics. Friction and inertia stay positive by the bounds: a drive that does
// no work against them cannot be fitted, which is the balance of energy.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "components/base/types/angle.h"
#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"
#include "components/model/identify/processing.h"
#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using actuator::JointModel;
using types::Run;
using types::Signal;

constexpr std::size_t kMostInstants = 4000;

enum class Channel {
  kNone,
  kDrive,
  kMagnitude,  // of the drive: it is given the sign of the speed
  kAngles,
  kZero,  // of the output's angle
  kPressure,
  kLoad,
  kPayload,
  kTime
};

struct Reading {
  const char* rule;
  Channel channel;
  double factor;  // what is recorded times this is what the mapping declares; kZero: plus this, rad
  const char* words;
  bool rotary_only = false;
};
using types::kPi;
constexpr Reading kAsDeclared = {"", Channel::kNone, 1.0, ""};
constexpr Reading kReadings[] = {
    {"drive_sign", Channel::kDrive, -1.0, "with its sign reversed"},
    {"drive_sign", Channel::kMagnitude, 1.0, "as a magnitude, with the sign of the speed,"},
    {"zero", Channel::kZero, -0.5 * kPi, "a quarter turn lower", true},
    {"zero", Channel::kZero, 0.5 * kPi, "a quarter turn higher", true},
    {"zero", Channel::kZero, kPi, "half a turn higher", true},
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

// Half an order of magnitude: how far a declared value may be off, and how near two readings are
// one, because a declared value makes up for their difference.
constexpr double kHalfOrder = 3.16227766;

// Locally smoothed channels of a recording, at the instants where the joint moves.
struct Part {
  const Run* run = nullptr;
  std::vector<effects::JointSample> samples;  // drive_input: as recorded
};

std::optional<Part> MakePart(const Run& run, Signal drive, double gear_ratio) {
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
  const double least = 0.1 * identify::Rms(rate);
  Part out;
  out.run = &run;
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

effects::JointSample Read(effects::JointSample x, const Reading& reading) {
  const double factor = reading.factor;
  switch (reading.channel) {
    case Channel::kNone:
      break;
    case Channel::kDrive:
      x.drive_input *= factor;
      break;
    case Channel::kMagnitude:
      x.drive_input = std::copysign(x.drive_input, x.velocity_rad_s);
      break;
    case Channel::kZero:
      x.position_rad += factor;
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
  const double k = kHalfOrder;
  const double size = std::abs(value.value);
  if (value.value == 0.0) return {value.fixed ? 0.0 : info.lower, value.fixed ? 0.0 : info.upper};
  if (!value.fixed && value.tolerance >= 0.9) {
    const double wide = size * k * (1.0 + value.tolerance);
    return {info.lower < 0.0 ? -wide : 0.0, wide};
  }
  return value.value > 0.0 ? Box{size / k, size * k} : Box{-size * k, -size / k};
}

using Parts = std::vector<const Part*>;

// x theta = y at every instant, theta within its boxes: the declared terms against the drive.
struct Equations {
  Eigen::MatrixXd x;
  Eigen::VectorXd y;
  std::vector<Box> boxes;
};

// Rows of one recording from `row` on; returns the row after them.
Eigen::Index FillRows(const Part& part, const JointModel& model, const Reading& reading,
                      const std::vector<const actuator::Term*>& terms, const actuator::Term& drive,
                      Eigen::Index row, Equations* out) {
  // As identify does: what the winding sees is left after the back-EMF.
  const double back_emf = identify::DriveSignal(model) == Signal::kDriveVoltage
                              ? model.constants.back_emf_V_s_rad
                              : 0.0;
  std::array<double, effects::kMaxParameters> phi{};
  std::vector<std::vector<double>> memory;
  memory.reserve(terms.size());
  for (const actuator::Term* term : terms) {
    memory.emplace_back(static_cast<std::size_t>(term->effect->memory_size()));
  }
  bool first = true;
  effects::JointSample last;
  for (const effects::JointSample& sample : part.samples) {
    effects::JointSample at = Read(sample, reading);
    at.drive_input -= back_emf * at.motor_velocity_rad_s;
    const std::vector<double> none = actuator::NonlinearValues(drive);
    drive.effect->Regressors(at, none, {}, std::span(phi.data(), drive.linear.size()));
    out->y[row] = -drive.linear.front().value * phi[0];
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
      for (std::size_t i = 0; i < terms[t]->linear.size(); ++i) out->x(row, column++) = phi[i];
    }
    last = at;
    first = false;
    ++row;
  }
  return row;
}

Equations MakeEquations(const Parts& parts, const JointModel& model, const Reading& reading) {
  Equations out;
  std::vector<const actuator::Term*> terms;
  const actuator::Term* drive = nullptr;
  for (const actuator::Term& term : model.terms) {
    if (!model.Counts(term)) continue;
    if (term.effect->info().role == effects::Role::kDrive) {
      drive = &term;
      continue;
    }
    terms.push_back(&term);
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      out.boxes.push_back(BoxOf(term.linear[i], term.effect->info().linear[i]));
    }
  }
  Eigen::Index rows = 0;
  for (const Part* part : parts) rows += static_cast<Eigen::Index>(part->samples.size());
  out.x.setZero(rows, static_cast<Eigen::Index>(out.boxes.size()));
  out.y.setZero(rows);
  Eigen::Index row = 0;
  for (const Part* part : parts) {
    row = FillRows(*part, model, reading, terms, *drive, row, &out);
  }
  return out;
}

// Share of the drive's variance that the model leaves within the boxes.
double LeftShare(Equations at) {
  if (at.x.cols() == 0 || !at.x.allFinite() || !at.y.allFinite()) return 1.0;
  at.y.array() -= at.y.mean();
  at.x.rowwise() -= at.x.colwise().mean().eval();
  const double all = at.y.squaredNorm();
  if (!(all > 0.0)) return 1.0;
  const Eigen::MatrixXd gram = at.x.transpose() * at.x;
  const Eigen::VectorXd right = at.x.transpose() * at.y;
  Eigen::VectorXd theta(at.x.cols());
  for (Eigen::Index i = 0; i < theta.size(); ++i) {
    const Box& box = at.boxes[static_cast<std::size_t>(i)];
    theta[i] = std::clamp(0.5 * (box.low + box.high), box.low, box.high);
    if (box.low > 0.0) theta[i] = std::sqrt(box.low * box.high);
  }
  for (int sweep = 0; sweep < 400; ++sweep) {  // coordinate descent: the problem is convex
    for (Eigen::Index i = 0; i < theta.size(); ++i) {
      if (!(gram(i, i) > 0.0)) continue;
      const Box& box = at.boxes[static_cast<std::size_t>(i)];
      const double step = (right[i] - gram.row(i).dot(theta)) / gram(i, i);
      theta[i] = std::clamp(theta[i] + step, box.low, box.high);
    }
  }
  return (at.y - at.x * theta).squaredNorm() / all;
}

constexpr double kHalf = 0.5;   // a reading that leaves more explains nothing
constexpr double kTenth = 0.1;  // of the drive: less than this no declared model need leave

// Does the drive change by more than no declared model need explain? At one held speed it does
// not: what is left beside the constant is noise, which any term of the right size follows.
bool DriveChanges(const Eigen::VectorXd& y) {
  return (y.array() - y.mean()).matrix().squaredNorm() > kTenth * kTenth * y.squaredNorm();
}

// Never negative although the joint moves in both directions.
bool IsMagnitude(const Part& part, Signal drive) {
  const Eigen::VectorXd& x = part.run->At(drive);
  if (x.minCoeff() < 0.0 && x.maxCoeff() > 0.0) return false;
  const auto forward =
      std::count_if(part.samples.begin(), part.samples.end(),
                    [](const effects::JointSample& sample) { return sample.velocity_rad_s > 0.0; });
  const double share = static_cast<double>(forward) / static_cast<double>(part.samples.size());
  return share > kTenth && share < 1.0 - kTenth;
}

// Can these recordings be read so, and does the model have a term to which it matters?
bool Applies(const Reading& reading, const JointModel& model, const Parts& parts, Signal drive) {
  if (reading.rotary_only && model.kind == types::JointKind::kPrismatic) return false;
  const auto any = [&](Signal signal) {
    return std::any_of(parts.begin(), parts.end(), [&](const Part* part) {
      return part->run->Has(signal) && Range(part->run->At(signal)) > 0.0;
    });
  };
  switch (reading.channel) {
    case Channel::kMagnitude:
      return std::all_of(parts.begin(), parts.end(),
                         [&](const Part* part) { return IsMagnitude(*part, drive); });
    case Channel::kZero:
      return model.Find("gravity") >= 0 &&
             std::none_of(parts.begin(), parts.end(), [](const Part* part) {
               return part->run->zero_unknown.contains(Signal::kPosition);
             });
    case Channel::kPressure:
      return any(Signal::kChamberPressure) && model.Find("pneumatic_torque") >= 0;
    case Channel::kLoad:
      return any(Signal::kLoadForce) && model.Find("load_force") >= 0;
    case Channel::kPayload:
      return any(Signal::kPayload) && model.Find("declared_payload") >= 0;
    default:
      return true;
  }
}

std::string ChannelName(Channel channel, Signal drive) {
  switch (channel) {
    case Channel::kAngles:
    case Channel::kZero:
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

std::string RemedyOf(const Reading& reading) {
  if (reading.channel == Channel::kZero) {
    return "Add " + Number(reading.factor) + " rad (" +
           Number(reading.factor / types::kDegree_rad) +
           " degrees) to the angle: key `offset` of signals.position in the mapping, in the unit "
           "of its column and before its `sign`.";
  }
  if (reading.channel == Channel::kMagnitude) {
    return "Map a column that holds the drive with its sign; a column of 1 and -1 is multiplied "
           "with it by the key `times`.";
  }
  if (reading.factor < 0.0) {
    return "Turn the sign of this channel in the mapping (or of the angles, if they are wrong).";
  }
  return "Correct the unit of this channel in the mapping, or the declared values.";
}

// The best reading under one rule, with what the gate reports of it.
struct Best {
  const Reading* reading = nullptr;
  Measurement measured;
};

// The best reading under each rule; the best of all speaks, the others stay below their limits.
std::vector<Best> Compare(const Parts& parts, const JointModel& model, Signal drive) {
  const Equations as_declared = MakeEquations(parts, model, kAsDeclared);
  if (!DriveChanges(as_declared.y)) return {};
  const double declared = LeftShare(as_declared);
  std::vector<Best> out;
  for (const Reading& reading : kReadings) {
    if (!Applies(reading, model, parts, drive)) continue;
    const double left = LeftShare(MakeEquations(parts, model, reading));
    const double statistic = left > kHalf ? 0.0 : declared / (left + kTenth);
    auto at = std::find_if(out.begin(), out.end(),
                           [&](const Best& best) { return best.measured.rule == reading.rule; });
    if (!(statistic > (at == out.end() ? 0.0 : at->measured.statistic))) continue;
    if (at == out.end()) at = out.insert(out.end(), Best{});
    at->reading = &reading;
    Measurement& measured = at->measured;
    measured.rule = reading.rule;
    measured.signal = ChannelName(reading.channel, drive);
    measured.statistic = statistic;
    measured.reason = "read " + std::string(reading.words) + " the declared model leaves " +
                      Number(100.0 * left) + " % of the drive, as it is mapped " +
                      Number(100.0 * declared) + " %.";
    measured.remedy = RemedyOf(reading);
    if (parts.size() > 1) continue;
    const Run& run = *parts.front()->run;
    measured.recording = run.name;
    measured.last_row = run.size() - 1;
    measured.from_s = run.time_s[0];
    measured.to_s = run.time_s[run.size() - 1];
  }
  double most = 0.0;
  for (const Best& best : out) most = std::max(most, best.measured.statistic);
  for (Best& best : out) {
    double& statistic = best.measured.statistic;
    if (statistic < most) statistic = std::min(statistic, 1.0);
  }
  return out;
}

bool IsFault(const Best& best) {
  return best.measured.statistic > FindRule(best.measured.rule).limit;
}

// Readings that a declared value can make one.
bool Agree(const Reading& a, const Reading& b) {
  if (a.channel != b.channel) return false;
  if (a.channel == Channel::kZero) return a.factor == b.factor;
  const double ratio = a.factor / b.factor;
  return ratio > 1.0 / kHalfOrder && ratio < kHalfOrder;
}

// A machine is mapped once: recordings that ask for different readings under one rule show that
// none of them is it. Returns whether there are such; they stay below their limits then.
bool SilenceContradictions(std::vector<Best>* found) {
  std::set<std::string> rules;
  for (const Best& a : *found) {
    for (const Best& b : *found) {
      if (!IsFault(a) || !IsFault(b) || a.measured.rule != b.measured.rule) continue;
      if (!Agree(*a.reading, *b.reading)) rules.insert(a.measured.rule);
    }
  }
  for (Best& best : *found) {
    double& statistic = best.measured.statistic;
    if (rules.contains(best.measured.rule)) statistic = std::min(statistic, 1.0);
  }
  return !rules.empty();
}

}  // namespace

std::vector<Measurement> CheckBalance(const std::vector<Run>& runs, const JointModel& model) {
  if (model.Find("rigid_body") >= 0 || runs.empty()) return {};
  const std::optional<Signal> only = OnlyDrive(model);
  if (!only) return {};
  const Signal drive = *only;
  std::vector<Part> parts;
  for (const Run& run : runs) {
    if (run.held) continue;
    if (std::optional<Part> part = MakePart(run, drive, model.constants.gear_ratio)) {
      parts.push_back(std::move(*part));
    }
  }
  std::vector<Best> found;
  Parts all;
  for (const Part& part : parts) {
    Append(Compare({&part}, model, drive), &found);
    all.push_back(&part);
  }
  // All together only where none of them says it alone, and they do not contradict each other.
  const bool contradict = SilenceContradictions(&found);
  if (all.size() > 1 && !contradict && std::none_of(found.begin(), found.end(), IsFault)) {
    Append(Compare(all, model, drive), &found);
  }
  std::vector<Measurement> out;
  out.reserve(found.size());
  for (Best& best : found) out.push_back(std::move(best.measured));
  return out;
}

}  // namespace sinew::gate
