#include "components/model/report/errors.h"

#include <cmath>

#include "components/model/report/section.h"
#include "components/model/trace/rules.h"

namespace sinew::report {

namespace {

void AddBalance(const trace::Assessment& assessed, effects::Balance balance,
                const std::string& unit, const std::string& note, std::vector<ErrorLine>* table) {
  table->push_back({"train", "training recordings" + note, balance, unit,
                    assessed.nominal_train.rms, assessed.before_train.rms,
                    assessed.after_train.rms});
  table->push_back({"held_out", "held-out recordings" + note, balance, unit,
                    assessed.nominal_held_out.rms, assessed.before_held_out.rms,
                    assessed.after_held_out.rms});
}

// A model that runs away is worse than one that does not; what is within the rule's limit is not.
bool Worse(double after, double before, const trace::InForce& in_force) {
  if (!std::isfinite(after)) return std::isfinite(before);
  return after > in_force.Limit(trace::rules::kRaises) * before;
}

}  // namespace

std::vector<ErrorLine> ErrorTable(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const types::JointKind kind = trace.corrected.kind;
  std::vector<ErrorLine> out;
  AddBalance(trace, effects::Balance::kMotion, ErrorUnit(trace),
             trace.by_simulation ? ", pieces simulated from fitted start states" : "", &out);
  for (const trace::BalanceSummary& summary : trace.balances) {
    if (!summary.unseen.empty()) continue;
    AddBalance(summary, summary.balance, summary.unit,
               ", " + std::string(effects::BalanceName(summary.balance)) + " balance", &out);
  }
  if (report.free_run.errors) {
    const free_run::FreeRun& run = *report.free_run.errors;
    const std::string how = run.method == free_run::Method::kClosedLoop
                                ? "in closed loop"
                                : "over " + Short(run.horizon_s) + " s from measured states";
    out.push_back({"simulated", "position simulated " + how + ", held-out recordings",
                   effects::Balance::kMotion, kind == types::JointKind::kRevolute ? "rad" : "m",
                   run.models.at(kDeclaredModel).rms, run.models.at(kRefittedModel).rms,
                   run.models.at(kCorrectedModel).rms});
  }
  return out;
}

std::vector<ErrorLine> Rises(const Report& report) {
  const trace::InForce& in_force = report.trace.in_force;
  std::vector<ErrorLine> out;
  for (ErrorLine& line : ErrorTable(report)) {
    if (line.key == "train") continue;
    if (Worse(line.corrected, line.declared, in_force) ||
        Worse(line.corrected, line.refitted, in_force)) {
      out.push_back(std::move(line));
    }
  }
  return out;
}

std::string RiseSentence(const Report& report) {
  std::string by_effect, by_refit;
  for (const ErrorLine& line : Rises(report)) {
    std::string& to =
        Worse(line.corrected, line.refitted, report.trace.in_force) ? by_effect : by_refit;
    to += (to.empty() ? "" : "; ") + line.what + ": " + ThreeErrors(line);
  }
  std::string out;
  if (!by_effect.empty()) out = "The added effect raises an error: " + by_effect + ".";
  if (!by_refit.empty()) {
    out += std::string(out.empty() ? "" : " ") +
           "The refit of the declared terms raises an error: " + by_refit + ".";
  }
  return out;
}

std::string ErrorText(double error) { return std::isfinite(error) ? Short(error) : "diverged"; }

std::string ThreeErrors(const ErrorLine& line) {
  return ErrorText(line.declared) + " declared, " + ErrorText(line.refitted) + " refitted, " +
         ErrorText(line.corrected) + " " + line.unit + " corrected";
}

}  // namespace sinew::report
