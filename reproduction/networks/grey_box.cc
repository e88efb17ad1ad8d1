#include "reproduction/networks/grey_box.h"

#include <Eigen/QR>
#include <cmath>

namespace sinew::networks {
namespace {

// Below these speeds friction changes its sign smoothly.
constexpr double kSlow_rad_s = 0.03;
constexpr double kSlow_m_s = 2e-4;

Eigen::VectorXd Terms(Task task, const Eigen::VectorXd& u) {
  Eigen::VectorXd x;
  switch (task) {
    case Task::kSea: {
      // The play angle falls when the link rises: the sign is the coefficient's.
      const double sign = std::tanh(u(1) / kSlow_rad_s);
      x.resize(6);
      x << u(2), sign, 1.0, u(2) * u(0), u(1), u(2) * sign;
      break;
    }
    case Task::kPea:
      x.resize(7);
      x << u(4), u(1), std::tanh(u(1) / kSlow_rad_s), std::cos(u(0)), u(2), u(3), 1.0;
      break;
    case Task::kForce: {
      const double sign = std::tanh(u(1) / kSlow_m_s);
      x.resize(5);
      x << u(2), sign, u(2) * sign, u(1), 1.0;
      break;
    }
  }
  return x;
}

std::vector<std::string> Names(Task task) {
  switch (task) {
    case Task::kSea:
      return {"K_Nm_bar",         "T_dynamic_Nm",    "offset_Nm", "stiffness_Nm_rad_bar",
              "viscous_Nm_s_rad", "T_dynamic_Nm_bar"};
    case Task::kPea:
      return {"inertia_kg_m2",   "viscous_Nm_s_rad", "coulomb_Nm", "gravity_Nm",
              "pressure_Nm_bar", "load_m",           "offset_Nm"};
    case Task::kForce:
      return {"area_N_bar", "coulomb_N", "coulomb_N_bar", "viscous_N_s_m", "offset_N"};
  }
  return {};
}

}  // namespace

GreyBox FitGreyBox(Task task, const Samples& samples, Eigen::MatrixXd* predicted) {
  const Eigen::Index terms = static_cast<Eigen::Index>(Names(task).size());
  Eigen::MatrixXd all(samples.count(), terms);
  for (int t = 0; t < samples.count(); ++t) {
    const Eigen::VectorXd u =
        samples.inputs.col(t).cwiseProduct(samples.input.scale) + samples.input.offset;
    all.row(t) = Terms(task, u).transpose();
  }
  Eigen::MatrixXd x(static_cast<Eigen::Index>(samples.train.size()), terms);
  Eigen::VectorXd y(x.rows());
  for (Eigen::Index i = 0; i < x.rows(); ++i) {
    const int t = samples.train[static_cast<std::size_t>(i)];
    x.row(i) = all.row(t);
    y(i) = samples.targets(0, t) * samples.output.scale(0) + samples.output.offset(0);
  }
  GreyBox model;
  model.names = Names(task);
  model.coefficients = x.colPivHouseholderQr().solve(y);
  *predicted =
      (((all * model.coefficients).array() - samples.output.offset(0)) / samples.output.scale(0))
          .matrix()
          .transpose();
  return model;
}

}  // namespace sinew::networks
