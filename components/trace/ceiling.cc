#include "components/trace/ceiling.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <random>

#include "components/identify/statistics.h"

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

struct Sums {
  Eigen::MatrixXd G;
  Eigen::VectorXd m;
  double yy = 0.0;
};

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
      !design.rows().window.empty() ? drive_factor  // levels are taken off: sizes tell nothing
      : input > 0.0 ? drive_factor * std::sqrt(balance.drive_torque.squaredNorm() / input)
                    : 0.0;
  const double high = FromDifferences(design, gain);
  if (still > 0.0 && (still <= high || high == 0.0)) return {still, "standstill"};
  if (high > 0.0) return {high, "sample-to-sample scatter"};
  return {0.0, ""};
}

Eigen::MatrixXd FlexibleColumns(const identify::Design& design, int count, std::uint64_t seed) {
  using effects::JointSample;
  using Getter = double (*)(const JointSample&);
  constexpr Getter kInputs[] = {
      [](const JointSample& x) { return x.position_rad; },
      [](const JointSample& x) { return x.velocity_rad_s; },
      [](const JointSample& x) {
        return static_cast<double>(x.velocity_rad_s > 0.0) -
               static_cast<double>(x.velocity_rad_s < 0.0);
      },
      [](const JointSample& x) { return x.acceleration_rad_s2; },
      [](const JointSample& x) { return x.drive_input; },
      [](const JointSample& x) { return x.pressure_bar; },
      [](const JointSample& x) { return x.load_force_N; },
      [](const JointSample& x) { return x.payload_kg; },
      [](const JointSample& x) { return x.temperature_degC; },
      [](const JointSample& x) { return x.pressure_rate_bar_s; },
      [](const JointSample& x) { return x.tooth_torque_Nm; },
  };
  struct Input {
    Getter get;
    double mean;
    double deviation;
  };
  std::vector<Input> inputs;
  for (const Getter get : kInputs) {
    const Eigen::VectorXd values = design.Variable(get);
    const double mean = values.mean();
    const double deviation = std::sqrt((values.array() - mean).square().mean());
    if (deviation > 1e-9 * (1.0 + std::abs(mean))) inputs.push_back({get, mean, deviation});
  }
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd out(design.rows().size(), count);
  for (int c = 0; c < count; ++c) {
    std::vector<double> weight;
    const double bias = normal(random);
    for (std::size_t i = 0; i < inputs.size(); ++i) weight.push_back(0.8 * normal(random));
    out.col(c) = design.Column([&](const JointSample& x) {
      double sum = bias;
      for (std::size_t i = 0; i < inputs.size(); ++i) {
        sum += weight[i] * (inputs[i].get(x) - inputs[i].mean) / inputs[i].deviation;
      }
      return std::tanh(sum);
    });
  }
  return out;
}

FlexibleFit FitFlexible(const std::vector<identify::Block>& blocks,
                        const Eigen::Ref<const Eigen::MatrixXd>& base,
                        const Eigen::Ref<const Eigen::MatrixXd>& flexible,
                        const Eigen::Ref<const Eigen::VectorXd>& target, int folds) {
  Eigen::MatrixXd X(base.rows(), base.cols() + flexible.cols());
  X << base, flexible;
  const Eigen::Index p = X.cols();
  std::vector<identify::Moments> moments;
  std::vector<Sums> fold(static_cast<std::size_t>(folds));
  Sums total{Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 0.0};
  double rows = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const identify::Moments sums = identify::MomentsOf(blocks[b], X, target);
    Sums& part = fold[b % static_cast<std::size_t>(folds)];
    if (part.G.size() == 0) part = {Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), 0.0};
    part.G += sums.G;
    part.m += sums.m;
    part.yy += sums.yy;
    total.G += sums.G;
    total.m += sums.m;
    total.yy += sums.yy;
    rows += sums.rows;
  }
  const auto solve = [&](const Eigen::MatrixXd& G, const Eigen::VectorXd& m, double ridge,
                         bool with_flexible) -> Eigen::VectorXd {
    Eigen::VectorXd b = Eigen::VectorXd::Zero(p);
    if (!with_flexible) {
      const Eigen::Index k = base.cols();
      b.head(k) = identify::Solve(G.topLeftCorner(k, k), m.head(k));
      return b;
    }
    Eigen::MatrixXd A = G;
    A.diagonal().tail(flexible.cols()).array() += ridge * rows;
    for (Eigen::Index i = 0; i < base.cols(); ++i) A(i, i) *= 1.0 + 1e-9;
    return A.ldlt().solve(m);
  };
  const auto left_out = [&](double ridge, bool with_flexible) {
    double error = 0.0;
    for (const Sums& part : fold) {
      if (part.G.size() == 0) continue;
      const Eigen::VectorXd b = solve(total.G - part.G, total.m - part.m, ridge, with_flexible);
      error += part.yy - 2.0 * b.dot(part.m) + b.dot(part.G * b);
    }
    return error;
  };
  const double base_error = left_out(0.0, false);
  double least = base_error;
  double best_ridge = 1.0;
  for (const double ridge : {1e-4, 1e-3, 1e-2, 1e-1}) {
    const double error = left_out(ridge, true);
    if (error < least) {
      least = error;
      best_ridge = ridge;
    }
  }
  FlexibleFit out;
  out.left_out_share = base_error > 0.0 ? 1.0 - least / base_error : 0.0;
  out.remainder = target - X * solve(total.G, total.m, best_ridge, true);
  for (int f = 0; f < folds; ++f) {
    const Sums& part = fold[static_cast<std::size_t>(f)];
    if (part.G.size() == 0) continue;
    const Eigen::VectorXd b = solve(total.G - part.G, total.m - part.m, best_ridge, true);
    for (std::size_t k = static_cast<std::size_t>(f); k < blocks.size();
         k += static_cast<std::size_t>(folds)) {
      for (const Eigen::Index i : blocks[k]) out.remainder[i] = target[i] - X.row(i).dot(b);
    }
  }
  return out;
}

}  // namespace sinew::trace
