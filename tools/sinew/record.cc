#include "components/record/logger/participant/record.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/types/json_text.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/progress.h"

namespace sinew::tools {

void AddRecordCommand(CLI::App& app) {
  struct Options {
    node::Options node;
    logger::RecordOptions record;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("record", "Record the topics of a domain into an MCAP file");
  AddNodeOptions(*command, &options->node);
  logger::AddRecordOptions(*command, &options->record);
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Ends with the session, after --duration, or with Ctrl-C; the file is whole in each case.\n"
      "A recorder that is killed leaves a file that can be read but for the last 200 ms; sinew "
      "recover makes it\nwhole.\n\nExamples:\n"
      "  sinew record --out run.mcap --domain 0\n"
      "  sinew record --out run.mcap --topics joint_state,actuator_state --duration 60\n"
      "  sinew record --out run.mcap --exclude 'sim_.*' --split-duration 1h --keep-going\n"
      "  sinew record --out fault.mcap --last 30s --on-fault --keep-going");
  command->callback([options] {
    node::StopFlag stop;
    node::Node node(options->node);
    ProgressBar bar("record", "messages", 0);
    const logger::RecordResult result =
        logger::Record(node, stop, options->record,
                       [&bar](const logger::RecordResult& now) { bar.Update(now.messages); });
    bar.Finish();
    if (options->json) {
      std::cout << types::JsonText(nlohmann::ordered_json{{"file", options->record.out.string()},
                                                          {"messages", result.messages},
                                                          {"topics", result.topics},
                                                          {"bytes", result.bytes},
                                                          {"dropped", result.dropped},
                                                          {"lost", result.lost},
                                                          {"missing", result.missing},
                                                          {"missing_ticks", result.missing_ticks},
                                                          {"files", result.files},
                                                          {"triggers", result.triggers},
                                                          {"end", result.end}})
                << '\n';
    } else {
      std::cout << options->record.out.string() << ": " << result.messages << " messages of "
                << result.topics << " topics, " << result.bytes << " bytes (" << result.end
                << ")\n";
      if (result.files != 1) std::cout << result.files << " files\n";
      if (result.dropped > 0)
        std::cout << result.dropped << " messages were dropped: the disk was too slow\n";
      if (result.lost > 0 || result.missing > 0) {
        std::cout << result.lost << " samples were reported lost on the way, " << result.missing
                  << " are missing in the numbers of their writers\n";
      }
      if (result.missing_ticks > 0) {
        std::cout << result.missing_ticks << " ticks of joint_state never arrived\n";
      }
    }
  });
}

}  // namespace sinew::tools
