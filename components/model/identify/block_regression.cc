#include "components/model/identify/block_regression.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace sinew::identify {

namespace {

constexpr double kRidge = 1e-9;

// Scaled to unit diagonal, with the ridge: D^-1/2 G D^-1/2 + ridge I.
struct Scaled {
  Eigen::VectorXd scale;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

Scaled Factor(const Eigen::Ref<const Eigen::MatrixXd>& G) {
  Scaled out;
  const Eigen::Index n = G.rows();
  out.scale.resize(n);
  for (Eigen::Index i = 0; i < n; ++i)
    out.scale[i] = G(i, i) > 0.0 ? 1.0 / std::sqrt(G(i, i)) : 0.0;
  Eigen::MatrixXd unit = out.scale.asDiagonal() * G * out.scale.asDiagonal();
  unit.diagonal().array() += kRidge;
  out.factor.compute(unit);
  return out;
}

}  // namespace

std::vector<Block> MakeBlocks(const Rows& rows, double length_s, double gap_s, int fewest_rows) {
  std::vector<Block> blocks;
  for (Eigen::Index first = 0; first < rows.size();) {
    Eigen::Index last = first;
    while (last + 1 < rows.size() && rows.segment[static_cast<std::size_t>(last + 1)] ==
                                         rows.segment[static_cast<std::size_t>(first)]) {
      ++last;
    }
    const double start = rows.time_s[first];
    const double span = rows.time_s[last] - start;
    const int windows = std::max(1, static_cast<int>(std::floor(span / length_s + 1e-9)));
    const double width = span / windows;
    Block block;
    const std::size_t before = blocks.size();
    int window = 0;
    for (Eigen::Index i = first; i <= last; ++i) {
      const double at = rows.time_s[i] - start;
      const int here = std::min(windows - 1, static_cast<int>(at / width));
      if (here != window) {
        window = here;
        if (static_cast<int>(block.size()) >= fewest_rows) {
          blocks.push_back(std::move(block));
          block.clear();
        }
      }
      if (!rows.used[static_cast<std::size_t>(i)]) continue;
      const double from_left = at - here * width;
      const double to_right = (here + 1) * width - at;
      if (here > 0 && from_left < gap_s - 1e-9) continue;
      if (here < windows - 1 && to_right < gap_s - 1e-9) continue;
      block.push_back(i);
    }
    if (static_cast<int>(block.size()) >= fewest_rows) {
      blocks.push_back(std::move(block));
    } else if (blocks.size() > before) {
      blocks.back().insert(blocks.back().end(), block.begin(), block.end());
    }
    first = last + 1;
  }
  return blocks;
}

double Moments::SquaredError(const Eigen::Ref<const Eigen::VectorXd>& b) const {
  return yy - 2.0 * b.dot(m) + b.dot(G * b);
}

Moments MomentsOf(const Block& block, const Eigen::Ref<const Eigen::MatrixXd>& X,
                  const Eigen::Ref<const Eigen::VectorXd>& y) {
  const auto n = static_cast<Eigen::Index>(block.size());
  Eigen::MatrixXd part(n, X.cols());
  Eigen::VectorXd target(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    part.row(i) = X.row(block[static_cast<std::size_t>(i)]);
    target[i] = y[block[static_cast<std::size_t>(i)]];
  }
  Moments out;
  out.G = part.transpose() * part;
  out.m = part.transpose() * target;
  out.yy = target.squaredNorm();
  out.rows = static_cast<double>(n);
  return out;
}

Eigen::VectorXd Solve(const Eigen::Ref<const Eigen::MatrixXd>& G,
                      const Eigen::Ref<const Eigen::VectorXd>& m) {
  const Scaled scaled = Factor(G);
  const Eigen::VectorXd right = scaled.scale.cwiseProduct(m);
  return scaled.scale.cwiseProduct(scaled.factor.solve(right));
}

Eigen::VectorXd LeftBy(const Eigen::Ref<const Eigen::MatrixXd>& X,
                       const Eigen::Ref<const Eigen::VectorXd>& y) {
  return y - X * Solve(X.transpose() * X, X.transpose() * y);
}

Eigen::MatrixXd Inverse(const Eigen::Ref<const Eigen::MatrixXd>& G) {
  const Scaled scaled = Factor(G);
  const Eigen::MatrixXd unit = scaled.factor.solve(Eigen::MatrixXd::Identity(G.rows(), G.cols()));
  return scaled.scale.asDiagonal() * unit * scaled.scale.asDiagonal();
}

Eigen::MatrixXd BlockCovariance(const std::vector<Moments>& blocks,
                                const Eigen::Ref<const Eigen::VectorXd>& b) {
  const Eigen::Index p = b.size();
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(p, p);
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(p, p);
  double rows = 0.0;
  for (const Moments& block : blocks) {
    const Eigen::VectorXd score = block.m - block.G * b;
    total += block.G;
    scores += score * score.transpose();
    rows += block.rows;
  }
  const Eigen::MatrixXd inverse = Inverse(total);
  const double count = static_cast<double>(blocks.size());
  const double factor = count > 1.0 ? count / (count - 1.0) * (rows - 1.0) /
                                          std::max(1.0, rows - static_cast<double>(p))
                                    : 1.0;
  return factor * inverse * scores * inverse;
}

}  // namespace sinew::identify
