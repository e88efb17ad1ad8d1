#include "components/model/report/page_parts.h"

#include "components/base/types/seconds.h"

namespace sinew::report {

Section RecordingsSection(const std::vector<Recording>& train,
                          const std::vector<Recording>& held_out) {
  Section out =
      TableSection("The recordings", {"recording", "used for", "rows", "duration, s", "content"},
                   "Content: the hash of its samples, the same for the same ones.", true);
  for (const auto* list : {&train, &held_out}) {
    for (const Recording& recording : *list) {
      out.Add({recording.name, list == &train ? "training" : "held out",
               std::to_string(recording.rows), Short(recording.duration_s),
               recording.content_hash});
    }
  }
  return out;
}

Section FaultSection(const gate::GateReport& gate) {
  Section out = TableSection("Faults of the data",
                             {"rule", "where", "statistic", "limit", "reason", "remedy"});
  for (const gate::Finding& finding : gate.findings) {
    if (finding.name == gate::kLeftOutRows) out.paragraphs.push_back(finding.text);
  }
  for (const gate::Fault& fault : gate.faults) {
    std::string where = fault.signal;
    if (!fault.recording.empty()) where += (where.empty() ? "" : "\n") + fault.recording;
    if (fault.last_row >= fault.first_row && !fault.recording.empty()) {
      where += Text("\nrows %td to %td, ", fault.first_row, fault.last_row) +
               types::SecondsText(fault.from_s) + " to " + types::SecondsText(fault.to_s) + " s";
    }
    out.Add({fault.rule + (fault.accepted
                               ? "\naccepted"
                               : "\nto continue in spite of it: " + gate::AcceptOption(fault)),
             where, Short(fault.statistic), Short(fault.limit), fault.reason, fault.remedy});
  }
  return out;
}

Section DataSection(const gate::GateReport& gate) {
  Section out = TableSection("The data", {"finding", "what"}, "", true);
  for (const gate::Finding& finding : gate.findings) {
    if (finding.name != gate::kLeftOutRows) out.Add({finding.name, finding.text});
  }
  return out;
}

Section NotExcitedSection(const std::vector<trace::NotExcited>& hidden) {
  Section out = TableSection("Not excited by these recordings", {"effect", "why"}, "", true);
  if (hidden.empty()) {
    out.paragraphs = {"None: every effect of the catalogue would have been detected."};
  }
  for (const trace::NotExcited& entry : hidden) out.Add({entry.effect, entry.reason});
  return out;
}

Section NextSection(const std::string& experiment) {
  Section out = {.title = "Next experiment"};
  if (!experiment.empty()) out.paragraphs = {experiment};
  return out;
}

std::string MetaText(const std::vector<Recording>& train, const std::vector<Recording>& held_out,
                     const std::string& model_file) {
  return "Trained on " + NamesOf(train) + ". Held out: " + NamesOf(held_out) + ". Model " +
         model_file + ".";
}

std::string ConfirmedText(const trace::Confirmation& confirmation) {
  if (confirmation.blocks == 0) return "not tested";
  return std::string(trace::ConfirmationWord(confirmation.verdict)) + ", slope " +
         Short(confirmation.slope) + " [" + Short(confirmation.lower) + ", " +
         Short(confirmation.upper) + "]";
}

std::string Percent(double share) { return Text("%.1f %%", 100.0 * share); }

}  // namespace sinew::report
