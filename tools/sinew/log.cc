#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/did_you_mean.h"
#include "components/base/types/text.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/record/recording/message_type.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/log_lines.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

using inspect::LogText;
using Clock = std::chrono::steady_clock;

// Recent lines that a domain's processes still have: 256 of each (idl/README.md).
constexpr std::size_t kRecent = 100;
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

struct LogOptions {
  node::Options node;
  std::vector<std::filesystem::path> files;
  std::vector<std::string> processes;  // empty: all
  std::optional<std::size_t> last;     // none: kRecent of a domain, kAll of recordings
  msg::LogLevel level = msg::LogLevel::kInfo;
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
  double wait_s = 2.0;
  bool once = false;
};

bool IsWanted(const LogText& line, const LogOptions& options) {
  const auto& names = options.processes;
  return line.level >= options.level &&
         (names.empty() || std::find(names.begin(), names.end(), line.name) != names.end());
}

std::string ClockText(std::int64_t time_ns) {
  const std::time_t seconds = time_ns / 1'000'000'000;
  std::tm local{};
  ::localtime_r(&seconds, &local);
  return types::Text("%02d:%02d:%02d.%03d", local.tm_hour, local.tm_min, local.tm_sec,
                     static_cast<int>(time_ns / 1'000'000 % 1000));
}

const char* ColourOf(msg::LogLevel level) {
  if (level == msg::LogLevel::kInfo) return "\x1b[32m";
  return level == msg::LogLevel::kWarning ? "\x1b[33m" : "\x1b[1;31m";
}

void PrintLine(const std::string& time, const LogText& line) {
  static const bool kColours = ::isatty(STDOUT_FILENO) == 1;
  std::cout << time << ' ';
  if (kColours) Unfiltered(std::cout) << ColourOf(line.level);
  Print("%-8s", NameOf(line.level));
  if (kColours) Unfiltered(std::cout) << "\x1b[0m";
  Print(" %-12s %s\n", line.name.c_str(), line.text.c_str());
}

// In the order of their times; of more than `most` the newest.
std::vector<LogText> Newest(std::vector<LogText> lines, std::size_t most) {
  std::stable_sort(lines.begin(), lines.end(),
                   [](const LogText& a, const LogText& b) { return a.time_ns < b.time_ns; });
  if (lines.size() > most) lines.erase(lines.begin(), lines.end() - static_cast<long>(most));
  return lines;
}

struct RecordedLines {
  std::vector<LogText> lines;
  std::int64_t start_ns = std::numeric_limits<std::int64_t>::max();
};

void ReadFile(const std::filesystem::path& file, const LogOptions& options, RecordedLines* out) {
  try {
    recording::FileSource source(file);
    const recording::McapReader reader(source);
    std::map<recording::ChannelId, std::pair<recording::MessageType, inspect::LogReader>> readers;
    std::set<std::string> names;
    for (const auto& [id, channel] : reader.channels()) {
      names.insert(channel.topic);
      if (channel.topic != node::kLog.name) continue;
      const recording::MessageType type = recording::MessageTypeOf(reader, channel);
      readers.emplace(id, std::pair(type, inspect::LogReader(*type.type)));
    }
    if (readers.empty()) {
      throw UsageError(
          types::NoSuch("topic", std::string(node::kLog.name), {names.begin(), names.end()}));
    }
    out->start_ns = std::min(out->start_ns, reader.statistics().start_time_ns);
    recording::MessageFilter filter;
    filter.topics = std::set<std::string>{std::string(node::kLog.name)};
    recording::McapMessages messages = reader.Messages(filter);
    recording::McapMessage message;
    while (messages.Next(&message)) {
      try {
        LogText line = readers.at(message.channel_id).second.Read(message.data);
        if (IsWanted(line, options)) out->lines.push_back(std::move(line));
      } catch (const recording::CdrError&) {
        // A recorder keeps malformed messages as they came.
      }
    }
  } catch (const std::exception& error) {
    throw UsageError(file.string() + ": " + error.what());
  }
}

void PrintFiles(const LogOptions& options) {
  RecordedLines recorded;
  for (const std::filesystem::path& file : options.files) ReadFile(file, options, &recorded);
  const auto seconds = [&recorded](const LogText& line) {
    return 1e-9 * static_cast<double>(line.time_ns - recorded.start_ns);
  };
  std::erase_if(recorded.lines, [&](const LogText& line) {
    return seconds(line) < options.from_s || seconds(line) > options.to_s;
  });
  for (const LogText& line : Newest(std::move(recorded.lines), options.last.value_or(kAll))) {
    PrintLine(types::Text("%10.3f", seconds(line)), line);
  }
}

