// The threshold of a generalised likelihood ratio test from its mean time between false alarms.
//
// Watched is the largest |sum of the last n values| / sqrt(n), n = 1 .. window, of independent
// standard normal values. Siegmund, Venkatraman (Ann. Statist. 23 (1995) 255, theorem 1, two-sided)
// with the window's limits in the integral (Lai: J. R. Statist. Soc. B 57 (1995) 613, section 3):
//
//     1 / (mean run length) = b phi(b) integral from b / sqrt(window) to b of x nu(x)^2 dx
//
// phi is the normal density; nu(x) corrects for overshoot, about exp(-0.583 x) (Siegmund
// 1985, 4.38), here in the closed form of Siegmund, Yakir (2007): nu(x) = (2/x) (Phi(x/2) - 1/2) /
// ((x/2) Phi(x/2) + phi(x/2)). A test simulates it. Several statistics watched at once: their rates
// add up at most (Bonferroni), so `statistics` divides the run length. Set-up only; throws
// std::invalid_argument.
#pragma once

namespace sinew::residual {

// Mean number of values until a false alarm of one statistic at the threshold b, b >= 1.
double MeanRunLength(double threshold, int window);

// The threshold b at which `statistics` of them together run at least run_length values, in the
// mean; run_length >= 10, both counts >= 1.
double ThresholdFor(double run_length, int window, int statistics);

}  // namespace sinew::residual
