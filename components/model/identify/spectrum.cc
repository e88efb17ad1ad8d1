#include "components/model/identify/spectrum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace sinew::identify {

std::vector<std::complex<double>> FourierTransform(std::span<const double> x) {
  std::vector<std::complex<double>> out(x.size() / 2 + 1);
  if (x.size() < 2) {  // Eigen's transform of one value reads what is not there
    if (!x.empty()) out[0] = x[0];
    return out;
  }
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  fft.fwd(out.data(), x.data(), static_cast<Eigen::Index>(x.size()));
  return out;
}

Spectrum PowerDensity(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz, int length) {
  Spectrum out;
  if (x.size() < 8) return out;
  std::size_t n = std::bit_floor(static_cast<std::size_t>(std::max(length, 8)));
  n = std::min(n, std::bit_floor(static_cast<std::size_t>(x.size())));
  const auto size = static_cast<Eigen::Index>(n);
  Eigen::VectorXd window(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    window[i] = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(i) /
                                     static_cast<double>(size));
  }
  const double mean = x.mean();
  out.frequency_Hz.resize(size / 2 + 1);
  out.density = Eigen::VectorXd::Zero(size / 2 + 1);
  std::vector<double> piece(n);
  int pieces = 0;
  for (Eigen::Index start = 0; start + size <= x.size(); start += size / 2, ++pieces) {
    for (Eigen::Index i = 0; i < size; ++i) {
      piece[static_cast<std::size_t>(i)] = (x[start + i] - mean) * window[i];
    }
    const std::vector<std::complex<double>> transform = FourierTransform(piece);
    for (Eigen::Index i = 0; i <= size / 2; ++i) {
      out.density[i] += std::norm(transform[static_cast<std::size_t>(i)]);
    }
  }
  const double scale = 2.0 / (rate_Hz * window.squaredNorm() * pieces);
  out.density *= scale;
  out.density[0] /= 2.0;
  out.density[size / 2] /= 2.0;
  for (Eigen::Index i = 0; i <= size / 2; ++i) {
    out.frequency_Hz[i] = rate_Hz * static_cast<double>(i) / static_cast<double>(size);
  }
  return out;
}

namespace {

constexpr Eigen::Index kFewestLines = 12;
constexpr double kAboveNoise = 4.0;

}  // namespace

double Spectrum::Noise() const {
  const Eigen::Index n = density.size();
  if (n < kFewestLines) return 0.0;
  std::vector<double> top(density.begin() + 2 * n / 3, density.end());
  std::nth_element(top.begin(), top.begin() + static_cast<std::ptrdiff_t>(top.size() / 2),
                   top.end());
  return top[top.size() / 2];
}

double Spectrum::HighestBandAboveNoise() const {
  if (density.size() < kFewestLines) return 0.0;
  const double level = kAboveNoise * Noise();
  for (Eigen::Index i = density.size() - 3; i >= 3; --i) {
    if (density.segment(i - 2, 5).mean() > level) return frequency_Hz[i];
  }
  return frequency_Hz[1];
}

double Spectrum::BandOfLeastError(int derivative) const {
  if (density.size() < kFewestLines) return 0.0;
  const double noise = Noise();
  double error = 0.0, least = 0.0;  // less that of no signal at all
  double best = frequency_Hz[1];
  for (Eigen::Index i = 1; i < density.size(); ++i) {
    error += std::pow(frequency_Hz[i], 2 * derivative) * (2.0 * noise - density[i]);
    if (error >= least) continue;
    least = error;
    best = frequency_Hz[i];
  }
  return best;
}

double Spectrum::BandOfMotion(double share) const {
  if (density.size() < kFewestLines) return 0.0;
  const Eigen::ArrayXd above =
      (density.array() - kAboveNoise * Noise()).max(0.0) * frequency_Hz.array().square();
  const double wanted = share * above.sum();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < above.size(); ++i) {
    sum += above[i];
    if (sum >= wanted) return frequency_Hz[i];
  }
  return frequency_Hz[1];
}

double Spectrum::BandAbove(double level) const {
  for (Eigen::Index i = density.size() - 1; i > 0; --i) {
    if (density[i] > level) return frequency_Hz[i];
  }
  return 0.0;
}

double Spectrum::BandAboveNoise() const {
  if (density.size() < kFewestLines) return 0.0;
  const double level = kAboveNoise * Noise();
  for (Eigen::Index i = 1; i < density.size(); ++i) {
    if (density[i] < level) return frequency_Hz[i];
  }
  return frequency_Hz[density.size() - 1];
}

}  // namespace sinew::identify
