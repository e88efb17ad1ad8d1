// The bank of rigs: `rig_bank make`, `run`, `score`, `merge`. See bench/rigs/README.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "bench/rigs/figures.h"
#include "bench/rigs/files.h"
#include "bench/rigs/outcome.h"
#include "bench/rigs/planting.h"
#include "bench/rigs/true_set.h"
#include "bench/rigs/variants.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Shard {
  int part = 1, of = 1;
  bool Has(std::size_t i) const { return static_cast<int>(i) % of == part - 1; }
};

Shard ParseShard(const std::string& text) {
  Shard out;
  if (std::sscanf(text.c_str(), "%d/%d", &out.part, &out.of) != 2 || out.part < 1 ||
      out.part > out.of) {
    throw CLI::ValidationError("--shard", "'" + text + "', expected K/N with K from 1 to N");
  }
  return out;
}

bool Matches(const rigs::Case& c, const rigs::Rig& rig, const std::string& pattern) {
  if (pattern.empty()) return true;
  std::string text = c.name + " " + rigs::WordOf(rig.family);
  for (const std::string& effect : c.effects) text += " " + effect;
  return text.find(pattern) != std::string::npos;
}

void Make(const fs::path& out, int first, int count, const std::string& only, const Shard& shard,
          double noise_share) {
  fs::create_directories(out);
  int made = 0, kept = 0;
  const auto start = Clock::now();
  for (int i = 0; i < count; ++i) {
    if (!shard.Has(static_cast<std::size_t>(i))) continue;
    const rigs::Rig rig = rigs::DrawRig(static_cast<std::uint64_t>(first + i));
    std::unique_ptr<rigs::Sizer> sizers[3];
    for (const rigs::Case& what : rigs::DrawCases(rig)) {
      if (!Matches(what, rig, only)) continue;
      const fs::path folder = out / what.name;
      if (fs::exists(folder / "truth.json")) {
        ++kept;
        continue;
      }
      auto& sizer = sizers[static_cast<int>(what.excitation)];
      if (!sizer) sizer = std::make_unique<rigs::Sizer>(rig, what.excitation);
      try {
        WriteCase(folder, rig, MakeCase(rig, what, *sizer, noise_share));
        ++made;
      } catch (const std::runtime_error& error) {  // one case less, printed and counted
        std::cerr << error.what() << ", left out\n";
      }
    }
    std::printf("rig %d (%s): %d cases made, %d were there, %.1f s a case\n", first + i,
                rigs::WordOf(rig.family), made, kept, made > 0 ? Since(start) / made : 0.0);
    std::fflush(stdout);
  }
}

void Vary(const fs::path& cases, const fs::path& out, const std::string& only) {
  int made = 0;
  for (const auto& entry : fs::directory_iterator(cases)) {
    const std::string name = entry.path().filename().string();
    if (!fs::exists(entry.path() / "truth.json") || name.find(only) == std::string::npos) continue;
    for (const Variant& variant : Variants()) {
      const fs::path folder = out / (name + "-" + variant.name);
      if (fs::exists(folder / "truth.json")) continue;
      made += WriteVariant(entry.path(), variant, folder) ? 1 : 0;
    }
  }
  std::printf("%d variants made\n", made);
}

