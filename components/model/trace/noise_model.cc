#include "components/model/trace/noise_model.h"

#include <algorithm>
#include <cmath>

namespace sinew::trace {

namespace {

// Share of the variance that is taken as white: bounds the gain of the whitening filter to
// 1 / sqrt(kWhiteFloor). Columns are known to a few per cent of their size, not better.
constexpr double kWhiteFloor = 0.01;

constexpr Eigen::Index kRowsAtATime = 1024;  // two of them fit into any first-level cache

}  // namespace

NoiseModel::NoiseModel(const Eigen::Ref<const Eigen::VectorXd>& noise,
                       const std::vector<Stretch>& stretches, int longest_order) {
  Eigen::VectorXd forward = noise, backward = noise;
  double rows = 0.0, power = 0.0;
  for (const Stretch& stretch : stretches) {
    power += noise.segment(stretch.first, stretch.count).squaredNorm();
    rows += static_cast<double>(stretch.count);
  }
  const double variance = rows > 0.0 ? power / rows : 1.0;
  const double floor = kWhiteFloor * variance;
  Eigen::MatrixXd table = Eigen::MatrixXd::Zero(longest_order + 1, longest_order);
  Eigen::VectorXd innovation = Eigen::VectorXd::Zero(longest_order + 1);
  innovation[0] = variance > 0.0 ? variance : 1.0;
  double least = rows * std::log(innovation[0]);
  int best = 0;
  for (int m = 1; m <= longest_order; ++m) {
    double cross = 0.0, sum = 0.0, pairs = 0.0;
    for (const Stretch& stretch : stretches) {
      for (Eigen::Index i = stretch.first + m; i < stretch.first + stretch.count; ++i) {
        cross += forward[i] * backward[i - 1];
        sum += forward[i] * forward[i] + backward[i - 1] * backward[i - 1];
        pairs += 1.0;
      }
    }
    if (!(sum > 0.0) || pairs < 10.0 * m) break;
    const double reflection = -2.0 * cross / (sum + 2.0 * pairs * floor);
    for (int k = 1; k < m; ++k) {
      table(m, k - 1) = table(m - 1, k - 1) + reflection * table(m - 1, m - k - 1);
    }
    table(m, m - 1) = reflection;
    innovation[m] = innovation[m - 1] * (1.0 - reflection * reflection);
    for (const Stretch& stretch : stretches) {
      for (Eigen::Index i = stretch.first + stretch.count - 1; i >= stretch.first + m; --i) {
        const double ahead = forward[i];
        forward[i] = ahead + reflection * backward[i - 1];
        backward[i] = backward[i - 1] + reflection * ahead;
      }
    }
    const double criterion = rows * std::log(innovation[m]) + 2.0 * m;
    if (criterion < least) {
      least = criterion;
      best = m;
    }
  }
  coefficients_ = table.topLeftCorner(best + 1, best);
  scale_ = innovation.head(best + 1).cwiseSqrt().cwiseInverse();
  sigma_ = std::sqrt(innovation[best]);
}

Eigen::MatrixXd NoiseModel::Whiten(const Eigen::Ref<const Eigen::MatrixXd>& columns,
                                   const std::vector<Stretch>& stretches,
                                   const Eigen::VectorXd& weight) const {
  const Eigen::Index p = order();
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  Eigen::VectorXd x(columns.rows());
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    if (weight.size() > 0) {
      x = weight.cwiseProduct(columns.col(c));
    } else {
      x = columns.col(c);
    }
    auto e = out.col(c);
    for (const Stretch& stretch : stretches) {
      const Eigen::Index start = stretch.first + std::min(p, stretch.count);
      const Eigen::Index rest = stretch.first + stretch.count - start;
      for (Eigen::Index i = stretch.first; i < start; ++i) {
        const Eigen::Index m = i - stretch.first;
        double sum = x[i];
        for (Eigen::Index k = 1; k <= m; ++k) sum += coefficients_(m, k - 1) * x[i - k];
        e[i] = scale_[m] * sum;
      }
      for (Eigen::Index first = start; first < start + rest; first += kRowsAtATime) {
        const Eigen::Index count = std::min(kRowsAtATime, start + rest - first);
        e.segment(first, count) = scale_[p] * x.segment(first, count);
        for (Eigen::Index k = 1; k <= p; ++k) {
          e.segment(first, count) +=
              scale_[p] * coefficients_(p, k - 1) * x.segment(first - k, count);
        }
      }
    }
  }
  return out;
}

Eigen::VectorXd NoiseModel::Transpose(const Eigen::Ref<const Eigen::VectorXd>& whitened,
                                      const std::vector<Stretch>& stretches) const {
  const int p = order();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(whitened.size());
  for (const Stretch& stretch : stretches) {
    for (Eigen::Index i = 0; i < stretch.count; ++i) {
      const Eigen::Index m = std::min<Eigen::Index>(p, i);
      const double e = scale_[m] * whitened[stretch.first + i];
      out[stretch.first + i] += e;
      for (Eigen::Index k = 1; k <= m; ++k) {
        out[stretch.first + i - k] += coefficients_(m, k - 1) * e;
      }
    }
  }
  return out;
}

}  // namespace sinew::trace
