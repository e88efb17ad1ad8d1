#include "reproduction/commands/experiment.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "reproduction/laboratory/coverage.h"
#include "reproduction/laboratory/laboratory.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "tools/sinew/progress.h"

namespace sinew::reproduction {
namespace {

using experiment::Quantity;
using experiment::Recording;
using experiment::Result;
using laboratory::Coverage;
using nlohmann::ordered_json;
using tools::ExperimentOptions;
using tools::ExperimentOutcome;

constexpr std::uint64_t kSteps = 1000;  // of a progress bar
constexpr double kLowestCoverage = 0.90, kHighestCoverage = 0.99;

struct RigOptions {
  std::filesystem::path surrogate;
  int seeds = 0;
  int threads = 2;
  double spread = 0.1;
};

// A share of the work into a progress bar, from several threads.
class SharedProgress {
 public:
  explicit SharedProgress(const std::string& what)
      : bar_("experiment " + what, "permille", kSteps) {}
  void Report(double share) {
    const std::lock_guard<std::mutex> lock(mutex_);
    bar_.Update(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * kSteps));
  }

 private:
  std::mutex mutex_;
  tools::ProgressBar bar_;
};

// Seeds 1..n, each another specimen, by several threads. The order of what is counted does not
// depend on the threads.
std::map<std::string, Coverage> CountCoverage(const std::string& name,
                                              const surrogate::RigParameters& rig,
                                              const experiment::RigConstants& constants,
                                              const RigOptions& options, std::uint64_t first_seed) {
  std::vector<std::optional<Result>> results(static_cast<std::size_t>(options.seeds));
  std::vector<std::exception_ptr> errors(results.size());
  std::atomic<std::size_t> next{0}, finished{0};
  SharedProgress progress(name + ", " + std::to_string(options.seeds) + " seeds");
  const auto work = [&] {
    for (std::size_t i = next++; i < results.size(); i = next++) {
      try {
        const std::uint64_t seed = first_seed + i;
        const surrogate::RigParameters specimen =
            laboratory::MakeSpecimen(rig, options.spread, seed);
        laboratory::Plan plan{
            .size = laboratory::Size::kCoverage, .constants = constants, .seed = seed + 1000003};
        results[i] = laboratory::RunOnSurrogate(name, specimen, plan).result;
      } catch (...) {
        errors[i] = std::current_exception();
      }
      progress.Report(static_cast<double>(++finished) / static_cast<double>(results.size()));
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  laboratory::CoverageCount count;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (errors[i]) std::rethrow_exception(errors[i]);
    count.Add(*results[i]);
  }
  return count.by_id();
}

std::string Percent(double share) {
  char text[24];
  std::snprintf(text, sizeof text, "%.2f %%", 100.0 * share);
  return text;
}

std::string LineOf(const std::string& id, const Coverage& c) {
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%-34s intervals held the truth in %d of %d seeds; bias %.2f %%, half width %.2f %%",
      id.c_str(), c.covered, c.seeds, 100.0 * c.mean_error, 100.0 * c.mean_half_width);
  return text + (c.has_target ? "; target met in " + std::to_string(c.met) : std::string());
}

ordered_json JsonOf(const Coverage& c) {
  return {{"seeds", c.seeds},
          {"covered", c.covered},
          {"target_met", c.has_target ? ordered_json(c.met) : ordered_json(nullptr)},
          {"bias_1", c.mean_error},
          {"largest_error_1", c.largest_error},
          {"half_width_1", c.mean_half_width}};
}

report::Comparison TargetOf(const std::string& name, const Coverage& c) {
  report::Comparison line;
  line.name = name + ": coverage of its interval";
  line.unit = "%";
  char text[24];
  std::snprintf(text, sizeof text, "%.0f", 100.0 * c.share());
  line.ours = text;
  line.target = "90 to 99 % of the seeds";
  line.met = c.share() >= kLowestCoverage - 1e-9 && c.share() <= kHighestCoverage + 1e-9;
  line.remark = std::to_string(c.seeds) + " seeds";
  return line;
}

tools::ExperimentAddition AdditionOf(const std::map<std::string, Coverage>& coverage,
                                     const Result& result, double spread) {
  tools::ExperimentAddition addition;
  ordered_json json = ordered_json::object();
  report::Table table;
  table.title = "Intervals against the truth of many specimens";
  table.caption =
      "Each seed is another specimen whose parameters are off by up to " + Percent(spread) + ".";
  table.header = {"quantity",     "seeds", "intervals that held the truth",
                  "targets met",  "bias",  "half width",
                  "largest error"};
  for (const auto& [id, c] : coverage) {
    const Quantity* quantity = result.Find(id);
    const std::string name = quantity != nullptr ? quantity->name : id;
    addition.lines.push_back(LineOf(id, c));
    json[id] = JsonOf(c);
    table.rows.push_back({name, std::to_string(c.seeds), std::to_string(c.covered),
                          c.has_target ? std::to_string(c.met) : std::string("-"),
                          Percent(c.mean_error), Percent(c.mean_half_width),
                          Percent(c.largest_error)});
    if (c.has_target) addition.comparisons.push_back(TargetOf(name, c));
  }
  addition.json = {{"coverage", json}};
  addition.tables.push_back(std::move(table));
  return addition;
}

class SurrogateRig : public tools::SimulatedRig {
 public:
  SurrogateRig(RigOptions rig_options, ExperimentOptions options)
      : rig_options_(std::move(rig_options)), options_(std::move(options)) {
    rig_ = surrogate::LoadRig(rig_options_.surrogate);
    rig_.seed = options_.seed;
    rig_ = surrogate::Specimen(rig_);
  }

