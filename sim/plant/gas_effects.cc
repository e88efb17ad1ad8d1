#include "sim/plant/gas_effects.h"

namespace sinew::plant {

GasEffects::GasEffects(const actuator::JointModel& model) : model_(model) {
  for (const actuator::Term& term : model.terms) {
    if (term.effect->info().name == "valve_dead_time") dead_time_s_ += term.linear[0].value;
  }
  model_.balance = effects::Balance::kGas;
  std::erase_if(model_.terms, [this](const actuator::Term& term) {
    const effects::EffectInfo& info = term.effect->info();
    return !model_.Counts(term) || !info.rate || info.name == "gas_compression" ||
           info.name == "pressure_offset";
  });
  memory_.resize(static_cast<std::size_t>(model_.memory_size()));
  Reset();
}

void GasEffects::Reset() {
  waited_s_ = 0.0;
  model_.ResetMemory({}, memory_);
}

bool GasEffects::Valve(bool command, double dt_s) noexcept {
  waited_s_ = command ? waited_s_ + dt_s : 0.0;
  return command && waited_s_ > dead_time_s_;
}

double GasEffects::Rate_bar_s(double pressure_bar, double pressure_rate_bar_s,
                              double volume_rate_1_s, bool valve_open, double dt_s) noexcept {
  if (model_.terms.empty()) return 0.0;
  effects::JointSample x;
  x.pressure_bar = pressure_bar;
  x.pressure_rate_bar_s = pressure_rate_bar_s;
  x.volume_rate_1_s = volume_rate_1_s;
  x.valve_open = valve_open;
  model_.Advance(x, dt_s, memory_);
  return -model_.Torque(effects::Role::kPassive, x, memory_);
}

}  // namespace sinew::plant
