// The size of an effect in a rig, whether it is identifiable, and its class of equivalent effects.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/rigs/drawn/likelihood.h"
#include "bench/rigs/drawn/motion.h"
#include "bench/rigs/drawn/undeclared.h"

namespace sinew::rigs {

// All recordings of one rig, motion and set of effects.
struct Run {
  std::vector<std::vector<TrueRow>> rows;  // kRecordings of them
};
Run Play(const Rig& rig, const std::vector<Effect>& effects, Excitation excitation,
         int recordings = kRecordings);

struct Measured {
  double share = 0.0;   // of the raw residual's variance, 1 - twin's / its own, training recordings
  double lambda = 0.0;  // of the likelihood test
  double residual_rms = 0.0, twin_rms = 0.0;
};

// Twins of one rig and excitation are made once.
class Sizer {
 public:
  Sizer(const Rig& rig, Excitation excitation);

  // Share and test of a set of effects in the balance.
  Measured Measure(const Run& run, Shows asked, bool absorbed = false) const;

  struct Sized {
    Effect effect;
    Measured measured;
    bool reached = false;  // the requested share, within a fifth of its odds
  };
  // The effect with a size that makes the share (weak 0.10, strong 0.30), or, where a refit
  // absorbs it, a lambda (weak 20, strong 60). Never beyond LargestSize.
  Sized Size(const Effect& effect, double share) const;

  // Effects whose best fit to this signature loses less than kClassMargin of its energy; the effect
  // itself first.
  std::vector<std::string> ClassOf(const Effect& effect) const;

  double width_rows() const { return width_; }

 private:
  struct Signature {
    Eigen::VectorXd values;
    std::vector<int> row;
  };
  Balance Clean(const Run& run, Shows shows, int recordings) const;
  Balance Noisy(const Run& run, Shows shows, int recordings) const;
  Signature SignatureOf(const Balance& with, const Balance& without) const;

  double Share(const Run& run, Shows asked) const;
  std::pair<double, double> Residuals(const Balance& noisy, Shows shows) const;
  const Balance& TwinBalance(Shows shows, bool noisy) const;
  const std::vector<Signature>& RivalsOf(const std::string& name, Shows shows) const;

  const Rig& rig_;
  mutable std::map<std::string, std::vector<Signature>> rivals_;
  mutable std::map<std::pair<int, bool>, Balance> twins_;
  Excitation excitation_;
  Run twin_;
  double width_ = 3.0;
};

inline constexpr double kWeakShare = 0.10, kStrongShare = 0.30;
inline constexpr double kWeakLambda = 20.0, kStrongLambda = 60.0;
inline constexpr double kClassMargin = 0.05;

}  // namespace sinew::rigs
