#include "components/model/identify/processing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/statistics.h"

namespace sinew::identify {

namespace {

void Spread(std::vector<char>& flags, Eigen::Index reach) {
  const auto n = static_cast<Eigen::Index>(flags.size());
  std::vector<char> out(flags.size(), 0);
  Eigen::Index until = -1;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (flags[static_cast<std::size_t>(i)]) until = i + reach;
    if (i <= until) out[static_cast<std::size_t>(i)] = 1;
  }
  until = n;
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    if (flags[static_cast<std::size_t>(i)]) until = i - reach;
    if (i >= until) out[static_cast<std::size_t>(i)] = 1;
  }
  flags = std::move(out);
}

// Below `doubtful` the velocity is that of a lower low-pass, `slow`, unless the two differ by more
// than noise: then the motion changes too fast for it. Within `reach` rows of quicker motion, which
// smears into it, neither gives the direction: those rows are returned as flags.
std::vector<char> TakeSlowVelocity(const Eigen::VectorXd& slow, double doubtful, Eigen::Index reach,
                                   Eigen::VectorXd* v) {
  const auto n = static_cast<std::size_t>(v->size());
  std::vector<char> quick(n), unsure(n, 0);
  for (std::size_t k = 0; k < n; ++k) {
    quick[k] = std::abs((*v)[static_cast<Eigen::Index>(k)]) >= doubtful;
  }
  std::vector<char> near_quick = quick;
  Spread(near_quick, reach);
  for (std::size_t k = 0; k < n; ++k) {
    if (quick[k]) continue;
    unsure[k] = near_quick[k];
    double& at = (*v)[static_cast<Eigen::Index>(k)];
    const double slowly = slow[static_cast<Eigen::Index>(k)];
    if (std::abs(slowly - at) < doubtful) at = slowly;
  }
  return unsure;
}

// A motor that stands while the output moves (inside its play): the balance is the output's alone.
bool IsLocked(const Eigen::VectorXd& motor_at_output, const Eigen::VectorXd& output) {
  constexpr double kStandsStill = 0.05;  // of the output's range
  const auto range = [](const Eigen::VectorXd& x) { return x.maxCoeff() - x.minCoeff(); };
  return range(motor_at_output) < kStandsStill * range(output);
}

// The middle of the play in the gap's zero: encoders are set to zero anywhere, so it is the middle
// of the extreme gaps, where these are as far apart as the play is wide.
double MiddleOfPlay(const Eigen::VectorXd& gap, double play) {
  const std::vector<double> values(gap.data(), gap.data() + gap.size());
  const double low = Quantile(values, 0.005);
  const double high = Quantile(values, 0.995);
  return high - low > 0.8 * play ? 0.5 * (low + high) : 0.0;
}

// Rows in which a tooth surely carries. gap: motor / N - output, rad.
std::vector<char> Carries(const Eigen::VectorXd& gap, double play) {
  constexpr double kCarries = 0.85;  // of the half play
  const double middle = MiddleOfPlay(gap, play);
  std::vector<char> out;
  for (const double at : gap) out.push_back(std::abs(at - middle) >= kCarries * 0.5 * play);
  return out;
}

std::vector<char> Slower(const Eigen::VectorXd& v, double limit) {
  std::vector<char> out;
  for (const double at : v) out.push_back(std::abs(at) < limit);
  return out;
}

// Presliding: the teeth and seals turn over before friction has its moving value. steps: of the
// angle from row to row.
std::vector<char> Settling(const std::vector<char>& at_rest, const Eigen::VectorXd& steps,
                           double distance) {
  std::vector<char> out;
  double covered = 0.0;
  for (std::size_t k = 0; k < at_rest.size(); ++k) {
    covered = at_rest[k] ? 0.0 : covered + std::abs(steps[static_cast<Eigen::Index>(k)]);
    out.push_back(static_cast<char>(covered < distance));
  }
  return out;
}

// Times from the nearest row in which no tooth surely carries.
std::vector<double> FromContact(const std::vector<char>& carries, double period_s) {
  const std::size_t n = carries.size();
  std::vector<double> out(n, 0.0);
  const auto pass = [&](std::size_t i, double* since) {
    *since = carries[i] ? *since + period_s : 0.0;
    return *since;
  };
  double since = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i) out[i] = pass(i, &since);
  since = std::numeric_limits<double>::infinity();
  for (std::size_t i = n; i-- > 0;) out[i] = std::min(out[i], pass(i, &since));
  return out;
}

