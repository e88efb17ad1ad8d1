#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/base/types/text.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/rate_meter.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/recordings.h"
#include "tools/sinew/span_messages.h"

namespace sinew::tools {

namespace {

using Json = nlohmann::ordered_json;
using HzClock = std::chrono::steady_clock;
using inspect::Arrival;
using inspect::RateMeter;
using inspect::RateSummary;
using inspect::Spread;

constexpr auto kReplayOrigin = static_cast<std::int64_t>(msg::Origin::kReplay);
constexpr std::uint64_t kLockstepDepth = 256;  // history of the profile "lockstep"

struct HzOptions {
  node::Options node;
  std::vector<std::string> topics;  // on the command line recordings, too
  RecordedSpan recorded;
  double duration_s = 0.0;
  double every_s = 1.0;
  bool json = false;
};

// The header of the messages of a topic.
class HeaderFields {
 public:
  // Throws IdlError.
  HeaderFields(const std::string& type_name, const std::string& idl)
      : idl_(recording::IdlSchema::Parse(idl)),
        type_(idl_.Struct(type_name)),
        session_(type_, "header.session_id"),
        tick_(type_, "header.tick"),
        stamp_(type_, "header.stamp_ns"),
        origin_(type_, "header.origin") {
    if (type_name == "sinew::msg::ComponentStatus") name_.emplace(type_, "name");
  }

  // The message is the component_status of this participant.
  bool IsStatusOf(const std::string& participant, std::span<const std::byte> payload) const try {
    return name_ && name_->AsText(payload) == participant;
  } catch (const recording::CdrError&) {
    return false;
  }

  // A payload that is cut off has no header.
  void Read(std::span<const std::byte> payload, Arrival* arrival) const try {
    arrival->session_id = static_cast<std::uint64_t>(session_.AsInt(payload));
    arrival->tick = static_cast<std::uint64_t>(tick_.AsInt(payload));
    arrival->stamp_ns = stamp_.AsInt(payload);
    arrival->is_replay = origin_.AsInt(payload) == kReplayOrigin;
  } catch (const recording::CdrError&) {
    arrival->session_id.reset();
  }

