#include "components/identify/data_gate.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

namespace sinew::identify {

namespace {

std::string Format(const char* format, double a, double b = 0.0) {
  char text[160];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

// Share of samples that sit at the largest absolute value, three or more in a row.
double SaturatedShare(const Eigen::VectorXd& x) {
  const double limit = x.cwiseAbs().maxCoeff();
  if (!(limit > 0.0)) return 0.0;
  Eigen::Index saturated = 0;
  Eigen::Index spell = 0;
  for (Eigen::Index i = 0; i <= x.size(); ++i) {
    if (i < x.size() && std::abs(x[i]) >= (1.0 - 1e-6) * limit) {
      ++spell;
      continue;
    }
    if (spell >= 3) saturated += spell;
    spell = 0;
  }
  return static_cast<double>(saturated) / static_cast<double>(x.size());
}

// Smallest step between neighbouring samples; 0 when more than half of the steps differ.
double Resolution(const Eigen::VectorXd& x) {
  std::vector<double> steps;
  for (Eigen::Index i = 1; i < x.size(); ++i) {
    const double step = std::abs(x[i] - x[i - 1]);
    if (step > 0.0) steps.push_back(step);
  }
  if (steps.size() < 50) return 0.0;
  std::sort(steps.begin(), steps.end());
  const double smallest = steps.front();
  std::size_t whole = 0;
  for (const double step : steps) {
    const double ratio = step / smallest;
    if (std::abs(ratio - std::round(ratio)) < 0.02) ++whole;
  }
  return whole > 0.95 * static_cast<double>(steps.size()) ? smallest : 0.0;
}

}  // namespace

double VelocityLag(const Eigen::Ref<const Eigen::VectorXd>& measured,
                   const Eigen::Ref<const Eigen::VectorXd>& velocity,
                   const Eigen::Ref<const Eigen::VectorXd>& acceleration, double least_speed) {
  double aa = 0.0;
  double ad = 0.0;
  for (Eigen::Index i = 0; i < measured.size(); ++i) {
    if (std::abs(velocity[i]) < least_speed) continue;
    aa += acceleration[i] * acceleration[i];
    ad += acceleration[i] * (velocity[i] - measured[i]);
  }
  return aa > 0.0 ? ad / aa : 0.0;
}

std::vector<Finding> ExamineData(const std::vector<Run>& runs, const StateSet& states,
                                 const actuator::JointModel& model) {
  std::vector<Finding> out;
  Eigen::Index lost = 0;
  Eigen::Index dropped = 0;
  double jitter = 0.0;
  bool even = true;
  bool stamps = true;
  for (const SamplingReport& sampling : states.sampling) {
    lost += sampling.lost_rows;
    dropped += sampling.dropped_rows;
    jitter = std::max(jitter, sampling.jitter_rms_s);
    even = even && sampling.even;
    stamps = stamps && sampling.stamps_used;
  }
  out.push_back({"rate", Format("sampled at %.4g Hz", states.rate_Hz), states.rate_Hz, "Hz"});
  if (!even) {
    out.push_back(
        {"jitter",
         Format("stamps scatter by %.2f ms rms about an even grid; ", 1e3 * jitter) +
             (stamps ? "they make the position smoother than row numbers do, so they are used"
                     : "row numbers make the position smoother, so stamps are not used"),
         jitter, "s"});
  }
  if (lost > 0) {
    out.push_back(
        {"lost_rows",
         Format("%.0f rows are lost; what lies around them is left out", static_cast<double>(lost)),
         static_cast<double>(lost), "rows"});
  }
  if (dropped > 0) {
    out.push_back(
        {"dropped_rows",
         Format("%.0f rows lie in pieces too short to be used", static_cast<double>(dropped)),
         static_cast<double>(dropped), "rows"});
  }
  const Signal drive = DriveSignal(model);
  double saturated = 0.0;
  for (const Run& run : runs) saturated = std::max(saturated, SaturatedShare(run.At(drive)));
  if (saturated > 1e-3) {
    out.push_back(
        {"saturation",
         Format("the drive sits at its limit for %.1f %% of a recording", 100.0 * saturated),
         saturated, "1"});
  }
  for (const Signal signal : {Signal::kPosition, Signal::kChamberPressure}) {
    if (!runs.front().Has(signal)) continue;
    const double step = Resolution(runs.front().At(signal));
    if (step > 0.0) {
      const std::string unit(SignalUnit(signal, model.kind));
      out.push_back(
          {"resolution",
           std::string(SignalName(signal)) + " comes in steps of " + Format("%.3g ", step) + unit,
           step, unit});
    }
  }
  std::set<std::string> constant;
  for (const auto& [signal, values] : runs.front().signals) {
    bool moves = false;
    for (const Run& run : runs) {
      if (run.Has(signal)) {
        moves = moves || run.At(signal).maxCoeff() - run.At(signal).minCoeff() > 0.0;
      }
    }
    if (!moves) constant.insert(std::string(SignalName(signal)));
  }
  for (const std::string& name : constant) {
    out.push_back({"constant", name + " never changes: its effects cannot be seen", 0.0, ""});
  }
  // Velocity columns against the derivative of their angle, first piece of the first recording.
  const UniformRun uniform = MakeUniform(runs.front());
  const UniformSegment& piece = uniform.segments.front();
  const StateSegment& segment = states.segments.front();
  const auto lag = [&](Signal signal, auto velocity, auto acceleration) {
    const auto found = piece.signals.find(signal);
    if (found == piece.signals.end() || found->second.size() != segment.size()) return;
    Eigen::VectorXd v(segment.size());
    Eigen::VectorXd a(segment.size());
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      v[i] = velocity(segment.samples[static_cast<std::size_t>(i)]);
      a[i] = acceleration(segment.samples[static_cast<std::size_t>(i)]);
    }
    const double rms = std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
    const double late_s = VelocityLag(found->second, v, a, 0.2 * rms);
    if (std::abs(late_s) < 0.1 * segment.period_s) return;
    out.push_back(
        {"lag_" + std::string(SignalName(signal)),
         std::string(SignalName(signal)) +
             Format(late_s > 0 ? " lags its angle by %.1f ms; " : " leads its angle by %.1f ms; ",
                    1e3 * std::abs(late_s)) +
             "angles are differentiated instead",
         late_s, "s"});
  };
  lag(
      Signal::kVelocity, [](const effects::JointSample& x) { return x.velocity_rad_s; },
      [](const effects::JointSample& x) { return x.acceleration_rad_s2; });
  lag(
      Signal::kMotorVelocity, [](const effects::JointSample& x) { return x.motor_velocity_rad_s; },
      [](const effects::JointSample& x) { return x.motor_acceleration_rad_s2; });
  return out;
}

}  // namespace sinew::identify
