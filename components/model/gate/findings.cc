// Findings on a recording, which need not stop: stamps, lost rows, saturation, resolution, lags.
#include <algorithm>
#include <cmath>

#include "components/base/types/joined.h"
#include "components/base/types/seconds.h"
#include "components/model/gate/checks.h"
#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::gate {

namespace {

using identify::Resolution;
using types::Run;
using types::Signal;

struct Sampling {
  double rate_Hz = 0.0, jitter_s = 0.0;
  double set_forward_s = 0.0;
  Eigen::Index lost = 0;
};

// Does the angle go on from row i - 1 to i by the step of about one period, as fast before and
// behind? Over a gap of twenty periods and more, rows that are lost would have moved it farther.
bool GoesOn(const Run& run, Eigen::Index i) {
  constexpr Eigen::Index kAround = 5;
  for (const Signal angle : {Signal::kPosition, Signal::kMotorPosition}) {
    if (!run.Has(angle) || i <= kAround || i + kAround >= run.size()) continue;
    const Eigen::VectorXd& q = run.At(angle);
    const double before = (q[i - 1] - q[i - 1 - kAround]) / kAround;
    const double behind = (q[i + kAround] - q[i]) / kAround;
    const double step = 0.5 * (before + behind);
    return before * behind > 0.0 && std::abs(before - behind) < 0.5 * std::abs(step) &&
           std::abs(q[i] - q[i - 1] - step) < 2.0 * std::abs(step);
  }
  return false;
}

// Stamps against whole periods; rows that no even count explains are irregular, not lost.
Sampling SamplingOf(const Run& run) {
  Sampling out;
  const double period = MedianPeriod(run);
  if (!(period > 0.0)) return out;
  out.rate_Hz = 1.0 / period;
  std::vector<double> off;
  for (Eigen::Index i = 1; i < run.size(); ++i) {
    const double steps = (run.time_s[i] - run.time_s[i - 1]) / period;
    const double whole = std::max(1.0, std::round(steps));
    if (whole >= 20.0 && GoesOn(run, i)) {
      out.set_forward_s += (steps - 1.0) * period;
    } else {
      out.lost += static_cast<Eigen::Index>(whole) - 1;
    }
    off.push_back((steps - whole) * period);
  }
  double squares = 0.0;
  for (const double at : off) squares += at * at;
  out.jitter_s = off.empty() ? 0.0 : std::sqrt(0.5 * squares / static_cast<double>(off.size()));
  return out;
}

// Share of rows that sit at the largest absolute value, three or more in a row.
double SaturatedShare(const Eigen::VectorXd& x) {
  const double limit = x.cwiseAbs().maxCoeff();
  if (!(limit > 0.0)) return 0.0;
  Eigen::Index saturated = 0;
  for (const Span& span :
       EqualSpans((x.cwiseAbs().array() >= (1.0 - 1e-6) * limit).cast<double>(), 3)) {
    if (std::abs(x[span.first]) >= (1.0 - 1e-6) * limit) saturated += span.rows();
  }
  return static_cast<double>(saturated) / static_cast<double>(x.size());
}

// v_measured = v - lag a, with the error of a straight line; instants are half a width apart.
std::vector<Finding> LagOf(const Run& run, Signal angle, Signal measured) {
  if (!run.Has(angle) || !run.Has(measured) || !(Range(run.At(measured)) > 0.0)) return {};
  const double half = HalfWidth_s(run, angle);
  const std::vector<double> at = Centres(run, half, 4000);
  if (at.size() < 50) return {};
  const auto local = LocalCubics(run, {angle, measured}, half, at);
  const Eigen::VectorXd &v = local.at(angle).rate, &a = local.at(angle).acceleration;
  const Eigen::VectorXd off = v - local.at(measured).value;
  const double aa = a.squaredNorm();
  if (!(aa > 0.0)) return {};
  const double lag = a.dot(off) / aa;
  const double left = (off - lag * a).squaredNorm() / static_cast<double>(off.size() - 1);
  const double half_width = 2.0 * std::sqrt(2.0 * left / aa);
  if (std::abs(lag) < std::max(half_width, 0.1 * MedianPeriod(run))) return {};
  const std::string name(types::SignalName(measured));
  return {{"lag_" + name,
           name + (lag > 0 ? " lags its angle by " : " leads its angle by ") +
               Number(1e3 * std::abs(lag)) + " ms (95 %: +- " + Number(1e3 * half_width) +
               " ms); angles are differentiated instead",
           lag, "s"}};
}

// "500 Hz (a.csv, b.csv) and 333.3 Hz (c.csv)"; without names where all of them are sampled alike.
std::string RatesText(const std::vector<Run>& runs, const std::vector<Sampling>& samplings) {
  // Rates nearer than this are one: clocks differ by less than a thousandth, and stamps in whole
  // milliseconds put the median period of the usual rates off by up to a hundredth.
  constexpr double kSameRate = 0.01;
  struct Group {
    double rate_Hz = 0.0;
    std::vector<std::string> names;
  };
  std::vector<Group> groups;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const double rate_Hz = samplings[i].rate_Hz;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return std::abs(rate_Hz - group.rate_Hz) <= kSameRate * group.rate_Hz;
    });
    if (same == groups.end()) {
      groups.push_back({rate_Hz, {runs[i].name}});
    } else {
      same->names.push_back(runs[i].name);
    }
  }
  std::vector<std::string> texts;
  texts.reserve(groups.size());
  for (const Group& group : groups) {
    texts.push_back(Number(group.rate_Hz) + " Hz" +
                    (groups.size() > 1 ? " (" + types::Joined(group.names) + ")" : ""));
  }
  return types::Joined(texts, " and ");
}

