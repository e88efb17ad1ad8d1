#include "components/model/trace/close_loop.h"

#include <stdexcept>

#include "components/model/trace/balances.h"
#include "components/model/trace/band.h"
#include "components/model/trace/likelihood_tracer.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

namespace {

// The second low-pass of the angles, over the first.
constexpr double kOtherBand = 0.6;

// As if nothing had been found.
void DropFindings(LoopResult* loop) {
  TraceResult& trace = loop->trace;
  trace.effects.clear();
  trace.open.clear();
  trace.events.clear();
  trace.zero_turns.clear();
  trace.shifts.clear();
  trace.unexplained = {};
  trace.verdict = Verdict::kNone;
  trace.corrected = trace.declared;
  trace.after_train = trace.before_train;
  trace.after_held_out = trace.before_held_out;
  loop->train->PredictDrive(trace.corrected);
  loop->held_out->PredictDrive(trace.corrected);
}

TraceResult NotAssessed(const actuator::JointModel& joint, TooLittle why, const InForce& in_force) {
  TraceResult out;
  out.in_force = in_force;
  out.verdict = Verdict::kTooLittleData;
  out.nominal = out.declared = out.corrected = joint;
  out.too_little = std::move(why);
  return out;
}

LoopResult Analyse(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out,
                   const actuator::JointModel& joint, double longest_gap_s,
                   const TraceOptions& given) {
  // Every balance may give a false alarm: all of them together as seldom as one alone.
  const std::vector<effects::Balance> others = OtherBalances(joint);
  TraceOptions options = given;
  options.searches = given.searches * static_cast<int>(1 + others.size());
  LoopResult loop;
  // Holds are not filtered: where only those are trained on, the held-out recordings fill in what
  // is theirs alone.
  const bool held = train.front().held;
  loop.processing = held               ? identify::FromMotion(held_out, joint, longest_gap_s)
                    : given.processing ? identify::Resolve(*given.processing, train)
                                       : BandOfLeastResidual(train, held_out, joint, longest_gap_s,
                                                             given.in_force);
  if (!held) loop.processing.contact_guard_s = ContactGuard(train, joint, loop.processing);
  loop.train.emplace(identify::MakeStates(train, joint, loop.processing), loop.processing);
  loop.held_out.emplace(identify::MakeStates(held_out, joint, loop.processing), loop.processing);
  if (!held) {
    if (auto too_little = FindTooLittle(*loop.train, *loop.held_out, joint, options.in_force)) {
      loop.trace = NotAssessed(joint, std::move(*too_little), options.in_force);
      return loop;
    }
  }
  std::optional<identify::Design> narrower;
  if (!held) {
    identify::ProcessingOptions other = loop.processing;
    other.state_cutoff_Hz *= kOtherBand;
    other.motor_cutoff_Hz *= kOtherBand;
    narrower.emplace(identify::MakeStates(train, joint, other), other);
  }
  loop.trace = TraceByLikelihood(*loop.train, *loop.held_out, joint, options,
                                 narrower ? &*narrower : nullptr);
  if (held) return loop;  // holds have no other balance
  for (const effects::Balance balance : others) {
    TraceResult other =
        TraceBalance(balance, train, held_out, loop.trace.corrected, loop.processing, options);
    // Encoders whose difference drifts with time give no torques.
    if (balance == effects::Balance::kKinematic && other.unexplained.variable == "time_s" &&
        loop.trace.verdict != Verdict::kNone) {
      const bool corrected = !loop.trace.effects.empty();
      DropFindings(&loop);
      if (corrected) {
        other =
            TraceBalance(balance, train, held_out, loop.trace.corrected, loop.processing, options);
      }
    }
    loop.trace = WithBalance(std::move(loop.trace), std::move(other));
  }
  return loop;
}

}  // namespace

LoopResult CloseLoop(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out,
                     const actuator::JointModel& joint, double longest_gap_s,
                     const TraceOptions& options) {
  try {
    return Analyse(train, held_out, joint, longest_gap_s, options);
  } catch (const identify::TooLittleData& error) {
    LoopResult out;
    out.trace = NotAssessed(joint,
                            {.rule = rules::kRows.id,
                             .limit = options.in_force.Limit(rules::kRows),
                             .reason = error.what()},
                            options.in_force);
    return out;
  }
}

void RequireHeldOut(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out) {
  for (const types::Run& a : held_out) {
    for (const types::Run& b : train) {
      if (!a.content_hash.empty() && a.content_hash == b.content_hash) {
        throw std::invalid_argument(a.name + ": held-out recording holds the same samples as " +
                                    b.name + ", expected one that was not trained on");
      }
    }
  }
}

}  // namespace sinew::trace
