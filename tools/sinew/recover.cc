#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/mcap_recover.h"
#include "tools/sinew/commands.h"

namespace sinew::tools {

namespace {

struct RecoverOptions {
  std::filesystem::path file, out;
  bool overwrite = false;
  bool json = false;
};

void Recover(const RecoverOptions& options) {
  if (!options.overwrite && std::filesystem::exists(options.out)) {
    throw UsageError(options.out.string() +
                     ": is there already, expected a new name (or --overwrite)");
  }
  recording::FileSource source(options.file);
  try {
    const recording::McapReader reader(source);
    if (!reader.recovery()) {
      throw UsageError(options.file.string() + ": is whole, expected a recording that was cut off");
    }
    recording::WholeFileSink sink(options.out);
    recording::IoStatus status = recording::RecoverMcap(reader, sink);
    if (status.ok()) status = sink.Commit();
    if (!status.ok()) {
      throw std::runtime_error(options.out.string() + ": cannot be written: " + status.message());
    }
    const recording::Recovery& recovery = *reader.recovery();
    if (options.json) {
      std::cout << types::JsonText(nlohmann::ordered_json{{"file", options.out.string()},
                                                          {"messages", recovery.messages},
                                                          {"good_bytes", recovery.good_bytes},
                                                          {"lost_bytes", recovery.lost_bytes},
                                                          {"reason", recovery.reason}})
                << '\n';
      return;
    }
    std::cout << options.out.string() << ": " << recovery.messages << " messages; "
              << recovery.lost_bytes << " of " << source.size() << " bytes of "
              << options.file.string() << " are lost (" << recovery.reason << ")\n";
  } catch (const recording::McapError& error) {
    throw UsageError(options.file.string() + ": " + error.what());
  }
}

}  // namespace

void AddRecoverCommand(CLI::App& app) {
  auto options = std::make_shared<RecoverOptions>();
  CLI::App* command = app.add_subcommand(
      "recover", "Make a whole recording, with index and summary, of one that was cut off");
  command->add_option("file", options->file, "Recording of a killed recorder or a full disk")
      ->required()
      ->type_name("FILE.mcap");
  command->add_option("--out", options->out, "The recording to write")
      ->required()
      ->type_name("FILE.mcap");
  command->add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Everything up to the last whole record is kept, and what was lost is reported and noted in "
      "the file\n(metadata sinew.recovered). The file itself is not changed.\n\nExample:\n"
      "  sinew recover run.mcap --out whole.mcap");
  command->callback([options] { Recover(*options); });
}

}  // namespace sinew::tools
