// The result of close-loop: everything that the report's pages are made of.
// Pure data and text; no files.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/model/free_run/free_run.h"
#include "components/model/gate/gate.h"
#include "components/model/identify/as_published.h"
#include "components/model/identify/design.h"
#include "components/model/report/section.h"
#include "components/model/trace/rotation.h"
#include "components/model/trace/trace_result.h"

namespace sinew::report {

struct Recording {
  std::string name;
  std::string content_hash;
  Eigen::Index rows = 0;
  double duration_s = 0.0;
  double start_s = 0.0;  // on its own stamps
};

// "a.mcap, b.mcap".
inline std::string NamesOf(const std::vector<Recording>& recordings) {
  std::string names;
  for (const Recording& each : recordings) names += (names.empty() ? "" : ", ") + each.name;
  return names;
}

// The models of Report::free_run, in order.
inline constexpr std::size_t kDeclaredModel = 0, kRefittedModel = 1, kCorrectedModel = 2;

struct Report {
  std::string robot, joint, model_file;
  std::vector<Recording> train;       // those of check-data, too
  std::vector<Recording> held_out{};  // without any: those of `train`, each of them once
  identify::ProcessingOptions processing{};
  // Result of the data gate; where it stops nothing was traced. Its findings are completed by what
  // the processing finds.
  gate::GateReport gate{};
  trace::TraceResult trace{};
  std::optional<identify::AsPublishedResult> as_published{};
  free_run::FreeRunResult free_run{};  // declared, refitted, corrected on the held-out recordings
  // Without held-out recordings each of the training ones was held out once.
  std::vector<trace::Rotation> rotations{};
  // Effects that were given, nothing was searched for; none: a search.
  std::optional<std::set<std::string>> given{};
  std::uint64_t seed = 1;
  double seconds = 0.0;  // it took

  // False: the data stopped it (data_fault, too_little_data), and there is no corrected model.
  bool assessed() const { return !gate.stops() && !trace.too_little; }
};

// "Nm" or "N".
std::string TorqueUnit(types::JointKind kind);
// Unit of a balance's errors; of the motion's "rad" or "m" where they are of the simulated angle.
std::string ErrorUnit(const trace::TraceResult& trace,
                      effects::Balance balance = effects::Balance::kMotion);
// The quantity that relative errors are a share of: "the drive", or "the motion" by simulation.
std::string MeasuredSide(const trace::TraceResult& trace);
// Words for an effect's name, e.g. "Stribeck friction".
std::string EffectTitle(const std::string& name);

// Is any effect part of the corrected model?
bool HasCorrection(const trace::TraceResult& trace);
// The first term of an effect, linear parameters in their own units.
actuator::Term FittedTerm(const trace::TraceResult& trace, const trace::FoundEffect& effect);

// The effect's name; with its first nonlinear parameter when it was found more than once.
std::string EffectLabel(const trace::TraceResult& trace, const trace::FoundEffect& effect);

// The names that are 90 % probable together, with their probabilities, e.g.
// "load_dependent_friction (49 %) or drive_efficiency_direction (48 %)".
std::string NamedSetText(const trace::Posterior& posterior);

// "quadratic_Nm_s2_rad2 = 0.4 +- 0.02": every parameter of the effect with its 95 % interval.
std::string SizesText(const trace::TraceResult& trace, const trace::FoundEffect& effect);
// "held-out error 0.9 -> 0.3 Nm (-66.7 %)", without the effect and with it.
std::string HeldOutText(const trace::TraceResult& trace, const trace::FoundEffect& effect);
// Why it is not in the model, with rule, number and limit; empty where it is.
std::string RefusalText(const trace::FoundEffect& effect);

// Effects that a rotation found, e.g. "stribeck (confirmed)"; "refuted" ones as well.
std::string RotationText(const trace::Rotation& rotation);

// The verdict in words: what was found with its size, then what is open, then the errors that the
// model raises.
std::string VerdictSentence(const Report& report);
// The experiment that would separate the effect from its rivals or show what is hidden; may be
// empty.
std::string NextExperiment(const Report& report);
std::string VerdictWord(const Report& report);
std::string VerdictWord(trace::Verdict verdict);
// Verdict on the data alone: "data_fault" or "ok".
std::string VerdictWord(const gate::GateReport& gate);
std::string VerdictSentence(const gate::GateReport& gate);
// Finer than the verdict: "effect", "open" (neither confirmed nor refuted), "training_only"
// (refuted held out), "unexplained" (follows a variable), "not_detectable", "nothing" (the residual
// is the sensors' noise), "too_little_data", "data_fault".
std::string OutcomeWord(const Report& report);

// Measured against model, residuals over time, residual over its variable, candidates, errors by
// round.
std::vector<Picture> MakePictures(const Report& report, const identify::Design& train,
                                  const identify::Design& held_out);

// The first seconds of a simulation beside what was measured, with two of its models (free_run).
Picture PathPicture(const free_run::FreeRunResult& following, types::JointKind kind,
                    std::size_t before, std::size_t after);

// Up to six faults, each where it is, then an overview of up to four recordings.
std::vector<Picture> MakePictures(const gate::GateReport& gate, const std::vector<types::Run>& runs,
                                  const actuator::JointModel& model);

// The page of close-loop, whatever the verdict; of check-data.
Page MakePage(const Report& report, std::vector<Picture> pictures);
Page MakeCheckPage(const Report& report, std::vector<Picture> pictures);

}  // namespace sinew::report
