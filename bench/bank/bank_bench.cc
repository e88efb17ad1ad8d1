// bank-bench: the whole test bank, its figures, and the sizes that it uses.
//   cmake --build build/release --target bank_bench
//   build/release/bin/bank_bench --out bank.jsonl
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "components/config/config.h"
#include "tests/bank/bank.h"
#include "tests/bank/figures.h"

namespace {

using namespace sinew;

struct Arguments {
  bank::Plan plan;
  std::string part = "1/1";
  int threads = 2;
  bool explain = false;
  bool no_task = false, no_parameters = false, calibrate = false, list = false;
  std::filesystem::path out;
  std::filesystem::path json;
  std::vector<std::filesystem::path> read;
};

template <class T>
std::vector<T> PartOf(const std::vector<T>& all, const std::string& part) {
  const std::size_t slash = part.find('/');
  int number = 0, of = 0;
  try {
    number = std::stoi(part.substr(0, slash));
    of = slash == std::string::npos ? 0 : std::stoi(part.substr(slash + 1));
  } catch (const std::exception&) {
  }
  if (number < 1 || of < 1 || number > of) {
    throw UsageError("--part " + part + ": expected N/M with N from 1 to M");
  }
  std::vector<T> out;
  for (std::size_t i = static_cast<std::size_t>(number - 1); i < all.size();
       i += static_cast<std::size_t>(of)) {
    out.push_back(all[i]);
  }
  return out;
}

void CalibrateAll(const Arguments& arguments) {
  std::vector<std::string> names = arguments.plan.effects;
  if (names.empty()) {
    names = bank::CatalogueNames();
    for (const std::string& name : bank::OutsideNames()) names.push_back(name);
  }
  for (const auto excitation :
       {surrogate::ExcitationKind::kDesigned, surrogate::ExcitationKind::kTask}) {
    for (const std::string& name : PartOf(names, arguments.part)) {
      std::cout << bank::FormatSize(bank::Calibrate(name, excitation)) << std::flush;
    }
  }
}

std::vector<bank::Outcome> ReadOutcomes(const std::vector<std::filesystem::path>& files) {
  std::vector<bank::Outcome> outcomes;
  for (const std::filesystem::path& file : files) {
    std::ifstream in(file);
    if (!in) throw UsageError(file.string() + ": cannot be read, expected outcomes of the bank");
    int number = 0;
    for (std::string line; std::getline(in, line);) {
      ++number;
      try {
        outcomes.push_back(bank::FromJson(line));
      } catch (const std::invalid_argument& error) {
        throw UsageError(file.string() + ":" + std::to_string(number) + ": " + error.what());
      }
    }
  }
  return outcomes;
}

void Run(Arguments& arguments) {
  if (arguments.calibrate) return CalibrateAll(arguments);
  std::vector<bank::Outcome> outcomes = ReadOutcomes(arguments.read);
  if (arguments.read.empty()) {
    arguments.plan.task = !arguments.no_task;
    arguments.plan.parameters = !arguments.no_parameters;
    const std::vector<bank::Case> cases = PartOf(bank::MakeCases(arguments.plan), arguments.part);
    std::ofstream lines;
    if (!arguments.out.empty()) {
      lines.open(arguments.out);
      if (!lines) throw UsageError(arguments.out.string() + ": cannot be written");
    }
    std::size_t done = 0;
    outcomes = bank::RunCases(
        cases, arguments.threads, arguments.plan.parameters, [&](const bank::Outcome& outcome) {
          if (lines) lines << bank::ToJson(outcome) << std::endl;
          if (arguments.explain) {
            std::cout << bank::CaseName(outcome.what) << ": " << outcome.verdict << '\n'
                      << outcome.explanation;
          }
          if (++done % 20 == 0) {
            std::cerr << done << " of " << cases.size() << '\n';
          }
        });
  }
  const bank::Figures figures = bank::CountFigures(outcomes);
  std::cout << bank::FormatConfusion(outcomes) << '\n' << bank::FormatFigures(figures);
  if (!arguments.json.empty()) {
    config::WriteFileAtomically(arguments.json, bank::FiguresToJson(figures));
  }
}

}  // namespace

int main(int argc, char** argv) try {
  Arguments arguments;
  CLI::App app{"Runs the test bank: hidden effects of the surrogate against the tracer."};
  app.add_option("--seeds", arguments.plan.seeds, "specimens per effect")->capture_default_str();
  app.add_option("--first-seed", arguments.plan.first_seed, "of the specimens")
      ->capture_default_str();
  app.add_option("--effects", arguments.plan.effects,
                 "only these, with none and pairs as names; all by default")
      ->delimiter(',');
  app.add_option("--without", arguments.plan.without, "recordings without an effect")
      ->capture_default_str();
  app.add_option("--pair-seeds", arguments.plan.pair_seeds, "specimens per pair")
      ->capture_default_str();
  app.add_option("--part", arguments.part, "N/M: only every M-th case, from the N-th on")
      ->capture_default_str();
  app.add_option("--threads", arguments.threads, "cases at a time")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  app.add_flag("--explain", arguments.explain, "print the best candidates of every case");
  app.add_flag("--no-task", arguments.no_task, "designed excitation only");
  app.add_flag("--no-parameters", arguments.no_parameters,
               "do not compare parameters with recordings without noise");
  app.add_option("--out", arguments.out, "a line of JSON per case");
  app.add_option("--json", arguments.json, "the figures");
  app.add_option("--read", arguments.read,
                 "figures of cases that were run before (files of --out), nothing is run");
  app.add_flag("--calibrate", arguments.calibrate,
               "make the sizes of the effects (tests/bank/sizes.inc)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  Run(arguments);
  return 0;
} catch (const sinew::UsageError& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
