// Power over frequency, by the fast Fourier transform, and the frequencies up to which a signal is
// above its noise. Pure, any thread; allocates.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

namespace sinew::identify {

// sum over i of x[i] exp(-2 pi j k i / n), k = 0 .. n / 2, of n = x.size() values of a real signal.
// Fastest for powers of 2.
std::vector<std::complex<double>> FourierTransform(std::span<const double> x);

struct Spectrum {
  Eigen::VectorXd frequency_Hz;
  Eigen::VectorXd density;  // one-sided power per Hz; integrates to the variance

  // The following are 0 where there are too few lines.
  // Median density in the top third of the band, per Hz: noise, if anything is.
  double Noise() const;
  // The lowest frequency at which the spectrum sinks to four times that: above it there is more
  // noise than motion.
  double BandAboveNoise() const;
  // The same from above: the highest frequency at which the spectrum, averaged over five lines,
  // still stands above that level. Motion made of ramps or of one frequency has gaps below.
  double HighestBandAboveNoise() const;
  // Cut-off of the low-pass behind which a derivative has the least squared error: what it lets
  // pass of white noise and what it takes from the signal (an ideal low-pass in the sense of
  // Wiener).
  double BandOfLeastError(int derivative) const;
  // The lowest frequency below which this share of the velocity's power above the noise lies.
  double BandOfMotion(double share) const;
  // The highest frequency at which the density, per Hz, stands above a level.
  double BandAbove(double level) const;
};

// Welch's method: Hann window, pieces of `length` (a power of 2, reduced to fit) that overlap by
// half, mean removed. Empty for fewer than 8 samples.
Spectrum PowerDensity(const Eigen::Ref<const Eigen::VectorXd>& x, double rate_Hz,
                      int length = 1024);

}  // namespace sinew::identify
