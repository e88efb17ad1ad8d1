#include "components/model/identify/iir_filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace sinew::identify {
namespace {

// The reference runs in direct form, we in second-order sections: rounding of an eighth-order
// polynomial separates them by 1e-9 at most.
constexpr double kRounding = 1e-9;
constexpr double kPi = std::numbers::pi;

// x = sin(0.3 n) + 0.5 cos(1.1 n) + 0.02 n, n = 0 .. 39
Eigen::VectorXd Wave() {
  Eigen::VectorXd x(40);
  for (int n = 0; n < 40; ++n) x[n] = std::sin(0.3 * n) + 0.5 * std::cos(1.1 * n) + 0.02 * n;
  return x;
}

void ExpectAt(const Eigen::VectorXd& y, const std::vector<int>& at, const std::vector<double>& want,
              double tolerance) {
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(y[at[i]], want[i], tolerance) << "sample " << at[i];
  }
}

TEST(IirFilter, ZeroPhaseButterworthOfOrderFourAgreesWithSciPy) {
  // scipy 1.10: b, a = butter(4, 0.2); filtfilt(b, a, x, padlen=12)[[0, 1, 5, 20, 38, 39]]
  ExpectAt(FilterZeroPhase(ButterworthLowPass(4, 0.2, 2.0), Wave()), {0, 1, 5, 20, 38, 39},
           {0.493078365202898, 0.580894098427113, 1.00476255811296, 0.120510684908524,
            0.0405901135318791, 0.280108640284042},
           kRounding);
}

TEST(IirFilter, ZeroPhaseButterworthOfOddOrderAgreesWithSciPy) {
  // scipy 1.10: b, a = butter(5, 0.15); filtfilt(b, a, x, padlen=15)[[0, 1, 5, 20, 38, 39]]
  ExpectAt(FilterZeroPhase(ButterworthLowPass(5, 0.15, 2.0), Wave()), {0, 1, 5, 20, 38, 39},
           {0.497973413839197, 0.64627700276742, 1.01294948459597, 0.113688829854363,
            0.10537318487472, 0.229986252707979},
           kRounding);
}

TEST(IirFilter, OnePassFromZeroAgreesWithSciPy) {
  // scipy 1.10: b, a = butter(3, 0.3); lfilter(b, a, x)[[0, 1, 5, 20, 39]]
  ExpectAt(Filter(ButterworthLowPass(3, 0.3, 2.0), Wave()), {0, 1, 5, 20, 39},
           {0.0247664981786266, 0.129938770541265, 0.562748825126547, -0.179399189854578,
            -0.436677102610519},
           kRounding);
}

TEST(IirFilter, DecimationAgreesWithTheChebyshevFilterOfSciPy) {
  // scipy 1.10, MATLAB's choice of samples:
  //   y = sosfiltfilt(cheby1(8, 0.05, 0.08, output='sos'), x, padlen=24)
  //   nout = ceil(203 / 10); nbeg = 10 - (10 * nout - 203); y[nbeg - 1::10][[0, 1, 10, 20]]
  Eigen::VectorXd x(203);
  for (int n = 0; n < 203; ++n) x[n] = std::sin(0.05 * n) + 0.3 * std::sin(1.7 * n) + 0.001 * n;
  const Eigen::VectorXd y = Decimate(x, 10);
  ASSERT_EQ(y.size(), 21);
  ExpectAt(y, {0, 1, 10, 20},
           {0.101932469472723, 0.578338655728201, -0.825938988982887, -0.488914298130769},
           kRounding);
}

TEST(IirFilter, ButterworthGainIsItsDefinition) {
  // |H|^2 = 1 / (1 + (tan(pi f / fs) / tan(pi fc / fs))^(2 n)) after the bilinear transform.
  for (const int order : {1, 2, 3, 4, 7, 8}) {
    const IirFilter filter = ButterworthLowPass(order, 100.0, 1000.0);
    for (const double f : {0.0, 30.0, 100.0, 170.0, 400.0}) {
      const double ratio = std::tan(kPi * f / 1000.0) / std::tan(kPi * 0.1);
      EXPECT_NEAR(filter.Gain(f, 1000.0), 1.0 / std::sqrt(1.0 + std::pow(ratio, 2 * order)), 1e-12)
          << "order " << order << " at " << f << " Hz";
    }
  }
}

