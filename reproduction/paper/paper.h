// A paper: measurements made by commands of `sinew`, collected on one page.
//
// A plan file names the commands. Each runs as a process of its own with --out FOLDER/ID and leaves
// a section there (components/model/report/section.h). What is there already is not made again, so
// an interrupted paper goes on where it stopped. One thread.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace sinew::reproduction {

struct PaperStep {
  std::string id;                    // folder and section
  std::vector<std::string> command;  // of `sinew`, without --out; {robots} is the robots folder
  std::vector<std::string> quick;    // the same in a short form; empty: left out of a quick paper
};

struct PaperPlan {
  std::string title;
  std::string introduction;
  std::vector<PaperStep> steps;
};

// Throws UsageError with file, line and key.
PaperPlan LoadPaperPlan(const std::filesystem::path& file);

struct PaperOptions {
  std::filesystem::path program;  // `sinew`
  std::filesystem::path robots;   // what {robots} stands for
  std::filesystem::path out;
  bool quick = false;
  bool again = false;             // make everything anew
  std::vector<std::string> only;  // ids; empty: all
};

struct PaperStepResult {
  std::string id;
  bool ok = false;
  bool was_there = false;  // from an earlier run
  std::string cause;       // of a failure
  double seconds = 0.0;
};

// begin: called before a step, with its place and the number of steps; end: after it.
struct PaperProgress {
  std::function<void(const PaperStep&, int place, int count)> begin;
  std::function<void(const PaperStepResult&)> end;
};

// Runs the steps one after another and writes out/index.html from all that succeeded; a failed one
// is listed there, too. Throws UsageError: an unknown id in `only`, a folder that cannot be
// written.
std::vector<PaperStepResult> MakePaper(const PaperPlan& plan, const PaperOptions& options,
                                       const PaperProgress& progress);

}  // namespace sinew::reproduction