// Instants at which teeth that were apart touch again: what an impact does to the drive is over
// before a recording of some 100 Hz has seen it. Where the motor is locked, all rows at which they
// touch: they hold the output, and its balance is another. gap: motor / N - output, rad.
void MarkTouches(const Eigen::VectorXd& gap, double play, bool locked, std::vector<char>* flags) {
  // Teeth are apart for sure when the gap is this share of the half play away from both sides.
  constexpr double kApart = 0.7;
  constexpr double kTouch = 0.9;
  const double middle = MiddleOfPlay(gap, play);
  bool apart = false;
  for (Eigen::Index i = 0; i < gap.size(); ++i) {
    const double share = std::abs(gap[i] - middle) / (0.5 * play);
    if ((apart || locked) && share > kTouch) {
      (*flags)[static_cast<std::size_t>(i)] = 1;
      apart = false;
    } else if (share < kApart) {
      apart = true;
    }
  }
}

// Touches, which are kept away from like reversals, and rows whose contact still rings, which are
// left out alone.
void MarkContacts(const Eigen::VectorXd& gap, double play, bool locked, double guard_s,
                  StateSegment* segment, std::vector<char>* touches, std::vector<char>* ringing) {
  MarkTouches(gap, play, locked, touches);
  if (locked) return;
  segment->from_contact_s = FromContact(Carries(gap, play), segment->period_s);
  for (std::size_t i = 0; i < ringing->size(); ++i) {
    if (segment->from_contact_s[i] < guard_s) (*ringing)[i] = 1;
  }
}

// Fields of JointSample that a recording gives, beside those that all give.
std::set<std::string> FieldsOf(const types::Run& run) {
  std::set<std::string> fields;
  if (run.Has(types::Signal::kMotorPosition)) {
    fields.insert({"motor_position_rad", "motor_velocity_rad_s", "motor_acceleration_rad_s2"});
  }
  if (run.Has(types::Signal::kChamberPressure)) {
    fields.insert({"pressure_bar", "pressure_rate_bar_s"});
  }
  if (run.Has(types::Signal::kLoadForce)) fields.insert("load_force_N");
  if (run.Has(types::Signal::kPayload)) fields.insert("payload_kg");
  if (run.Has(types::Signal::kTemperature)) fields.insert("temperature_degC");
  if (run.Has(types::Signal::kValveOpen)) fields.insert("valve_open");
  if (!run.rigid_torque.empty() || run.rigid_torque_later) fields.insert("rigid_torque_Nm");
  return fields;
}

// Signals of a piece of a recording, and what filters and derivatives make of them.
class PieceSignals {
 public:
  PieceSignals(const types::Run& run, const UniformSegment& piece, const ProcessingOptions& options)
      : run_(run), piece_(piece), options_(options) {}

  bool Has(types::Signal signal) const { return piece_.signals.contains(signal); }
  // Empty where it was not recorded.
  Eigen::VectorXd Recorded(types::Signal signal) const {
    return Has(signal) ? piece_.signals.at(signal) : Eigen::VectorXd();
  }
  Eigen::VectorXd Raw(types::Signal signal, double fallback) const {
    return Has(signal) ? piece_.signals.at(signal)
                       : Eigen::VectorXd::Constant(piece_.size(), fallback);
  }
  // Rows that are holds have no neighbours: neither filters nor derivatives.
  Eigen::VectorXd LowPassed(const Eigen::VectorXd& x, double cutoff_Hz) const {
    if (run_.held) return x;
    return Smooth(x, options_.state_order, cutoff_Hz, piece_.rate_Hz());
  }
  Eigen::VectorXd Smoothed(const Eigen::VectorXd& x) const {
    return LowPassed(x, options_.state_cutoff_Hz);
  }
  Eigen::VectorXd RateOf(const Eigen::VectorXd& x) const {
    if (run_.held) return Eigen::VectorXd::Zero(x.size());
    return WideDifference(x, piece_.period_s);
  }
  // Smooth signals at the very instants of the rows, measured ones as they were recorded: a spline
  // through jittering stamps would take away what is fast.
  Eigen::VectorXd AtRowsOf(const Eigen::VectorXd& x) const {
    return options_.raw ? AtRows(piece_, x) : x;
  }
  Eigen::VectorXd Measured(types::Signal signal) const {
    return options_.raw ? AsMeasured(run_, piece_, signal) : piece_.signals.at(signal);
  }