std::string Quoted(const fs::path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Options of the tracer beside the recordings.
struct Asked {
  std::vector<std::string> without;  // rules
  bool true_set = false;             // what is truly there is given
  bool without_truth = false;        // what is truly there is in no catalogue
};

// One subprocess; run.json has its exit code and time.
void RunCase(const fs::path& sinew, const fs::path& folder, const fs::path& out, int limit_s,
             const Asked& asked) {
  std::string options;
  for (const std::string& rule : asked.without) options += " --without-rule " + Quoted(rule);
  if (asked.true_set || asked.without_truth) {
    std::ifstream truth(folder / "truth.json");
    const auto there = nlohmann::json::parse(truth);
    const std::vector<std::string> given =
        asked.true_set ? TrueSetOptions(there) : EachEffect("--without-effect", there);
    if (given.empty()) return;
    for (const std::string& word : given) options += " " + Quoted(word);
  }
  fs::create_directories(out);
  const std::string command =
      "timeout " + std::to_string(limit_s) + " " + Quoted(sinew) + " close-loop --model " +
      Quoted(folder / "model.yaml") + " --map " + Quoted(folder / "csv_map.yaml") + " --train " +
      Quoted(folder / "train_1.csv") + " " + Quoted(folder / "train_2.csv") + " " +
      Quoted(folder / "train_3.csv") + " --held-out " + Quoted(folder / "sealed.csv") + " --out " +
      Quoted(out) + options + " > " + Quoted(out / "log.txt") + " 2>&1";
  const auto start = Clock::now();
  const int status = std::system(command.c_str());
  const int code = status < 0 ? -1 : (status >> 8) & 0xff;
  const bool report = fs::exists(out / "report.json");
  // A program that stops with a message, neither a crash (128 and more) nor out of time (124).
  const bool refused = !report && code > 0 && code < 124;
  std::ofstream(out / "run.json")
      << nlohmann::json{{"seconds", Since(start)}, {"exit", code}, {"refused", refused}}.dump()
      << "\n";
}

void Run(const fs::path& cases, const fs::path& sinew, const fs::path& reports,
         const std::string& only, int jobs, int limit_s, const Shard& shard, const Asked& asked) {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(cases)) {
    const std::string name = entry.path().filename().string();
    if (fs::exists(entry.path() / "truth.json") && name.find(only) != std::string::npos) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  std::atomic<std::size_t> next{0};
  std::atomic<int> done{0};
  auto work = [&] {
    for (std::size_t i = next++; i < folders.size(); i = next++) {
      const fs::path out = reports / folders[i].filename();
      if (!shard.Has(i) || fs::exists(out / "report.json") || fs::exists(out / "run.json"))
        continue;
      RunCase(sinew, folders[i], out, limit_s, asked);
      std::printf("%d: %s\n", ++done, folders[i].filename().c_str());
      std::fflush(stdout);
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < jobs; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
}

void Print(const std::vector<Outcome>& outcomes, const fs::path& json, bool confusion) {
  const Figures figures = CountFigures(outcomes);
  std::cout << outcomes.size() << " cases\n" << TableOf(figures);
  std::cout << "names by the p that is printed beside them\n" << ReliabilityOf(outcomes);
  const Calibration line = Calibrate(outcomes);
  std::printf("  log odds of being right = %.2f + %.2f log odds of p (%d names)\n", line.offset,
              line.slope, line.names);
  std::cout << PlantedTableOf(outcomes);
  if (confusion) std::cout << "\n" << ConfusionOf(outcomes);
  if (!json.empty()) std::ofstream(json) << ToJson(figures).dump(1) << "\n";
}

struct Options {
  fs::path out, cases, sinew, reports, jsonl, json, true_sets, quiet;
  std::vector<fs::path> lines;
  Asked asked;
  std::string only, shard = "1/1";
  int first = 1, count = 20, trials = 500, jobs = 1, limit_s = 900;
  double noise_share = 1.0;
  bool confusion = false;
};

void AddMakeAndRun(CLI::App& app, Options* o) {
  auto* make = app.add_subcommand("make", "draw rigs and write their cases");
  make->add_option("--out", o->out, "folder of the cases")->required();
  make->add_option("--first", o->first, "first rig's number")->check(CLI::PositiveNumber);
  make->add_option("--count", o->count, "number of rigs")->check(CLI::PositiveNumber);
  make->add_option("--only", o->only, "cases whose name, family or candidates hold this text");
  make->add_option("--shard", o->shard, "K/N: every N-th rig, from the K-th on");
  make->add_option("--noise", o->noise_share, "share of the rig's noise that the recordings have")
      ->check(CLI::PositiveNumber);

  auto* run = app.add_subcommand("run", "run the program on every case that has no report yet");
  run->add_option("cases", o->cases, "folder of the cases")->required();
  run->add_option("--sinew", o->sinew, "the program")->required()->check(CLI::ExistingFile);
  run->add_option("--out", o->reports, "folder of the reports")->required();
  run->add_option("--only", o->only, "cases whose name holds this text");
  run->add_option("--jobs", o->jobs, "processes at a time")->check(CLI::PositiveNumber);
  run->add_option("--limit", o->limit_s, "seconds after which a case is given up");
  run->add_option("--shard", o->shard, "K/N: every N-th case, from the K-th on");
  run->add_option("--without", o->asked.without,
                  "rules of the tracer to take out, to see what they are worth");
  run->add_flag("--true-set", o->asked.true_set, "give the effects that are there, for `true-set`");

  run->add_flag(
      "--without-truth", o->asked.without_truth,
      "take the effects that are there out of the catalogue: what is named then is wrong");
}

// Commands on cases and reports that are there.
void AddOthers(CLI::App& app, Options* o) {
  auto* score = app.add_subcommand("score", "count the results of the reports");
  score->add_option("cases", o->cases, "folder of the cases")->required();
  score->add_option("--reports", o->reports, "folder of the reports")->required();
  score->add_option("--jsonl", o->jsonl, "outcomes, one a line, for `merge`");
  score->add_option("--json", o->json, "the figures");
  score->add_flag("--confusion", o->confusion, "also who was taken for whom");

  auto* vary = app.add_subcommand("vary", "write cases again in other units and at other rates");
  vary->add_option("cases", o->cases, "folder of the cases")->required();
  vary->add_option("--out", o->out, "folder of the variants")->required();
  vary->add_option("--only", o->only, "cases whose name holds this text");

  auto* compare = app.add_subcommand("compare", "differences of the variants' reports");
  compare->add_option("reports", o->cases, "folder of the cases' reports")->required();
  compare->add_option("variants", o->reports, "folder of the variants' reports")->required();

  auto* plant = app.add_subcommand("plant", "write cases with effects of their detectable size");
  plant->add_option("cases", o->cases, "folder of the cases")->required();
  plant->add_option("--reports", o->reports, "folder of the cases' reports")->required();
  plant->add_option("--out", o->out, "folder of the planted cases")->required();
  plant->add_option("--count", o->trials, "trials, shared out evenly among the effects");

  auto* true_set = app.add_subcommand("true-set", "reports beside those of the true sets");
  true_set->add_option("cases", o->cases, "folder of the cases")->required();
  true_set->add_option("--reports", o->reports, "folder of the reports")->required();
  true_set->add_option("--true-sets", o->true_sets, "folder of `run --true-set`")->required();
  true_set->add_option("--quiet", o->quiet,
                       "folder of `run --true-set` on the cases of `make --noise 0.1`");

  auto* merge = app.add_subcommand("merge", "count the outcomes of several runs together");
  merge->add_option("files", o->lines, "outcomes that `score --jsonl` wrote")->required();
  merge->add_option("--json", o->json, "the figures");
  merge->add_flag("--confusion", o->confusion, "also who was taken for whom");
}

std::vector<Outcome> ReadLines(const std::vector<fs::path>& paths) {
  std::vector<Outcome> outcomes;
  for (const fs::path& path : paths) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path.string() + ": cannot be read");
    for (std::string line; std::getline(file, line);) {
      if (!line.empty()) outcomes.push_back(FromJson(nlohmann::json::parse(line)));
    }
  }
  return outcomes;
}

int Main(int argc, char** argv) {
  CLI::App app{
      "The bank of rigs: draws rigs, plants effects in their recordings, runs close-loop, counts"};
  app.require_subcommand(1);
  Options o;
  AddMakeAndRun(app, &o);
  AddOthers(app, &o);
  CLI11_PARSE(app, argc, argv);

  if (app.got_subcommand("make")) {
    Make(o.out, o.first, o.count, o.only, ParseShard(o.shard), o.noise_share);
  } else if (app.got_subcommand("run")) {
    Run(o.cases, o.sinew, o.reports, o.only, o.jobs, o.limit_s, ParseShard(o.shard), o.asked);
  } else if (app.got_subcommand("vary")) {
    Vary(o.cases, o.out, o.only);
  } else if (app.got_subcommand("compare")) {
    std::cout << TableOfVariants(o.cases, o.reports);
  } else if (app.got_subcommand("plant")) {
    std::printf("%d trials made\n", PlantAll(o.cases, o.reports, o.trials, o.out));
  } else if (app.got_subcommand("true-set")) {
    std::cout << TableOf(CompareWithTrueSets(o.cases, o.reports, o.true_sets, o.quiet));
  } else if (app.got_subcommand("score")) {
    const std::vector<Outcome> outcomes = ReadOutcomes(o.cases, o.reports);
    if (!o.jsonl.empty()) {
      std::ofstream file(o.jsonl);
      for (const Outcome& outcome : outcomes) file << ToJson(outcome).dump() << "\n";
    }
    Print(outcomes, o.json, o.confusion);
  } else {
    Print(ReadLines(o.lines), o.json, o.confusion);
  }
  return 0;
}

}  // namespace
}  // namespace sinew::rig_bank

int main(int argc, char** argv) try {
  return sinew::rig_bank::Main(argc, argv);
} catch (const CLI::Error& error) {
  std::cerr << error.what() << '\n';
  return 2;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
