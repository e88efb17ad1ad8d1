#include "components/model/trace/noise_floor.h"

#include <algorithm>
#include <cmath>

#include "components/model/identify/statistics.h"

namespace sinew::trace {

namespace {

double FromStandstill(const identify::Design& design, const Eigen::VectorXd& torque) {
  const identify::Rows& rows = design.rows();
  const double settle_s = 1.0 / design.options().parallel_cutoff_Hz;
  double squares = 0.0;
  double freedom = 0.0;
  const auto close = [&](const std::vector<Eigen::Index>& spell) {
    const auto n = static_cast<double>(spell.size());
    if (n < 10.0) return;
    double mean_t = 0.0;
    double mean_y = 0.0;
    for (const Eigen::Index i : spell) {
      mean_t += rows.time_s[i] / n;
      mean_y += torque[i] / n;
    }
    double tt = 0.0;
    double ty = 0.0;
    double yy = 0.0;
    for (const Eigen::Index i : spell) {
      const double t = rows.time_s[i] - mean_t;
      const double y = torque[i] - mean_y;
      tt += t * t;
      ty += t * y;
      yy += y * y;
    }
    squares += yy - ty * ty / tt;
    freedom += n - 2.0;
  };
  for (std::size_t s = 0; s < design.states().segments.size(); ++s) {
    const identify::StateSegment& segment = design.states().segments[s];
    // Seconds since and until motion, at the full rate.
    const auto n = static_cast<std::size_t>(segment.size());
    std::vector<double> still(n, 0.0);
    double since = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      since = segment.at_rest[i] ? since + segment.period_s : 0.0;
      still[i] = since;
    }
    since = 0.0;
    for (std::size_t i = n; i-- > 0;) {
      since = segment.at_rest[i] ? since + segment.period_s : 0.0;
      still[i] = std::min(still[i], since);
    }
    std::vector<Eigen::Index> spell;
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (rows.segment[k] != static_cast<int>(s)) continue;
      if (still[static_cast<std::size_t>(rows.sample[k])] > settle_s) {
        spell.push_back(i);
      } else {
        close(spell);
        spell.clear();
      }
    }
    close(spell);
  }
  return freedom >= 30.0 ? std::sqrt(squares / freedom) : 0.0;
}

double FromDifferences(const identify::Design& design, double drive_gain) {
  double best = 0.0;
  for (const identify::StateSegment& segment : design.states().segments) {
    const Eigen::VectorXd& x = segment.drive_input;
    const double rate = 1.0 / segment.period_s;
    const double cutoff = design.options().parallel_cutoff_Hz;
    const bool filtered = cutoff < 0.5 * rate;
    if (x.size() < 100 || (filtered && cutoff > 0.4 * rate)) continue;
    const double sigma = identify::WhiteNoise({&x, 1});
    const double rms = drive_gain * sigma * (filtered ? std::sqrt(cutoff / (0.5 * rate)) : 1.0);
    best = best > 0.0 ? std::min(best, rms) : rms;
  }
  return best;
}

}  // namespace

NoiseFloor EstimateNoiseFloor(const identify::Design& design, const identify::Balance& balance,
                              double drive_factor) {
  Eigen::VectorXd torque = balance.target;
  if (balance.fits_scale) {
    torque = drive_factor * (balance.target - balance.columns.col(0) / drive_factor);
  }
  const double still = FromStandstill(design, torque);
  // Gain from drive input to torque, by their sizes.
  double input = 0.0;
  for (const identify::StateSegment& segment : design.states().segments) {
    input += segment.drive_input.squaredNorm() * segment.period_s * design.rows_per_s();
  }
  const double gain =
      !design.rows().window.empty() ? drive_factor  // levels are removed: sizes say nothing
      : input > 0.0 ? drive_factor * std::sqrt(balance.drive_torque.squaredNorm() / input)
                    : 0.0;
  const double high = FromDifferences(design, gain);
  if (still > 0.0 && (still <= high || high == 0.0)) return {still, "standstill"};
  if (high > 0.0) return {high, "sample-to-sample scatter"};
  return {0.0, ""};
}

}  // namespace sinew::trace