 private:
  const types::Run& run_;
  const UniformSegment& piece_;
  const ProcessingOptions& options_;
};

// Motion of a piece, on its even grid.
struct Motion {
  Eigen::VectorXd q, v, a;                    // output
  std::vector<char> unsure;                   // rows without a direction
  bool locked = false;                        // the motor stands
  Eigen::VectorXd motor_q, motor_v, motor_a;  // motor shaft
};

Motion MotionOf(const types::Run& run, const UniformSegment& piece, const PieceSignals& signals,
                const actuator::JointModel& model, const ProcessingOptions& options) {
  const double ratio = model.constants.gear_ratio;
  const Eigen::VectorXd position = OutputPosition(piece, ratio, run.name);
  Motion out;
  out.q = signals.Smoothed(position);
  out.v = signals.RateOf(out.q);
  out.a = signals.RateOf(out.v);
  out.unsure.assign(piece.valid.size(), 0);
  if (options.doubtful_velocity > 0.0 && !run.held) {
    const double rows = piece.rate_Hz() / options.slow_cutoff_Hz;
    out.unsure = TakeSlowVelocity(
        signals.RateOf(signals.LowPassed(position, options.slow_cutoff_Hz)),
        options.doubtful_velocity, static_cast<Eigen::Index>(std::lround(rows)), &out.v);
  }
  if (!signals.Has(types::Signal::kMotorPosition)) {
    out.motor_q = ratio * out.q;
    out.motor_v = ratio * out.v;
    out.motor_a = ratio * out.a;
    return out;
  }
  const Eigen::VectorXd motor = signals.Recorded(types::Signal::kMotorPosition);
  out.locked = options.raw && IsLocked(motor / ratio, out.q);
  out.motor_q = signals.LowPassed(
      motor, options.motor_cutoff_Hz > 0.0 ? options.motor_cutoff_Hz : options.state_cutoff_Hz);
  out.motor_v = signals.RateOf(out.motor_q);
  if (out.locked) out.motor_v.setZero();
  out.motor_a = signals.RateOf(out.motor_v);
  return out;
}

// The motor's angle of each row: torque that repeats with an angle belongs to the very angle of its
// row.
Eigen::VectorXd MotorAngles(const Motion& motion, const PieceSignals& signals, double ratio,
                            bool raw) {
  if (!raw) return motion.motor_q;
  if (signals.Has(types::Signal::kMotorPosition)) {
    return signals.Measured(types::Signal::kMotorPosition);
  }
  if (signals.Has(types::Signal::kPosition))
    return ratio * signals.Measured(types::Signal::kPosition);
  return signals.AtRowsOf(ratio * motion.q);
}

// Input that drives, row by row.
Eigen::VectorXd DriveInput(types::Signal drive, const PieceSignals& signals, const Motion& motion,
                           const actuator::JointModel& model) {
  Eigen::VectorXd input = signals.Measured(drive);
  // Teeth that a locked motor holds hand nothing on inside the play: its current is noise.
  if (motion.locked) return Eigen::VectorXd::Zero(input.size());
  // A voltage on the winding drives only what the turning motor leaves of it; an open bridge
  // nothing.
  if (drive == types::Signal::kDriveVoltage && model.constants.back_emf_V_s_rad > 0.0) {
    const Eigen::VectorXd supply = signals.Recorded(types::Signal::kSupplyVoltage);
    input -= model.constants.back_emf_V_s_rad * signals.AtRowsOf(motion.motor_v);
    for (Eigen::Index i = 0; i < supply.size(); ++i) {
      if (supply[i] == 0.0) input[i] = 0.0;
    }
  }
  return input;
}

// The load cell is the response where the motor is locked, a regressor elsewhere. silent: it
// measured nothing but its noise.
Eigen::VectorXd LoadForce(const PieceSignals& signals, bool locked, bool raw, bool* silent) {
  const Eigen::VectorXd rows = signals.Raw(types::Signal::kLoadForce, 0.0);
  if (raw && signals.Has(types::Signal::kLoadForce)) {
    // An unloaded load cell would add its noise to the balance, so it is replaced by its mean.
    const double sigma = WhiteNoise(std::span(&rows, 1));
    const double variance = (rows.array() - rows.mean()).square().mean();
    *silent = sigma * sigma > kMostNoise * variance;
    if (locked) return signals.Measured(types::Signal::kLoadForce);
    if (*silent) return signals.AtRowsOf(Eigen::VectorXd::Constant(rows.size(), rows.mean()));
  }
  return signals.AtRowsOf(raw && !locked ? signals.Smoothed(rows) : rows);
}

