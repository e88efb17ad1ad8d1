// Execution phase of Fig 7.1: inside the free play (SEA) or outside (PEA), from the play angle
//
//     alpha = motor angle / N - output angle, from the lower contact: 0 <= alpha <= backlash
//
// 0 < alpha < backlash is inside; at either end teeth touch: the source's rule (alpha < backlash)
// with both ends named. Lower contact: the motor pushes the link down; upper: up.
//
// The output encoder's counts and noise blur alpha by sigma. Let x be the distance to a contact and
// m_n the mean of its last n values since the last decision, n = 1..16. With a threshold t of half
// the hysteresis (two encoder counts, so one; 2.5 sigma where that is more):
//
//     the contact is left when     m_n > t + 4.5 sigma / sqrt(n) for an n,
//                                  or x > t + 2 sigma after x > t + sigma / 2, from firm contact
//                                  (m_8 < t - 1.75 sigma since it was reached)
//     the contact is reached when  m_n < t - 4.5 sigma / sqrt(n) for an n,
//                                  or x <= t - sigma, coming from afar by a sigma a sample
//
// so fast motion is decided on one sample, creeping on as many as it takes, and a joint that rests
// at the threshold does not chatter. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <array>

#include "components/base/types/regime.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::regime {

using Contact = msg::ContactSide;

struct PlayConfig {
  double backlash_rad = 0.0;                       // full width at the output
  double output_count_rad = 3.834951969714103e-4;  // 14 bit
  double output_noise_rad = 1.5e-4;                // standard deviation of the output encoder
  double hysteresis_counts = 2.0;
  double sampling_skew_s = 0.0;  // motor and output are sampled this far apart
};

struct PlayDecision {
  types::Regime regime = types::Regime::kUnknown;
  Contact contact = Contact::kNone;
  double confidence = 0.0;  // probability that noise alone did not decide otherwise
};

class PlayDetector {
 public:
  // Throws std::invalid_argument for widths that are not positive, or a backlash under eight
  // counts.
  explicit PlayDetector(const PlayConfig& config);

  void Reset() noexcept;
  // alpha_rad is finite; velocity_rad_s of the output widens sigma by the sampling skew.
  PlayDecision Step(double alpha_rad, double velocity_rad_s) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

  // Standard deviation of alpha at rest.
  double sigma_rad() const noexcept { return sigma_rad_; }

 private:
  static constexpr int kWindow = 16;

  double Threshold_rad(double sigma_rad) const noexcept;
  // Into the play from a contact: of the sample `age` samples ago; of the newest samples.
  double Distance(Contact contact, int age) const noexcept {
    const double alpha_rad = alpha_[(next_ + kWindow - 1 - age) % kWindow];
    return contact == Contact::kUpper ? config_.backlash_rad - alpha_rad : alpha_rad;
  }
  double Sum(Contact contact, int samples) const noexcept;
  bool Leaves(double threshold, double sigma) const noexcept;
  bool Reaches(Contact side, double threshold, double sigma) const noexcept;

  PlayConfig config_;
  double sigma_rad_;
  std::array<double, kWindow> alpha_{};
  int next_ = 0;
  int known_ = 0;              // samples in alpha_
  int since_ = 0;              // samples since the last decision
  std::array<bool, 2> far_{};  // from the lower and upper contact, since it was left
  bool firm_ = false;          // the contact has been seen beyond doubt
  Contact contact_ = Contact::kNone;
  bool started_ = false;
};

}  // namespace sinew::regime
