#include "tests/bank/bank.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "components/identify/fit.h"
#include "components/trace/balances.h"
#include "components/trace/close_loop.h"
#include "components/trace/slow_motion.h"
#include "sim/surrogate/undeclared.h"
#include "tests/bank/oracle.h"

namespace sinew::bank {
namespace {

using surrogate::ExcitationKind;

constexpr double kColouredNoise_A = 0.05;
constexpr double kShort_s = 25.0;  // recordings without an effect are short ones

// Effects that act either way: odd seeds take the other sign.
constexpr std::array<std::string_view, 10> kEitherWay = {"direction_dependent_viscous",
                                                         "direction_dependent_coulomb",
                                                         "torque_constant_gain",
                                                         "current_offset",
                                                         "gear_eccentricity",
                                                         "encoder_eccentricity",
                                                         "external_bump",
                                                         "gravity_phase",
                                                         "load_cell_gain",
                                                         "pressure_offset"};

constexpr std::array<std::array<std::string_view, 2>, 20> kPairs = {{
    {"stribeck", "quadratic_viscous"},
    {"stribeck", "gear_eccentricity"},
    {"quadratic_viscous", "direction_dependent_viscous"},
    {"quadratic_viscous", "seal_hysteresis"},
    {"direction_dependent_viscous", "seal_hysteresis"},
    {"direction_dependent_viscous", "load_dependent_friction"},
    {"cogging", "quadratic_viscous"},
    {"cogging", "seal_hysteresis"},
    {"load_dependent_friction", "gear_eccentricity"},
    {"drive_efficiency_direction", "quadratic_viscous"},
    {"temperature_friction", "gravity_phase"},
    {"transport_delay", "quadratic_viscous"},
    {"transport_delay", "seal_hysteresis"},
    {"flexible_link", "direction_dependent_viscous"},
    {"pressure_lag", "quadratic_viscous"},
    {"stiffness_collapse", "stribeck"},
    {"presliding", "direction_dependent_viscous"},
    {"payload_step", "quadratic_viscous"},
    {"external_bump", "stribeck"},
    {"torque_constant_saturation", "gravity_phase"},
}};

struct Designs {
  identify::Design train, sealed;
};

Designs MakeDesigns(const Recorded& recorded, const actuator::JointModel& model,
                    const identify::ProcessingOptions& processing) {
  return {identify::Design(identify::MakeStates(recorded.train, model, processing), processing),
          identify::Design(identify::MakeStates(recorded.sealed, model, processing), processing)};
}

double Rate_Hz(const Recorded& recorded) {
  const Eigen::VectorXd& time_s = recorded.train.front().time_s;
  return static_cast<double>(time_s.size() - 1) / (time_s[time_s.size() - 1] - time_s[0]);
}

// Where an effect shows: torque that repeats with the motor's angle does where the motion creeps.
bool ShowsInSlowMotion(const std::vector<std::string>& names, const actuator::JointModel& model) {
  const std::vector<std::string> slow = trace::EffectsOfMotorAngle(model);
  return names.size() == 1 && std::find(slow.begin(), slow.end(), names.front()) != slow.end();
}

double SignOf(const std::string& effect, std::uint64_t seed) {
  const bool either = std::find(kEitherWay.begin(), kEitherWay.end(), effect) != kEitherWay.end();
  return either && seed % 2 == 1 ? -1.0 : 1.0;
}

Scene SceneOf(const Case& what) {
  Scene scene{.excitation = what.excitation, .seed = what.seed};
  if (what.kind == Kind::kNone) scene.seconds = kShort_s;
  if (what.coloured) scene.coloured_noise_A = kColouredNoise_A;
  for (const std::string& name : what.effects) {
    const SizeOf& size = FindSize(name, what.excitation);
    scene.effects.push_back(
        {name,
         SignOf(name, what.seed) * (what.strength == Strength::kWeak ? size.weak : size.strong),
         0.0});
  }
  return scene;
}

// What the oracle is fitted to, and beside what it is judged.
struct Ground {
  identify::Design train, sealed;
  actuator::JointModel declared;
  const trace::Judgement* judged = nullptr;
};

// None where the recordings show nothing of the balance.
std::optional<Ground> GroundOf(effects::Balance balance, const std::vector<std::string>& names,
                               const Recorded& recorded, const trace::LoopResult& loop) {
  actuator::JointModel declared = loop.trace.declared;
  if (balance != effects::Balance::kMotion) {
    declared.balance = balance;
    trace::BalanceDesigns designs =
        trace::MakeBalanceDesigns(balance, recorded.train, recorded.sealed, declared,
                                  identify::Resolve(recorded.processing, recorded.train));
    if (!designs.why_not.empty()) return std::nullopt;
    const auto& all = loop.trace.balances;
    const auto judged = std::find_if(
        all.begin(), all.end(), [&](const auto& summary) { return summary.balance == balance; });
    return Ground{std::move(*designs.train), std::move(*designs.sealed), std::move(declared),
                  &*judged};
  }
  if (ShowsInSlowMotion(names, recorded.declared)) {
    declared = trace::HeldForSlowMotion(declared);
    Designs slow =
        MakeDesigns(recorded, declared,
                    identify::SlowMotion(identify::Resolve(recorded.processing, recorded.train),
                                         declared, Rate_Hz(recorded)));
    if (trace::ShowsSlowMotion(slow.train, slow.sealed)) {
      return Ground{std::move(slow.train), std::move(slow.sealed), std::move(declared), nullptr};
    }
  }
  Designs designs = MakeDesigns(recorded, recorded.declared, recorded.processing);
  return Ground{std::move(designs.train), std::move(designs.sealed), recorded.declared, nullptr};
}

void JudgeAgainstOracle(const Case& what, const Scene& scene, const Recorded& recorded,
                        const trace::LoopResult& loop, bool parameters, Outcome* out) {
  std::optional<effects::Balance> balance;
  for (const std::string& name : what.effects) {
    const std::optional<effects::Balance> shown = BalanceOf(name, recorded.declared);
    if (!shown || (balance && shown != balance)) return;
    balance = shown;
  }
  std::optional<Ground> seen = GroundOf(*balance, what.effects, recorded, loop);
  if (!seen) return;
  Ground& ground = *seen;
  const Oracle oracle = FitOracle(&ground.train, ground.declared, what.effects);
  const auto error_of = [&](actuator::JointModel model) {
    model.balance = *balance;
    ground.sealed.PredictDrive(model);
    return identify::ErrorOf(ground.sealed, model).rms;
  };
  out->sealed_oracle = error_of(oracle.model);
  out->oracle_significant = oracle.significant;
  out->sealed_before =
      ground.judged ? ground.judged->before_sealed.rms : error_of(loop.trace.declared);
  out->sealed_after =
      ground.judged ? ground.judged->after_sealed.rms : error_of(loop.trace.corrected);

  if (!parameters || what.kind != Kind::kEffect) return;
  const auto found = std::find_if(loop.trace.effects.begin(), loop.trace.effects.end(),
                                  [&](const trace::FoundEffect& effect) {
                                    return effect.name == what.effects.front() &&
                                           effect.balance == *balance && !effect.swallowed;
                                  });
  if (found == loop.trace.effects.end()) return;
  Scene silent = scene;
  silent.silent = true;
  const Recorded clean = Record(silent);
  std::optional<Ground> clean_ground = GroundOf(*balance, what.effects, clean, loop);
  if (!clean_ground) return;
  const actuator::Term& term = loop.trace.corrected.terms[static_cast<std::size_t>(found->term)];
  const Oracle truth = FitOracle(&clean_ground->train, clean_ground->declared, what.effects);
  const actuator::ParameterValue& value = MainParameter(term);
  out->value = value.value;
  out->half_width = value.half_width_95.value_or(std::numeric_limits<double>::quiet_NaN());
  out->truth = truth.value;
}

std::string Explain(const trace::TraceResult& result) {
  std::string out;
  const auto add = [&](const std::vector<trace::RoundReport>& rounds, const char* where) {
    for (const trace::RoundReport& round : rounds) {
      for (std::size_t i = 0; i < round.scores.size() && i < 5; ++i) {
        const trace::CandidateScore& score = round.scores[i];
        char line[240];
        std::snprintf(
            line, sizeof line,
            "  %s%s %-32s gain %6.3f +- %.3f (placebo %.3f) theta %.3g psi %.3g size/se %.1f  %s\n",
            where, round.slow_motion ? " slow" : "", score.name.c_str(), score.gain_share,
            score.share_error, round.placebo_99, score.theta.empty() ? 0.0 : score.theta.front(),
            score.psi.empty() ? 0.0 : score.psi.front(), score.size_in_errors,
            score.name == round.added ? "ADDED" : score.refused.c_str());
        out += line;
      }
    }
  };
  add(result.rounds, "M");
  for (const trace::BalanceSummary& balance : result.balances) add(balance.rounds, "other");
  char line[160];
  std::snprintf(
      line, sizeof line,
      "  train %.4f -> %.4f, floor %.4f, ceiling %.4f, units %d of %.2f s, rest follows %s %.3f\n",
      result.before_train.rms, result.after_train.rms, result.noise_floor_rms, result.ceiling_rms,
      result.units, result.unit_length_s, result.unexplained.variable.c_str(),
      result.unexplained.share);
  return out + line;
}

}  // namespace

std::vector<std::string> CatalogueNames() {
  std::vector<std::string> names;
  for (const surrogate::EffectInfo& info : surrogate::UndeclaredEffects()) {
    if (info.in_catalogue) names.emplace_back(info.name);
  }
  return names;
}

std::vector<std::string> OutsideNames() {
  std::vector<std::string> names;
  for (const surrogate::EffectInfo& info : surrogate::UndeclaredEffects()) {
    if (!info.in_catalogue) names.emplace_back(info.name);
  }
  return names;
}

std::vector<Case> MakeCases(const Plan& plan) {
  std::vector<Case> cases;
  const auto wanted = [&](const std::string& name) {
    return plan.effects.empty() ||
           std::find(plan.effects.begin(), plan.effects.end(), name) != plan.effects.end();
  };
  for (const std::string& name : plan.effects) {
    const std::vector<std::string> in = CatalogueNames(), outside = OutsideNames();
    if (std::find(in.begin(), in.end(), name) == in.end() &&
        std::find(outside.begin(), outside.end(), name) == outside.end() && name != "none" &&
        name != "pairs") {
      throw std::invalid_argument("effect '" + name +
                                  "' is not known, expected one of the surrogate's, none or pairs");
    }
  }
  const auto seed_of = [&](int k) { return plan.first_seed + static_cast<std::uint64_t>(k); };
  std::vector<ExcitationKind> excitations = {ExcitationKind::kDesigned};
  if (plan.task) excitations.push_back(ExcitationKind::kTask);
  // Seeds outermost: the first part of a run already has every effect once.
  for (int k = 0; k < plan.seeds; ++k) {
    for (const ExcitationKind excitation : excitations) {
      for (const Strength strength : {Strength::kStrong, Strength::kWeak}) {
        for (const std::string& name : CatalogueNames()) {
          if (wanted(name)) {
            cases.push_back({Kind::kEffect, {name}, strength, excitation, seed_of(k)});
          }
        }
      }
    }
    for (const std::string& name : OutsideNames()) {
      if (wanted(name))
        cases.push_back({.kind = Kind::kOutside, .effects = {name}, .seed = seed_of(k)});
    }
  }
  if (wanted("pairs")) {
    for (int k = 0; k < plan.pair_seeds; ++k) {
      for (const auto& pair : kPairs) {
        cases.push_back({.kind = Kind::kPair,
                         .effects = {std::string(pair[0]), std::string(pair[1])},
                         .seed = seed_of(k)});
      }
    }
  }
  if (wanted("none")) {
    for (int k = 0; k < plan.without; ++k) {
      cases.push_back({.kind = Kind::kNone,
                       .effects = {},
                       .excitation = k % 4 < 2 || !plan.task ? ExcitationKind::kDesigned
                                                             : ExcitationKind::kTask,
                       .seed = 10000 + seed_of(k),
                       .coloured = k % 2 == 1});
    }
  }
  return cases;
}

std::string CaseName(const Case& what) {
  std::string out;
  for (const std::string& effect : what.effects) out += (out.empty() ? "" : "+") + effect;
  if (out.empty()) out = what.coloured ? "none/coloured" : "none/white";
  if (!what.effects.empty()) out += what.strength == Strength::kStrong ? "/strong" : "/weak";
  out += what.excitation == surrogate::ExcitationKind::kDesigned ? "/designed" : "/task";
  return out + ", seed " + std::to_string(what.seed);
}

Outcome RunCase(const Case& what, bool parameters) {
  const auto start = std::chrono::steady_clock::now();
  Outcome out;
  out.what = what;
  out.value = out.truth = out.half_width = std::numeric_limits<double>::quiet_NaN();
  const Scene scene = SceneOf(what);
  const Recorded recorded = Record(scene);
  trace::TraceOptions options;
  options.seed = what.seed;
  const trace::LoopResult loop = trace::CloseLoop(recorded.train, recorded.sealed,
                                                  recorded.declared, recorded.processing, options);
  const trace::TraceResult& result = loop.trace;
  out.verdict = result.verdict == trace::Verdict::kEffect        ? "effect"
                : result.verdict == trace::Verdict::kUnexplained ? "unexplained"
                                                                 : "none";
  for (const trace::FoundEffect& effect : result.effects) {
    out.found.push_back({effect.name, effect.rivals, effect.swallowed});
  }
  out.variable = result.unexplained.variable;
  for (const trace::NotExcited& hidden : result.not_excited) {
    out.not_excited.push_back(hidden.effect);
  }
  for (const trace::ParameterShift& shift : result.shifts) {
    out.shift_causes.push_back(shift.effect);
    for (const std::string& cause : shift.causes) {
      if (std::find(out.shift_causes.begin(), out.shift_causes.end(), cause) ==
          out.shift_causes.end()) {
        out.shift_causes.push_back(cause);
      }
    }
  }
  out.explanation = Explain(result);
  out.sealed_before = result.before_sealed.rms;
  out.sealed_after = result.after_sealed.rms;
  if (!what.effects.empty()) {
    JudgeAgainstOracle(what, scene, recorded, loop, parameters, &out);
  }
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return out;
}

std::vector<Outcome> RunCases(const std::vector<Case>& cases, int threads, bool parameters,
                              const std::function<void(const Outcome&)>& done) {
  std::vector<Outcome> outcomes(cases.size());
  std::atomic<std::size_t> next{0};
  std::mutex telling;
  std::exception_ptr failed;
  const auto work = [&] {
    for (std::size_t i = next++; i < cases.size(); i = next++) {
      try {
        outcomes[i] = RunCase(cases[i], parameters);
        const std::lock_guard<std::mutex> lock(telling);
        if (done) done(outcomes[i]);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(telling);
        if (!failed) failed = std::current_exception();
        next = cases.size();
      }
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < threads; ++i) workers.emplace_back(work);
  work();
  for (std::thread& worker : workers) worker.join();
  if (failed) std::rethrow_exception(failed);
  return outcomes;
}

}  // namespace sinew::bank
