#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <iostream>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/did_you_mean.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/model/report/section.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_reader.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/inspect/message_text.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/echo_plot.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/recordings.h"
#include "tools/sinew/span_messages.h"

namespace sinew::tools {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr std::size_t kQueue = 4096;
constexpr double kOnceTimeout_s = 5.0;

struct EchoOptions {
  node::Options node;
  std::string topic;
  RecordedSpan recorded;
  std::vector<std::string> fields;
  std::vector<std::string> plot;
  std::filesystem::path png;
  double window_s = 10.0;
  std::uint64_t count = 0;
  double timeout_s = 0.0;
  double rate_Hz = 0.0;  // 0: every message
  bool once = false, json = false;
};

// A choice of messages: at most so many a second of their time.
class RateLimit {
 public:
  explicit RateLimit(double rate_Hz)
      : step_ns_(rate_Hz > 0.0 ? static_cast<std::int64_t>(1e9 / rate_Hz) : 0) {}
  bool Passes(std::int64_t time_ns) {
    if (last_ns_ && time_ns >= *last_ns_ && time_ns - *last_ns_ < step_ns_) return false;
    last_ns_ = time_ns;
    return true;
  }

 private:
  const std::int64_t step_ns_;
  std::optional<std::int64_t> last_ns_;
};

// Consumer of the messages of a topic.
class MessageSink {
 public:
  virtual ~MessageSink() = default;
  // Throws recording::CdrError.
  virtual void Take(std::span<const std::byte> payload, std::int64_t arrival_ns) = 0;
  virtual void Idle() {}  // several times a second, live
  virtual void End() {}
};

// Draws fields of messages.
class Plotter : public MessageSink {
 public:
  Plotter(const std::string& topic, const std::string& type_name, const std::string& idl,
          const EchoOptions& options)
      : idl_(recording::IdlSchema::Parse(idl)),
        options_(options),
        live_(options.recorded.files.empty()),
        draws_live_(live_ && ::isatty(STDOUT_FILENO) == 1) {
    try {
      plot_.emplace(topic, idl_.Struct(type_name), options.plot, live_ ? options.window_s : 0.0);
    } catch (const recording::CdrError& error) {
      throw UsageError("--plot: topic '" + topic + "': " + error.what());
    } catch (const std::invalid_argument& error) {
      throw UsageError("--plot: topic '" + topic + "': " + error.what());
    }
  }

  void Take(std::span<const std::byte> payload, std::int64_t arrival_ns) override {
    plot_->Add(payload, arrival_ns);
  }
  void Idle() override {
    if (!draws_live_ || plot_->messages() == 0 || Clock::now() < next_) return;
    next_ = Clock::now() + milliseconds(500);
    Unfiltered(std::cout) << "\x1b[H\x1b[2J";
    Unfiltered(std::cout) << DrawnHere(plot_->curves()) << std::flush;
  }
  void End() override {
    if (plot_->messages() == 0) return;
    if (!draws_live_) Unfiltered(std::cout) << DrawnHere(plot_->curves());
    if (options_.png.empty()) return;
    config::WriteFileAtomically(options_.png, inspect::DrawnPicture(plot_->curves(), "png"));
  }

