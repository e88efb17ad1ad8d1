#include "tests/components/model/gate/plant.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <stdexcept>

#include "components/model/identify/statistics.h"

namespace sinew::gate {

namespace {

using types::Run;
using types::Signal;
using Runs = std::vector<Run>;
using Random = std::mt19937_64;

constexpr double kPi = std::numbers::pi;

struct Planting {
  FaultKind kind;
  std::function<void(Random&, Runs*, actuator::JointModel*)> plant;
};

std::size_t Any(Random& random, const Runs& runs) { return random() % runs.size(); }

auto Scale(std::vector<Signal> signals, double factor, bool all = true) {
  return [=](Random& random, Runs* runs, actuator::JointModel*) {
    const std::size_t one = Any(random, *runs);
    for (std::size_t k = 0; k < runs->size(); ++k) {
      if (!all && k != one) continue;
      for (const Signal signal : signals) {
        if ((*runs)[k].Has(signal)) (*runs)[k].signals[signal] *= factor;
      }
    }
  };
}

// A single row, by 30 to 100 % of the channel's range and at least 30 times its noise.
auto Spike(Signal signal) {
  return [=](Random& random, Runs* runs, actuator::JointModel*) {
    Eigen::VectorXd& x = (*runs)[Any(random, *runs)].signals.at(signal);
    const double noise = identify::WhiteNoise(std::span<const Eigen::VectorXd>(&x, 1));
    const double range = std::max(x.maxCoeff() - x.minCoeff(), 30.0 / 0.3 * noise);
    const auto row =
        static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(x.size() - 20)) + 10;
    const double size = std::uniform_real_distribution<>(0.3, 1.0)(random);
    x[row] += (random() % 2 == 0 ? 1.0 : -1.0) * size * range;
  };
}

// 0.5 to 2 s, where the joint moves most of the time.
auto Freeze(Signal signal) {
  return [=](Random& random, Runs* runs, actuator::JointModel*) {
    Run& run = (*runs)[Any(random, *runs)];
    Eigen::VectorXd& x = run.signals.at(signal);
    const Eigen::VectorXd& q =
        run.At(run.Has(Signal::kMotorPosition) ? Signal::kMotorPosition : Signal::kPosition);
    const double length_s = std::uniform_real_distribution<>(0.5, 2.0)(random);
    const double period =
        (run.time_s[run.size() - 1] - run.time_s[0]) / static_cast<double>(run.size());
    const auto rows = static_cast<Eigen::Index>(length_s / period);
    const double range = q.maxCoeff() - q.minCoeff();
    Eigen::Index first = 0;
    for (int attempt = 0; attempt < 1000; ++attempt) {
      first = static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(x.size() - rows - 1));
      const auto part = q.segment(first, rows);
      if (part.maxCoeff() - part.minCoeff() > 0.1 * range) break;
    }
    x.segment(first, rows).setConstant(x[first]);
  };
}

auto Wrap(Signal signal, double period, bool at_median) {
  return [=](Random&, Runs* runs, actuator::JointModel*) {
    for (Run& run : *runs) {
      Eigen::VectorXd& x = run.signals.at(signal);
      const double start = at_median ? 0.5 * (x.maxCoeff() + x.minCoeff()) : 0.0;
      for (double& value : x) value -= period * std::floor((value - start) / period) + start;
    }
  };
}

auto Copy(Signal from, Signal to) {
  return [=](Random&, Runs* runs, actuator::JointModel*) {
    for (Run& run : *runs) run.signals[to] = run.At(from);
  };
}

auto Hold(Signal signal) {
  return [=](Random&, Runs* runs, actuator::JointModel*) {
    for (Run& run : *runs) run.signals.at(signal).setConstant(run.At(signal)[0]);
  };
}

