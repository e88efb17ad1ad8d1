#include "components/model/identify/processing_settings.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/spectrum.h"
#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

namespace {

using types::kTwoPi;
// Standard deviations of its noise from which on the sign of a velocity is sure: one wrong sign in
// two million rows.
constexpr double kSureVelocity = 5.0;
// Share of the velocity's power that the low-pass of an angle lets pass in any case: what it takes
// shows as an oscillator in the residual.
constexpr double kMotionShare = 0.999;
// Torque noise that the acceleration may bring, share of the drive torque: three times what
// identification of robots reaches, most of it beyond the motion's band and so whitened away.
constexpr double kNoiseShare = 0.03;
// The same as a share of the drive's own noise: a motion that nearly repeats lets other columns
// stand for the acceleration, and what they gain is its noise. Less than what counts as explained
// (1.5 %).
constexpr double kUnseenShare = 0.01;
// Share of the 75th percentile of speed that counts as rest. Rows slower than a share of the
// highest speed (its 99.5th percentile) are none of those: a joint may rest most of the time.
constexpr double kRestShare = 0.03, kSurelyRests = 0.01;
// Factor by which the low-pass of slow motion is lower: its velocity has a fifteenth of the noise.
constexpr double kSlower = 6.0;
// Low-pass of the angles, forward and backward. What it lets pass of white noise that is
// differentiated once or twice, over f^3 or f^5; and its periods that a reversal is kept away from:
// what friction does there rings for as long in the derivatives.
struct LowPass {
  int order;
  double passed_once, passed_twice, guard_periods;
};
// Nearly an ideal one; e^(-4 pi sin 22.5 deg) = 0.008 of a transient is left behind the guard.
constexpr LowPass kSteep = {4, 1.0 / 3.0, 1.0 / 5.0, 2.0};
// The smoother of least error for accelerations that are white beside white noise (Wiener; the
// cubic smoothing spline), 1 / (1 + (f / f0)^4); the integrals of x^2 and x^4 over (1 + x^4)^2 are
// both pi / (8 sqrt 2), and e^(-2 pi sin 45 deg) = 0.012 is left. For a motor with an encoder of
// its own: where teeth touch it stops within a row, and a steep filter rings long after each
// impact.
constexpr LowPass kSoft = {2, 0.2777, 0.2777, 1.0};
// By whether the motor has an encoder of its own.
const LowPass& LowPassOf(const types::Run& run) {
  return run.Has(types::Signal::kMotorPosition) ? kSoft : kSteep;
}
// Share of the moving time that guards leave at least: where a motion reverses quickly, rows near
// reversals are better than none.
constexpr double kLeastKept = 1.0 / 3.0;

// Measured torques and currents have white noise of this share of their rms, and more. One with
// less than the second share was low-passed before it was recorded.
constexpr double kQuietestDrive = 6e-4, kNoNoise = 1e-5;

// The band of such recordings, as far as their drive stands above the noise that it lost; 0: they
// were not low-passed.
double BandOfEarlierFilter(const std::vector<types::Run>& runs, types::Signal drive,
                           double longest_gap_s) {
  double band_Hz = 0.0;
  for (const types::Run& run : runs) {
    for (const UniformSegment& segment : MakeUniform(run, longest_gap_s).segments) {
      const Eigen::VectorXd x = AsMeasured(run, segment, drive);
      const double rms = Rms(x.array() - x.mean());
      if (!(rms > 0.0) || WhiteNoise(std::span(&x, 1)) > kNoNoise * rms) return 0.0;
      const double rate_Hz = segment.rate_Hz();
      const double level = std::pow(kQuietestDrive * rms, 2) / (0.5 * rate_Hz);
      band_Hz = std::max(band_Hz, PowerDensity(x, rate_Hz).BandAbove(level));
    }
  }
  return band_Hz;
}

// The quick speed of a motion that may rest at times.
double SpeedOfMotion(std::vector<double> speeds) {
  const double still = kSurelyRests * Quantile(speeds, 0.995);
  speeds.erase(std::remove_if(speeds.begin(), speeds.end(), [&](double v) { return v < still; }),
               speeds.end());
  return Quantile(std::move(speeds), 0.75);
}

// Velocity behind a low-pass at f that has to be exceeded for the sign to be sure. Noise:
// (2 pi)^2 S passed f^3. Rounding of a slow motion, a saw of the resolution's size and first
// harmonic step / pi: up to 2 pi f step / pi.
double SureVelocity(const LowPass& low_pass, double density, double step, double cutoff_Hz) {
  const double noise = kTwoPi * std::sqrt(low_pass.passed_once * density * std::pow(cutoff_Hz, 3));
  return std::max(kSureVelocity * noise, 2.0 * step * cutoff_Hz);
}

// Times of motion from rest or reversal to the next, s: a stroke begins with a fifth of the quick
// speed and ends at rest or with as much to the other side.
void AppendStrokes(const Eigen::VectorXd& velocity, double period_s, std::vector<double>* out) {
  const Eigen::VectorXd speed = velocity.cwiseAbs();
  const double quick = SpeedOfMotion(std::vector<double>(speed.begin(), speed.end()));
  const double swing = 0.2 * quick, rest = kRestShare * quick;
  int side = 0;
  Eigen::Index since = 0;
  for (Eigen::Index i = 0; i < velocity.size(); ++i) {
    const int now = velocity[i] > swing    ? 1
                    : velocity[i] < -swing ? -1
                    : speed[i] < rest      ? 0
                                           : side;
    if (now == side) continue;
    if (side != 0) out->push_back(static_cast<double>(i - since) * period_s);
    side = now;
    since = i;
  }
  if (side != 0) out->push_back(static_cast<double>(velocity.size() - since) * period_s);
}

// The longest guard, up to `wished`, that leaves the least share of the strokes.
double GuardFor(const std::vector<double>& strokes_s, double wished) {
  double all = 0.0;
  for (const double stroke : strokes_s) all += stroke;
  double guard = wished;
  for (int i = 0; i < 20; ++i, guard *= 0.8) {
    double kept = 0.0;
    for (const double stroke : strokes_s) kept += std::max(0.0, stroke - 2.0 * guard);
    if (kept >= kLeastKept * all) break;
  }
  return guard;
}

// The band of an angle: as far as the torque noise that its acceleration brings in all,
// J^2 (2 pi)^4 S passed f^5, stays a small share of the drive's (quiet_Hz); the motion itself
// passes, as far as that noise stays below a share of the drive torque as well: a servo's command
// repeats the noise of its angle, and would allow too much.
struct AngleBand {
  double band_Hz = 0.0, quiet_Hz = 0.0;
};
AngleBand BandOf(const Eigen::VectorXd& angle, double rate, double inertia,
                 const Eigen::VectorXd& drive_torque, const LowPass& low_pass) {
  const Spectrum spectrum = PowerDensity(angle, rate);
  const double above_noise =
      std::min(spectrum.HighestBandAboveNoise(), spectrum.BandOfLeastError(2));
  const double of_angle = inertia * inertia * spectrum.Noise();
  const double drive_noise = PowerDensity(drive_torque, rate).Noise();
  if (!(of_angle > 0.0) || !(drive_noise > 0.0)) return {above_noise, 0.0};
  const auto bringing = [&](double variance) {
    return std::pow(variance / (low_pass.passed_twice * of_angle), 0.2) / std::pow(kTwoPi, 0.8);
  };
  const double quiet = bringing(kUnseenShare * drive_noise * 0.5 * rate);
  const double torque = kNoiseShare * Rms(drive_torque);
  return {std::min({above_noise, bringing(torque * torque),
                    std::max(quiet, spectrum.BandOfMotion(kMotionShare))}),
          std::min(above_noise, quiet)};
}

}  // namespace