  ExperimentOutcome Run(const std::string& name,
                        const experiment::RigConstants& constants) const override {
    ExperimentOutcome done;
    laboratory::Plan plan;
    plan.size = options_.quick ? laboratory::Size::kQuick : laboratory::Size::kFull;
    plan.trials = options_.trials;
    plan.constants = constants;
    plan.seed = options_.seed;
    {
      SharedProgress progress(name);
      laboratory::Outcome outcome = laboratory::RunOnSurrogate(
          name, rig_, plan, [&progress](double share) { progress.Report(share); });
      done.result = std::move(outcome.result);
      done.simulated_s = outcome.simulated_s;
      // Separate trials are placed one after the other, a second apart.
      double offset_s = 0.0;
      for (const Recording& recording : outcome.recordings) {
        for (experiment::Row row : recording) {
          row.time_s += offset_s;
          done.rows.push_back(row);
        }
        if (!done.rows.empty()) offset_s = done.rows.back().time_s + 1.0;
      }
    }
    done.source = "surrogate, seed " + std::to_string(options_.seed);
    const bool data_only = name == "sea-data" || name == "pea-data";
    if (rig_options_.seeds > 0 && !data_only) {
      done.addition = AdditionOf(CountCoverage(name, rig_, constants, rig_options_, options_.seed),
                                 done.result, rig_options_.spread);
    }
    return done;
  }

  void FillTruth(Result* result) const override { laboratory::FillTruth(rig_, result); }

 private:
  RigOptions rig_options_;
  ExperimentOptions options_;
  surrogate::RigParameters rig_;
};

class SurrogateExperiments : public tools::ExperimentSimulation {
 public:
  void AddOptions(CLI::App& command) override {
    command.add_option("--surrogate", options_.surrogate,
                       "File (sinew-surrogate/1) of the rig that is played; with --dds or "
                       "a recording only the true values are taken from it");
    command
        .add_option("--seeds", options_.seeds,
                    "In process: also count over this many specimens how often intervals held "
                    "the truth")
        ->check(CLI::Range(1, 10000));
    command
        .add_option("--spread", options_.spread, "Specimens of --seeds are off by up to this share")
        ->check(CLI::Range(0.0, 0.3))
        ->capture_default_str();
    command.add_option("--threads", options_.threads, "For --seeds")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
  }

  std::unique_ptr<tools::SimulatedRig> MakeRig(const ExperimentOptions& options) const override {
    if (!options.in_process() && options_.surrogate.empty()) return nullptr;
    return std::make_unique<SurrogateRig>(options_, options);
  }

 private:
  RigOptions options_;
};

}  // namespace

std::shared_ptr<tools::ExperimentSimulation> MakeSurrogateExperiments() {
  return std::make_shared<SurrogateExperiments>();
}

}  // namespace sinew::reproduction
