// Recursive low-pass filters of any order, and their zero-phase use on whole recordings.
//
// Design: analogue prototype, bilinear transform with pre-warped cut-off, second-order sections
// (Oppenheim, Schafer: Discrete-Time Signal Processing, 7.1). Zero phase: forward and backward with
// odd reflection at both ends and steady-state initial conditions (Gustafsson, IEEE Trans. Signal
// Processing 44 (1996) 988; the same as filtfilt of MATLAB and SciPy).
// Set-up only: allocates, throws std::invalid_argument with the value in the message.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace sinew::identify {

// b0 + b1 z^-1 + b2 z^-2 over 1 + a1 z^-1 + a2 z^-2.
struct Biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0;
  double a1 = 0.0, a2 = 0.0;
};

struct IirFilter {
  std::vector<Biquad> sections;
  int order = 0;

  // |H| at a frequency in Hz, for a sampling rate in Hz.
  double Gain(double frequency_Hz, double rate_Hz) const;
};

// cutoff: -3.01 dB point, 0 < cutoff < rate / 2; order 1 to 20.
IirFilter ButterworthLowPass(int order, double cutoff_Hz, double rate_Hz);

// ripple_dB > 0: pass-band ripple; cutoff: where the gain leaves the ripple band.
IirFilter ChebyshevLowPass(int order, double ripple_dB, double cutoff_Hz, double rate_Hz);

// One pass from zero state.
Eigen::VectorXd Filter(const IirFilter& filter, const Eigen::Ref<const Eigen::VectorXd>& x);

// Forward and backward: no phase, the gain squared. padding: samples reflected at each end; -1
// takes 3 x order (MATLAB). Limited to size - 1. Needs at least 2 samples.
Eigen::VectorXd FilterZeroPhase(const IirFilter& filter, const Eigen::Ref<const Eigen::VectorXd>& x,
                                int padding = -1);

// Butterworth low-pass without phase, padded so far that its start-up dies out inside the reflected
// part; x itself from the Nyquist frequency on.
Eigen::VectorXd Smooth(const Eigen::Ref<const Eigen::VectorXd>& x, int order, double cutoff_Hz,
                       double rate_Hz);

// MATLAB's decimate(x, factor): Chebyshev type I of order 8, 0.05 dB, cut-off at 0.8 of the new
// Nyquist frequency, zero phase; then every factor-th sample, so that the last sample of x is kept.
Eigen::VectorXd Decimate(const Eigen::Ref<const Eigen::VectorXd>& x, int factor);

}  // namespace sinew::identify
