#include "components/model/gate/gate.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/model/gate/channels.h"
#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"

namespace sinew::gate {

namespace {

using types::Run;

// Later checks do without the channels that a structural rule refused.
std::vector<Run> Sound(const std::vector<Run>& runs, const std::vector<Measurement>& measured) {
  std::vector<Run> out;
  for (const Run& run : runs) {
    bool usable = run.size() >= 12;
    Run sound = run;
    for (const Measurement& at : measured) {
      if (at.recording != run.name || at.statistic <= FindRule(at.rule).limit) continue;
      if (at.rule == "stamps") usable = false;
      if (const auto signal = types::SignalFromName(at.signal)) sound.signals.erase(*signal);
    }
    if (usable) out.push_back(std::move(sound));
  }
  return out;
}

void Append(std::vector<Measurement> more, std::vector<Measurement>* all) {
  for (Measurement& at : more) all->push_back(std::move(at));
}

// One line for a channel of a recording, however many ways of looking agree.
bool HasLarger(const std::vector<Measurement>& all, const Measurement& one) {
  for (const Measurement& at : all) {
    if (at.rule != one.rule || at.signal != one.signal || at.recording != one.recording) continue;
    if (at.signal.empty()) continue;
    if (at.statistic > one.statistic || (at.statistic == one.statistic && &at < &one)) return true;
  }
  return false;
}

std::string Place(const Measurement& at) {
  std::string out = at.signal;
  if (!at.recording.empty()) out += (out.empty() ? "" : " of ") + at.recording;
  if (at.last_row >= at.first_row && !at.recording.empty()) {
    out += at.first_row == at.last_row
               ? ", row " + std::to_string(at.first_row) + " (" + Number(at.from_s) + " s)"
               : ", rows " + std::to_string(at.first_row) + " to " + std::to_string(at.last_row) +
                     " (" + Number(at.from_s) + " to " + Number(at.to_s) + " s)";
  }
  return out.empty() ? "model" : out;
}

}  // namespace

bool GateReport::stops() const {
  return std::any_of(faults.begin(), faults.end(), [](const Fault& at) { return !at.accepted; });
}

GateReport ExamineData(const std::vector<Run>& runs, const actuator::JointModel& model,
                       const GateOptions& options) {
  for (const std::string& name : options.accepted) FindRule(name);
  for (const Run& run : runs) {
    for (const auto& [signal, values] : run.signals) {
      if (values.size() != run.size()) {
        throw std::invalid_argument(
            "run '" + run.name + "': " + std::string(types::SignalName(signal)) + " has " +
            std::to_string(values.size()) + " rows, expected " + std::to_string(run.size()));
      }
    }
  }
  std::vector<Measurement> all = CheckConstants(runs, model);
  Append(CheckStructure(runs, model), &all);
  std::vector<Run> sound = Sound(runs, all);
  std::vector<Measurement> shape;
  for (const Run& run : sound) {
    Append(CheckWrapped(run), &shape);
    Append(CheckSpikes(run), &shape);
  }
  sound = Sound(sound, shape);
  Append(shape, &all);
  std::vector<Measurement> frozen;
  for (const Run& run : sound) Append(CheckFrozen(run, model), &frozen);
  sound = Sound(sound, frozen);
  Append(frozen, &all);
  std::vector<Measurement> kinematic;
  for (const Run& run : sound) Append(CheckKinematics(run, model), &kinematic);
  sound = Sound(sound, kinematic);
  Append(kinematic, &all);
  Append(CheckBalance(sound, model), &all);
  Append(CheckRecordings(sound), &all);

  GateReport out;
  for (const Rule& rule : Rules()) {
    const Measurement* largest = nullptr;
    for (Measurement& at : all) {
      if (at.rule != rule.id) continue;
      at.limit = rule.limit;
      if (largest == nullptr || at.statistic > largest->statistic) largest = &at;
      if (!(at.statistic > rule.limit) || HasLarger(all, at)) continue;
      Fault fault;
      static_cast<Measurement&>(fault) = at;
      fault.accepted = options.accepted.contains(at.rule);
      out.faults.push_back(std::move(fault));
    }
    if (largest != nullptr) out.largest.push_back(*largest);
  }
  if (!sound.empty()) out.findings = FindFindings(sound, model);
  return out;
}

std::string FormatFault(const Fault& fault) {
  return fault.rule + (fault.accepted ? " (accepted)" : "") + ": " + Place(fault) + ": " +
         fault.reason + " " + fault.remedy;
}

}  // namespace sinew::gate
