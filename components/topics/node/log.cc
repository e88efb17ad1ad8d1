#include "components/topics/node/log.h"

#include <spdlog/details/log_msg_buffer.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>

#include "components/base/types/printable.h"
#include "components/topics/node/overrun_queue.h"

namespace sinew::node::internal {

namespace {

// Longer than any burst at start or at an end; with lines of 200 bytes a fifth of a megabyte.
constexpr std::size_t kLogLines = 1024;
constexpr std::size_t kUnsentLines = 256;  // as many as a writer keeps for late readers (lockstep)

// Data of the writing thread. They are never destroyed: the thread may stand in a write() to a
// stream that nobody reads when the process ends.
struct LogState {
  spdlog::sinks::stderr_color_sink_st stream;  // of the writing thread
  OverrunQueue<spdlog::details::log_msg_buffer> lines{kLogLines};
  std::atomic<std::uint64_t> written{0};

  OverrunQueue<msg::LogLine> unsent{kUnsentLines};
  std::uint64_t unsent_dropped = 0;  // said; of the sending thread
  std::atomic<std::size_t> sending_thread{0};
  PriorityMutex sender_mutex;
  WakeUp* sender = nullptr;  // guarded
};
std::atomic<LogState*> g_log{nullptr};

// Keeps a line for the topic `log`; the codec cuts its texts to what the topic holds.
void KeepForTopic(const spdlog::details::log_msg& line, LogState* log) {
  if (line.level < spdlog::level::info || line.thread_id == log->sending_thread) return;
  msg::LogLine kept;
  kept.time_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(line.time.time_since_epoch()).count();
  kept.level = static_cast<msg::LogLevel>(line.level - spdlog::level::info);
  kept.name.assign(line.logger_name.data(), line.logger_name.size());
  kept.text.assign(line.payload.data(), line.payload.size());
  log->unsent.Push(std::move(kept));
  const std::lock_guard<PriorityMutex> lock(log->sender_mutex);
  if (log->sender != nullptr) log->sender->Give();
}

void Write(const spdlog::details::log_msg& line, LogState* log) {
  KeepForTopic(line, log);
  log->stream.log(line);
}

void WriteLines(LogState* log) {
  BecomeHelper("sinew-log");
  std::uint64_t dropped = 0;
  while (true) {
    const spdlog::details::log_msg_buffer line = log->lines.Take();
    const std::uint64_t dropped_now = log->lines.dropped();
    if (dropped_now != dropped) {
      const std::string text = std::to_string(dropped_now - dropped) +
                               " lines of the log were dropped: nobody read the error stream";
      Write({line.logger_name, spdlog::level::warn, text}, log);
    }
    Write(line, log);
    log->written.fetch_add(1 + dropped_now - dropped);
    dropped = dropped_now;
  }
}

class QueueSink final : public spdlog::sinks::sink {
 public:
  explicit QueueSink(LogState* log) : log_(log) {}
  void log(const spdlog::details::log_msg& message) override {
    log_->lines.Push(spdlog::details::log_msg_buffer(message));
  }
  void flush() override {}  // FlushLog, which has a limit
  void set_pattern(const std::string& pattern) override { log_->stream.set_pattern(pattern); }
  void set_formatter(std::unique_ptr<spdlog::formatter> formatter) override {
    log_->stream.set_formatter(std::move(formatter));
  }

 private:
  LogState* log_;
};

// The text of a line, which may hold the name or reason of somebody else.
class PrintableText final : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm& /*time*/,
              spdlog::memory_buf_t& out) override {
    const std::string text = types::Printable({message.payload.data(), message.payload.size()});
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::custom_flag_formatter> clone() const override {
    return std::make_unique<PrintableText>();
  }
};

}  // namespace

void SetLogPattern(const std::string& before_text) {
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<PrintableText>('*').set_pattern(before_text + "%*");
  spdlog::set_formatter(std::move(formatter));
}

void StartLog(const std::string& name, const std::string& level) {
  auto* log = new LogState;
  auto logger = std::make_shared<spdlog::logger>(name, std::make_shared<QueueSink>(log));
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(logger);
  SetLogPattern("%H:%M:%S.%e %n %^%l%$ ");
  std::thread(&WriteLines, log).detach();
  g_log = log;
}

bool FlushLog(std::chrono::milliseconds time) {
  const LogState* log = g_log;
  if (log == nullptr) return true;
  const std::uint64_t wanted = log->lines.pushed();
  const auto end = std::chrono::steady_clock::now() + time;
  while (log->written < wanted) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

bool LogIsUnsent() {
  LogState* log = g_log;
  if (log == nullptr) return false;
  const std::lock_guard<PriorityMutex> lock(log->sender_mutex);
  return log->sender == nullptr;
}

void WakeForLog(WakeUp* wake_up) {
  LogState* log = g_log;
  if (log == nullptr) return;
  const std::lock_guard<PriorityMutex> lock(log->sender_mutex);
  log->sender = wake_up;
}

std::optional<msg::LogLine> NextLogLine() {
  LogState* log = g_log;
  if (log == nullptr) return std::nullopt;
  log->sending_thread = spdlog::details::os::thread_id();
  std::optional<msg::LogLine> line = log->unsent.TryTake();
  const std::uint64_t dropped = log->unsent.dropped();
  if (!line || dropped == log->unsent_dropped) return line;
  // The line at hand goes with those that were dropped.
  line->level = msg::LogLevel::kWarning;
  line->text = std::to_string(dropped - std::exchange(log->unsent_dropped, dropped) + 1) +
               " lines of the log were not sent: they came too fast";
  return line;
}

}  // namespace sinew::node::internal
