#include "components/model/trace/rotation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace sinew::trace {

namespace {

using identify::ModelError;

// The effect of a rotation that is `name` or has it as a rival; null: none.
const FoundEffect* FindClass(const std::vector<FoundEffect>& effects, const std::string& name) {
  for (const FoundEffect& effect : effects) {
    if (effect.name == name) return &effect;
  }
  for (const FoundEffect& effect : effects) {
    if (std::ranges::count(effect.rivals(), name) != 0) return &effect;
  }
  return nullptr;
}

// Root of the mean square, each weighted by the rows of its recording.
class Pooled {
 public:
  void Add(double error, double rows) {
    squares_ += rows * error * error;
    rows_ += rows;
  }
  double rms() const { return rows_ > 0.0 ? std::sqrt(squares_ / rows_) : 0.0; }

 private:
  double squares_ = 0.0, rows_ = 0.0;
};

using ErrorMember = ModelError Assessment::*;

// The residual becomes theirs where it has
// as many rows as that of all recordings.
void PoolError(const std::vector<const Assessment*>& rotations, ErrorMember member,
               Assessment* all) {
  Pooled rms, percent;
  Eigen::Index rows = 0;
  for (const Assessment* assessed : rotations) {
    const ModelError& error = assessed->*member;
    const auto count = static_cast<double>(error.residual.size());
    rms.Add(error.rms, count);
    percent.Add(error.percent, count);
    rows += error.residual.size();
  }
  ModelError& out = all->*member;
  out.rms = rms.rms();
  out.percent = percent.rms();
  if (rows != out.residual.size()) return;
  Eigen::Index at = 0;
  for (const Assessment* assessed : rotations) {
    const Eigen::VectorXd& part = (assessed->*member).residual;
    out.residual.segment(at, part.size()) = part;
    at += part.size();
  }
}

void PoolErrors(const std::vector<const Assessment*>& rotations, Assessment* all) {
  if (rotations.empty()) return;
  for (const ErrorMember member :
       {&Assessment::nominal_held_out, &Assessment::before_held_out, &Assessment::after_held_out}) {
    PoolError(rotations, member, all);
  }
}

// Figures of a found effect from the rotations that confirm it.
void NoteConfirmations(const std::vector<Rotation>& rotations, FoundEffect* effect) {
  Pooled before, after;
  std::vector<Posterior> posteriors;
  for (const Rotation& rotation : rotations) {
    const FoundEffect* found = FindClass(rotation.trace.effects, effect->name);
    if (found == nullptr || found->confirmation.verdict != ConfirmationVerdict::kConfirmed) {
      continue;
    }
    const auto rows = static_cast<double>(rotation.trace.after_held_out.residual.size());
    before.Add(found->held_out_before, rows);
    after.Add(found->held_out_after, rows);
    if (posteriors.empty() || found->confirmation.lower < effect->confirmation.lower) {
      effect->confirmation = found->confirmation;
    }
    posteriors.push_back(found->posterior);
  }
  effect->posterior = MeanPosterior(effect->name, posteriors);
  effect->held_out_before = before.rms();
  effect->held_out_after = after.rms();
}

std::size_t ConfirmationsNeeded(const std::vector<Rotation>& rotations) {
  return std::max<std::size_t>(2, rotations.size() - 1);
}

std::size_t Confirmations(const std::vector<Rotation>& rotations, const std::string& name) {
  return static_cast<std::size_t>(
      std::count_if(rotations.begin(), rotations.end(), [&](const Rotation& rotation) {
        const FoundEffect* found = FindClass(rotation.trace.effects, name);
        return found != nullptr && found->confirmation.verdict == ConfirmationVerdict::kConfirmed;
      }));
}

// Effects that most rotations confirm, but too few for the model: each as the rotation found it
// that misses it most.
std::vector<FoundEffect> OpenEffects(const std::vector<Rotation>& rotations,
                                     const std::vector<FoundEffect>& agreed) {
  std::vector<FoundEffect> found, out;
  for (const Rotation& rotation : rotations) {
    for (const FoundEffect& effect : rotation.trace.effects) found.push_back(effect);
  }
  SortByGain(&found);
  for (FoundEffect& effect : found) {
    if (FindClass(agreed, effect.name) != nullptr || FindClass(out, effect.name) != nullptr)
      continue;
    const std::size_t confirmations = Confirmations(rotations, effect.name);
    if (2 * confirmations <= rotations.size()) continue;
    effect.term = -1;
    effect.confirmation.verdict = ConfirmationVerdict::kNotConfirmed;
    effect.refusal = rotations.front().trace.in_force.RefusedBy(
        rules::kRotations,
        static_cast<double>(confirmations) / static_cast<double>(ConfirmationsNeeded(rotations)));
    out.push_back(std::move(effect));
  }
  return out;
}

}  // namespace