void FillSamples(const UniformSegment& piece, const PieceSignals& signals, const Motion& motion,
                 const Eigen::VectorXd& motor_angles, const Eigen::VectorXd& force,
                 const Eigen::VectorXd& rigid, StateSegment* segment) {
  const Eigen::VectorXd jerk = signals.RateOf(motion.a);
  const Eigen::VectorXd input = signals.Smoothed(segment->drive_input);
  segment->drive_rate = signals.AtRowsOf(signals.RateOf(input));
  const Eigen::VectorXd pressure =
      signals.Smoothed(signals.Raw(types::Signal::kChamberPressure, 0.0));
  using Field = double effects::JointSample::*;
  using effects::JointSample;
  const std::vector<std::pair<Field, Eigen::VectorXd>> columns = {
      {&JointSample::position_rad, signals.AtRowsOf(motion.q)},
      {&JointSample::velocity_rad_s, signals.AtRowsOf(motion.v)},
      {&JointSample::acceleration_rad_s2, signals.AtRowsOf(motion.a)},
      {&JointSample::jerk_rad_s3, signals.AtRowsOf(jerk)},
      {&JointSample::snap_rad_s4, signals.AtRowsOf(signals.RateOf(jerk))},
      {&JointSample::motor_position_rad, motor_angles},
      {&JointSample::motor_velocity_rad_s, signals.AtRowsOf(motion.motor_v)},
      {&JointSample::motor_acceleration_rad_s2, signals.AtRowsOf(motion.motor_a)},
      {&JointSample::drive_input, signals.AtRowsOf(input)},
      {&JointSample::drive_rate, segment->drive_rate},
      {&JointSample::pressure_bar, signals.AtRowsOf(pressure)},
      {&JointSample::pressure_rate_bar_s, signals.AtRowsOf(signals.RateOf(pressure))},
      {&JointSample::load_force_N, force},
      {&JointSample::payload_kg, signals.Raw(types::Signal::kPayload, 0.0)},
      {&JointSample::temperature_degC, signals.Raw(types::Signal::kTemperature, 25.0)},
      {&JointSample::rigid_torque_Nm, rigid}};
  const Eigen::VectorXd valve = signals.Raw(types::Signal::kValveOpen, 0.0);
  segment->samples.resize(piece.valid.size());
  for (Eigen::Index i = 0; i < piece.size(); ++i) {
    JointSample& x = segment->samples[static_cast<std::size_t>(i)];
    x.time_s = piece.Time(i);
    x.valve_open = valve[i] > 0.5;
    for (const auto& [field, values] : columns) x.*field = values[i];
  }
}

// Marks the rows that a moving model may be fitted to, and why not the others.
void MarkRows(const types::Run& run, const UniformSegment& piece, const Motion& motion,
              const actuator::JointModel& model, const ProcessingOptions& options,
              StateSegment* segment) {
  const double rate = piece.rate_Hz();
  segment->at_rest = Slower(motion.v, run.held ? 0.0 : options.rest_velocity);
  // A quick reversal may have no row that is slow enough.
  for (std::size_t i = 1; options.raw && !run.held && i < segment->samples.size(); ++i) {
    if (segment->samples[i - 1].velocity_rad_s * segment->samples[i].velocity_rad_s > 0.0) continue;
    segment->at_rest[i - 1] = segment->at_rest[i] = 1;
  }
  const auto guard = static_cast<Eigen::Index>(std::lround(options.reversal_guard_s * rate));
  std::vector<char> near_rest = segment->at_rest, touches(piece.valid.size(), 0);
  std::vector<char> ringing = touches, settling = touches;
  Spread(near_rest, guard);
  if (piece.signals.contains(types::Signal::kMotorPosition) && model.backlash_rad > 0.0) {
    MarkContacts(motion.motor_q / model.constants.gear_ratio - motion.q, model.backlash_rad,
                 motion.locked, options.contact_guard_s, segment, &touches, &ringing);
    Spread(touches, guard);
  }
  if (!run.held) {
    settling = Settling(segment->at_rest, motion.v * piece.period_s, options.settle_distance);
  }
  const auto border =
      run.held ? Eigen::Index{0} : static_cast<Eigen::Index>(std::lround(options.border_s * rate));
  for (Eigen::Index i = 0; i < piece.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    segment->use.push_back(!piece.valid[k]                            ? RowUse::kHole
                           : i < border || i >= piece.size() - border ? RowUse::kBorder
                           : segment->at_rest[k] || motion.unsure[k]  ? RowUse::kRest
                           : near_rest[k]                             ? RowUse::kReversal
                           : touches[k] || ringing[k]                 ? RowUse::kContact
                           : settling[k]                              ? RowUse::kSettling
                                                                      : RowUse::kUsed);
    segment->usable.push_back(static_cast<char>(segment->use.back() == RowUse::kUsed));
  }
}