 private:
  recording::IdlSchema idl_;
  const EchoOptions& options_;
  const bool live_, draws_live_;
  std::optional<EchoPlot> plot_;
  Clock::time_point next_{};
};

// Prints messages of one type: as a whole, or some fields of them, which may be lists. On a
// terminal several fields are a table where they fit its width, else a line each.
class Printer : public MessageSink {
 public:
  Printer(const std::string& topic, const std::string& type_name, const std::string& idl,
          const EchoOptions& options)
      : idl_(recording::IdlSchema::Parse(idl)), type_(idl_.Struct(type_name)), options_(options) {
    try {
      for (const std::string& path : options.fields) {
        const bool is_list = recording::HasField(type_, path + "[0]");
        fields_.emplace_back(type_, is_list ? path + "[0]" : path);
        is_list_.push_back(is_list);
        widths_.push_back(std::max(path.size(), kLeastCell) + 2);
      }
    } catch (const recording::CdrError& error) {
      throw UsageError("--field: topic '" + topic + "': " + error.what());
    }
    if (options.json || fields_.size() < 2 || ::isatty(STDOUT_FILENO) != 1) return;
    on_terminal_ = true;
    const auto columns = static_cast<std::size_t>(SizeOfTerminal(STDOUT_FILENO).columns);
    if (std::accumulate(widths_.begin(), widths_.end(), std::size_t{0}) > columns ||
        std::find(is_list_.begin(), is_list_.end(), true) != is_list_.end()) {
      return;
    }
    is_table_ = true;
    for (std::size_t i = 0; i < fields_.size(); ++i) PrintCell(options.fields[i], i);
    std::cout << '\n';
  }

  void Take(std::span<const std::byte> payload, std::int64_t) override {
    if (fields_.empty()) {
      const Json json = inspect::MessageJson(type_, payload);
      std::cout << types::JsonText(json, options_.json ? -1 : 2) << '\n';
      return;
    }
    if (options_.json) {
      Json json;
      for (std::size_t i = 0; i < fields_.size(); ++i) json[options_.fields[i]] = Value(i, payload);
      std::cout << types::JsonText(json) << '\n';
      return;
    }
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const Json value = Value(i, payload);
      const std::string text =
          value.is_string() ? value.get<std::string>() : types::JsonText(value);
      if (is_table_) {
        PrintCell(value.is_number_float() ? report::Short(value.get<double>()) : text, i);
      } else if (on_terminal_) {
        std::cout << options_.fields[i] << ' ' << text << '\n';
      } else {
        std::cout << (i > 0 ? " " : "") << text;
      }
    }
    std::cout << '\n';
  }

 private:
  static constexpr std::size_t kLeastCell = 10;  // "-1.235e-05"

  void PrintCell(const std::string& text, std::size_t column) const {
    const std::size_t width = widths_[column] - 2;
    std::cout << text.substr(0, width)
              << std::string(width - std::min(text.size(), width) + 2, ' ');
  }
  Json Value(std::size_t i, std::span<const std::byte> payload) const {
    using Kind = recording::IdlType::Kind;
    const recording::CdrField& field = fields_[i];
    if (is_list_[i]) {  // its entries in use
      std::string pointer = "/" + options_.fields[i];
      std::replace_if(
          pointer.begin(), pointer.end(), [](char c) { return c == '.' || c == '['; }, '/');
      std::erase(pointer, ']');
      return inspect::MessageJson(type_, payload).at(Json::json_pointer(pointer));
    }
    switch (field.type().kind) {
      case Kind::kString:
      case Kind::kEnum:
        return field.AsText(payload);
      case Kind::kBool:
        return field.AsInt(payload) != 0;
      case Kind::kFloat:
      case Kind::kDouble:
        return field.AsDouble(payload);
      case Kind::kUint64:
        return static_cast<std::uint64_t>(field.AsInt(payload));
      default:
        return field.AsInt(payload);
    }
  }

  recording::IdlSchema idl_;
  const recording::IdlType& type_;
  const EchoOptions& options_;
  std::vector<recording::CdrField> fields_;  // of a list, its first entry
  std::vector<bool> is_list_;
  std::vector<std::size_t> widths_;  // of a table's columns, with two blanks
  bool on_terminal_ = false, is_table_ = false;
};

// Keeps a reference to the options.
std::unique_ptr<MessageSink> MakeSink(const std::string& topic, const std::string& type_name,
                                      const std::string& idl, const EchoOptions& options) {
  if (!options.plot.empty()) return std::make_unique<Plotter>(topic, type_name, idl, options);
  return std::make_unique<Printer>(topic, type_name, idl, options);
}

