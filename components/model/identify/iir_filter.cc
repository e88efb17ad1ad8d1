#include "components/model/identify/iir_filter.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"

namespace sinew::identify {

namespace {

using Complex = std::complex<double>;
using types::kPi;

void Check(int order, double cutoff_Hz, double rate_Hz) {
  if (order < 1 || order > 20) {
    throw std::invalid_argument("filter order " + std::to_string(order) + ", expected 1 to 20");
  }
  if (!(rate_Hz > 0.0) || !(cutoff_Hz > 0.0) || !(cutoff_Hz < rate_Hz / 2.0)) {
    throw std::invalid_argument("filter cut-off " + std::to_string(cutoff_Hz) +
                                " Hz, expected between 0 and half the rate of " +
                                std::to_string(rate_Hz) + " Hz");
  }
}

// Sections of an all-pole analogue low-pass whose poles are given for a cut-off of 1 rad/s. The
// poles come in the order k = 0 .. order - 1, so that k and order - 1 - k are a conjugate pair.
// Every zero lies at z = -1; each section has unit gain at 0 Hz, the first times `dc_gain`.
IirFilter FromPoles(const std::vector<Complex>& poles, double cutoff_Hz, double rate_Hz,
                    double dc_gain) {
  const double warped = 2.0 * std::tan(kPi * cutoff_Hz / rate_Hz);  // for a rate of 1
  const auto to_digital = [&](Complex pole) {
    const Complex s = pole * warped;
    return (2.0 + s) / (2.0 - s);
  };
  IirFilter filter;
  filter.order = static_cast<int>(poles.size());
  const int pairs = filter.order / 2;
  if (filter.order % 2 == 1) {
    const double p = to_digital(poles[static_cast<std::size_t>(pairs)]).real();
    const double g = (1.0 - p) / 2.0;
    filter.sections.push_back({g, g, 0.0, -p, 0.0});
  }
  for (int k = pairs - 1; k >= 0; --k) {  // lowest quality factor first
    const Complex p = to_digital(poles[static_cast<std::size_t>(k)]);
    const double a1 = -2.0 * p.real();
    const double a2 = std::norm(p);
    const double g = (1.0 + a1 + a2) / 4.0;
    filter.sections.push_back({g, 2.0 * g, g, a1, a2});
  }
  filter.sections.front().b0 *= dc_gain;
  filter.sections.front().b1 *= dc_gain;
  filter.sections.front().b2 *= dc_gain;
  return filter;
}

// Transposed direct form II, in place; z holds two states per section.
void RunFilter(const IirFilter& filter, std::vector<double>& z, Eigen::VectorXd& x) {
  for (std::size_t s = 0; s < filter.sections.size(); ++s) {
    const Biquad& q = filter.sections[s];
    double z0 = z[2 * s];
    double z1 = z[2 * s + 1];
    for (double& value : x) {
      const double in = value;
      const double out = q.b0 * in + z0;
      z0 = q.b1 * in - q.a1 * out + z1;
      z1 = q.b2 * in - q.a2 * out;
      value = out;
    }
    z[2 * s] = z0;
    z[2 * s + 1] = z1;
  }
}

// States at which a constant input of 1 gives a constant output.
std::vector<double> SteadyState(const IirFilter& filter) {
  std::vector<double> z;
  double level = 1.0;  // input of the section
  for (const Biquad& q : filter.sections) {
    const double out = level * (q.b0 + q.b1 + q.b2) / (1.0 + q.a1 + q.a2);
    z.push_back(out - q.b0 * level);
    z.push_back(q.b2 * level - q.a2 * out);
    level = out;
  }
  return z;
}

void RunFromSteadyState(const IirFilter& filter, const std::vector<double>& steady,
                        Eigen::VectorXd& x) {
  std::vector<double> z(steady);
  for (double& state : z) state *= x[0];
  RunFilter(filter, z, x);
}

}  // namespace

double IirFilter::Gain(double frequency_Hz, double rate_Hz) const {
  const Complex w = std::polar(1.0, -2.0 * kPi * frequency_Hz / rate_Hz);
  double gain = 1.0;
  for (const Biquad& q : sections) {
    gain *= std::abs((q.b0 + q.b1 * w + q.b2 * w * w) / (1.0 + q.a1 * w + q.a2 * w * w));
  }
  return gain;
}

IirFilter ButterworthLowPass(int order, double cutoff_Hz, double rate_Hz) {
  Check(order, cutoff_Hz, rate_Hz);
  std::vector<Complex> poles;
  poles.reserve(static_cast<std::size_t>(order));
  for (int k = 0; k < order; ++k) {
    poles.push_back(std::polar(1.0, kPi * (2.0 * k + order + 1) / (2.0 * order)));
  }
  return FromPoles(poles, cutoff_Hz, rate_Hz, 1.0);
}

IirFilter ChebyshevLowPass(int order, double ripple_dB, double cutoff_Hz, double rate_Hz) {
  Check(order, cutoff_Hz, rate_Hz);
  if (!(ripple_dB > 0.0)) {
    throw std::invalid_argument("filter ripple " + std::to_string(ripple_dB) +
                                " dB, expected above 0");
  }
  const double epsilon = std::sqrt(std::pow(10.0, ripple_dB / 10.0) - 1.0);
  const double mu = std::asinh(1.0 / epsilon) / order;
  std::vector<Complex> poles;
  for (int k = 0; k < order; ++k) {
    const double angle = kPi * (2.0 * k + 1) / (2.0 * order);
    poles.emplace_back(-std::sinh(mu) * std::sin(angle), std::cosh(mu) * std::cos(angle));
  }
  // An even order starts at the bottom of the ripple band.
  const double dc_gain = order % 2 == 0 ? 1.0 / std::sqrt(1.0 + epsilon * epsilon) : 1.0;
  return FromPoles(poles, cutoff_Hz, rate_Hz, dc_gain);
}

Eigen::VectorXd Filter(const IirFilter& filter, const Eigen::Ref<const Eigen::VectorXd>& x) {
  Eigen::VectorXd y = x;
  std::vector<double> z(2 * filter.sections.size(), 0.0);
  RunFilter(filter, z, y);
  return y;
}

Eigen::VectorXd FilterZeroPhase(const IirFilter& filter, const Eigen::Ref<const Eigen::VectorXd>& x,
                                int padding) {
  const Eigen::Index n = x.size();
  if (n < 2) throw std::invalid_argument("zero-phase filter needs at least 2 samples");
  const Eigen::Index pad = std::min<Eigen::Index>(padding < 0 ? 3 * filter.order : padding, n - 1);
  Eigen::VectorXd y(n + 2 * pad);
  for (Eigen::Index i = 0; i < pad; ++i) {
    y[i] = 2.0 * x[0] - x[pad - i];
    y[pad + n + i] = 2.0 * x[n - 1] - x[n - 2 - i];
  }
  y.segment(pad, n) = x;
  const std::vector<double> steady = SteadyState(filter);
  RunFromSteadyState(filter, steady, y);
  y.reverseInPlace();
  RunFromSteadyState(filter, steady, y);
  y.reverseInPlace();
  return y.segment(pad, n);
}

Eigen::VectorXd Smooth(const Eigen::Ref<const Eigen::VectorXd>& x, int order, double cutoff_Hz,
                       double rate_Hz) {
  if (cutoff_Hz >= 0.5 * rate_Hz) return x;
  const int padding = std::max(3 * order, static_cast<int>(std::ceil(2.0 * rate_Hz / cutoff_Hz)));
  return FilterZeroPhase(ButterworthLowPass(order, cutoff_Hz, rate_Hz), x, padding);
}

Eigen::VectorXd Decimate(const Eigen::Ref<const Eigen::VectorXd>& x, int factor) {
  if (factor < 1) {
    throw std::invalid_argument("decimation factor " + std::to_string(factor) +
                                ", expected at least 1");
  }
  if (factor == 1) return x;
  const Eigen::VectorXd smooth = FilterZeroPhase(ChebyshevLowPass(8, 0.05, 0.8 / factor, 2.0), x);
  const Eigen::Index n = x.size();
  const Eigen::Index kept = (n + factor - 1) / factor;
  const Eigen::Index first = factor - (factor * kept - n) - 1;
  Eigen::VectorXd y(kept);
  for (Eigen::Index i = 0; i < kept; ++i) y[i] = smooth[first + i * factor];
  return y;
}

}  // namespace sinew::identify