double NominalDriveGain(const actuator::JointModel& model) {
  for (const actuator::Term& term : model.terms) {
    if (term.effect->info().role != effects::Role::kDrive || !model.Counts(term)) continue;
    // A share of the ideal gain (an efficiency), or torque per volt itself.
    const bool share = term.effect->info().linear.front().dimension == effects::Dimension::kNone;
    return term.linear.front().value * (share ? effects::IdealDriveGain(model.constants) : 1.0);
  }
  return 1.0;
}

double NominalInertia(const actuator::JointModel& model, effects::Side side) {
  double sum = 0.0;
  for (const actuator::Term& term : model.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.role == effects::Role::kInertia && info.side == side && model.Counts(term)) {
      sum += term.linear.front().value;
    }
  }
  return sum;
}

types::Signal DriveSignal(const actuator::JointModel& model) {
  const actuator::Term* drive = nullptr;
  for (const actuator::Term& term : model.terms) {
    const effects::EffectInfo& info = term.effect->info();
    if (info.role != effects::Role::kDrive || info.balance != effects::Balance::kMotion) continue;
    if (drive != nullptr) {
      throw std::invalid_argument("joint '" + model.name + "' has more than one drive term");
    }
    drive = &term;
  }
  if (drive == nullptr) {
    throw std::invalid_argument("joint '" + model.name +
                                "' has no drive term, expected drive_current, drive_voltage or "
                                "drive_torque");
  }
  const std::string& name = drive->effect->info().name;
  if (name.find("voltage") != std::string::npos) return types::Signal::kDriveVoltage;
  if (name.find("torque") != std::string::npos) return types::Signal::kTorque;
  return types::Signal::kMotorCurrent;
}

