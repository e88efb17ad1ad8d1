#include "tools/tune_robot/gain_search.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "components/base/types/text.h"
#include "tools/jobs/jobs.h"

namespace sinew::tune {
namespace {

std::string NameOf(const GainTrial& trial) {
  return "trial " + std::to_string(trial.number) + " of stage " + std::to_string(trial.stage);
}

// Takes over what is done of the stage; true: all of it is.
bool TakeDone(const std::vector<GainTrial>& done, std::vector<GainTrial>* stage) {
  for (const GainTrial& known : done) {
    for (GainTrial& trial : *stage) {
      if (trial.stage != known.stage || trial.number != known.number) continue;
      if (!SameGains(trial.pid, known.pid) || trial.name != known.name) {
        throw std::invalid_argument(NameOf(known) +
                                    " has other gains in this search, expected the search that "
                                    "made the table");
      }
      trial.score = known.score;
    }
  }
  return std::all_of(stage->begin(), stage->end(),
                     [](const GainTrial& trial) { return trial.score.has_value(); });
}

double Rounded(double gain) {
  return std::strtod(types::Text("%.*g", kGainDigits, gain).c_str(), nullptr);
}

std::vector<GainTrial> DrawnStage(const GainSearchConfig& config, int stage,
                                  const control::PidConfig& center) {
  std::vector<GainTrial> trials;
  for (control::PidConfig pid : DrawStage(config.search, stage, center)) {
    for (const Gain& gain : kGains) pid.*gain.of = Rounded(pid.*gain.of);
    trials.push_back({stage, static_cast<int>(trials.size()), "", pid, std::nullopt});
  }
  return trials;
}

std::vector<GainTrial> FirstStages(const GainSearchConfig& config) {
  std::vector<GainTrial> trials;
  for (const NamedGains& named : config.compared) {
    control::PidConfig pid = config.rest;
    pid.proportional_Nm_rad = named.proportional_Nm_rad;
    pid.integral_Nm_rad_s = named.integral_Nm_rad_s;
    pid.derivative_Nm_s_rad = named.derivative_Nm_s_rad;
    trials.push_back({0, static_cast<int>(trials.size()), named.name, pid, std::nullopt});
  }
  const std::vector<GainTrial> drawn = DrawnStage(config, 1, config.rest);
  trials.insert(trials.end(), drawn.begin(), drawn.end());
  return trials;
}

}  // namespace

const GainTrial* BestTrial(const std::vector<GainTrial>& trials, int first_stage) noexcept {
  const GainTrial* best = nullptr;
  for (const GainTrial& trial : trials) {
    if (trial.stage < first_stage || !(trial.cost() < kDiscarded)) continue;
    if (best == nullptr || trial.cost() < best->cost()) best = &trial;
  }
  return best;
}

std::vector<GainTrial> PlanTrials(const GainSearchConfig& config,
                                  const std::vector<GainTrial>& done) {
  std::vector<GainTrial> trials = FirstStages(config);
  const bool first_done = TakeDone(done, &trials);
  const GainTrial* center = first_done ? BestTrial(trials) : nullptr;
  if (center != nullptr) {
    std::vector<GainTrial> second = DrawnStage(config, 2, center->pid);
    TakeDone(done, &second);
    trials.insert(trials.end(), second.begin(), second.end());
  }
  for (const GainTrial& known : done) {
    const bool planned = std::any_of(trials.begin(), trials.end(), [&known](const GainTrial& t) {
      return t.stage == known.stage && t.number == known.number;
    });
    if (!planned) throw std::invalid_argument(NameOf(known) + " is not one of this search");
  }
  return trials;
}

GainSearchResult RunGainSearch(const GainSearchConfig& config, const std::vector<GainTrial>& done,
                               const std::function<ClosedLoopScore(const control::PidConfig&)>& run,
                               const std::function<void(const GainTrial&)>& keep,
                               const std::function<void(std::size_t, std::size_t)>& progress) {
  const std::size_t total =
      config.compared.size() + 2 * static_cast<std::size_t>(std::max(0, config.search.trials));
  std::mutex mutex;
  std::vector<GainTrial> trials = PlanTrials(config, done);
  for (;;) {
    std::vector<std::function<void()>> jobs;
    for (GainTrial& trial : trials) {
      if (trial.score) continue;
      jobs.emplace_back([&mutex, &run, &keep, &trial] {
        const ClosedLoopScore score = run(trial.pid);
        const std::lock_guard lock(mutex);
        trial.score = score;
        if (keep) keep(trial);
      });
    }
    if (jobs.empty()) break;
    const std::size_t before = trials.size() - jobs.size();
    tools::RunJobs(jobs, config.threads, [&](std::size_t now) {
      if (progress) progress(before + now, total);
    });
    trials = PlanTrials(config, trials);
  }
  GainSearchResult result{std::move(trials), std::nullopt};
  const GainTrial* best = BestTrial(result.trials);
  if (best != nullptr) result.best = *best;
  return result;
}

}  // namespace sinew::tune
