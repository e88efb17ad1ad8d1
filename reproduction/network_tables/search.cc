#include "reproduction/network_tables/search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <stdexcept>

#include "reproduction/training_sets/training_sets.h"
#include "tools/jobs/jobs.h"

namespace sinew::reproduction {
namespace {

using networks::ReservoirConfig;

constexpr int kFewest = 100, kMost = 550;
constexpr double kLowestRadius = 0.75, kHighestRadius = 1.25;
constexpr double kLowestLeak = 0.05, kHighestLeak = 0.15;

double Between(double low, double high, int step, int steps) {
  return low + (high - low) * step / (steps - 1);
}

std::string Head(const SearchOptions& options) {
  char text[200];
  std::snprintf(text, sizeof text,
                "# sinew-search/1 task=%s mode=%s steps=%d points=%d seeds=%d gcv=%d seconds=%g "
                "seed=%llu",
                std::string(networks::InfoOf(options.task).name).c_str(),
                options.random ? "random" : "grid", options.random ? 0 : options.steps,
                options.random ? options.points : 0, options.seeds, options.gcv ? 1 : 0,
                options.duration_s, static_cast<unsigned long long>(options.seed));
  return text;
}

// Reservoirs of spectral radius 1, one for every size and seed.
class Reservoirs {
 public:
  Reservoirs(const ReservoirConfig& config, int inputs) : config_(config), inputs_(inputs) {}

  const esn::Weights& Get(int neurons, std::uint64_t seed) {
    Entry* entry = nullptr;
    {
      const std::lock_guard lock(mutex_);
      entry = &entries_[{neurons, seed}];
    }
    std::call_once(entry->once, [&] {
      esn::Hyperparameters hyper = config_.hyper;
      hyper.neurons = neurons;
      hyper.spectral_radius = 1.0;
      hyper.seed = seed;
      entry->weights = networks::MakeReservoir(hyper, inputs_, 1);
    });
    return entry->weights;
  }

 private:
  struct Entry {
    std::once_flag once;
    esn::Weights weights;
  };
  ReservoirConfig config_;
  int inputs_;
  std::mutex mutex_;
  std::map<std::pair<int, std::uint64_t>, Entry> entries_;
};

}  // namespace

std::vector<SearchPoint> PlanSearch(const SearchOptions& options) {
  if (options.steps < 2 || options.points < 1 || options.seeds < 1 ||
      options.task == networks::Task::kForce) {
    throw std::invalid_argument(
        "search: expected at least 2 steps, 1 point and 1 reservoir, and the task sea or pea");
  }
  std::vector<SearchPoint> points;
  if (options.random) {
    std::mt19937_64 bits(options.seed);
    const auto uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
    for (int k = 0; k < options.points; ++k) {
      SearchPoint point;
      point.neurons = 50 + static_cast<int>(550.0 * uniform());
      point.spectral_radius = 0.3 + 1.2 * uniform();
      point.leak = 0.02 * std::pow(20.0, uniform());  // 0.02 .. 0.4
      points.push_back(point);
    }
    return points;
  }
  for (int n = 0; n < options.steps; ++n) {
    for (int r = 0; r < options.steps; ++r) {
      for (int t = 0; t < options.steps; ++t) {
        SearchPoint point;
        point.neurons = static_cast<int>(std::lround(Between(kFewest, kMost, n, options.steps)));
        point.spectral_radius = Between(kLowestRadius, kHighestRadius, r, options.steps);
        point.leak = Between(kLowestLeak, kHighestLeak, t, options.steps);
        points.push_back(point);
      }
    }
  }
  return points;
}

void RunSearch(const SearchOptions& options, std::vector<SearchPoint>* points,
               const Progress& progress, const std::function<void()>& save) {
  const networks::Samples samples = networks::MakeSamples(
      networks::MakeTable(
          {MakeSurrogateRun(
              {.task = options.task, .duration_s = options.duration_s, .seed = options.seed})},
          {.task = options.task}),
      kValidationShare, kGap);
  ReservoirConfig config =
      (options.task == networks::Task::kSea ? networks::Table62() : networks::Table64())
          .back()
          .reservoir;
  if (options.gcv) config.ridge_beta.reset();
  Reservoirs reservoirs(config, static_cast<int>(samples.inputs.rows()));

  std::mutex mutex;
  std::vector<std::function<void()>> jobs;
  std::size_t done_before = 0;
  for (SearchPoint& point : *points) {
    if (point.done()) {
      ++done_before;
      continue;
    }
    jobs.push_back([&] {
      double validation = 0.0, test = 0.0;
      for (int k = 0; k < options.seeds; ++k) {
        esn::Weights weights =
            reservoirs.Get(point.neurons, options.seed + static_cast<std::uint64_t>(k));
        weights.hyper.spectral_radius = point.spectral_radius;
        weights.hyper.leak = point.leak;
        for (double& value : weights.reservoir.value) value *= point.spectral_radius;
        const Eigen::MatrixXd states = networks::ReservoirStates(weights, samples);
        const networks::ReservoirModel model =
            networks::FitReadout(weights, states, samples, config);
        const Eigen::MatrixXd predicted = model.readout * states;
        validation += networks::MeanSquare(samples, predicted, samples.validation) / options.seeds;
        test += networks::MeanSquare(samples, predicted, samples.test) / options.seeds;
      }
      const std::lock_guard lock(mutex);
      point.validation_mse = validation;
      point.test_mse = test;
    });
  }
  using Clock = std::chrono::steady_clock;
  Clock::time_point next = Clock::now() + std::chrono::seconds(1);
  tools::RunJobs(jobs, options.threads, [&](std::size_t done) {
    if (progress) progress(done_before + done, points->size());
    if (Clock::now() < next) return;
    next = Clock::now() + std::chrono::seconds(1);
    const std::lock_guard lock(mutex);
    if (save) save();
  });
  if (save) save();
}

const SearchPoint* Best(const std::vector<SearchPoint>& points) {
  const SearchPoint* best = nullptr;
  for (const SearchPoint& point : points) {
    if (point.done() && (best == nullptr || point.validation_mse < best->validation_mse)) {
      best = &point;
    }
  }
  return best;
}

std::string FormatSearch(const SearchOptions& options, const std::vector<SearchPoint>& points) {
  std::string text = Head(options) + "\nneurons,spectral_radius,leak,validation_mse,test_mse\n";
  char line[160];
  for (const SearchPoint& point : points) {
    if (!point.done()) continue;
    std::snprintf(line, sizeof line, "%d,%.9g,%.9g,%.9g,%.9g\n", point.neurons,
                  point.spectral_radius, point.leak, point.validation_mse, point.test_mse);
    text += line;
  }
  return text;
}

void ResumeSearch(const SearchOptions& options, const std::string& text, const std::string& name,
                  std::vector<SearchPoint>* points) {
  std::istringstream lines(text);
  std::string line;
  std::getline(lines, line);
  if (line != Head(options)) {
    throw std::invalid_argument(name + ":1: a search of other options, expected '" + Head(options) +
                                "'");
  }
  std::getline(lines, line);
  for (int number = 3; std::getline(lines, line); ++number) {
    SearchPoint read;
    if (std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%lf", &read.neurons, &read.spectral_radius,
                    &read.leak, &read.validation_mse, &read.test_mse) != 5 ||
        !(read.validation_mse >= 0.0) || !(read.test_mse >= 0.0)) {
      throw std::invalid_argument(name + ":" + std::to_string(number) + ": '" + line +
                                  "', expected five numbers");
    }
    const auto same = [&](const SearchPoint& point) {
      return point.neurons == read.neurons &&
             std::abs(point.spectral_radius - read.spectral_radius) < 1e-7 &&
             std::abs(point.leak - read.leak) < 1e-7;
    };
    const auto found = std::find_if(points->begin(), points->end(), same);
    if (found == points->end()) {
      throw std::invalid_argument(name + ":" + std::to_string(number) +
                                  ": a point that this search does not have");
    }
    found->validation_mse = read.validation_mse;
    found->test_mse = read.test_mse;
  }
}