ProcessingOptions Resolve(const ProcessingOptions& options, const std::vector<types::Run>& runs) {
  ProcessingOptions out = options;
  if (runs.empty()) throw std::invalid_argument("no recording given");
  if (out.state_cutoff_Hz > 0.0 && out.parallel_cutoff_Hz > 0.0 && out.rest_velocity > 0.0) {
    return out;
  }
  if (runs.front().held) {  // nothing is filtered: any settled values do
    if (!(out.state_cutoff_Hz > 0.0)) out.state_cutoff_Hz = 1.0;
    if (!(out.parallel_cutoff_Hz > 0.0)) out.parallel_cutoff_Hz = 0.25;
    if (!(out.rest_velocity > 0.0)) out.rest_velocity = 1e-3;
    return out;
  }
  const UniformRun uniform = MakeUniform(runs.front(), out.longest_gap_s);
  const UniformSegment& segment = *std::max_element(
      uniform.segments.begin(), uniform.segments.end(),
      [](const UniformSegment& a, const UniformSegment& b) { return a.size() < b.size(); });
  const double rate = segment.rate_Hz();
  const Eigen::VectorXd position = OutputPosition(segment, 1.0, runs.front().name);
  const Eigen::VectorXd velocity =
      WideDifference(Smooth(position, 4, 0.1 * rate, rate), segment.period_s);
  if (!(out.state_cutoff_Hz > 0.0)) {
    out.state_cutoff_Hz =
        std::clamp(PowerDensity(position, rate).BandAboveNoise(), 0.02 * rate, 0.25 * rate);
  }
  if (!(out.parallel_cutoff_Hz > 0.0)) out.parallel_cutoff_Hz = 0.25 * out.state_cutoff_Hz;
  if (!(out.rest_velocity > 0.0)) {
    out.rest_velocity =
        0.03 * std::sqrt(velocity.squaredNorm() / static_cast<double>(velocity.size()));
  }
  return out;
}

