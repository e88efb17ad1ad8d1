#include "tools/view/live_view.h"

#include <sinew_idl/status.h>
#include <spdlog/spdlog.h>
#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/clock/utc.h"
#include "components/base/types/json_text.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/idl_schema.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"
#include "components/topics/node/realtime.h"
#include "components/topics/node/version.h"
#include "tools/launch/find_program.h"
#include "tools/launch/program.h"
#include "tools/view/operator_desk.h"
#include "tools/view/participants.h"
#include "tools/view/routes.h"
#include "tools/view/server.h"
#include "tools/view/shown_log.h"
#include "tools/view/topic_rates.h"

namespace sinew::live {

namespace {

namespace fs = std::filesystem;

// For what waits in its queue, 16 MiB, to reach a disk of 5 MB/s, rounded up.
constexpr std::chrono::seconds kEndLimit(4);

// The name of a recording that begins at a time ("2024-05-17T09:30:00Z"), without colons.
std::string RecordingName(const std::string& utc) {
  std::string name = "view_" + utc + ".mcap";
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

// The last line of a text that is not empty.
std::string LastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  if (end == std::string::npos) return {};
  const std::size_t begin = text.rfind('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

// A sinew-logger that the page starts and stops. One thread, the one that starts it: the logger
// ends with that thread.
class RecorderProcess {
 public:
  // Recordings are FOLDER/view_TIME.mcap. Throws UsageError: no such folder.
  RecorderProcess(const node::Options& options, std::filesystem::path folder)
      : options_(options), folder_(std::move(folder)) {
    std::error_code error;
    if (!fs::is_directory(folder_, error)) {
      throw UsageError("--record-folder " + folder_.string() + ": expected a folder that is there");
    }
  }
  // A recording that runs is ended in order.
  ~RecorderProcess() {
    if (!program_) return;
    Stop();
    (void)program_->Wait(kEndLimit);
  }
  RecorderProcess(const RecorderProcess&) = delete;
  RecorderProcess& operator=(const RecorderProcess&) = delete;

  // Empty, or why not.
  std::string Start() {
    if (program_) return "a recording runs already";
    const fs::path program =
        launch::FindProgram("sinew-logger", fs::current_path(), launch::ProgramFolder());
    if (program.empty()) return launch::NoProgram("sinew-logger", launch::ProgramFolder());
    file_ = folder_ / RecordingName(types::UtcNow());
    std::vector<std::string> line = {program.string(),
                                     "--name",
                                     options_.name + "-logger",
                                     "--domain",
                                     std::to_string(options_.domain_id),
                                     "--out",
                                     file_.string(),
                                     "--keep-going",
                                     "--note",
                                     "started_by=" + options_.name};
    for (const std::string& name : options_.interfaces) {
      line.insert(line.end(), {"--interface", name});
    }
    if (!options_.qos_path.empty()) line.insert(line.end(), {"--qos", options_.qos_path.string()});
    if (options_.mode == node::TimeMode::kLockstep) line.push_back("--lockstep");
    problem_.clear();
    stopping_ = false;
    try {
      program_ = std::make_unique<launch::Program>(line);
    } catch (const std::runtime_error& error) {
      problem_ = error.what();
    }
    return problem_;
  }
  // It writes what waits, and ends.
  void Stop() {
    if (!program_ || std::exchange(stopping_, true)) return;
    program_->Signal(SIGINT);
  }
  // Notices its end; waits for nothing.
  void Step() {
    if (!program_) return;
    const int status = program_->Wait(std::chrono::milliseconds(0));
    if (status == launch::Program::kTimeout) return;
    if (status != 0) {
      problem_ = LastLine(program_->error());
      if (problem_.empty()) problem_ = "the logger ended with " + std::to_string(status);
    }
    program_.reset();
    stopping_ = false;
  }

  bool running() const { return program_ != nullptr; }
  bool stopping() const { return stopping_; }
  const std::filesystem::path& file() const { return file_; }  // the last one; empty: none yet
  const std::string& problem() const { return problem_; }      // of the last one; empty: none

 private:
  const node::Options options_;
  const std::filesystem::path folder_;
  std::filesystem::path file_;
  std::unique_ptr<launch::Program> program_;
  bool stopping_ = false;
  std::string problem_;
};

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr milliseconds kLongestWait(50);
constexpr std::int64_t kReport_ns = 500'000'000;    // the page asks once a second
constexpr std::int64_t kSample_ns = 1'000'000'000;  // rates and loads: 100 clock ticks of a process
constexpr std::size_t kTokenBytes = 16;             // 128 bits

std::string RandomHex(std::size_t bytes) {
  std::vector<unsigned char> random(bytes);
  if (::getrandom(random.data(), random.size(), 0) != static_cast<ssize_t>(random.size())) {
    throw std::runtime_error("the system has no random numbers");
  }
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : random) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

Json RobotInfo(const Robot* robot) {
  if (robot == nullptr) return nullptr;
  return {{"driven", robot->driven()}, {"moving", robot->moving()}};
}

ParticipantStatus StatusOf(const msg::ComponentStatus& message) {
  ParticipantStatus status;
  status.name = message.name;
  status.kind = message.component_kind;
  status.state = NameOf(message.state);
  status.host = message.host;
  status.message = message.message;
  status.standby = message.standby;
  status.process_id = message.process_id;
  status.cycles = message.cycles;
  status.stale_inputs = message.stale_inputs;
  status.missed_ticks = message.missed_ticks;
  status.write_failures = message.write_failures;
  status.malformed_samples = message.malformed_samples;
  status.dropped_samples = message.dropped_samples;
  status.refused_datagrams = message.refused_datagrams;
  status.resident_MB = message.resident_MB;
  return status;
}

ServerOptions OptionsOfServer(const node::Options& options, const ViewOptions& view) {
  ServerOptions server;
  server.address = view.address;
  server.port = static_cast<unsigned short>(view.port);
  server.listener = view.listener;
  server.name = options.name + ", domain " + std::to_string(options.domain_id);
  server.session = RandomHex(kTokenBytes);
  server.token = RandomHex(kTokenBytes);
  return server;
}

std::string AddressOf(const Server& server, const ServerOptions& options) {
  return "http://" + options.address + ":" + std::to_string(server.port()) + "/";
}

void Announce(const Server& server, const ServerOptions& options) {
  const std::string address = AddressOf(server, options);
  spdlog::info("page and Foxglove WebSocket at {}", address);
  if (!options.address.starts_with("127.")) {
    spdlog::warn("other hosts reach it; with commands: {}#token={}", address, options.token);
  }
}

// Reads the lines of the topic `log`, in the threads of DDS.
class LiveLog {
 public:
  void Take(std::span<const std::byte> payload) {
    try {
      shown_.Add(reader_.Read(payload));
    } catch (const recording::CdrError&) {
      // Another program's; it is no line.
    }
  }
  const ShownLog& shown() const { return shown_; }

 private:
  static const node::TopicInfo& Topic() { return *node::FindTopic(node::kLog.name); }

  const recording::IdlSchema idl_ = recording::IdlSchema::Parse(Topic().idl);
  const inspect::LogReader reader_{idl_.Struct(Topic().type_name)};
  ShownLog shown_;
};

// Counts of what came, by topic; written by the threads of DDS.
struct Arrivals {
  explicit Arrivals(std::size_t topics) : counts(topics) {}
  std::vector<std::atomic<std::uint64_t>> counts;
  std::vector<std::uint64_t> Read() const {
    std::vector<std::uint64_t> out;
    out.reserve(counts.size());
    for (const auto& count : counts) out.push_back(count.load(std::memory_order_relaxed));
    return out;
  }
};

class Live {
 public:
  Live(const node::Options& options, const ViewOptions& view, const Page& page, const Robot* robot)
      : recorder_(options, view.record_folder),
        arrivals_(std::make_shared<Arrivals>(node::AllTopics().size())),
        log_(std::make_shared<LiveLog>()),
        rates_(node::AllTopics().size()),
        node_(options),
        desk_(node_, {view.sockets.begin(), view.sockets.end()}),
        statuses_(node_.MakeReader(node::kComponentStatus)),
        participants_(node::HostName(), options.name, static_cast<double>(::sysconf(_SC_CLK_TCK))) {
    routes_.page = &page;
    routes_.robot = robot;
    routes_.log = &log_->shown();
    routes_.allow_arming = view.allow_arming;
    routes_.info = types::JsonText(Json{{"mode", "live"},
                                        {"name", options.name},
                                        {"domain", options.domain_id},
                                        {"version", node::kVersion},
                                        {"allow_arming", view.allow_arming},
                                        {"robot", RobotInfo(robot)},
                                        {"signals", view.signals}});
    routes_.status = [this] {
      const std::lock_guard lock(mutex_);
      return status_;
    };
    routes_.command = [this](Command command) { return Take(command); };
    server_options_ = OptionsOfServer(options, view);
    server_ = std::make_shared<Server>(
        server_options_, ChannelsOf(),
        [this](const HttpRequest& request) { return routes_.Answer(request); });
    server_end_.server = server_;
    std::uint32_t number = 1;
    for (const node::TopicInfo& topic : node::AllTopics()) {
      // Server, counts and log live as long as DDS may call.
      node_.ReadRaw(topic, [server = server_, arrivals = arrivals_,
                            log = topic.name == node::kLog.name ? log_ : nullptr,
                            channel = ChannelNumber{number}](node::RawSample&& sample) {
        ++arrivals->counts[static_cast<std::uint32_t>(channel) - 1];
        if (log) log->Take(sample.payload);
        server->Publish(channel, sample.reception_stamp_ns, std::move(sample.payload));
      });
      ++number;
    }
  }
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;

  const Server& server() const { return *server_; }
  const ServerOptions& server_options() const { return server_options_; }

  void Run(const node::StopFlag& stop) {
    node_.SetState(node::Node::State::kActive, "page at " + AddressOf(*server_, server_options_));
    node::BeginRealtime();
    std::int64_t sample_ns = 0, report_ns = 0;
    while (!stop.requested()) {
      node_.WaitForData(kLongestWait);
      const std::int64_t now_ns = types::MonotonicNow_ns();
      while (const auto status = statuses_.TakeNext()) {
        participants_.Hear(StatusOf(*status), now_ns);
      }
      TakeCommands();
      desk_.Step(now_ns);
      recorder_.Step();
      if (now_ns >= sample_ns) {
        sample_ns = now_ns + kSample_ns;
        rates_.Sample(arrivals_->Read(), now_ns);
        participants_.Refresh(now_ns);
        ++cycles_;
        node_.SetCounts({cycles_, 0, 0, 0});
      }
      if (now_ns >= report_ns) {
        report_ns = now_ns + kReport_ns;
        std::string report = Report(now_ns);
        const std::lock_guard lock(mutex_);
        status_ = std::move(report);
      }
    }
  }

 private:
  static std::vector<Channel> ChannelsOf() {
    std::vector<Channel> channels;
    channels.reserve(node::AllTopics().size());
    for (const node::TopicInfo& topic : node::AllTopics()) {
      channels.push_back({ChannelNumber{static_cast<std::uint32_t>(channels.size() + 1)},
                          topic.name, topic.type_name, topic.idl});
    }
    return channels;
  }

  // The thread of the server.
  std::string Take(Command command) {
    switch (command) {
      case Command::kEstop:
        return desk_.Ask(OperatorAction::kEstop);
      case Command::kDisarm:
        return desk_.Ask(OperatorAction::kDisarm);
      case Command::kArm:
        return desk_.Ask(OperatorAction::kArm);
      case Command::kReset:
        return desk_.Ask(OperatorAction::kReset);
      case Command::kStartRecording:
      case Command::kStopRecording:
        break;
    }
    {
      const std::lock_guard lock(mutex_);
      record_ = command == Command::kStartRecording;
    }
    node_.Wake();
    return {};
  }

  // The logger belongs to the thread that starts it.
  void TakeCommands() {
    std::optional<bool> record;
    {
      const std::lock_guard lock(mutex_);
      record = std::exchange(record_, std::nullopt);
    }
    if (!record) return;
    if (!*record) return recorder_.Stop();
    const std::string problem = recorder_.Start();
    if (problem.empty()) {
      spdlog::info("records into {}", recorder_.file().string());
    } else {
      spdlog::warn("recording not started: {}", problem);
    }
  }

  std::string Report(std::int64_t now_ns) const {
    Json topics = Json::array();
    for (std::size_t i = 0; i < rates_.topics().size(); ++i) {
      const TopicRates::Topic& topic = rates_.topics()[i];
      if (topic.messages == 0) continue;
      topics.push_back({{"name", node::AllTopics()[i].name},
                        {"messages", topic.messages},
                        {"rate_Hz", topic.rate_Hz},
                        {"age_s", 1e-9 * static_cast<double>(now_ns - topic.news_ns)}});
    }
    Json clients = Json::array();
    for (const ClientCounts& client : server_->clients()) {
      clients.push_back({{"address", client.address},
                         {"subscriptions", client.subscriptions},
                         {"sent", client.sent},
                         {"lost", client.lost},
                         {"waiting", client.waiting}});
    }
    const auto robot = desk_.robot(now_ns);
    return types::JsonText(Json{{"robot_state", robot ? Json(NameOf(*robot)) : Json(nullptr)},
                                {"fault", robot ? desk_.fault() : ""},
                                {"action", desk_.Report()},
                                {"recording",
                                 {{"running", recorder_.running()},
                                  {"stopping", recorder_.stopping()},
                                  {"file", recorder_.file().string()},
                                  {"problem", recorder_.problem()}}},
                                {"participants", participants_.Rows(now_ns)},
                                {"topics", std::move(topics)},
                                {"clients", std::move(clients)},
                                {"problems", node_.Problems()}});
  }

  RecorderProcess recorder_;
  std::shared_ptr<Arrivals> arrivals_;
  std::shared_ptr<LiveLog> log_;
  TopicRates rates_;
  node::Node node_;
  OperatorDesk desk_;
  node::Reader<msg::ComponentStatus> statuses_;
  Participants participants_;
  Routes routes_;
  ServerOptions server_options_;
  std::mutex mutex_;
  std::string status_ = "{}";   // guarded
  std::optional<bool> record_;  // guarded: asked for since the last look
  std::uint64_t cycles_ = 0;
  std::shared_ptr<Server> server_;
  // Goes first: the server's thread calls this object, and the callbacks of DDS keep the server.
  struct ServerEnd {
    std::shared_ptr<Server> server;
    ~ServerEnd() {
      if (server) server->Stop();
    }
  } server_end_;
};

}  // namespace

void RunLive(const node::Options& options, const node::StopFlag& stop, const ViewOptions& view,
             const Page& page, const Robot* robot) {
  Live live(options, view, page, robot);
  Announce(live.server(), live.server_options());
  live.Run(stop);
}

void RunRecorded(const node::Options& options, const node::StopFlag& stop, const ViewOptions& view,
                 const Page& page, const Robot* robot) {
  const RecordedView recorded(view.recording);
  Routes routes;
  routes.page = &page;
  routes.robot = robot;
  routes.recorded = &recorded;
  routes.info = types::JsonText(Json{{"mode", "recording"},
                                     {"name", options.name},
                                     {"domain", nullptr},
                                     {"version", node::kVersion},
                                     {"allow_arming", false},
                                     {"robot", RobotInfo(robot)},
                                     {"signals", view.signals}});
  const ServerOptions server_options = OptionsOfServer(options, view);
  const Server server(server_options, {},
                      [&routes](const HttpRequest& request) { return routes.Answer(request); });
  Announce(server, server_options);
  while (!stop.requested()) std::this_thread::sleep_for(kLongestWait);
}

}  // namespace sinew::live