StateSegment MakeSegment(const types::Run& run, const UniformSegment& piece, std::size_t number,
                         const actuator::JointModel& model, const ProcessingOptions& options,
                         StateSet* all) {
  const types::Signal drive = DriveSignal(model);
  const PieceSignals signals(run, piece, options);
  const Motion motion = MotionOf(run, piece, signals, model, options);
  all->locked = all->locked || motion.locked;
  StateSegment out;
  out.run = static_cast<int>(all->run_names.size()) - 1;
  out.start_s = piece.start_s;
  out.period_s = piece.period_s;
  out.held = run.held;
  if (!run.rigid_columns.empty()) out.rigid_columns = run.rigid_columns.at(number);
  out.drive_input = DriveInput(drive, signals, motion, model);
  out.drive_signal = signals.Measured(drive);
  out.reference_position = signals.Recorded(types::Signal::kReferencePosition);
  out.supply_voltage = signals.Recorded(types::Signal::kSupplyVoltage);
  out.valid = piece.valid;
  bool silent = true;
  const Eigen::VectorXd force = LoadForce(signals, motion.locked, options.raw, &silent);
  all->silent_load = all->silent_load && silent;
  FillSamples(
      piece, signals, motion, MotorAngles(motion, signals, model.constants.gear_ratio, options.raw),
      force,
      run.rigid_torque.empty() ? Eigen::VectorXd::Zero(piece.size()) : run.rigid_torque.at(number),
      &out);
  MarkRows(run, piece, motion, model, options, &out);
  return out;
}

}  // namespace

StateSet MakeStates(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                    const ProcessingOptions& options) {
  if (runs.empty()) throw std::invalid_argument("no recording given");
  StateSet out;
  out.measured = {"time_s",         "drive_input",         "drive_rate",  "position_rad",
                  "velocity_rad_s", "acceleration_rad_s2", "jerk_rad_s3", "snap_rad_s4"};
  if (model.backlash_rad == 0.0) {  // a rigid gear: the motor's motion is known from the output's
    out.measured.insert(
        {"motor_position_rad", "motor_velocity_rad_s", "motor_acceleration_rad_s2"});
  }
  const std::set<std::string> always = out.measured;
  for (const types::Run& run : runs) {
    if (run.kind != model.kind) {
      throw std::invalid_argument("recording " + run.name +
                                  " is of another joint kind than joint '" + model.name +
                                  "' of the model");
    }
    const bool first = out.run_names.empty();
    const std::set<std::string> fields = FieldsOf(run);
    if (first) out.measured.insert(fields.begin(), fields.end());
    std::erase_if(out.measured, [&](const std::string& field) {
      return !always.contains(field) && !fields.contains(field);
    });
    run.At(DriveSignal(model));  // says which signal is missing
    const UniformRun uniform = MakeUniform(run, options.longest_gap_s);
    out.rigid_mean = run.rigid_mean;
    out.rigid_spread = run.rigid_spread;
    out.run_names.push_back(run.name);
    if (first) out.rate_Hz = uniform.sampling.rate_Hz;
    for (std::size_t number = 0; number < uniform.segments.size(); ++number) {
      out.segments.push_back(
          MakeSegment(run, uniform.segments[number], number, model, options, &out));
    }
  }
  for (const actuator::Term& term : model.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.balance != effects::Balance::kMotion) continue;  // not every recording shows those
    for (const std::string& field : info.needs) {
      if (out.measured.contains(field)) continue;
      throw std::invalid_argument("recording " + runs.front().name + " does not give '" + field +
                                  "', which the term '" + info.name + "' of joint '" + model.name +
                                  "' reads");
    }
  }
  return out;
}

}  // namespace sinew::identify
