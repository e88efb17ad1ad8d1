// The lower bound of what lifting takes: m g dh for every rise of the centre of mass.
//
// Between two turning points of the height the mass is at rest in the vertical, so the drives have
// done at least m g dh of net work, and positive work (energy.h) is not less. The bound holds where
// nothing else pays: no horizontal motion that is converted, no spring or compressed gas that was
// charged on the way down (then its stored energy is to be subtracted). A published energy below
// the bound is therefore not positive mechanical work: two squats of 17.1 kg by 0.4 m need 134 J.
//
// Rises are counted from a lowest to the next highest height; turns smaller than `band_m` are noise
// and not counted. Of noise within +-n, n < band_m / 2, at most 2 n per rise is counted in excess.
// Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <cstdint>

#include "components/base/types/gravity.h"

namespace sinew::performance {

// m g dh; dh below 0 gives 0.
double LiftingWork_J(double mass_kg, double rise_m,
                     double gravity_m_s2 = types::kGravity_m_s2) noexcept;

class LiftingBound {
 public:
  // Throws std::invalid_argument for a mass, band or gravity that is not positive and finite.
  LiftingBound(double mass_kg, double band_m, double gravity_m_s2 = types::kGravity_m_s2);

  // height_m: of the centre of mass (of the base, times the share of it by which the centre moves),
  // upwards, any origin. One that is not usable (sliding_window.h) is left out and
  // counted.
  void Step(double height_m) noexcept;

  double rise_m() const noexcept;  // all rises, the present one included
  double work_J() const noexcept { return LiftingWork_J(mass_kg_, rise_m(), gravity_m_s2_); }
  std::uint64_t lost() const noexcept { return lost_; }

 private:
  double mass_kg_, band_m_, gravity_m_s2_;
  bool started_ = false, rising_ = false;
  double low_m_ = 0.0, high_m_ = 0.0;  // of this fall, this rise
  double past_m_ = 0.0;                // rises that have ended
  std::uint64_t lost_ = 0;
};

}  // namespace sinew::performance
