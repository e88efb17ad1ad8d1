#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"
#include "tools/new_bench/propose.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

namespace fs = std::filesystem;

struct NewBenchOptions {
  fs::path recording, out;
  std::vector<std::string> header;
  new_bench::Answers answers;
  CLI::Option *gear = nullptr, *constant = nullptr, *sign = nullptr, *hanging = nullptr;
  double hanging_at = 0.0;
};

// The number that is typed; nothing for an empty line.
std::optional<double> Ask(const std::string& question) {
  while (true) {
    std::cerr << question << ": " << std::flush;
    std::string line;
    if (!std::getline(std::cin, line) || line.empty()) return std::nullopt;
    try {
      std::size_t end = 0;
      const double number = std::stod(line, &end);
      if (end == line.size()) return number;
    } catch (const std::exception&) {  // asked again
    }
    std::cerr << "'" << line << "', expected a number or nothing\n";
  }
}

// On a terminal: what no option gives.
void AskForTheRest(const new_bench::Guess& guess, NewBenchOptions* options) {
  new_bench::Answers& answers = options->answers;
  if (::isatty(STDIN_FILENO) != 1) return;
  if (options->gear->count() == 0) {
    answers.gear_ratio = Ask("Gear ratio, motor turns for one of the joint [1]").value_or(1.0);
  }
  if (new_bench::NeedsTorqueConstant(guess) && options->constant->count() == 0) {
    answers.torque_constant_Nm_A = Ask("Torque constant of the motor in Nm/A").value_or(0.0);
  }
  if (options->sign->count() == 0) {
    const double sign = Ask("Does a positive drive raise the position? 1 or -1 [1]").value_or(1.0);
    answers.drive_sign = sign < 0.0 ? -1 : 1;
  }
  if (options->hanging->count() == 0) {
    answers.hanging =
        Ask("Reading of the position where the link hangs straight down [none: no gravity]");
  }
}

void MakeBench(NewBenchOptions& options) {
  const std::string name = options.recording.string();
  const std::string text = config::ReadFile(options.recording, config::kLargestData);
  for (const char* file : {"csv_map.yaml", "model.yaml", "README.md"}) {
    if (fs::exists(options.out / file)) {
      throw UsageError((options.out / file).string() + ": is there already, expected a new folder");
    }
  }
  try {
    const new_bench::Guess guess = new_bench::GuessColumns(text, name, options.header);
    if (options.hanging->count() > 0) options.answers.hanging = options.hanging_at;
    AskForTheRest(guess, &options);
    const new_bench::Files files =
        new_bench::Propose(guess, options.answers, fs::absolute(options.recording).string());
    // As close-loop will read it: nothing is written for a recording that it refuses.
    const types::Run run =
        recording::ReadCsvRun(text, name, recording::ParseCsvMap(files.csv_map, "csv_map.yaml"));
    fs::create_directories(options.out);
    config::WriteFileAtomically(options.out / "csv_map.yaml", files.csv_map);
    config::WriteFileAtomically(options.out / "model.yaml", files.model);
    config::WriteFileAtomically(options.out / "README.md", files.readme);
    for (const new_bench::Column& column : guess.columns) {
      const std::string signal =
          column.signal ? std::string(types::SignalName(*column.signal)) : "time";
      std::cout << column.name << " -> " << signal << ", " << column.unit << "  (" << column.why
                << ")\n";
    }
    std::cout << run.size() << " rows. Check " << (options.out / "csv_map.yaml").string()
              << "; what to do next is in " << (options.out / "README.md").string() << '\n';
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace

void AddNewCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("new", "Make the files of a bench of your own");
  command->require_subcommand(1);
  command->footer("Example:\n  sinew new bench run.csv --out bench");
  CLI::App* bench = command->add_subcommand(
      "bench", "Model and mapping of one joint, from the header of a CSV file; asks on a terminal");
  auto options = std::make_shared<NewBenchOptions>();
  bench->add_option("recording", options->recording, "CSV file")->required();
  bench->add_option("--out", options->out, "Folder of the files")->required();
  bench
      ->add_option("--header", options->header,
                   "Names of the columns, between commas, where the file has no header")
      ->delimiter(',');
  bench->add_option("--joint", options->answers.joint, "Its name")->capture_default_str();
  options->gear =
      bench->add_option("--gear", options->answers.gear_ratio, "Motor turns for one of the joint");
  options->constant = bench->add_option("--torque-constant", options->answers.torque_constant_Nm_A,
                                        "Of the motor, Nm/A, where the drive is a current");
  options->sign = bench
                      ->add_option("--sign", options->answers.drive_sign,
                                   "-1: a positive drive lowers the position")
                      ->check(CLI::IsMember({"1", "-1"}));
  options->hanging = bench->add_option(
      "--hanging", options->hanging_at,
      "Reading of the position, in the file's unit, where the link hangs straight down");
  bench->footer(
      "Example:\n  sinew new bench run.csv --out bench --gear 9 --torque-constant 0.09 --hanging "
      "0\n"
      "  sinew check-data --model bench/model.yaml --map bench/csv_map.yaml run.csv");
  bench->callback([options] { MakeBench(*options); });
}

}  // namespace sinew::tools
