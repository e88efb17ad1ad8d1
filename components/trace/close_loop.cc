#include "components/trace/close_loop.h"

#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "components/trace/balances.h"
#include "components/trace/likelihood_tracer.h"
#include "components/trace/slow_motion.h"

namespace sinew::trace {

namespace {

std::string ShortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

void AddDelayFinding(const TraceResult& trace, double rate_Hz,
                     std::vector<identify::Finding>* findings) {
  if (trace.rounds.empty()) return;
  for (const CandidateScore& score : trace.rounds.front().scores) {
    if (score.name != "transport_delay" || !(score.gain.t > 2.0)) continue;
    const double delay_s = score.delay_s;
    if (delay_s == 0.0) continue;
    findings->push_back({"drive_delay",
                         "the drive seems to act " + ShortNumber(1e3 * std::abs(delay_s)) + " ms " +
                             (delay_s > 0.0 ? "late" : "early") + " (" +
                             ShortNumber(std::abs(delay_s) * rate_Hz) +
                             " samples) against the position; nothing was shifted",
                         delay_s, "s"});
  }
}

// The second look, where the recordings creep; changes nothing when they do not.
void LookAtSlowMotion(const std::vector<identify::Run>& train,
                      const std::vector<identify::Run>& sealed, double rate_Hz,
                      TraceOptions options, LoopResult* loop) {
  const actuator::JointModel held = HeldForSlowMotion(loop->trace.corrected);
  const identify::ProcessingOptions processing =
      identify::SlowMotion(loop->processing, held, rate_Hz);
  identify::Design train_design(identify::MakeStates(train, held, processing), processing);
  identify::Design sealed_design(identify::MakeStates(sealed, held, processing), processing);
  for (const auto& [run, offset_s] : loop->train->clocks()) train_design.SetClock(run, offset_s);
  for (const auto& [run, offset_s] : loop->sealed->clocks()) sealed_design.SetClock(run, offset_s);
  options.only = EffectsOfMotorAngle(held);
  if (!ShowsSlowMotion(train_design, sealed_design)) return;
  TraceResult slow = Trace(train_design, sealed_design, held, options);
  loop->trace = WithSlowMotion(std::move(loop->trace), std::move(slow));
  if (!loop->trace.slow_motion) return;
  loop->processing = processing;
  loop->train = std::move(train_design);
  loop->sealed = std::move(sealed_design);
}

// As if nothing had been found.
void DropFindings(LoopResult* loop) {
  TraceResult& trace = loop->trace;
  trace.effects.clear();
  trace.events.clear();
  trace.shifts.clear();
  trace.unexplained = {};
  trace.verdict = Verdict::kNone;
  trace.corrected = trace.declared;
  trace.corrected_fit = trace.declared_fit;
  trace.after_train = trace.before_train;
  trace.after_sealed = trace.before_sealed;
  loop->train->PredictDrive(trace.corrected);
  loop->sealed->PredictDrive(trace.corrected);
}

}  // namespace

LoopResult CloseLoop(const std::vector<identify::Run>& train,
                     const std::vector<identify::Run>& sealed, const actuator::JointModel& joint,
                     const identify::ProcessingOptions& wished, const TraceOptions& given) {
  // Every balance may give a false alarm: all of them together as seldom as one alone.
  const std::vector<effects::Balance> others = OtherBalances(joint);
  TraceOptions options = given;
  options.searches = given.searches * static_cast<int>(1 + others.size());
  if (options.engine == Engine::kBlocks) {
    options.placebo_quantile = 1.0 - (1.0 - given.placebo_quantile) / options.searches;
    options.placebo_rounds = given.placebo_rounds * options.searches;
  }
  LoopResult loop;
  // Holds are not filtered: where only those are trained on, the sealed recordings fill in what is
  // theirs alone.
  const bool raw = options.engine == Engine::kLikelihood;
  const std::vector<identify::Run>& shape = train.front().held ? sealed : train;
  loop.processing = raw ? identify::FromMotion(shape, joint, wished.longest_gap_s)
                        : identify::Resolve(wished, shape);
  const identify::ProcessingOptions motion = loop.processing;
  identify::StateSet states = identify::MakeStates(train, joint, loop.processing);
  const double rate_Hz = states.rate_Hz;
  loop.findings = identify::ExamineData(train, states, joint);
  loop.train.emplace(std::move(states), loop.processing);
  loop.sealed.emplace(identify::MakeStates(sealed, joint, loop.processing), loop.processing);
  if (raw) {
    loop.trace = TraceByLikelihood(*loop.train, *loop.sealed, joint, options);
  } else {
    loop.trace = Trace(*loop.train, *loop.sealed, joint, options);
  }
  AddDelayFinding(loop.trace, rate_Hz, &loop.findings);
  // Rows that are holds creep already, and have no other balance.
  if (train.front().held) return loop;
  if (!raw) LookAtSlowMotion(train, sealed, rate_Hz, options, &loop);
  for (const effects::Balance balance : others) {
    TraceResult other = TraceBalance(balance, train, sealed, loop.trace.corrected, motion, options);
    // Encoders that come apart as time goes on tell no torques.
    if (balance == effects::Balance::kKinematic && other.unexplained.variable == "time_s" &&
        loop.trace.verdict != Verdict::kNone) {
      const bool corrected = !loop.trace.effects.empty();
      DropFindings(&loop);
      if (corrected) {
        other = TraceBalance(balance, train, sealed, loop.trace.corrected, motion, options);
      }
    }
    loop.trace = WithBalance(std::move(loop.trace), std::move(other));
  }
  return loop;
}

void RequireSealed(const std::vector<identify::Run>& train,
                   const std::vector<identify::Run>& sealed) {
  for (const identify::Run& a : sealed) {
    for (const identify::Run& b : train) {
      if (!a.content_hash.empty() && a.content_hash == b.content_hash) {
        throw std::invalid_argument(a.name + ": sealed recording holds the same samples as " +
                                    b.name + ", expected one that was not trained on");
      }
    }
  }
}

}  // namespace sinew::trace
