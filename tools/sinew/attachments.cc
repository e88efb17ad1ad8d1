#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/base/types/printable.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

struct AttachmentsOptions {
  std::filesystem::path file, out;
  std::string name;
  bool overwrite = false;
  bool json = false;
};

void PrintAttachments(const std::vector<recording::McapAttachment>& attachments, bool json) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const recording::McapAttachment& attachment : attachments) {
    rows.push_back({{"name", attachment.name},
                    {"media_type", attachment.media_type},
                    {"bytes", attachment.data.size()}});
    if (json) continue;
    std::cout << std::setw(10) << attachment.data.size() << "  " << std::left << std::setw(24)
              << types::Printable(attachment.media_type) << std::right << ' '
              << types::Printable(attachment.name) << '\n';
  }
  if (json) std::cout << types::JsonText(rows) << '\n';
}

void TakeOut(const recording::McapAttachment& attachment, const AttachmentsOptions& options) {
  if (options.out.empty()) {
    std::ostream& out = ::isatty(STDOUT_FILENO) == 1 ? std::cout : Unfiltered(std::cout);
    out << attachment.data << std::flush;
    return;
  }
  if (!options.overwrite && std::filesystem::exists(options.out)) {
    throw UsageError(options.out.string() +
                     ": is there already, expected a new name (or --overwrite)");
  }
  config::WriteFileAtomically(options.out, attachment.data);
}

void ShowAttachments(const AttachmentsOptions& options) {
  recording::FileSource source(options.file);
  try {
    const std::vector<recording::McapAttachment> attachments =
        recording::McapReader(source).ReadAttachments();
    if (options.name.empty()) return PrintAttachments(attachments, options.json);
    const auto found = std::find_if(
        attachments.begin(), attachments.end(),
        [&options](const auto& attachment) { return attachment.name == options.name; });
    if (found != attachments.end()) return TakeOut(*found, options);
    const std::string names = types::Joined(attachments, ", ", &recording::McapAttachment::name);
    throw UsageError(options.file.string() + ": no attachment '" + options.name + "', expected " +
                     (names.empty() ? "a recording with attachments" : "one of: " + names));
  } catch (const recording::McapError& error) {
    throw UsageError(options.file.string() + ": " + error.what());
  }
}

}  // namespace

void AddAttachmentsCommand(CLI::App& app) {
  auto options = std::make_shared<AttachmentsOptions>();
  CLI::App* command = app.add_subcommand(
      "attachments", "The files that a recording carries, such as its deployment; or one of them");
  command->add_option("file", options->file, "Recording")->required()->type_name("FILE.mcap");
  auto* name = command->add_option("name", options->name, "The attachment to take out");
  command
      ->add_option("--out", options->out,
                   "Where the attachment goes; by default to the standard output")
      ->needs(name)
      ->type_name("FILE");
  command->add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  command->add_flag("--json", options->json, "The list as JSON");
  command->footer(
      "Examples:\n  sinew attachments run.mcap\n"
      "  sinew attachments run.mcap deploy_rig.yaml --out deploy_rig.yaml");
  command->callback([options] { ShowAttachments(*options); });
}

}  // namespace sinew::tools
