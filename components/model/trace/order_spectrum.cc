#include "components/model/trace/order_spectrum.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "components/model/identify/spectrum.h"

namespace sinew::trace {

namespace {

// Cells per period of the highest order: sharing a row between two cells damps it by sinc^2(1/8),
// 5 per cent of the amplitude.
constexpr double kPerPeriod = 8.0;
constexpr double kFiner = 4.0;  // grid of orders, finer than the resolution
constexpr std::size_t kLargest = std::size_t{1} << 22;

}  // namespace

double TurnsCovered(const Eigen::Ref<const Eigen::VectorXd>& angle) {
  if (angle.size() == 0) return 0.0;
  return (angle.maxCoeff() - angle.minCoeff()) / (2.0 * std::numbers::pi);
}

double IndependentOrders(double turns, double lowest, double highest) {
  return std::max(1.0, turns * (highest - lowest));
}

OrderLine StrongestOrder(const Eigen::Ref<const Eigen::VectorXd>& g,
                         const Eigen::Ref<const Eigen::VectorXd>& angle, double lowest,
                         double highest, const std::vector<double>& known) {
  OrderLine best;
  const double turns = TurnsCovered(angle);
  if (!(turns > 0.0) || !(highest > lowest)) return best;
  std::size_t size = 8;
  while (static_cast<double>(size) < kPerPeriod * highest * turns * kFiner && size < kLargest) {
    size *= 2;
  }
  const double spacing = turns * kFiner / static_cast<double>(size);  // in turns
  std::vector<double> grid(size, 0.0);
  const double first = angle.minCoeff();
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    const double at = (angle[i] - first) / (2.0 * std::numbers::pi * spacing);
    const auto cell = static_cast<std::size_t>(at);
    const double part = at - std::floor(at);
    grid[cell % size] += (1.0 - part) * g[i];
    grid[(cell + 1) % size] += part * g[i];
  }
  // Rows that count may cover less of the angle: their lines are as much wider.
  std::vector<double> counting;
  for (Eigen::Index i = 0; i < g.size(); ++i) {
    if (g[i] != 0.0) counting.push_back(angle[i]);
  }
  const double covered = TurnsCovered(Eigen::Map<const Eigen::VectorXd>(
      counting.data(), static_cast<Eigen::Index>(counting.size())));
  const std::vector<std::complex<double>> transform = identify::FourierTransform(grid);
  const double step = 1.0 / (spacing * static_cast<double>(size));
  for (std::size_t k = 1; k < size / 2; ++k) {
    const double order = step * static_cast<double>(k);
    if (order < lowest) continue;
    if (order > highest) break;
    if (std::any_of(known.begin(), known.end(),
                    [&](double line) { return std::abs(order - line) * covered < 1.0; })) {
      continue;
    }
    if (std::norm(transform[k]) > best.power) best = {order, std::norm(transform[k])};
  }
  return best;
}

OrderLine StrongestRipple(const Eigen::Ref<const Eigen::VectorXd>& g,
                          const Eigen::Ref<const Eigen::VectorXd>& angle,
                          const Eigen::Ref<const Eigen::VectorXd>& speed, double band,
                          double lowest, double highest, const std::vector<double>& known) {
  if (!(band > 0.0)) return StrongestOrder(g, angle, lowest, highest, known);
  OrderLine best;
  for (double from = lowest; from < highest; from *= 2.0) {
    const double to = std::min(highest, 2.0 * from);
    const Eigen::VectorXd seen =
        (speed.array() * std::sqrt(from * to) < band).select(g.array(), 0.0);
    const double power = seen.squaredNorm();
    if (!(power > 0.0)) continue;
    OrderLine line = StrongestOrder(seen, angle, from, to, known);
    line.power /= power;
    if (line.power > best.power) best = line;
  }
  return best;
}

}  // namespace sinew::trace