TEST(IirFilter, ChebyshevGainStaysInItsRippleBand) {
  for (const int order : {5, 8}) {
    const IirFilter filter = ChebyshevLowPass(order, 0.05, 40.0, 1000.0);
    const double bottom = std::pow(10.0, -0.05 / 20.0);
    for (double f = 0.0; f <= 40.0; f += 0.5) {
      EXPECT_LE(filter.Gain(f, 1000.0), 1.0 + 1e-9);
      EXPECT_GE(filter.Gain(f, 1000.0), bottom - 1e-9);
    }
    EXPECT_NEAR(filter.Gain(40.0, 1000.0), bottom, 1e-9);
    EXPECT_LT(filter.Gain(100.0, 1000.0), order == 8 ? 1e-4 : 1e-2);
  }
}

TEST(IirFilter, ZeroPhaseFilterKeepsConstantsAndStraightLines) {
  const IirFilter filter = ButterworthLowPass(4, 10.0, 1000.0);
  const Eigen::VectorXd level = Eigen::VectorXd::Constant(300, 3.0);
  EXPECT_LT((FilterZeroPhase(filter, level) - level).cwiseAbs().maxCoeff(), 1e-11);
  Eigen::VectorXd x(1200);
  for (int n = 0; n < 1200; ++n) x[n] = 3.0 - 0.7 * n;
  const Eigen::VectorXd y = FilterZeroPhase(filter, x, 600);
  EXPECT_LT((y - x).cwiseAbs().maxCoeff(), 1e-5);  // start-up inside the reflected 0.6 s
}

TEST(IirFilter, ZeroPhaseFilterCommutesWithTimeReversal) {
  const Eigen::VectorXd x = Wave();
  const IirFilter filter = ButterworthLowPass(4, 0.2, 2.0);
  const Eigen::VectorXd forward = FilterZeroPhase(filter, x, 39);
  const Eigen::VectorXd backward = FilterZeroPhase(filter, x.reverse(), 39).reverse();
  // Start-up at the ends differs by order of passes; the middle must not.
  EXPECT_LT((forward - backward).segment(12, 16).cwiseAbs().maxCoeff(), 2e-2);
}

TEST(IirFilter, LongConstantInputStaysBounded) {
  const Eigen::VectorXd x = Eigen::VectorXd::Constant(200000, 1.0);
  const Eigen::VectorXd y = Filter(ButterworthLowPass(8, 1.0, 1000.0), x);
  EXPECT_NEAR(y[y.size() - 1], 1.0, 1e-8);
  EXPECT_LT(y.cwiseAbs().maxCoeff(), 1.3);
}

TEST(IirFilter, NonFiniteInputGivesNonFiniteOutput) {
  Eigen::VectorXd x = Wave();
  x[20] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(FilterZeroPhase(ButterworthLowPass(4, 0.2, 2.0), x).allFinite());
}

TEST(IirFilter, BadDesignsAreRefusedWithTheirValue) {
  EXPECT_THROW(ButterworthLowPass(0, 10.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(4, 50.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(4, -1.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(4, std::nan(""), 100.0), std::invalid_argument);
  EXPECT_THROW(ChebyshevLowPass(4, 0.0, 10.0, 100.0), std::invalid_argument);
  EXPECT_THROW(Decimate(Wave(), 0), std::invalid_argument);
  EXPECT_THROW(FilterZeroPhase(ButterworthLowPass(2, 1.0, 10.0), Eigen::VectorXd::Zero(1)),
               std::invalid_argument);
  try {
    ButterworthLowPass(4, 70.0, 100.0);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("70"), std::string::npos) << error.what();
  }
}

TEST(Decimate, ByOneIsTheSignalItself) {
  const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(50, 0.0, 49.0).array().sin();
  EXPECT_EQ(Decimate(x, 1), x);
}

}  // namespace
}  // namespace sinew::identify
