// For the files of catalogue/ only: friction that turns over with the stroke after a reversal
// (Dahl: A Solid Friction Model, 1968).
//
//     dz/dt = v / xs * (1 - z sign v),   |z| <= 1
//
// Between two samples the motion is taken as one stroke of sign s, in closed form: strokes of one
// sign compose exactly. Memory: z and the position it belongs to; psi: xs.
#pragma once

#include <cmath>
#include <span>

#include "components/model/effects/define.h"

namespace sinew::effects {

class Dahl : public Effect {
 public:
  using Effect::Effect;

  int memory_size() const noexcept override { return 2; }

  void ResetMemory(const JointSample& x, std::span<const double> /*psi*/,
                   std::span<double> memory) const noexcept override {
    memory[0] = 0.0;
    memory[1] = x.position_rad;
  }

  void Advance(const JointSample& x, double /*dt_s*/, std::span<const double> psi,
               std::span<double> memory) const noexcept override {
    const double stroke = x.position_rad - memory[1];
    const double s = Sign(stroke);
    if (s != 0.0) memory[0] = s + (memory[0] - s) * std::exp(-std::abs(stroke) / psi[0]);
    memory[1] = x.position_rad;
  }
};

}  // namespace sinew::effects
