#include "components/model/stance_fit/stance_sizes.h"

#include "components/bodies/links/links.h"
#include "components/model/identify/block_regression.h"
#include "components/model/identify/statistics.h"

namespace sinew::stance_fit {

namespace {

Eigen::MatrixXd WithSet(const Regression& regression, const trace::Columns& columns) {
  const trace::Bank& bank = regression.bank;
  Eigen::MatrixXd out(bank.target.size(),
                      bank.declared.cols() + static_cast<Eigen::Index>(columns.size()));
  out << bank.declared, bank.columns(Eigen::all, columns);
  return out;
}

// Precision of what is known beforehand, as a matrix: the priors of the columns, and of the places
// of payloads at the masses that b has.
Eigen::MatrixXd PrecisionOf(const Regression& regression, const trace::Columns& columns,
                            const std::vector<PlacePrior>& places, const Eigen::VectorXd& b) {
  const Eigen::Index declared = regression.bank.declared.cols();
  Eigen::VectorXd diagonal(declared + static_cast<Eigen::Index>(columns.size()));
  diagonal << regression.bank.prior.precision,
      regression.bank.spread(columns).array().square().inverse().matrix();
  Eigen::MatrixXd out = diagonal.asDiagonal();
  for (const PlacePrior& place : places) {
    const Eigen::Index mass = declared + place.first;
    if (!(b[mass] > 0.0) || !(place.size_m > 0.0)) continue;
    for (Eigen::Index k = 1; k <= place.moments; ++k) {
      out(mass + k, mass + k) += 1.0 / std::pow(b[mass] * place.size_m, 2);
    }
  }
  return out;
}

}  // namespace

PlainFit FitPlain(const Regression& regression, const trace::Columns& columns,
                  const std::vector<PlacePrior>& places) {
  const Eigen::MatrixXd W = WithSet(regression, columns);
  std::vector<identify::Moments> blocks;
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(W.cols(), W.cols());
  Eigen::VectorXd m = Eigen::VectorXd::Zero(W.cols());
  double rows = 0.0;
  for (const identify::Block& block : regression.long_blocks) {
    blocks.push_back(identify::MomentsOf(block, W, regression.bank.target));
    G += blocks.back().G;
    m += blocks.back().m;
    rows += blocks.back().rows;
  }
  const auto count = static_cast<double>(blocks.size());
  const double few = count > 1.0 ? count / (count - 1.0) : 1.0;
  PlainFit out;
  out.b = Eigen::VectorXd::Zero(W.cols());
  constexpr int kPasses = 4;  // dispersion and masses settle within two
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::MatrixXd P = PrecisionOf(regression, columns, places, out.b);
    const Eigen::MatrixXd A = G / out.dispersion + P;
    out.b = identify::Solve(A, m / out.dispersion);
    Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(W.cols(), W.cols());
    double squares = 0.0;
    for (const identify::Moments& block : blocks) {
      const Eigen::VectorXd score = block.m - block.G * out.b;
      scores += few * score * score.transpose();
      squares += block.SquaredError(out.b);
    }
    // Rows whose noise is white are no less certain than that: where blocks are few, their scores
    // may agree by chance.
    const double white = squares / std::max(1.0, rows);
    const double f = out.dispersion;
    const Eigen::MatrixXd inverse = identify::Inverse(A);
    out.covariance = inverse * (scores / (f * f) + P) * inverse;
    const Eigen::MatrixXd least = inverse * (white / (f * f) * G + P) * inverse;
    for (Eigen::Index i = 0; i < out.covariance.rows(); ++i) {
      out.covariance(i, i) = std::max(out.covariance(i, i), least(i, i));
    }
    double ratio = 0.0, used = 0.0;
    for (Eigen::Index i = 0; i < W.cols(); ++i) {
      if (!(G(i, i) > 0.0)) continue;
      ratio += scores(i, i) / G(i, i);
      used += 1.0;
    }
    out.dispersion = std::max({1.0, white, used > 0.0 ? ratio / used : 1.0});
  }
  out.quantile = identify::StudentQuantile(0.975, std::max(1.0, count - 1.0));
  return out;
}

Eigen::VectorXd Left(const Regression& regression, const PlainFit& fit,
                     const trace::Columns& columns) {
  return regression.bank.target - WithSet(regression, columns) * fit.b;
}

PlacedPayload PayloadOf(const PlainFit& fit, Eigen::Index first, const RigidGroup& group) {
  PlacedPayload out;
  out.link_name = group.name;
  out.rigid_with = group.link_names;
  out.place_m = group.center_m;
  out.mass_kg = fit.b[first];
  out.mass_half_width_95 = fit.HalfWidth(first);
  if (!(out.mass_kg > 0.0)) return out;
  // Along the group's axes: place = moment / mass, by the delta method.
  Eigen::Vector3d along = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, 4> slope = Eigen::Matrix<double, 3, 4>::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  const Eigen::Index count = group.excited + 1;
  covariance.topLeftCorner(count, count) = fit.covariance.block(first, first, count, count);
  for (Eigen::Index axis = 0; axis < group.excited; ++axis) {
    along[axis] = fit.b[first + 1 + axis] / out.mass_kg;
    slope(axis, 0) = -along[axis] / out.mass_kg;
    slope(axis, axis + 1) = 1.0 / out.mass_kg;
  }
  Eigen::Matrix3d spread = slope * covariance * slope.transpose();
  for (Eigen::Index axis = group.excited; axis < 3; ++axis) {
    spread(axis, axis) = group.size_m * group.size_m;
  }
  out.place_m += group.axes * along;
  const Eigen::Matrix3d in_link = group.axes * spread * group.axes.transpose();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<std::size_t>(axis);
    out.place_half_width_95[axis] = fit.quantile * std::sqrt(std::max(0.0, in_link(axis, axis)));
    out.excited[k] = out.place_half_width_95[axis] <= kWidestPlace_m;
  }
  return out;
}

Eigen::MatrixXd RestOfRows(const StanceLayout& layout, const std::vector<StanceRows>& recordings,
                           const Eigen::Ref<const Eigen::VectorXd>& rest) {
  const Eigen::Index channels = layout.channels();
  Eigen::MatrixXd out(rest.size() / channels, layout.noise.size());
  const Eigen::VectorXd variance = layout.noise.cwiseAbs2();
  Eigen::Index at = 0;
  for (const StanceRows& rows : recordings) {
    for (Eigen::Index i = 0; i < rows.size(); ++i, ++at) {
      const Eigen::MatrixXd& project = rows.project[static_cast<std::size_t>(i)];
      out.row(at) =
          variance.cwiseProduct(project.transpose() * rest.segment(at * channels, channels));
    }
  }
  return out;
}

StanceError ErrorOf(const StanceLayout& layout, const std::vector<StanceRows>& recordings,
                    const Eigen::Ref<const Eigen::VectorXd>& rest) {
  StanceError out;
  out.share = identify::Rms(rest);
  const Eigen::MatrixXd rows = RestOfRows(layout, recordings, rest);
  const auto rms = [&](Eigen::Index row) {
    return std::sqrt(rows.col(row).squaredNorm() / std::max(1.0, static_cast<double>(rows.rows())));
  };
  out.moment_x_Nm = rms(0);  // the first three of the layout's rows
  out.moment_y_Nm = rms(1);
  out.force_z_N = rms(2);
  for (std::size_t r = 0; r < layout.rows.size(); ++r) {
    if (layout.rows[r] >= arm::kBaseFreedom) {
      out.joints_Nm.push_back(rms(static_cast<Eigen::Index>(r)));
    }
  }
  return out;
}

}  // namespace sinew::stance_fit
