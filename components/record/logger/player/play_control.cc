#include "components/record/logger/player/play_control.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "components/base/types/text.h"
#include "components/record/logger/player/pace.h"

namespace sinew::logger {

namespace {

using Kind = PlayRequest::Kind;

// Replies that nobody takes (of Post) are dropped after so many others.
constexpr std::size_t kKeptReplies = 16;

constexpr std::array<double, 10> kRateSeries = {0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100};

constexpr char kRequestWords[] =
    "pause, resume, toggle, step [TICKS], seek [+|-]SECONDS, rate TIMES|max, faster, slower, "
    "status or quit";

[[noreturn]] void FailRequest(std::string_view line, const std::string& expected) {
  throw std::invalid_argument("'" + std::string(line) + "', expected " + expected);
}

// The whole word as a number.
template <class Number>
bool ReadWhole(std::string_view word, Number* value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), *value);
  return error == std::errc() && end == word.data() + word.size();
}

}  // namespace

PlayRequest ParsePlayRequest(std::string_view line) {
  std::istringstream in{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  if (words.empty() || words.size() > 2) FailRequest(line, kRequestWords);
  static const std::vector<std::pair<std::string, Kind>> kPlain = {
      {"pause", Kind::kPause},   {"resume", Kind::kResume}, {"toggle", Kind::kToggle},
      {"step", Kind::kStep},     {"faster", Kind::kFaster}, {"slower", Kind::kSlower},
      {"status", Kind::kStatus}, {"quit", Kind::kQuit}};
  PlayRequest request;
  if (words.size() == 1) {
    for (const auto& [word, kind] : kPlain) {
      if (words[0] != word) continue;
      request.kind = kind;
      return request;
    }
    FailRequest(line, kRequestWords);
  }
  const std::string& value = words[1];
  if (words[0] == "step") {
    request.kind = Kind::kStep;
    if (!ReadWhole(value, &request.ticks) || request.ticks == 0) {
      FailRequest(line, "step and a whole number of ticks from 1");
    }
  } else if (words[0] == "seek") {
    const bool relative = value[0] == '+' || value[0] == '-';
    request.kind = relative ? Kind::kSeekBy : Kind::kSeek;
    if (!ReadWhole(std::string_view(value).substr(value[0] == '+' ? 1 : 0), &request.seconds) ||
        !std::isfinite(request.seconds)) {
      FailRequest(line, "seek and seconds, with a sign: from where it is");
    }
  } else if (words[0] == "rate") {
    request.kind = Kind::kRate;
    if (value == "max") {
      request.rate = kMaxRate;
    } else if (!ReadWhole(value, &request.rate) || !std::isfinite(request.rate) ||
               request.rate < kLeastRate) {
      FailRequest(line, "rate and a number of at least 0.1, or max");
    }
  } else {
    FailRequest(line, kRequestWords);
  }
  return request;
}

double FasterRate(double rate) {
  if (rate == kMaxRate) return rate;
  const auto next = std::upper_bound(kRateSeries.begin(), kRateSeries.end(), rate);
  return next == kRateSeries.end() ? kMaxRate : *next;
}

double SlowerRate(double rate) {
  if (rate == kMaxRate) return kRateSeries.back();
  const auto next = std::lower_bound(kRateSeries.begin(), kRateSeries.end(), rate);
  return next == kRateSeries.begin() ? kRateSeries.front() : *std::prev(next);
}

std::string FormatPlayStatus(const PlayStatus& status) {
  const std::string rate = status.rate == kMaxRate ? "max" : types::Text("%g", status.rate);
  return types::Text(
      "position_s=%.3f duration_s=%.3f rate=%s paused=%d waiting=%d pass=%llu "
      "messages=%llu session_id=%llu tick=%llu",
      status.position_s, status.duration_s, rate.c_str(), status.paused ? 1 : 0,
      status.waiting ? 1 : 0, static_cast<unsigned long long>(status.pass),
      static_cast<unsigned long long>(status.messages),
      static_cast<unsigned long long>(status.session_id),
      static_cast<unsigned long long>(status.tick));
}

void PlayControl::Post(const PlayRequest& request) {
  {
    const std::lock_guard lock(mutex_);
    requests_.push_back({request, ++posted_});
  }
  requested_.notify_one();
}

bool PlayControl::Ask(const PlayRequest& request, std::chrono::milliseconds limit,
                      std::string* reply) {
  std::unique_lock lock(mutex_);
  const std::uint64_t number = ++posted_;
  requests_.push_back({request, number});
  requested_.notify_one();
  const auto mine = [&] {
    return std::find_if(replies_.begin(), replies_.end(),
                        [&](const auto& entry) { return entry.first == number; });
  };
  replied_.wait_for(lock, limit, [&] { return closed_ || mine() != replies_.end(); });
  const auto found = mine();
  if (found == replies_.end()) return false;
  *reply = found->second;
  return true;
}

bool PlayControl::Next(PlayRequest* request) {
  const std::lock_guard lock(mutex_);
  if (requests_.empty()) return false;
  *request = requests_.front().request;
  taken_ = requests_.front().number;
  requests_.pop_front();
  return true;
}

void PlayControl::Reply(const std::string& text) {
  {
    const std::lock_guard lock(mutex_);
    replies_.emplace_back(taken_, text);
    if (replies_.size() > kKeptReplies) replies_.pop_front();
  }
  replied_.notify_all();
}

void PlayControl::WaitForRequest(std::chrono::nanoseconds limit) {
  std::unique_lock lock(mutex_);
  requested_.wait_for(lock, limit, [this] { return !requests_.empty(); });
}

void PlayControl::Close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  replied_.notify_all();
}

}  // namespace sinew::logger