ProcessingOptions FromMotion(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                             double longest_gap_s, double wider, double least_Hz) {
  ProcessingOptions out;
  out.longest_gap_s = longest_gap_s;
  if (runs.empty()) throw std::invalid_argument("no recording given");
  if (runs.front().held) return Resolve(out, runs);
  const types::Signal drive_signal = DriveSignal(model);
  for (const types::Run& run : runs) run.At(drive_signal);  // says which is missing
  if (const double band_Hz = BandOfEarlierFilter(runs, drive_signal, longest_gap_s);
      band_Hz > 0.0) {
    // Half of it: what the earlier filter took from one side is gone from both.
    out.parallel_cutoff_Hz = 0.5 * band_Hz;
    return Resolve(out, runs);
  }
  const LowPass& low_pass = LowPassOf(runs.front());
  out.state_order = low_pass.order;
  const double drive_gain = NominalDriveGain(model);
  const double output_inertia =
      NominalInertia(model, effects::Side::kOutput) + runs.front().rigid_inertia;
  const double motor_inertia = NominalInertia(model, effects::Side::kMotor);
  double output_Hz = least_Hz, motor_Hz = 0.0, nyquist_Hz = 0.0;
  double density = 0.0, step = 0.0;  // of the position: noise, resolution
  std::vector<double> speeds, strokes_s;
  for (const types::Run& run : runs) {
    const bool output = run.Has(types::Signal::kPosition);
    step = std::max(step, output ? Resolution(run.At(types::Signal::kPosition))
                                 : Resolution(run.At(types::Signal::kMotorPosition)) /
                                       model.constants.gear_ratio);
    for (const UniformSegment& segment : MakeUniform(run, longest_gap_s).segments) {
      const double rate = segment.rate_Hz();
      nyquist_Hz = std::max(nyquist_Hz, 0.5 * rate);
      const auto drive = segment.signals.find(drive_signal);
      const Eigen::VectorXd drive_torque = drive == segment.signals.end()
                                               ? Eigen::VectorXd()
                                               : Eigen::VectorXd(drive_gain * drive->second);
      const Eigen::VectorXd position =
          OutputPosition(segment, model.constants.gear_ratio, run.name);
      output_Hz = std::max(output_Hz,
                           BandOf(position, rate, output_inertia, drive_torque, low_pass).band_Hz);
      const auto motor = segment.signals.find(types::Signal::kMotorPosition);
      if (motor != segment.signals.end()) {
        motor_Hz = std::max(motor_Hz, BandOf(motor->second / model.constants.gear_ratio, rate,
                                             motor_inertia, drive_torque, low_pass)
                                          .band_Hz);
      }
      density = std::max(density, PowerDensity(position, rate).Noise());
      const Eigen::VectorXd velocity =
          WideDifference(Smooth(position, out.state_order, std::max(output_Hz, 1e-3 * rate), rate),
                         segment.period_s);
      for (const double v : velocity) speeds.push_back(std::abs(v));
      AppendStrokes(velocity, segment.period_s, &strokes_s);
    }
  }
  // The wide difference is exact within a per cent up to this part of the Nyquist frequency.
  const double widest_Hz = 0.6 * nyquist_Hz;
  const auto within = [&](double frequency_Hz) {
    return std::clamp(frequency_Hz, 0.005 * nyquist_Hz, widest_Hz);
  };
  out.state_cutoff_Hz = within(wider * output_Hz);
  out.motor_cutoff_Hz = motor_Hz > 0.0 ? within(wider * motor_Hz) : 0.0;
  out.parallel_cutoff_Hz = nyquist_Hz;  // none
  out.raw = true;
  const auto sure_velocity = [&](double cutoff_Hz) {
    return SureVelocity(low_pass, density, step, cutoff_Hz);
  };
  out.slow_cutoff_Hz = out.state_cutoff_Hz / kSlower;
  out.doubtful_velocity = sure_velocity(out.state_cutoff_Hz);
  // Motion slower than this part of its quick half sticks and slips.
  out.rest_velocity =
      std::max(sure_velocity(out.slow_cutoff_Hz), kRestShare * SpeedOfMotion(std::move(speeds)));
  out.reversal_guard_s = GuardFor(strokes_s, low_pass.guard_periods / out.state_cutoff_Hz);
  out.border_s = 2.0 / out.state_cutoff_Hz;
  return out;
}

double QuietBand(const std::vector<types::Run>& runs, const actuator::JointModel& model,
                 double longest_gap_s) {
  const types::Signal drive_signal = DriveSignal(model);
  const double inertia = NominalInertia(model, effects::Side::kOutput);
  double out_Hz = 0.0;
  for (const types::Run& run : runs) {
    for (const UniformSegment& segment : MakeUniform(run, longest_gap_s).segments) {
      const auto drive = segment.signals.find(drive_signal);
      if (drive == segment.signals.end()) continue;
      const AngleBand band = BandOf(OutputPosition(segment, model.constants.gear_ratio, run.name),
                                    segment.rate_Hz(), inertia + run.rigid_inertia,
                                    NominalDriveGain(model) * drive->second, LowPassOf(run));
      out_Hz = std::max(out_Hz, band.quiet_Hz);
    }
  }
  return out_Hz;
}

ProcessingOptions Unfiltered(const ProcessingOptions& motion, double rate_Hz) {
  ProcessingOptions out = motion;
  out.parallel_cutoff_Hz = 0.5 * rate_Hz;
  return out;
}

}  // namespace sinew::identify
