// Sections and texts that several pages share.
#pragma once

#include <string>
#include <vector>

#include "components/model/report/report.h"
#include "components/model/report/section.h"

namespace sinew::report {

Section RecordingsSection(const std::vector<Recording>& train,
                          const std::vector<Recording>& held_out);
Section FaultSection(const gate::GateReport& gate);  // and the rows that were left out
Section DataSection(const gate::GateReport& gate);   // all other findings
Section NotExcitedSection(const std::vector<trace::NotExcited>& hidden);
Section NextSection(const std::string& experiment);

// "Trained on a.csv. Held out: b.csv. Model model.yaml."
std::string MetaText(const std::vector<Recording>& train, const std::vector<Recording>& held_out,
                     const std::string& model_file);
// "confirmed, slope 1.01 [0.9, 1.12]".
std::string ConfirmedText(const trace::Confirmation& confirmation);
// "12.3 %".
std::string Percent(double share);

}  // namespace sinew::report