void PrintDomain(const LogOptions& options, const node::StopFlag& stop) {
  struct Heard {
    std::mutex mutex;
    std::vector<LogText> lines;
  };
  const auto heard = std::make_shared<Heard>();
  const node::TopicInfo& topic = *node::FindTopic(node::kLog.name);
  const auto idl = std::make_shared<recording::IdlSchema>(recording::IdlSchema::Parse(topic.idl));
  const inspect::LogReader reader(idl->Struct(topic.type_name));
  node::Node node(options.node);
  node.ReadRaw(topic, [heard, idl, reader, &options](node::RawSample&& sample) {
    try {
      LogText line = reader.Read(sample.payload);
      if (!IsWanted(line, options)) return;
      const std::lock_guard<std::mutex> lock(heard->mutex);
      heard->lines.push_back(std::move(line));
    } catch (const recording::CdrError&) {
      // Another program's; it is no line.
    }
  });
  const auto end = Clock::now() + std::chrono::duration<double>(options.wait_s);
  while (!stop.requested() && Clock::now() < end) node.WaitForData(std::chrono::milliseconds(50));
  std::size_t most = options.last.value_or(kRecent);
  while (true) {
    std::vector<LogText> lines;
    {
      const std::lock_guard<std::mutex> lock(heard->mutex);
      lines.swap(heard->lines);
    }
    for (const LogText& line : Newest(std::move(lines), most)) {
      PrintLine(ClockText(line.time_ns), line);
    }
    std::cout.flush();
    if (options.once || stop.requested() || !std::cout) return;  // or the reader of a pipe is gone
    most = kAll;
    node.WaitForData(std::chrono::milliseconds(50));
  }
}

void AddChoice(CLI::App& command, LogOptions* options) {
  const std::map<std::string, msg::LogLevel> levels = {{"info", msg::LogLevel::kInfo},
                                                       {"warn", msg::LogLevel::kWarning},
                                                       {"warning", msg::LogLevel::kWarning},
                                                       {"error", msg::LogLevel::kError},
                                                       {"critical", msg::LogLevel::kCritical}};
  command
      .add_option_function<std::string>(
          "--level",
          [options, levels](const std::string& name) { options->level = levels.at(name); },
          "Lines of this level and above")
      ->check(CLI::IsMember({"info", "warn", "warning", "error", "critical"}));
  command
      .add_option("--process", options->processes,
                  "Only lines of the participant of this name; may be repeated")
      ->type_name("NAME")
      ->allow_extra_args(false);
  command.add_option("--last", options->last,
                     "At most so many recent lines (100 of a domain, all of recordings)");
}

}  // namespace

void AddLogCommand(CLI::App& app) {
  auto options = std::make_shared<LogOptions>();
  CLI::App* command = app.add_subcommand(
      "log", "Log lines of all participants, live or from recordings, in one order");
  AddNodeOptions(*command, &options->node);
  CLI::Option* files = command->add_option("recordings", options->files,
                                           "Recordings, FILE.mcap; without any, the domain");
  AddChoice(*command, options.get());
  command
      ->add_flag("--once", options->once,
                 "End after the recent lines, instead of going on until Ctrl-C")
      ->excludes(files);
  command->add_option("--wait", options->wait_s, "Seconds in which recent lines are gathered")
      ->check(node::IsTime(node::Zero::kAllowed))
      ->capture_default_str();
  command->add_option("--from", options->from_s, "Seconds after the start of the first recording")
      ->needs(files);
  command->add_option("--to", options->to_s, "The same, the end")->needs(files);
  command->footer(
      "A line has the time (of the clock; of recordings in seconds from their start), level, "
      "participant and text.\nParticipants send lines from level info on; each keeps its last 256 "
      "for later readers.\n\nExamples:\n"
      "  sinew log\n"
      "  sinew log --once --level warn\n"
      "  sinew log --process control --process esn\n"
      "  sinew log run.mcap --from 10 --to 20");
  command->callback([options] {
    const node::StopFlag stop;
    if (options->files.empty()) {
      PrintDomain(*options, stop);
    } else {
      PrintFiles(*options);
    }
  });
}

}  // namespace sinew::tools
