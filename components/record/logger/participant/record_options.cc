#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "components/record/logger/participant/record.h"
#include "components/topics/node/time_option.h"

namespace sinew::logger {

namespace {

CLI::Validator Duration() {
  return CLI::AsNumberWithUnit(
      std::map<std::string, double>{
          {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}, {"d", 86400.0}},
      CLI::AsNumberWithUnit::DEFAULT, "TIME");
}

void AddFileOptions(CLI::App& app, RecordOptions* options) {
  app.add_option("--compression", options->compression, "none, lz4 or zstd")
      ->transform(CLI::CheckedTransformer(
          std::map<std::string, recording::Compression>{{"none", recording::Compression::kNone},
                                                        {"lz4", recording::Compression::kLz4},
                                                        {"zstd", recording::Compression::kZstd}},
          CLI::ignore_case))
      ->default_str("zstd");
  app.add_option("--split-size", options->split_bytes,
                 "Numbered files, FILE_000.mcap and on, of about this size: 500M, 2G")
      ->transform(CLI::AsSizeValue(false))
      ->type_name("SIZE");
  app.add_option("--split-duration", options->split_s,
                 "Numbered files of this length: 90s, 10min, 1h")
      ->transform(Duration())
      ->check(node::IsTime(node::Zero::kAllowed))
      ->type_name("TIME");
  app.add_option("--sync", options->sync_s,
                 "To the disk so often (a power cut loses about so much), 0: when a file ends; 1 s "
                 "by default, 0 with --lockstep")
      ->transform(Duration())
      ->check(node::IsTime(node::Zero::kAllowed))
      ->type_name("TIME");
}

void AddRingOptions(CLI::App& app, RecordOptions* options) {
  auto* last =
      app.add_option("--last", options->last_s,
                     "Keep this much in memory, and write it when a trigger comes: SIGUSR1, or a "
                     "fault with --on-fault")
          ->transform(Duration())
          ->check(node::IsTime(node::Zero::kRefused))
          ->type_name("TIME");
  app.add_flag("--on-fault", options->on_fault,
               "A component or robot that goes to fault is a trigger, an estop too")
      ->needs(last);
  app.add_option("--after", options->after_s, "What is written after a trigger, 10 s by default")
      ->transform(Duration())
      ->check(node::IsTime(node::Zero::kAllowed))
      ->needs(last)
      ->type_name("TIME");
}

}  // namespace

void AddRecordOptions(CLI::App& app, RecordOptions* options) {
  app.add_option("--out", options->out, "The recording to write, FILE.mcap")->required();
  app.add_option("--topics", options->topics,
                 "Only these topics (comma or blank between): names, or regular expressions that "
                 "match whole names; all by default")
      ->type_name("TOPIC")
      ->delimiter(',');
  app.add_option("--exclude", options->exclude, "Not these topics: names or regular expressions")
      ->type_name("TOPIC")
      ->delimiter(',');
  app.add_option("--note", options->notes,
                 "KEY=VALUE for the recording's metadata; may be repeated")
      ->allow_extra_args(false);
  app.add_option("--attach", options->attach,
                 "FILE or NAME=FILE that goes into the recording, with its hash; may be repeated")
      ->allow_extra_args(false);
  app.add_flag("--overwrite", options->overwrite, "Replace the file if it is there");
  app.add_flag("--keep-going", options->keep_going,
               "Do not end with the session: further sessions go into the same file");
  app.add_option("--duration", options->duration_s,
                 "Seconds to record; until the session ends by default")
      ->check(node::IsTime(node::Zero::kAllowed));
  AddFileOptions(app, options);
  AddRingOptions(app, options);
}

}  // namespace sinew::logger
