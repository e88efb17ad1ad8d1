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

// Four times the median level in the top third of the band.
double NoiseLevel(const Spectrum& spectrum) {
  const Eigen::Index n = spectrum.density.size();
  std::vector<double> top(spectrum.density.begin() + 2 * n / 3, spectrum.density.end());
  std::nth_element(top.begin(), top.begin() + static_cast<std::ptrdiff_t>(top.size() / 2),
                   top.end());
  return 4.0 * top[top.size() / 2];
}

}  // namespace

double NoiseDensity(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  return spectrum.density.size() < 12 ? 0.0 : NoiseLevel(spectrum) / 4.0;
}

double HighestBandAboveNoise(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  const Eigen::Index n = spectrum.density.size();
  if (n < 12) return 0.0;
  const double level = NoiseLevel(spectrum);
  for (Eigen::Index i = n - 3; i >= 3; --i) {
    if (spectrum.density.segment(i - 2, 5).mean() > level) return spectrum.frequency_Hz[i];
  }
  return spectrum.frequency_Hz[1];
}

double BandOfLeastError(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz,
                        int derivative) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  if (spectrum.density.size() < 12) return 0.0;
  const double noise = NoiseLevel(spectrum) / 4.0;
  double error = 0.0, least = 0.0;  // less that of no signal at all
  double best = spectrum.frequency_Hz[1];
  for (Eigen::Index i = 1; i < spectrum.density.size(); ++i) {
    error +=
        std::pow(spectrum.frequency_Hz[i], 2 * derivative) * (2.0 * noise - spectrum.density[i]);
    if (error >= least) continue;
    least = error;
    best = spectrum.frequency_Hz[i];
  }
  return best;
}

double BandOfMotion(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz, double share) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  if (spectrum.density.size() < 12) return 0.0;
  const Eigen::ArrayXd above = (spectrum.density.array() - NoiseLevel(spectrum)).max(0.0) *
                               spectrum.frequency_Hz.array().square();
  const double wanted = share * above.sum();
  double sum = 0.0;
  for (Eigen::Index i = 0; i < above.size(); ++i) {
    sum += above[i];
    if (sum >= wanted) return spectrum.frequency_Hz[i];
  }
  return spectrum.frequency_Hz[1];
}

double BandAbove(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz, double level) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  for (Eigen::Index i = spectrum.density.size() - 1; i > 0; --i) {
    if (spectrum.density[i] > level) return spectrum.frequency_Hz[i];
  }
  return 0.0;
}

double BandAboveNoise(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz) {
  const Spectrum spectrum = PowerDensity(x, rate_Hz, 1024);
  const Eigen::Index n = spectrum.density.size();
  if (n < 12) return 0.0;
  const double level = NoiseLevel(spectrum);
  for (Eigen::Index i = 1; i < n; ++i) {
    if (spectrum.density[i] < level) return spectrum.frequency_Hz[i];
  }
  return spectrum.frequency_Hz[n - 1];
}

}  // namespace sinew::identify
