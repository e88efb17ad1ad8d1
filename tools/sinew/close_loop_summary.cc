// Of close_loop.h: the result of a joint on the standard output.
#include <iostream>
#include <set>

#include "components/model/report/errors.h"
#include "components/model/report/gate_page.h"
#include "components/model/report/section.h"
#include "tools/sinew/close_loop.h"

namespace sinew::tools {

void PrintGate(const gate::GateReport& gate) {
  for (const gate::Fault& fault : gate.faults) std::cout << gate::FormatFault(fault) << '\n';
  for (const identify::Finding& finding : gate.findings) {
    if (finding.name == gate::kLeftOutRows) std::cout << finding.text << '\n';
  }
}

void PrintSummary(const CloseLoopResult& result, const CloseLoopOptions& options) {
  const report::Report& report = result.report;
  const trace::TraceResult& trace = report.trace;
  using report::Short;
  PrintGate(result.gate);
  if (result.gate.stops()) {
    std::cout << "verdict: " << report::VerdictWord(result.gate)
              << "\nwritten: " << (options.out / "report.html").string() << ", report.json\n";
    return;
  }
  std::cout << "verdict: " << report::VerdictWord(trace.verdict) << " ("
            << report::OutcomeWord(trace) << ")\n"
            << report::VerdictSentence(report) << '\n';
  if (!result.assessed()) {
    std::cout << report::NextExperiment(report)
              << "\nwritten: " << (options.out / "report.html").string() << ", report.json\n";
    return;
  }
  const auto list = [&](const char* what, const std::vector<trace::FoundEffect>& effects) {
    for (const trace::FoundEffect& effect : effects) {
      const std::string why = report::RefusalText(effect);
      std::cout << "  " << what << effect.name << ": " << report::SizesText(trace, effect) << "; "
                << report::HeldOutText(trace, effect) << "; "
                << trace::ConfirmationWord(effect.confirmation.verdict)
                << (why.empty() ? "" : "; " + why) << '\n';
    }
  };
  list("", trace.effects);
  list("open: ", trace.open);
  list("refuted: ", trace.refuted);
  for (const trace::Rotation& rotation : report.rotations) {
    std::cout << "  held out " << rotation.held_out << ": " << report::RotationText(rotation)
              << "; " << Short(rotation.trace.nominal_held_out.rms) << " declared, "
              << Short(rotation.trace.before_held_out.rms) << " refitted, "
              << Short(rotation.trace.after_held_out.rms) << " corrected\n";
  }
  std::cout << "errors, rms:\n";
  for (const report::ErrorLine& line : report::ErrorTable(report)) {
    std::cout << "  " << line.what << ": " << report::ThreeErrors(line) << '\n';
  }
  std::cout << "  of " << report::MeasuredSide(trace)
            << ", held-out recordings: " << Short(trace.nominal_held_out.percent) << " % declared, "
            << Short(trace.before_held_out.percent) << " % refitted, "
            << Short(trace.after_held_out.percent) << " % corrected\n";
  for (const trace::BalanceSummary& summary : trace.balances) {
    if (summary.unseen.empty()) continue;
    std::cout << effects::BalanceName(summary.balance) << " balance: " << summary.unseen << '\n';
  }
  if (!report.free_run.errors) std::cout << "not simulated: " << report.free_run.why_not << '\n';
  if (report.as_published) {
    const identify::AsPublishedResult& published = *report.as_published;
    std::cout << "as published: " << Short(published.before_percent) << " -> "
              << Short(published.after_percent) << " %, cross test "
              << Short(published.cross_before_percent) << " -> "
              << Short(published.cross_after_percent) << " %\n";
  }
  for (const trace::ParameterShift& shift : trace.shifts) {
    std::cout << "shift: " << shift.effect << '.' << shift.parameter << ' ' << Short(shift.nominal)
              << " -> " << Short(shift.refit) << " (" << Short(shift.sigma) << " tolerances)\n";
  }
  if (!trace.detectable.empty()) {
    std::set<std::string> names;
    for (const trace::DetectableSize& size : trace.detectable) names.insert(size.effect);
    std::cout << "not excited by this data: " << trace.not_excited.size()
              << " effects; smallest detectable sizes of " << names.size()
              << " others: see the report\n";
  }
  std::cout << "written: " << (options.out / "report.html").string()
            << ", report.json, model.yaml (" << Short(report.seconds) << " s)\n";
}

}  // namespace sinew::tools