// Messages of a recording, until `printed` is the count that was asked for.
void EchoFile(const std::string& file, const EchoOptions& options, std::uint64_t* printed) {
  recording::FileSource source(file);
  try {
    const recording::McapReader reader(source);
    const recording::McapSchema* schema = nullptr;
    std::set<std::string> names;
    for (const auto& [id, channel] : reader.channels()) {
      names.insert(channel.topic);
      if (channel.topic == options.topic) schema = reader.SchemaOf(channel);
    }
    if (schema == nullptr) {
      throw UsageError(file + ": " +
                       types::NoSuch("topic", options.topic, {names.begin(), names.end()}));
    }
    const auto sink = MakeSink(options.topic, schema->name, schema->data, options);
    recording::MessageFilter filter;
    filter.topics = std::set<std::string>{options.topic};
    SpanMessages messages(reader, filter, options.recorded);
    recording::McapMessage message;
    RateLimit limit(options.rate_Hz);
    while ((options.count == 0 || *printed < options.count) && messages.Next(&message)) {
      if (!limit.Passes(message.publish_time_ns)) continue;
      sink->Take(message.data, message.log_time_ns);
      ++*printed;
    }
    sink->End();
  } catch (const recording::McapError& error) {
    throw UsageError(file + ": " + error.what());
  } catch (const recording::CdrError& error) {
    throw UsageError(file + ": message of '" + options.topic + "': " + error.what());
  } catch (const recording::IdlError& error) {
    throw UsageError(file + ": schema of '" + options.topic + "': " + error.what());
  }
}

void EchoFiles(const EchoOptions& options) {
  if (!options.plot.empty()) (void)OnlyOne(options.recorded.files);
  std::uint64_t printed = 0;
  for (const std::string& file : options.recorded.files) EchoFile(file, options, &printed);
  if (!options.once || printed > 0) return;
  std::cerr << "sinew echo: nothing on '" << options.topic << "' in "
            << types::Joined(options.recorded.files) << '\n';
  throw CLI::RuntimeError(1);
}

void EchoDomain(const EchoOptions& options, const node::StopFlag& stop) {
  const node::TopicInfo* topic = node::FindTopic(options.topic);
  if (topic == nullptr) {
    std::vector<std::string> names;
    for (const node::TopicInfo& known : node::AllTopics()) names.push_back(known.name);
    throw UsageError(types::NoSuch("topic", options.topic, names));
  }
  const auto sink = MakeSink(topic->name, topic->type_name, topic->idl, options);

  struct Queue {
    std::mutex mutex;
    std::deque<node::RawSample> samples;
    std::uint64_t dropped = 0;
  };
  auto queue = std::make_shared<Queue>();
  node::Node node(options.node);
  node.ReadRaw(*topic, [queue](node::RawSample&& sample) {
    const std::lock_guard<std::mutex> lock(queue->mutex);
    if (queue->samples.size() >= kQueue) {
      ++queue->dropped;
      return;
    }
    queue->samples.push_back(std::move(sample));
  });
  RateLimit limit(options.rate_Hz);
  std::uint64_t printed = 0;
  auto last = Clock::now();
  while (!stop.requested() && (options.count == 0 || printed < options.count)) {
    std::deque<node::RawSample> samples;
    std::uint64_t dropped = 0;
    {
      const std::lock_guard<std::mutex> lock(queue->mutex);
      samples.swap(queue->samples);
      std::swap(dropped, queue->dropped);
    }
    if (dropped > 0) std::cerr << "sinew echo: " << dropped << " messages came too fast to print\n";
    for (const node::RawSample& sample : samples) {
      if (options.count > 0 && printed == options.count) break;
      if (!limit.Passes(sample.reception_stamp_ns)) continue;
      try {
        sink->Take(sample.payload, sample.reception_stamp_ns);
        ++printed;
      } catch (const recording::CdrError& error) {
        std::cerr << "sinew echo: " << error.what() << '\n';
      }
    }
    sink->Idle();
    std::cout.flush();
    if (!std::cout) return;  // the reader of a pipe is gone
    if (!samples.empty()) {
      last = Clock::now();
      continue;
    }
    if (options.timeout_s > 0.0 &&
        Clock::now() - last > std::chrono::duration<double>(options.timeout_s)) {
      std::cerr << "sinew echo: nothing on '" << options.topic << "' in domain "
                << options.node.domain_id << " for " << options.timeout_s << " s\n";
      sink->End();
      throw CLI::RuntimeError(1);
    }
    node.WaitForData(milliseconds(50));
  }
  sink->End();
}

}  // namespace

