// Of close_loop.h: the result of a joint on the standard output.
#include <iostream>
#include <set>

#include "components/model/report/errors.h"
#include "components/model/report/gate_page.h"
#include "components/model/report/section.h"
#include "tools/sinew/close_loop.h"

namespace sinew::tools {

void PrintSummary(const CloseLoopResult& result, const CloseLoopOptions& options) {
  const report::Report& report = result.report;
  const trace::TraceResult& trace = report.trace;
  using report::Short;
  for (const gate::Fault& fault : result.gate.faults) {
    std::cout << gate::FormatFault(fault) << '\n';
  }
  if (result.gate.stops()) {
    std::cout << "verdict: " << report::VerdictWord(result.gate)
              << "\nwritten: " << (options.out / "report.html").string() << ", report.json\n";
    return;
  }
  std::cout << "verdict: " << report::VerdictWord(trace.verdict) << '\n'
            << report::VerdictSentence(report) << '\n';
  if (!result.assessed()) {
    std::cout << report::NextExperiment(report)
              << "\nwritten: " << (options.out / "report.html").string() << ", report.json\n";
    return;
  }
  for (const trace::FoundEffect& effect : trace.effects) {
    std::cout << "  " << effect.name << ':';
    const actuator::Term term = report::FittedTerm(trace, effect);
    const effects::EffectInfo& info = term.effect->info();
    for (std::size_t i = 0; i < info.linear.size(); ++i) {
      const actuator::ParameterValue& value = term.linear[i];
      std::cout << ' ' << effects::ParameterKey(info.linear[i], trace.corrected.kind) << " = "
                << Short(value.value);
      if (value.half_width_95) std::cout << " +- " << Short(*value.half_width_95);
    }
    for (std::size_t i = 0; i < info.nonlinear.size(); ++i) {
      std::cout << ' ' << effects::ParameterKey(info.nonlinear[i], trace.corrected.kind) << " = "
                << Short(term.nonlinear[i].value);
    }
    // Other orders of the same effect.
    for (std::size_t t = 1; t < effect.fitted.size(); ++t) {
      for (const actuator::ParameterValue& value : effect.fitted[t].nonlinear) {
        std::cout << ", " << Short(value.value);
      }
    }
    std::cout << "; held out " << report::ErrorText(effect.held_out_before) << " -> "
              << report::ErrorText(effect.held_out_after) << ' '
              << effects::BalanceUnit(effect.balance, trace.corrected.kind) << "; "
              << trace::ConfirmationWord(effect.confirmation.verdict)
              << (effect.in_model() ? "" : ", not in model.yaml") << '\n';
  }
  for (const trace::FoundEffect& effect : trace.refuted) {
    std::cout << "  refuted: " << effect.name << "; held out "
              << report::ErrorText(effect.held_out_before) << " -> "
              << report::ErrorText(effect.held_out_after) << ' '
              << effects::BalanceUnit(effect.balance, trace.corrected.kind) << '\n';
  }
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
  std::cout << "  of the drive, held-out recordings: " << Short(trace.nominal_held_out.percent)
            << " % declared, " << Short(trace.before_held_out.percent) << " % refitted, "
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