 private:
  recording::IdlSchema idl_;
  const recording::IdlType& type_;
  recording::CdrField session_, tick_, stamp_, origin_;
  std::optional<recording::CdrField> name_;  // component_status only
};

// Meters by topic; DDS threads add, the command reads.
struct Meters {
  std::mutex mutex;
  std::map<std::string, RateMeter> by_topic;
  std::map<node::WriterId, std::uint64_t> samples;  // of each writer
};
using Summaries = std::map<std::string, RateSummary>;

// end_ns: until when it was listened, epoch.
Summaries Summarize(const std::map<std::string, RateMeter>& meters, std::int64_t end_ns) {
  Summaries summaries;
  for (const auto& [topic, meter] : meters) summaries[topic] = meter.Summary(end_ns);
  return summaries;
}

Summaries SummarizeNow(Meters& meters) {
  const std::lock_guard lock(meters.mutex);
  return Summarize(meters.by_topic, types::EpochNow_ns());
}

// Cycles are counted on the topics of every cycle alone: others come on request or on change, of
// several writers. The first message of a writer of a latched topic may be as old as the writer.
// number: of the message among those of its writer, from 1 on.
void ApplyProfile(const node::TopicInfo* topic, std::uint64_t number, Arrival* arrival) {
  if (topic == nullptr) return;
  const bool latched = topic->profile == node::Profile::kLatched;
  const bool log = topic->name == node::kLog.name;
  if (latched || log || topic->profile == node::Profile::kEvent) arrival->tick.reset();
  arrival->from_history = latched && number == 1;
}

Json SpreadJson(const std::optional<Spread>& spread) {
  if (!spread) return nullptr;
  return {{"mean", spread->mean},
          {"deviation", spread->deviation},
          {"least", spread->least},
          {"largest", spread->largest}};
}

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json SummariesJson(const Summaries& summaries) {
  Json rows = Json::array();
  for (const auto& [topic, summary] : summaries) {
    rows.push_back({{"topic", topic},
                    {"messages", summary.messages},
                    {"seconds", summary.seconds},
                    {"rate_Hz", OrNull(summary.rate_Hz)},
                    {"interval_ms", SpreadJson(summary.interval_ms)},
                    {"age_ms", SpreadJson(summary.age_ms)},
                    {"delay_ms", SpreadJson(summary.delay_ms)},
                    {"tick_step", OrNull(summary.tick_step)},
                    {"lost", OrNull(summary.lost)},
                    {"lost_share", OrNull(summary.lost_share)},
                    {"repeated", summary.repeated},
                    {"sessions", summary.sessions}});
  }
  return rows;
}

std::string Cell(const char* format, const std::optional<double>& value) {
  return value ? types::Text(format, *value) : "-";
}

void PrintSummaries(const Summaries& summaries) {
  Print("%-20s %9s %9s %9s %9s %9s %9s %9s  %s\n", "topic", "messages", "Hz", "jitter ms",
        "longest", "age ms", "oldest", "delay ms", "lost");
  for (const auto& [topic, summary] : summaries) {
    const auto of = [](const std::optional<Spread>& spread, double Spread::*member) {
      return spread ? std::optional<double>((*spread).*member) : std::nullopt;
    };
    std::string lost = summary.lost ? std::to_string(*summary.lost) : "-";
    if (summary.lost_share && *summary.lost > 0) {
      lost += Cell(" (%.2f %%)", 100.0 * *summary.lost_share);
    }
    Print("%-20s %9llu %9s %9s %9s %9s %9s %9s  %s\n", topic.c_str(),
          static_cast<unsigned long long>(summary.messages), Cell("%.1f", summary.rate_Hz).c_str(),
          Cell("%.3f", of(summary.interval_ms, &Spread::deviation)).c_str(),
          Cell("%.2f", of(summary.interval_ms, &Spread::largest)).c_str(),
          Cell("%.2f", of(summary.age_ms, &Spread::mean)).c_str(),
          Cell("%.2f", of(summary.age_ms, &Spread::largest)).c_str(),
          Cell("%.2f", of(summary.delay_ms, &Spread::mean)).c_str(), lost.c_str());
    if (summary.repeated > 0 && summary.tick_step) {
      Print("%-20s %llu ticks came again or late: several writers?\n", "",
            static_cast<unsigned long long>(summary.repeated));
    }
  }
  std::cout << std::flush;
}

Summaries OfRecording(const std::string& file, const HzOptions& options) {
  recording::FileSource source(file);
  try {
    const recording::McapReader reader(source);
    std::set<std::string> recorded;
    std::map<recording::ChannelId, std::optional<HeaderFields>> fields;
    for (const auto& [id, channel] : reader.channels()) {
      recorded.insert(channel.topic);
      const recording::McapSchema* schema = reader.SchemaOf(channel);
      std::optional<HeaderFields>& field = fields[id];
      try {
        if (schema != nullptr && schema->encoding == "omgidl") {
          field.emplace(schema->name, schema->data);
        }
      } catch (const std::runtime_error&) {  // a foreign type without our header: rate alone
      }
    }
    recording::MessageFilter filter;
    if (!options.topics.empty()) filter.topics.emplace();
    for (const std::string& topic : options.topics) {
      if (!recorded.contains(topic)) {
        throw UsageError(file + ": no topic '" + topic +
                         "', expected one of: " + types::Joined(recorded));
      }
      filter.topics->insert(topic);
    }
    std::map<std::string, RateMeter> meters;
    std::map<recording::ChannelId, std::uint64_t> numbers;  // a channel is a writer
    SpanMessages messages(reader, filter, options.recorded);
    const recording::RecordedTime& time = messages.time();
    recording::McapMessage message;
    std::int64_t end_ns = reader.statistics().start_time_ns;
    while (messages.Next(&message)) {
      Arrival arrival;
      arrival.arrival_ns = end_ns = time.Of(message);
      const std::optional<HeaderFields>& field = fields.at(message.channel_id);
      if (field) field->Read(message.data, &arrival);
      if (arrival.stamp_ns && !time.is_simulated()) {  // set back as the log time was
        *arrival.stamp_ns += arrival.arrival_ns - message.log_time_ns;
      }
      const std::string& topic = reader.channels().at(message.channel_id).topic;
      ApplyProfile(node::FindTopic(topic), ++numbers[message.channel_id], &arrival);
      meters[topic].Add(arrival);
    }
    const std::int64_t whole_ns =
        time.span() ? time.span()->end_ns : reader.statistics().end_time_ns;
    return Summarize(meters, options.recorded.IsWhole() ? whole_ns : end_ns);
  } catch (const recording::McapError& error) {
    throw UsageError(file + ": " + error.what());
  }
}

std::vector<const node::TopicInfo*> WantedTopics(const std::vector<std::string>& names) {
  std::vector<const node::TopicInfo*> wanted;
  for (const node::TopicInfo& topic : node::AllTopics()) {
    if (names.empty()) wanted.push_back(&topic);
  }
  for (const std::string& name : names) {
    const node::TopicInfo* topic = node::FindTopic(name);
    if (topic == nullptr) {
      throw UsageError("no topic '" + name + "', expected one of: " +
                       types::Joined(node::AllTopics(), ", ", &node::TopicInfo::name));
    }
    wanted.push_back(topic);
  }
  return wanted;
}

Summaries OfDomain(const HzOptions& options, const node::StopFlag& stop) {
  const std::vector<const node::TopicInfo*> wanted = WantedTopics(options.topics);
  auto meters = std::make_shared<Meters>();
  node::Node node(options.node);
  const bool lockstep = options.node.mode == node::TimeMode::kLockstep;
  const std::int64_t begin_ns = types::EpochNow_ns();
  for (const node::TopicInfo* topic : wanted) {
    if (!options.topics.empty()) meters->by_topic[topic->name];  // silent ones are shown, too
    const auto fields = std::make_shared<HeaderFields>(topic->type_name, topic->idl);
    node.ReadRaw(*topic, [meters, fields, topic, lockstep, begin_ns,
                          own = options.node.name](node::RawSample&& sample) {
      if (fields->IsStatusOf(own, sample.payload)) return;
      Arrival arrival;
      arrival.arrival_ns = sample.reception_stamp_ns;
      arrival.sent_ns = sample.source_stamp_ns;
      fields->Read(sample.payload, &arrival);
      const std::lock_guard lock(meters->mutex);
      const std::uint64_t number = ++meters->samples[sample.writer];
      ApplyProfile(topic, number, &arrival);
      const bool keeps = lockstep || topic->name == node::kLog.name;  // for late readers
      if (keeps && number <= kLockstepDepth && sample.source_stamp_ns < begin_ns) {
        arrival.from_history = true;
      }
      meters->by_topic[topic->name].Add(arrival);
    });
  }
  const auto begin = HzClock::now();
  const std::chrono::duration<double> every(options.every_s);
  auto next = begin + every;
  while (!stop.requested()) {
    const auto now = HzClock::now();
    if (options.duration_s > 0.0 &&
        now - begin >= std::chrono::duration<double>(options.duration_s)) {
      break;
    }
    if (now >= next) {
      next += std::chrono::duration_cast<HzClock::duration>(every);
      if (!options.json) PrintSummaries(SummarizeNow(*meters));
      if (!std::cout) break;  // the reader of a pipe is gone
    }
    node.WaitForData(std::chrono::milliseconds(20));
  }
  return SummarizeNow(*meters);
}

}  // namespace

void AddHzCommand(CLI::App& app) {
  auto options = std::make_shared<HzOptions>();
  CLI::App* command =
      app.add_subcommand("hz", "Rate, jitter, age and loss of topics, live or from a recording");
  AddNodeOptions(*command, &options->node);
  command
      ->add_option("topics", options->topics,
                   "Names of topics, by default all; a recording to read instead of a domain")
      ->type_name("TOPIC... FILE");
  AddSpan(*command, &options->recorded, "sinew hz FILE.mcap");
  command->add_option("--duration", options->duration_s, "Seconds; by default until Ctrl-C")
      ->check(node::IsTime(node::Zero::kRefused));
  command->add_option("--every", options->every_s, "Seconds between two tables")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag("--json", options->json, "The figures of the end as JSON");
  command->footer(
      "jitter: standard deviation of the time between two messages; longest: the longest one. age: "
      "from\n"
      "header.stamp_ns to arrival (none of simulated time and replays); delay: from sending to "
      "arrival. lost:\n"
      "missing ticks by gaps of header.tick within a session. A recording in lockstep has "
      "simulated "
      "time. Exit code\n1 when no message came.\n\nExamples:\n"
      "  sinew hz joint_state joint_command\n"
      "  sinew hz --duration 5 --json\n"
      "  sinew hz run.mcap\n"
      "  sinew hz joint_state run.mcap --from 2 --to 4");
  command->callback([options] {
    node::StopFlag stop;
    TakeRecordings([](const std::string& word) { return node::FindTopic(word) != nullptr; },
                   &options->topics, &options->recorded.files);
    options->recorded.Check();
    const std::string file = OnlyOne(options->recorded.files);
    const Summaries summaries =
        file.empty() ? OfDomain(*options, stop) : OfRecording(file, *options);
    if (options->json) {
      std::cout << types::JsonText(SummariesJson(summaries)) << '\n';
    } else {
      PrintSummaries(summaries);
    }
    for (const auto& [topic, summary] : summaries) {
      if (summary.messages > 0) return;
    }
    std::cerr << "sinew hz: no message\n";
    throw CLI::RuntimeError(1);
  });
}

}  // namespace sinew::tools