void AddEchoCommand(CLI::App& app) {
  auto options = std::make_shared<EchoOptions>();
  CLI::App* command =
      app.add_subcommand("echo", "Print the messages of a topic, live or from a recording");
  AddNodeOptions(*command, &options->node);
  command->add_option("topic", options->topic, "Topic or TOPIC.FIELD, e.g. joint_state.torque_Nm")
      ->required();
  AddRecordings(*command, "", &options->recorded.files, "Recordings to read instead of a domain");
  AddSpan(*command, &options->recorded, "sinew echo TOPIC FILE.mcap");
  command
      ->add_option("--field", options->fields,
                   "Only this field, e.g. position_rad[0], or all of a list; may be repeated")
      ->type_name("FIELD")
      ->allow_extra_args(false);
  CLI::Option* count =
      command->add_option("-n,--count", options->count, "Stop after so many messages");
  command->add_flag("--once", options->once, "Stop after one message; give up after 5 s")
      ->excludes(count);
  command->add_option("--rate", options->rate_Hz, "At most so many messages a second")
      ->check(CLI::Range(1e-3, 1e6));
  CLI::Option* timeout = command
                             ->add_option("--timeout", options->timeout_s,
                                          "Give up after so many seconds of silence (exit code 1)")
                             ->check(node::IsTime(node::Zero::kAllowed));
  command->add_flag("--json", options->json, "One JSON object a line");
  CLI::Option* plot =
      command
          ->add_option("--plot", options->plot,
                       "Draw this field over time instead of printing, e.g. position_rad[0]; may "
                       "be repeated")
          ->type_name("FIELD")
          ->allow_extra_args(false);
  command->add_option("--png", options->png, "Write the plot of the end to this PNG file, too")
      ->needs(plot);
  command->add_option("--window", options->window_s, "Seconds that a live plot keeps")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->footer(
      "Of joint arrays the joint_count entries in use are printed. Several fields are a table on a "
      "terminal,\nwith four digits; in a pipe and with --json numbers are whole.\n\nExamples:\n"
      "  sinew echo joint_state --once\n"
      "  sinew echo joint_state.position_rad --rate 2\n"
      "  sinew echo joint_state --field header.tick --field position_rad[0] -n 100\n"
      "  sinew echo reference run.mcap --from 2 --to 4 --json\n"
      "  sinew echo joint_state --plot position_rad[0] --plot velocity_rad_s[0]\n"
      "  sinew echo joint_state run.mcap --plot torque_Nm[0] --png torque.png");
  command->callback([options, timeout] {
    node::StopFlag stop;
    inspect::TopicField asked = inspect::SplitField(options->topic);
    options->topic = asked.topic;
    if (!asked.field.empty()) options->fields.insert(options->fields.begin(), asked.field);
    if (options->once) options->count = 1;
    if (options->once && timeout->count() == 0) options->timeout_s = kOnceTimeout_s;
    options->recorded.Check();
    if (!options->recorded.files.empty()) {
      EchoFiles(*options);
    } else {
      EchoDomain(*options, stop);
    }
  });
}

}  // namespace sinew::tools
