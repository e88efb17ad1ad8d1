#include "components/model/gate/gate.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

#include "components/base/types/seconds.h"
#include "components/model/gate/channels.h"
#include "components/model/gate/checks.h"
#include "components/model/gate/rules.h"
#include "components/model/identify/interpolated.h"

namespace sinew::gate {

namespace {

using types::Run;

// Recordings for the later checks, each with its place among those that were given.
struct SoundRuns {
  std::vector<Run> runs;
  std::vector<std::size_t> places;
};

// Later checks do without the channels that a structural rule refused.
SoundRuns Sound(const SoundRuns& before, const std::vector<Measurement>& measured) {
  SoundRuns out;
  for (std::size_t i = 0; i < before.runs.size(); ++i) {
    Run sound = before.runs[i];
    bool usable = sound.size() >= 12;
    for (const Measurement& at : measured) {
      if (at.recording != sound.name || at.statistic <= FindRule(at.rule).limit) continue;
      if (at.rule == "stamps") usable = false;
      if (const auto signal = types::SignalFromName(at.signal)) sound.signals.erase(*signal);
    }
    if (!usable) continue;
    out.runs.push_back(std::move(sound));
    out.places.push_back(before.places[i]);
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
    out +=
        at.first_row == at.last_row
            ? ", row " + std::to_string(at.first_row) + " (" + types::SecondsText(at.from_s) + " s)"
            : ", rows " + std::to_string(at.first_row) + " to " + std::to_string(at.last_row) +
                  " (" + types::SecondsText(at.from_s) + " to " + types::SecondsText(at.to_s) +
                  " s)";
  }
  return out.empty() ? "model" : out;
}

void RequireLengths(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    for (const auto& [signal, values] : run.signals) {
      if (values.size() == run.size()) continue;
      throw std::invalid_argument(
          "run '" + run.name + "': " + std::string(types::SignalName(signal)) + " has " +
          std::to_string(values.size()) + " rows, expected " + std::to_string(run.size()));
    }
  }
}

// Rows that are not in the list, which may name a row twice.
std::vector<Eigen::Index> OtherRows(Eigen::Index size, std::vector<Eigen::Index> rows) {
  std::vector<Eigen::Index> out;
  std::sort(rows.begin(), rows.end());
  for (Eigen::Index i = 0; i < size; ++i) {
    if (!std::binary_search(rows.begin(), rows.end(), i)) out.push_back(i);
  }
  return out;
}

// Spikes of all channels; the recordings go on without the rows that are left out.
std::vector<Measurement> LeaveOutSpikes(bool leave_out, SoundRuns* sound, GateReport* report) {
  std::vector<Measurement> measured;
  std::vector<LeftOut> here;
  for (std::size_t i = 0; i < sound->runs.size(); ++i) {
    SpikeCheck check = CheckSpikes(sound->runs[i], leave_out);
    Append(std::move(check.measured), &measured);
    for (Finding& at : check.findings) report->findings.push_back(std::move(at));
    for (LeftOut& at : check.left_out) {
      at.run = i;
      here.push_back(at);
      at.run = sound->places[i];
      report->left_out.push_back(std::move(at));
    }
  }
  sound->runs = WithoutRows(std::move(sound->runs), here);
  return measured;
}

// The rows of a measurement as the recording has them, with those that were left out.
void CountLeftOut(const GateReport& report, const std::vector<Run>& runs, Measurement* at) {
  std::set<Eigen::Index> rows;
  for (const LeftOut& left_out : report.left_out) {
    if (runs[left_out.run].name == at->recording) {
      rows.insert(left_out.rows.begin(), left_out.rows.end());
    }
  }
  for (const Eigen::Index row : rows) {
    if (row <= at->first_row) ++at->first_row;
    if (row <= at->last_row) ++at->last_row;
  }
}

// Compares with the limits: faults in the order of the rules, and the largest of every rule.
void Decide(std::vector<Measurement> all, const GateOptions& options, GateReport* out) {
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
      out->faults.push_back(std::move(fault));
    }
    if (largest != nullptr) out->largest.push_back(*largest);
  }
}

}  // namespace

bool GateReport::stops() const {
  return std::any_of(faults.begin(), faults.end(), [](const Fault& at) { return !at.accepted; });
}

GateReport ExamineData(const std::vector<Run>& runs, const actuator::JointModel& model,
                       const GateOptions& options) {
  for (const std::string& name : options.accepted) FindRule(name);
  RequireLengths(runs);
  GateReport out;
  SoundRuns sound{runs, std::vector<std::size_t>(runs.size())};
  std::iota(sound.places.begin(), sound.places.end(), std::size_t{0});
  std::vector<Measurement> all = CheckConstants(runs, model);
  // Later checks do without what these found.
  const auto apply = [&](std::vector<Measurement> measured) {
    sound = Sound(sound, measured);
    Append(std::move(measured), &all);
  };
  const auto of_each = [&](auto check) {
    std::vector<Measurement> measured;
    for (const Run& run : sound.runs) Append(check(run), &measured);
    return measured;
  };
  apply(CheckStructure(runs, model));
  if (!sound.runs.empty()) out.findings = FindSampling(sound.runs);
  apply(of_each(CheckWrapped));
  apply(of_each(CheckRegisters));
  apply(LeaveOutSpikes(!options.accepted.contains("spike"), &sound, &out));
  const std::size_t with_all_rows = all.size();
  apply(of_each([&](const Run& run) { return CheckFrozen(run, model); }));
  apply(of_each([&](const Run& run) { return CheckKinematics(run, model); }));
  Append(CheckBalance(sound.runs, model), &all);
  Append(CheckRecordings(sound.runs), &all);
  for (std::size_t i = with_all_rows; i < all.size(); ++i) CountLeftOut(out, runs, &all[i]);
  Decide(std::move(all), options, &out);
  if (sound.runs.empty()) return out;
  for (Finding& at : FindChannels(sound.runs, model)) {
    out.findings.push_back(std::move(at));
  }
  return out;
}

std::vector<Run> WithoutRows(std::vector<Run> runs, const std::vector<LeftOut>& left_out) {
  std::map<std::size_t, std::vector<Eigen::Index>> rows;
  for (const LeftOut& at : left_out) {
    rows[at.run].insert(rows[at.run].end(), at.rows.begin(), at.rows.end());
  }
  for (auto& [place, without] : rows) {
    Run& run = runs.at(place);
    const std::vector<Eigen::Index> others = OtherRows(run.size(), std::move(without));
    run = identify::WithRows(std::move(run), others);
  }
  return runs;
}

std::string AcceptOption(const Fault& fault) { return "--accept-fault " + fault.rule; }

std::string FormatFault(const Fault& fault) {
  return fault.rule + (fault.accepted ? " (accepted)" : "") + ": " + Place(fault) + ": " +
         fault.reason + " " + fault.remedy +
         (fault.accepted ? "" : " To continue in spite of it: " + AcceptOption(fault) + ".");
}

}  // namespace sinew::gate
