// The logger: every topic of a domain into an MCAP file.
#include <spdlog/spdlog.h>

#include <algorithm>

#include "components/record/logger/participant/record.h"

int main(int argc, char** argv) {
  sinew::logger::RecordOptions record;
  const auto body = [&record](const sinew::node::Options& options, sinew::node::StopFlag& stop) {
    if (!options.config_path.empty()) {
      throw sinew::UsageError(
          "--config: the logger has no configuration file, expected options only");
    }
    sinew::node::Node node(options);
    const sinew::logger::RecordResult result = sinew::logger::Record(node, stop, record);
    spdlog::info(
        "{}: {} messages of {} topics, {} bytes in {} files, {} dropped, {} lost on the way, {} "
        "ticks missing, {}",
        record.out.string(), result.messages, result.topics, result.bytes, result.files,
        result.dropped, std::max(result.lost, result.missing), result.missing_ticks, result.end);
  };
  return sinew::node::RunParticipant(
      argc, argv, "logger", "Writes every topic of a domain into an MCAP recording", body,
      [&record](CLI::App& app) { sinew::logger::AddRecordOptions(app, &record); });
}
