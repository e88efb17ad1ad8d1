#include "components/model/report/errors.h"

#include <cmath>

#include "components/model/report/section.h"

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

// Is it worse in three digits? A model that runs away is worse than one that does not.
bool Worse(double after, double before) {
  if (!std::isfinite(after)) return std::isfinite(before);
  return after > before && Text("%.3g", after) != Text("%.3g", before);
}

}  // namespace

std::vector<ErrorLine> ErrorTable(const Report& report) {
  const trace::TraceResult& trace = report.trace;
  const types::JointKind kind = trace.corrected.kind;
  std::vector<ErrorLine> out;
  AddBalance(trace, effects::Balance::kMotion, TorqueUnit(kind), "", &out);
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
                   effects::Balance::kMotion, kind == types::JointKind::kRotary ? "rad" : "m",
                   run.models.at(kDeclaredModel).rms, run.models.at(kRefittedModel).rms,
                   run.models.at(kCorrectedModel).rms});
  }
  return out;
}

std::vector<ErrorLine> Rises(const Report& report) {
  std::vector<ErrorLine> out;
  for (ErrorLine& line : ErrorTable(report)) {
    if (line.key == "train") continue;
    if (Worse(line.corrected, line.declared) || Worse(line.corrected, line.refitted)) {
      out.push_back(std::move(line));
    }
  }
  return out;
}

std::string RiseSentence(const Report& report) {
  std::string out;
  for (const ErrorLine& line : Rises(report)) {
    out += (out.empty() ? "" : "; ") + line.what + ": " + ThreeErrors(line);
  }
  if (out.empty()) return out;
  return std::string(HasCorrection(report.trace) ? "The corrected model" : "The refitted model") +
         " raises an error: " + out + ".";
}

std::string ErrorText(double error) { return std::isfinite(error) ? Short(error) : "diverged"; }

std::string ThreeErrors(const ErrorLine& line) {
  return ErrorText(line.declared) + " declared, " + ErrorText(line.refitted) + " refitted, " +
         ErrorText(line.corrected) + " " + line.unit + " corrected";
}

}  // namespace sinew::report
