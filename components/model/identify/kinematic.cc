#include "components/model/identify/kinematic.h"

#include <algorithm>
#include <cmath>

#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"

namespace sinew::identify {

namespace {

actuator::JointModel OfMotion(const actuator::JointModel& model) {
  actuator::JointModel out = model;
  out.balance = effects::Balance::kMotion;
  return out;
}

// Calls f(segment, index, sample with the measured drive, memory) along every segment.
template <class Function>
void Along(const StateSet& states, const actuator::JointModel& model, Function f) {
  std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
  for (std::size_t s = 0; s < states.segments.size(); ++s) {
    const StateSegment& segment = states.segments[s];
    model.ResetMemory(segment.samples.front(), memory);
    for (Eigen::Index i = 0; i < segment.size(); ++i) {
      const effects::JointSample& x = segment.samples[static_cast<std::size_t>(i)];
      if (i > 0) model.Advance(x, segment.period_s, memory);
      f(s, i, x, memory);
    }
  }
}

}  // namespace

double RawResidualTorque(const StateSet& states, const actuator::JointModel& fitted) {
  const actuator::JointModel model = OfMotion(fitted);
  double squares = 0.0;
  double count = 0.0;
  Along(states, model,
        [&](std::size_t s, Eigen::Index i, const effects::JointSample& x,
            const std::vector<double>& memory) {
          if (!states.segments[s].usable[static_cast<std::size_t>(i)]) return;
          const double residual = model.Residual(x, memory);
          squares += residual * residual;
          count += 1.0;
        });
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

StateSet MakeKinematicStates(const std::vector<types::Run>& runs,
                             const actuator::JointModel& fitted, const ProcessingOptions& motion,
                             double residual_rms_Nm) {
  const actuator::JointModel model = OfMotion(fitted);
  StateSet states = MakeStates(runs, model, motion);
  const double residual =
      residual_rms_Nm > 0.0 ? residual_rms_Nm : RawResidualTorque(states, model);
  states.measured.insert({"tooth_torque_Nm", "tooth_side"});

  std::vector<std::vector<char>> contact;
  for (const StateSegment& segment : states.segments) contact.emplace_back(segment.samples.size());
  Along(states, model,
        [&](std::size_t s, Eigen::Index i, const effects::JointSample& x,
            const std::vector<double>& memory) {
          const auto k = static_cast<std::size_t>(i);
          const double motor = model.SideTorque(effects::Side::kMotor, x, memory);
          const double link = -model.SideTorque(effects::Side::kOutput, x, memory);
          // The link's side is known from sensors and load, the motor's from the current: both are
          // used.
          const double torque = 0.5 * (motor + link);
          // A term that was found, not declared, may sit on the other side of the teeth.
          double doubt = 0.0;
          for (std::size_t t = 0; t < model.terms.size(); ++t) {
            if (model.terms[t].declared || !model.Counts(model.terms[t])) continue;
            doubt += std::abs(model.TermTorque(static_cast<int>(t), x, memory));
          }
          const double sure = kSureContact * residual + doubt;
          effects::JointSample& sample = states.segments[s].samples[k];
          sample.tooth_torque_Nm = torque;
          const bool touches =
              motor * link > 0.0 && std::abs(motor) > sure && std::abs(link) > sure;
          sample.tooth_side = touches ? std::copysign(1.0, torque) : 0.0;
          contact[s][k] = static_cast<char>(sample.tooth_side);
        });

  std::size_t s = 0;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const UniformRun uniform = MakeUniform(runs[r], motion.longest_gap_s);
    for (const UniformSegment& piece : uniform.segments) {
      StateSegment& segment = states.segments[s];
      segment.window.assign(segment.samples.size(), static_cast<int>(r));
      const auto measured = [&](types::Signal signal) -> Eigen::VectorXd {
        return motion.raw ? AsMeasured(runs[r], piece, signal) : piece.signals.at(signal);
      };
      segment.drive_input = measured(types::Signal::kMotorPosition) / model.constants.gear_ratio -
                            measured(types::Signal::kPosition);
      const std::vector<double> seen(segment.drive_input.begin(), segment.drive_input.end());
      if (model.backlash_rad < kSmallPlay * (Quantile(seen, 0.9) - Quantile(seen, 0.1))) {
        segment.at_rest.assign(segment.at_rest.size(), 0);
        ++s;
        continue;
      }
      // The model's torque is smoothed: a side has to hold for longer than the filter sees.
      const double rate = piece.rate_Hz();
      const auto guard = static_cast<Eigen::Index>(
          std::ceil(rate * std::max(motion.reversal_guard_s, 1.0 / motion.state_cutoff_Hz)));
      Eigen::Index held = 0;
      std::vector<char> steady(contact[s].size(), 0);
      for (Eigen::Index i = 0; i < segment.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const bool same = i > 0 && contact[s][k] == contact[s][k - 1];
        held = contact[s][k] == 0 ? 0 : same ? held + 1 : 1;
        if (held > 2 * guard) steady[static_cast<std::size_t>(i - guard)] = 1;
      }
      for (std::size_t k = 0; k < steady.size(); ++k) {
        segment.usable[k] = static_cast<char>(segment.usable[k] && steady[k]);
        segment.at_rest[k] = 0;  // resting encoders repeat one count: no scatter to learn from
      }
      ++s;
    }
  }
  return states;
}

}  // namespace sinew::identify