std::vector<Finding> SaturationFindings(const std::vector<Run>& runs,
                                        const actuator::JointModel& model) {
  const std::optional<Signal> only = OnlyDrive(model);
  if (!only) return {};
  const Signal drive = *only;
  double saturated = 0.0, largest = 0.0;
  for (const Run& run : runs) {
    if (!run.Has(drive)) continue;
    saturated = std::max(saturated, SaturatedShare(run.At(drive)));
    largest = std::max(largest, run.At(drive).cwiseAbs().maxCoeff());
  }
  if (!(saturated > 1e-3)) return {};
  const double declared =
      drive == Signal::kMotorCurrent && model.constants.torque_constant_Nm_A > 0.0
          ? model.motor_torque_limit_Nm / model.constants.torque_constant_Nm_A
          : 0.0;
  return {{"saturation",
           "the drive sits at its limit of " + Number(largest) + " for " +
               Number(100.0 * saturated) + " % of a recording" +
               (declared > 0.0 ? "; declared: " + Number(declared) : ""),
           saturated, "1"}};
}

// Steps of the converters, and channels that never change.
std::vector<Finding> ChannelFindings(const std::vector<Run>& runs,
                                     const actuator::JointModel& model) {
  std::vector<Finding> out;
  for (const Signal signal :
       {Signal::kPosition, Signal::kMotorPosition, Signal::kChamberPressure}) {
    if (!runs.front().Has(signal) || !(Range(runs.front().At(signal)) > 0.0)) continue;
    const double step = Resolution(runs.front().At(signal));
    if (!(step > 0.0)) continue;
    const std::string unit(types::SignalUnit(signal, model.kind));
    out.push_back(
        {"resolution",
         std::string(types::SignalName(signal)) + " comes in steps of " + Number(step) + " " + unit,
         step, unit});
  }
  for (const auto& [signal, values] : runs.front().signals) {
    const bool moves = std::any_of(runs.begin(), runs.end(), [s = signal](const Run& run) {
      return run.Has(s) && Range(run.At(s)) > 0.0;
    });
    if (moves) continue;
    out.push_back(
        {"constant",
         std::string(types::SignalName(signal)) + " never changes: its effects cannot be seen", 0.0,
         ""});
  }
  return out;
}

}  // namespace

std::vector<Finding> FindSampling(const std::vector<Run>& runs) {
  std::vector<Finding> out;
  std::vector<Sampling> samplings;
  std::vector<double> rates_Hz;
  Eigen::Index lost = 0, interpolated = 0;
  double set_back_s = 0.0, set_forward_s = 0.0;
  double jitter = 0.0, jitter_s = 0.0;  // the largest, as a share of the period and in seconds
  for (const Run& run : runs) {
    samplings.push_back(SamplingOf(run));
    const Sampling& at = samplings.back();
    rates_Hz.push_back(at.rate_Hz);
    lost += at.lost;
    interpolated += run.interpolated_rows;
    set_back_s += run.clock_set_back_s;
    set_forward_s += at.set_forward_s;
    if (at.jitter_s * at.rate_Hz <= jitter) continue;
    jitter = at.jitter_s * at.rate_Hz;
    jitter_s = at.jitter_s;
  }
  out.push_back({"rate", "sampled at " + RatesText(runs, samplings), Median(rates_Hz), "Hz"});
  if (jitter > 1e-3 && !runs.front().held) {
    out.push_back(
        {"jitter",
         "stamps scatter by " + Number(100.0 * jitter) + " % of a period about an even grid",
         jitter_s, "s"});
  }
  if (set_back_s > 0.0) {
    out.push_back({"clock_set_back",
                   "the clock of the recording was set back by " + types::SecondsText(set_back_s) +
                       " s; rows are in the order of their ticks, and time goes on",
                   set_back_s, "s"});
  }
  if (set_forward_s > 0.0) {
    out.push_back({"clock_set_forward",
                   "the clock of the recording was set forward by " +
                       types::SecondsText(set_forward_s) +
                       " s, over which the motion goes on as in one period; what lies around it "
                       "is left out",
                   set_forward_s, "s"});
  }
  if (interpolated > 0) {
    out.push_back({"interpolated_rows",
                   std::to_string(interpolated) +
                       " rows lie on the line between their neighbours in every signal: they were "
                       "interpolated, not measured, and are left out",
                   static_cast<double>(interpolated), "rows"});
  }
  if (lost > 0) {
    out.push_back({"lost_rows",
                   std::to_string(lost) + " rows are lost; what lies around them is left out",
                   static_cast<double>(lost), "rows"});
  }
  return out;
}

std::vector<Finding> FindChannels(const std::vector<Run>& runs, const actuator::JointModel& model) {
  std::vector<Finding> out = SaturationFindings(runs, model);
  Append(ChannelFindings(runs, model), &out);
  if (runs.front().held) return out;
  Append(LagOf(runs.front(), Signal::kPosition, Signal::kVelocity), &out);
  Append(LagOf(runs.front(), Signal::kMotorPosition, Signal::kMotorVelocity), &out);
  return out;
}

}  // namespace sinew::gate