const std::vector<Planting>& Plantings() {
  constexpr auto q = Signal::kPosition, v = Signal::kVelocity, m = Signal::kMotorPosition,
                 w = Signal::kMotorVelocity, i = Signal::kMotorCurrent,
                 p = Signal::kChamberPressure, f = Signal::kLoadForce;
  static const std::vector<Planting> all = {
      {{"drive_reversed", {"drive_sign"}}, Scale({i}, -1.0)},
      {{"drive_reversed_in_one", {"drive_sign"}}, Scale({i}, -1.0, false)},
      {{"output_reversed", {"sign_gear"}}, Scale({q, v}, -1.0)},
      {{"motor_reversed", {"sign_gear"}}, Scale({m, w}, -1.0)},
      {{"velocity_reversed", {"sign_speed"}}, Scale({v}, -1.0)},
      {{"motor_velocity_reversed_in_one", {"sign_speed"}}, Scale({w}, -1.0, false)},
      {{"angles_in_degrees", {"units"}}, Scale({q, v, m, w}, 180.0 / kPi)},
      {{"output_in_degrees", {"units_gear"}}, Scale({q, v}, 180.0 / kPi)},
      {{"motor_in_degrees", {"units_gear"}}, Scale({m, w}, 180.0 / kPi)},
      {{"motor_in_turns", {"units_gear", "units_speed"}}, Scale({m}, 0.5 / kPi)},
      {{"velocity_in_degrees", {"units_speed"}}, Scale({v}, 180.0 / kPi)},
      {{"motor_velocity_in_rpm", {"units_speed"}}, Scale({w}, 30.0 / kPi)},
      {{"current_in_mA", {"units"}}, Scale({i}, 1e3)},
      {{"current_in_mA_in_one", {"units", "recording_differs"}}, Scale({i}, 1e3, false)},
      {{"pressure_in_kPa", {"units"}}, Scale({p}, 100.0)},
      {{"pressure_in_Pa", {"units"}}, Scale({p}, 1e5)},
      {{"pressure_in_kPa_in_one", {"units", "recording_differs"}}, Scale({p}, 100.0, false)},
      {{"load_in_mN", {"units"}, true}, Scale({f}, 1e3)},
      {{"stamps_in_ms", {"units", "units_speed"}},
       [](Random&, Runs* runs, actuator::JointModel*) {
         for (Run& run : *runs) run.time_s *= 1e3;
       }},
      {{"spike_position", {"spike"}, false, true}, Spike(q)},
      {{"spike_motor_position", {"spike"}, false, true}, Spike(m)},
      {{"spike_current", {"spike"}, false, true}, Spike(i)},
      {{"spike_pressure", {"spike"}, false, true}, Spike(p)},
      {{"spike_load", {"spike"}, false, true}, Spike(f)},
      {{"frozen_position", {"frozen"}}, Freeze(q)},
      {{"frozen_motor_position", {"frozen"}}, Freeze(m)},
      {{"frozen_velocity", {"frozen"}}, Freeze(v)},
      {{"frozen_motor_velocity", {"frozen"}}, Freeze(w)},
      {{"frozen_current", {"frozen"}}, Freeze(i)},
      {{"frozen_pressure", {"frozen"}}, Freeze(p)},
      {{"frozen_load", {"frozen"}}, Freeze(f)},
      {{"wrapped_motor", {"wrapped"}}, Wrap(m, 2.0 * kPi, false)},
      {{"wrapped_output", {"wrapped"}}, Wrap(q, 2.0 * kPi, true)},
      {{"constant_position", {"constant"}}, Hold(q)},
      {{"constant_motor_velocity", {"constant"}}, Hold(w)},
      {{"constant_current", {"constant"}}, Hold(i)},
      {{"duplicated_velocity", {"duplicated"}}, Copy(q, v)},
      {{"duplicated_load", {"duplicated"}}, Copy(i, f)},
      {{"missing_torque_constant", {"missing_constant"}},
       [](Random&, Runs*, actuator::JointModel* model) {
         model->constants.torque_constant_Nm_A = 0.0;
       }},
      {{"not_a_number", {"non_finite"}},
       [](Random& random, Runs* runs, actuator::JointModel*) {
         Eigen::VectorXd& x = (*runs)[Any(random, *runs)].signals.at(Signal::kMotorCurrent);
         x[static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(x.size()))] =
             std::numeric_limits<double>::quiet_NaN();
       }},
      {{"stamp_back", {"stamps"}},
       [](Random& random, Runs* runs, actuator::JointModel*) {
         Run& run = (*runs)[Any(random, *runs)];
         const auto row =
             static_cast<Eigen::Index>(random() % static_cast<std::uint64_t>(run.size() - 2)) + 1;
         run.time_s[row] = run.time_s[row - 1];
       }},
  };
  return all;
}

}  // namespace

const std::vector<FaultKind>& FaultKinds() {
  static const std::vector<FaultKind> kinds = [] {
    std::vector<FaultKind> out;
    for (const Planting& at : Plantings()) out.push_back(at.kind);
    return out;
  }();
  return kinds;
}

bool IsFound(const FaultKind& kind, const GateReport& report) {
  if (kind.leaves_out && !report.left_out.empty()) return true;
  return std::any_of(report.faults.begin(), report.faults.end(), [&](const Fault& fault) {
    return std::find(kind.rules.begin(), kind.rules.end(), fault.rule) != kind.rules.end();
  });
}

void Plant(const std::string& name, std::uint64_t seed, Runs* runs, actuator::JointModel* model) {
  for (const Planting& at : Plantings()) {
    if (at.kind.name != name) continue;
    Random random(seed);
    at.plant(random, runs, model);
    return;
  }
  throw std::invalid_argument("no data fault is called '" + name + "'");
}

}  // namespace sinew::gate
