#include "components/model/identify/processing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/spectrum.h"
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

}  // namespace

StateSet MakeStates(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                    const ProcessingOptions& options) {
  if (runs.empty()) throw std::invalid_argument("no recording given");
  const types::Signal drive = DriveSignal(model);
  StateSet out;
  out.measured = {"time_s",         "drive_input",         "drive_rate",  "position_rad",
                  "velocity_rad_s", "acceleration_rad_s2", "jerk_rad_s3", "snap_rad_s4"};
  std::set<std::string> always = out.measured;
  if (model.backlash_rad == 0.0) {  // a rigid gear: the motor's motion is known from the output's
    always.insert({"motor_position_rad", "motor_velocity_rad_s", "motor_acceleration_rad_s2"});
    out.measured = always;
  }
  bool first = true;
  for (const types::Run& run : runs) {
    if (run.kind != model.kind) {
      throw std::invalid_argument("recording " + run.name +
                                  " is of another joint kind than joint '" + model.name +
                                  "' of the model");
    }
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
    if (first) {
      out.measured.insert(fields.begin(), fields.end());
    } else {
      std::erase_if(out.measured, [&](const std::string& field) {
        return !always.contains(field) && !fields.contains(field);
      });
    }
    run.At(drive);  // says which signal is missing

    const UniformRun uniform = MakeUniform(run, options.longest_gap_s);
    out.rigid_mean = run.rigid_mean;
    out.rigid_spread = run.rigid_spread;
    const int index = static_cast<int>(out.run_names.size());
    out.run_names.push_back(run.name);
    out.run_hashes.push_back(run.content_hash);
    if (first) out.rate_Hz = uniform.sampling.rate_Hz;
    first = false;

    for (std::size_t number = 0; number < uniform.segments.size(); ++number) {
      const UniformSegment& piece = uniform.segments[number];
      const Eigen::VectorXd rigid = run.rigid_torque.empty() ? Eigen::VectorXd::Zero(piece.size())
                                                             : run.rigid_torque.at(number);
      const double rate = piece.rate_Hz();
      const double dt = piece.period_s;
      // Rows that are holds have no neighbours: neither filters nor derivatives.
      const auto smooth = [&](const Eigen::VectorXd& x) {
        if (run.held) return x;
        return Smooth(x, options.state_order, options.state_cutoff_Hz, rate);
      };
      const auto rate_of = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        if (run.held) return Eigen::VectorXd::Zero(x.size());
        return WideDifference(x, dt);
      };
      const auto raw = [&](types::Signal signal, double fallback) -> Eigen::VectorXd {
        const auto found = piece.signals.find(signal);
        if (found == piece.signals.end()) return Eigen::VectorXd::Constant(piece.size(), fallback);
        return found->second;
      };
      const auto filtered = [&](types::Signal signal, double fallback) {
        return smooth(raw(signal, fallback));
      };
      const double ratio = model.constants.gear_ratio;
      const Eigen::VectorXd q = smooth(OutputPosition(piece, ratio, run.name));
      Eigen::VectorXd v = rate_of(q);
      const Eigen::VectorXd a = rate_of(v);
      std::vector<char> unsure(piece.valid.size(), 0);
      if (options.doubtful_velocity > 0.0 && !run.held) {
        unsure = TakeSlowVelocity(
            rate_of(Smooth(OutputPosition(piece, ratio, run.name), options.state_order,
                           options.slow_cutoff_Hz, rate)),
            options.doubtful_velocity,
            static_cast<Eigen::Index>(std::lround(rate / options.slow_cutoff_Hz)), &v);
      }
      const Eigen::VectorXd jerk = rate_of(a);
      const Eigen::VectorXd snap = rate_of(jerk);
      const bool motor = piece.signals.contains(types::Signal::kMotorPosition);
      const bool locked = options.raw && motor &&
                          IsLocked(piece.signals.at(types::Signal::kMotorPosition) / ratio, q);
      out.locked = out.locked || locked;
      // Smooth signals at the very instants of the rows, measured ones as they were recorded: a
      // spline through jittering stamps would take away what is fast.
      const auto at_rows = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd {
        return options.raw ? AtRows(piece, x) : x;
      };
      const auto measured = [&](types::Signal signal) -> Eigen::VectorXd {
        return options.raw ? AsMeasured(run, piece, signal) : piece.signals.at(signal);
      };
      const Eigen::VectorXd motor_raw =
          motor ? piece.signals.at(types::Signal::kMotorPosition) : Eigen::VectorXd(ratio * q);
      const Eigen::VectorXd motor_rows =
          motor ? measured(types::Signal::kMotorPosition)
          : options.raw && piece.signals.contains(types::Signal::kPosition)
              ? Eigen::VectorXd(ratio * measured(types::Signal::kPosition))
              : at_rows(ratio * q);
      const double motor_cutoff_Hz =
          options.motor_cutoff_Hz > 0.0 ? options.motor_cutoff_Hz : options.state_cutoff_Hz;
      const Eigen::VectorXd motor_q =
          motor && !run.held ? Smooth(motor_raw, options.state_order, motor_cutoff_Hz, rate)
                             : motor_raw;
      Eigen::VectorXd motor_v = motor ? rate_of(motor_q) : Eigen::VectorXd(ratio * v);
      if (locked) motor_v.setZero();
      std::vector<char> at_rest = Slower(v, run.held ? 0.0 : options.rest_velocity);
      const Eigen::VectorXd motor_a = motor ? rate_of(motor_v) : Eigen::VectorXd(ratio * a);
      const auto recorded = [&](types::Signal signal) -> Eigen::VectorXd {
        const auto found = piece.signals.find(signal);
        return found == piece.signals.end() ? Eigen::VectorXd() : found->second;
      };
      const Eigen::VectorXd signal = measured(drive);
      const Eigen::VectorXd supply = recorded(types::Signal::kSupplyVoltage);
      // A voltage on the winding drives only what the turning motor leaves of it; an open bridge
      // nothing.
      Eigen::VectorXd input = signal;
      if (drive == types::Signal::kDriveVoltage && model.constants.back_emf_V_s_rad > 0.0) {
        input -= model.constants.back_emf_V_s_rad * at_rows(motor_v);
        for (Eigen::Index i = 0; i < supply.size(); ++i) {
          if (supply[i] == 0.0) input[i] = 0.0;
        }
      }
      // Teeth that a locked motor holds hand nothing on inside the play: its current is noise.
      if (locked) input.setZero();
      const Eigen::VectorXd input_smooth = smooth(input);
      const Eigen::VectorXd input_rate = rate_of(input_smooth);
      const Eigen::VectorXd pressure = filtered(types::Signal::kChamberPressure, 0.0);
      const Eigen::VectorXd pressure_rate = rate_of(pressure);
      // The load cell is the response where the motor is locked, a regressor elsewhere.
      Eigen::VectorXd force = options.raw && !locked ? filtered(types::Signal::kLoadForce, 0.0)
                                                     : raw(types::Signal::kLoadForce, 0.0);
      if (options.raw && run.Has(types::Signal::kLoadForce)) {
        // An unloaded load cell would add its noise to the balance, so it is replaced by its mean.
        const Eigen::VectorXd force_rows = raw(types::Signal::kLoadForce, 0.0);
        const double sigma = WhiteNoise(std::span(&force_rows, 1));
        const double variance = (force_rows.array() - force_rows.mean()).square().mean();
        if (sigma * sigma > kMostNoise * variance) {
          force.setConstant(force_rows.mean());
        } else {
          out.silent_load = false;
        }
      }
      const Eigen::VectorXd payload = raw(types::Signal::kPayload, 0.0);
      const Eigen::VectorXd temperature = raw(types::Signal::kTemperature, 25.0);
      const Eigen::VectorXd valve = raw(types::Signal::kValveOpen, 0.0);

      const Eigen::VectorXd row_q = at_rows(q), row_v = at_rows(v), row_a = at_rows(a),
                            row_jerk = at_rows(jerk), row_snap = at_rows(snap),
                            row_motor_v = at_rows(motor_v), row_motor_a = at_rows(motor_a),
                            row_input = at_rows(input_smooth), row_input_rate = at_rows(input_rate),
                            row_pressure = at_rows(pressure),
                            row_pressure_rate = at_rows(pressure_rate),
                            row_force = locked && run.Has(types::Signal::kLoadForce)
                                            ? measured(types::Signal::kLoadForce)
                                            : at_rows(force);
      StateSegment segment;
      segment.run = index;
      segment.start_s = piece.start_s;
      segment.period_s = dt;
      segment.held = run.held;
      if (!run.rigid_columns.empty()) segment.rigid_columns = run.rigid_columns.at(number);
      segment.drive_input = input;
      segment.drive_rate = row_input_rate;
      segment.drive_signal = signal;
      segment.reference_position = recorded(types::Signal::kReferencePosition);
      segment.supply_voltage = supply;
      segment.valid = piece.valid;
      segment.samples.resize(piece.valid.size());
      segment.at_rest = std::move(at_rest);
      for (Eigen::Index i = 0; i < piece.size(); ++i) {
        effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
        x.time_s = piece.Time(i);
        x.position_rad = row_q[i];
        x.velocity_rad_s = row_v[i];
        x.acceleration_rad_s2 = row_a[i];
        x.jerk_rad_s3 = row_jerk[i];
        x.snap_rad_s4 = row_snap[i];
        // Torque that repeats with an angle belongs to the very angle of its row.
        x.motor_position_rad = options.raw ? motor_rows[i] : motor_q[i];
        x.motor_velocity_rad_s = row_motor_v[i];
        x.motor_acceleration_rad_s2 = row_motor_a[i];
        x.drive_input = row_input[i];
        x.drive_rate = row_input_rate[i];
        x.pressure_bar = row_pressure[i];
        x.pressure_rate_bar_s = row_pressure_rate[i];
        x.load_force_N = row_force[i];
        x.payload_kg = payload[i];
        x.temperature_degC = temperature[i];
        x.valve_open = valve[i] > 0.5;
        x.rigid_torque_Nm = rigid[i];
      }
      // A quick reversal may have no row that is slow enough.
      for (Eigen::Index i = 1; options.raw && !run.held && i < piece.size(); ++i) {
        if (row_v[i - 1] * row_v[i] > 0.0) continue;
        segment.at_rest[static_cast<std::size_t>(i - 1)] = 1;
        segment.at_rest[static_cast<std::size_t>(i)] = 1;
      }
      const auto guard = static_cast<Eigen::Index>(std::lround(options.reversal_guard_s * rate));
      std::vector<char> near_rest = segment.at_rest, touches(piece.valid.size(), 0);
      std::vector<char> ringing = touches, settling = touches;
      Spread(near_rest, guard);
      if (motor && model.backlash_rad > 0.0) {
        MarkContacts(motor_q / ratio - q, model.backlash_rad, locked, options.contact_guard_s,
                     &segment, &touches, &ringing);
        Spread(touches, guard);
      }
      if (!run.held) settling = Settling(segment.at_rest, v * dt, options.settle_distance);
      const auto border = run.held
                              ? Eigen::Index{0}
                              : static_cast<Eigen::Index>(std::lround(options.border_s * rate));
      for (Eigen::Index i = 0; i < piece.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        segment.use.push_back(!piece.valid[k]                            ? RowUse::kHole
                              : i < border || i >= piece.size() - border ? RowUse::kBorder
                              : segment.at_rest[k] || unsure[k]          ? RowUse::kRest
                              : near_rest[k]                             ? RowUse::kReversal
                              : touches[k] || ringing[k]                 ? RowUse::kContact
                              : settling[k]                              ? RowUse::kSettling
                                                                         : RowUse::kUsed);
        segment.usable.push_back(static_cast<char>(segment.use.back() == RowUse::kUsed));
      }
      out.segments.push_back(std::move(segment));
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