std::set<std::string> AgreedEffects(const std::vector<Rotation>& rotations) {
  std::map<std::string, double> gain;  // of every effect that some rotation confirms
  std::set<std::string> refuted;
  for (const Rotation& rotation : rotations) {
    for (const FoundEffect& effect : rotation.trace.refuted) refuted.insert(effect.name);
    for (const FoundEffect& effect : rotation.trace.effects) gain[effect.name] += effect.gain_share;
  }
  const auto agreed = [&](const std::string& name) {
    const auto share = static_cast<double>(Confirmations(rotations, name)) /
                       static_cast<double>(ConfirmationsNeeded(rotations));
    return share >= rotations.front().trace.in_force.Limit(rules::kRotations) &&
           !refuted.contains(name);
  };
  std::set<std::string> out;
  for (const std::pair<const std::string, double>& effect : gain) {
    const std::string& name = effect.first;
    const double own = effect.second;
    if (!agreed(name)) continue;
    // The name that gains most in all stands for a class that goes by several names.
    const bool other = std::any_of(gain.begin(), gain.end(), [&](const auto& entry) {
      if (entry.first == name || entry.second <= own || !agreed(entry.first)) return false;
      return std::any_of(rotations.begin(), rotations.end(), [&](const Rotation& rotation) {
        const FoundEffect* found = FindClass(rotation.trace.effects, entry.first);
        return found != nullptr && found == FindClass(rotation.trace.effects, name);
      });
    });
    if (!other) out.insert(name);
  }
  return out;
}

std::vector<Fold> LeaveOneOut(const std::vector<types::Run>& runs,
                              const actuator::JointModel& joint) {
  const bool alike = std::all_of(runs.begin(), runs.end(), [&](const types::Run& run) {
    return run.held == runs.front().held;
  });
  if (runs.size() < 2 || !alike) {
    throw std::invalid_argument(
        "recordings rotate when there are two at least, all or none of them of held positions");
  }
  std::vector<Fold> out;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    Fold fold{runs, runs[i], joint, {}};
    fold.train.erase(fold.train.begin() + static_cast<std::ptrdiff_t>(i));
    RequireHeldOut(fold.train, {fold.held_out});
    out.push_back(std::move(fold));
  }
  return out;
}

RotatedLoop RotateLoop(const std::vector<Fold>& folds, const std::vector<types::Run>& runs,
                       const actuator::JointModel& joint, double longest_gap_s,
                       const TraceOptions& options) {
  RotatedLoop out;
  const auto loops = static_cast<double>(folds.size() + 1);
  const auto part = [&](std::size_t done) {
    TraceOptions own = options;
    if (options.progress) {
      own.progress = [&options, loops, done](const std::string& what, double share) {
        options.progress(what, (static_cast<double>(done) + share) / loops);
      };
    }
    return own;
  };
  for (std::size_t i = 0; i < folds.size(); ++i) {
    TraceOptions own = part(i);
    own.held_out_error = folds[i].held_out_error;
    LoopResult loop =
        CloseLoop(folds[i].train, {folds[i].held_out}, folds[i].joint, longest_gap_s, own);
    out.rotations.push_back({folds[i].held_out.name, loop.processing, std::move(loop.trace)});
    if (out.rotations.back().trace.too_little) {
      out.all = std::move(loop);
      out.all.trace = out.rotations.back().trace;
      return out;
    }
  }
  TraceOptions agreed = part(folds.size());
  if (!options.agreed) agreed.agreed = AgreedEffects(out.rotations);
  out.all = CloseLoop(runs, runs, joint, longest_gap_s, agreed);
  TraceResult& trace = out.all.trace;
  if (trace.too_little) return out;
  std::vector<const Assessment*> assessed;
  for (const Rotation& rotation : out.rotations) assessed.push_back(&rotation.trace);
  PoolErrors(assessed, &trace);
  for (std::size_t b = 0; b < trace.balances.size(); ++b) {
    assessed.clear();
    for (const Rotation& rotation : out.rotations) {
      if (rotation.trace.balances[b].unseen.empty())
        assessed.push_back(&rotation.trace.balances[b]);
    }
    PoolErrors(assessed, &trace.balances[b]);
  }
  for (FoundEffect& effect : trace.effects) NoteConfirmations(out.rotations, &effect);
  if (options.agreed) return out;
  trace.open = OpenEffects(out.rotations, trace.effects);
  if (trace.verdict == Verdict::kNone && !trace.open.empty()) trace.verdict = Verdict::kUnexplained;
  return out;
}

}  // namespace sinew::trace
