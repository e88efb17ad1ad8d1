#include "reproduction/commands/search.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "reproduction/network_tables/search.h"
#include "tools/sinew/progress.h"

namespace sinew::reproduction {
namespace {

struct Options {
  SearchOptions search;
  std::string task = "sea";
  std::filesystem::path out;
  bool quick = false;
  bool json = false;
};

report::Section SectionOf(const Options& options, const std::vector<SearchPoint>& points,
                          const SearchPoint& best, double seconds) {
  report::Section section;
  section.id = options.search.random ? "search-random" : "search-grid";
  section.title = options.search.random ? "Random search of the reservoir"
                                        : "Hyper-parameters of the reservoir (Fig 6.7)";
  section.paragraphs = {
      "Every point is an echo state network with the published input variance and density, fitted "
      "on the surrogate's " +
      options.task +
      " set. Points are compared by their error on validation samples, which neither train nor "
      "test; MSE is of the normalised target."};
  const auto add = [&](const char* name, const char* published, const std::string& ours) {
    report::Comparison comparison;
    comparison.name = name;
    comparison.published = published;
    comparison.source = "Fig 6.7";
    comparison.ours = ours;
    section.comparisons.push_back(comparison);
  };
  add("reservoir size N", options.search.random ? "550" : "500", std::to_string(best.neurons));
  add("spectral radius", options.search.random ? "0.8985" : "1.15",
      report::Short(best.spectral_radius));
  add("leak tau", options.search.random ? "0.11" : "0.12", report::Short(best.leak));
  add("test MSE of the best", "", report::Short(best.test_mse));
  section.pictures = {SearchPicture(points)};
  section.seconds = seconds;
  return section;
}

void Run(Options options) {
  SearchOptions& search = options.search;
  search.task = options.task == "sea" ? networks::Task::kSea : networks::Task::kPea;
  if (options.quick) {
    search.steps = std::min(search.steps, 4);
    search.points = std::min(search.points, 40);
    if (search.task == networks::Task::kPea) search.duration_s = 60.0;
  }
  const auto start = std::chrono::steady_clock::now();
  std::vector<SearchPoint> points;
  try {
    points = PlanSearch(search);
    const std::filesystem::path state = options.out / "search.csv";
    if (!options.out.empty()) {
      std::filesystem::create_directories(options.out);
      if (std::filesystem::exists(state)) {
        ResumeSearch(search, config::ReadFile(state), state.string(), &points);
      }
    }
    tools::ProgressBar bar("search", "points", points.size());
    RunSearch(
        search, &points,
        [&](std::size_t done, std::size_t total) {
          bar.Update(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(total));
        },
        [&] {
          if (!options.out.empty()) {
            config::WriteFileAtomically(state, FormatSearch(search, points));
          }
        });
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const SearchPoint& best = *Best(points);
  if (options.json) {
    const nlohmann::ordered_json json = {{"points", points.size()},
                                         {"best",
                                          {{"neurons", best.neurons},
                                           {"spectral_radius", best.spectral_radius},
                                           {"leak", best.leak},
                                           {"validation_mse", best.validation_mse},
                                           {"test_mse", best.test_mse}}},
                                         {"time_s", seconds}};
    std::cout << types::JsonText(json, 2) << '\n';
  } else {
    std::printf("%zu points: N %d, rho %.4f, tau %.4f: validation MSE %.5f, test MSE %.5f\n",
                points.size(), best.neurons, best.spectral_radius, best.leak, best.validation_mse,
                best.test_mse);
    std::printf("published: %s; %.1f s\n",
                search.random ? "N 550, rho 0.8985, tau 0.11" : "N 500, rho 1.15, tau 0.12",
                seconds);
  }
  if (!options.out.empty()) {
    report::WriteSection(options.out, SectionOf(options, points, best, seconds));
  }
}

}  // namespace

void AddSearchCommand(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("search", "Search size, spectral radius and leak of a reservoir");
  command->footer(
      "With --out the search goes on where it was stopped. Example:\n"
      "  sinew search --out search\n"
      "  sinew search --random --points 300 --out random");
  auto options = std::make_shared<Options>();
  command->add_option("--task", options->task, "sea (inside the backlash) or pea (outside)")
      ->check(CLI::IsMember({"sea", "pea"}))
      ->capture_default_str();
  command->add_flag("--random", options->search.random, "Drawn points instead of the grid");
  command->add_option("--steps", options->search.steps, "Of every axis of the grid")
      ->check(CLI::Range(2, 20))
      ->capture_default_str();
  command->add_option("--points", options->search.points, "To draw")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--reservoirs", options->search.seeds, "Of every point; their mean counts")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--gcv", options->search.gcv,
                    "Ridge strength by cross-validation instead of the published 0.01");
  command->add_option("--threads", options->search.threads, "Points at a time")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command->add_option("--seed", options->search.seed, "Of the data set, draws and reservoirs")
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "A coarse grid or few points: some seconds");
  command->add_option("--out", options->out, "Folder: search.csv (resumed), picture, section");
  command->add_flag("--json", options->json, "Result as JSON");
  command->callback([options] { Run(*options); });
}

}  // namespace sinew::reproduction