report::Picture SearchPicture(const std::vector<SearchPoint>& points) {
  report::Picture picture;
  picture.title = "Error of the echo state network over N, rho and tau (Fig 6.7)";
  const SearchPoint* best = Best(points);
  if (best != nullptr) {
    char text[240];
    std::snprintf(text, sizeof text,
                  "Validation MSE, normalised. Best: N = %d, rho = %.3f, tau = %.3f (published: "
                  "500, 1.15, 0.12), validation MSE %.4f, test MSE %.4f.",
                  best->neurons, best->spectral_radius, best->leak, best->validation_mse,
                  best->test_mse);
    picture.caption = text;
  }
  picture.script = report::PictureHead(520) +
                   "set xlabel 'N'\nset ylabel 'spectral radius'\nset zlabel 'leak' rotate\n"
                   "set cblabel 'validation MSE'\nset logscale cb\nset ticslevel 0\n"
                   "set palette defined (0 '#1b7f9e', 1 '#c9a227', 2 '#b5525c')\nset view 62,38\n"
                   "$points << EOD\n";
  for (const SearchPoint& point : points) {
    if (!point.done()) continue;
    picture.script += std::to_string(point.neurons) + " " +
                      report::PictureNumber(point.spectral_radius) + " " +
                      report::PictureNumber(point.leak) + " " +
                      report::PictureNumber(point.validation_mse) + "\n";
  }
  picture.script += "EOD\n";
  std::string best_plot;
  if (best != nullptr) {
    picture.script += "$best << EOD\n" + std::to_string(best->neurons) + " " +
                      report::PictureNumber(best->spectral_radius) + " " +
                      report::PictureNumber(best->leak) + "\nEOD\n";
    best_plot =
        ", $best using 1:2:3 with points pointtype 6 pointsize 2.2 linewidth 2 linecolor rgb "
        "'#333333' title 'best'";
  }
  picture.script +=
      "splot $points using 1:2:3:4 with points pointtype 7 pointsize 0.7 palette notitle" +
      best_plot + "\n";
  return picture;
}

}  // namespace sinew::reproduction
