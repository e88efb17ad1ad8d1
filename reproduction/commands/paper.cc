#include "reproduction/commands/paper.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/config/program_file.h"
#include "components/base/types/json_text.h"
#include "reproduction/paper/paper.h"
#include "tools/sinew/shipped.h"

namespace sinew::reproduction {

namespace {

struct PaperArguments {
  std::string paper;
  PaperOptions options;
  bool list = false;
  bool json = false;
};

std::filesystem::path PlanFile(const std::string& paper) {
  if (paper.find('/') != std::string::npos || paper.find('.') != std::string::npos) return paper;
  const std::filesystem::path folder = tools::ShippedFolder("reproduction/papers");
  std::filesystem::path file = folder / (paper + ".yaml");
  if (folder.empty() || !std::filesystem::exists(file)) {
    throw UsageError("reproduction/papers/" + paper +
                     ".yaml: not found beside the program, expected the file's path");
  }
  return file;
}

void List(const PaperPlan& plan) {
  for (const PaperStep& step : plan.steps) {
    std::cout << step.id << ": sinew";
    for (const std::string& word : step.command) std::cout << ' ' << word;
    std::cout << '\n';
  }
}

int Make(PaperArguments& arguments) {
  const PaperPlan plan = LoadPaperPlan(PlanFile(arguments.paper));
  if (arguments.list) {
    List(plan);
    return 0;
  }
  arguments.options.program = config::ProgramFile();
  arguments.options.robots = tools::RobotsFolder();
  if (arguments.options.out.empty()) arguments.options.out = "paper_" + arguments.paper;
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  PaperProgress progress;
  progress.begin = [&](const PaperStep& step, int place, int count) {
    std::cerr << '[' << place << '/' << count << "] " << step.id << (terminal ? " ..." : "\n")
              << std::flush;
  };
  progress.end = [&](const PaperStepResult& result) {
    char text[64];
    std::snprintf(text, sizeof text, "%.1f s", result.seconds);
    std::cerr << (terminal ? " " : "  ")
              << (result.was_there ? "was there"
                  : result.ok      ? text
                                   : "FAILED, " + result.cause)
              << '\n';
  };
  const std::vector<PaperStepResult> results = MakePaper(plan, arguments.options, progress);
  bool ok = true;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const PaperStepResult& result : results) {
    ok = ok && result.ok;
    list.push_back({{"id", result.id},
                    {"ok", result.ok},
                    {"was_there", result.was_there},
                    {"cause", result.cause},
                    {"seconds", result.seconds}});
  }
  const std::string page = (arguments.options.out / "index.html").string();
  if (arguments.json) {
    std::cout << types::JsonText(nlohmann::ordered_json{{"page", page}, {"parts", list}}, 2)
              << '\n';
  } else {
    std::cout << page << '\n';
  }
  return ok ? 0 : 1;
}

}  // namespace

void AddPaperCommand(CLI::App& app) {
  auto arguments = std::make_shared<PaperArguments>();
  CLI::App* command = app.add_subcommand(
      "paper", "Regenerate the tables and figures of a paper, published values beside ours");
  command->add_option("paper", arguments->paper, "'actuator', or a plan file (sinew-paper/1)")
      ->required()
      ->type_name("NAME|FILE.yaml");
  command->add_option("--out", arguments->options.out, "Folder of the page; paper_NAME by default")
      ->type_name("DIR");
  command->add_flag("--quick", arguments->options.quick, "Few repetitions: minutes, not figures");
  command->add_flag("--again", arguments->options.again, "Make anew what is there already");
  command->add_option("--only", arguments->options.only, "Only these parts")->type_name("ID");
  command->add_flag("--list", arguments->list, "Print the parts and their commands");
  command->add_flag("--json", arguments->json, "Print the outcome as JSON");
  command->footer(
      "Parts that are in the folder already are kept, so an interrupted paper goes on.\n\n"
      "Examples:\n"
      "  sinew paper actuator --out paper\n"
      "  sinew paper actuator --quick --out quick\n"
      "  sinew paper actuator --out paper --only backlash stiffness --again");
  command->callback([arguments] {
    if (const int code = Make(*arguments); code != 0) throw CLI::RuntimeError(code);
  });
}

}  // namespace sinew::reproduction
