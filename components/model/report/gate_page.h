// The result of the data gate, as a page and as sentences: of `sinew check-data`, and of a
// close-loop that stopped there. Pure text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/model/gate/gate.h"
#include "components/model/report/picture.h"
#include "components/model/report/report.h"

namespace sinew::report {

struct DataCheck {
  std::string robot, joint, model_file;
  std::vector<Recording> train;       // those of check-data, too
  std::vector<Recording> held_out{};  // of close-loop
  gate::GateReport gate{};
  std::uint64_t seed = 1;
  double seconds = 0.0;  // it took
};

// "data_fault" or "ok".
std::string VerdictWord(const gate::GateReport& gate);
std::string VerdictSentence(const gate::GateReport& gate);

// Up to six faults, each where it is, then an overview of up to four recordings.
std::vector<Picture> MakePictures(const gate::GateReport& gate, const std::vector<types::Run>& runs,
                                  const actuator::JointModel& model);

// The page. svgs: one per picture, in order.
std::string FormatHtml(const DataCheck& check, const std::vector<Picture>& pictures,
                       const std::vector<std::string>& svgs);

// Rows of a table, for pages that go on in spite of accepted faults; empty without faults.
std::string FormatFaultTable(const std::vector<gate::Fault>& faults);

}  // namespace sinew::report
