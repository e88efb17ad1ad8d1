// Requests of a user to a running player, and its replies: between the thread that takes the
// request (a key, a socket) and the player's.
//
// Requests are lines of text, the same from a key, a socket and a test:
//
//   pause | resume | toggle | step [TICKS] | seek SECONDS | seek +SECONDS | seek -SECONDS
//   rate TIMES | rate max | faster | slower | status | quit
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

namespace sinew::logger {

struct PlayRequest {
  enum class Kind {
    kPause,
    kResume,
    kToggle,  // pause or resume
    kStep,    // `ticks` ticks, then paused
    kSeek,    // to `seconds` after the first message
    kSeekBy,  // by `seconds`
    kRate,    // to `rate`, pace.h
    kFaster,  // the next rate of the series 0.1 0.2 0.5 1 2 5 ... 100, max
    kSlower,
    kStatus,
    kQuit,
  };
  Kind kind{};
  std::uint64_t ticks = 1;
  double seconds = 0.0;
  double rate = 1.0;
};

// Throws std::invalid_argument: what was wrong and what was expected.
PlayRequest ParsePlayRequest(std::string_view line);

// The rate above or below in the series of kFaster; the ends stay.
double FasterRate(double rate);
double SlowerRate(double rate);

struct PlayStatus {
  double position_s = 0.0;  // after the first message that is played
  double duration_s = 0.0;
  double rate = 1.0;  // pace.h
  bool paused = false;
  bool waiting = false;    // for readers
  std::uint64_t pass = 0;  // how often it has begun again: loops and jumps
  std::uint64_t messages = 0;
  std::uint64_t session_id = 0;  // of the last message
  std::uint64_t tick = 0;
};

// One line: "position_s=1.250 duration_s=10.000 rate=2 paused=0 ...".
std::string FormatPlayStatus(const PlayStatus& status);

// Requests in, replies out. Thread-safe; one player takes.
class PlayControl {
 public:
  // Any thread: hands a request over, without waiting.
  void Post(const PlayRequest& request);
  // Any thread: the same, and waits for the player's reply. False: none within the limit.
  bool Ask(const PlayRequest& request, std::chrono::milliseconds limit, std::string* reply);

  // The player's thread. Next: false when there is no request; each one that was taken must be
  // replied to. WaitForRequest returns when there is one, or at the limit.
  bool Next(PlayRequest* request);
  void Reply(const std::string& text);
  void WaitForRequest(std::chrono::nanoseconds limit);

  // Any thread: no replies will come; Ask returns false from here on.
  void Close();

 private:
  struct Entry {
    PlayRequest request;
    std::uint64_t number = 0;
  };

  std::mutex mutex_;
  std::condition_variable requested_, replied_;
  std::deque<Entry> requests_;
  bool closed_ = false;
  std::uint64_t posted_ = 0;
  std::uint64_t taken_ = 0;  // number of the request that Next gave last
  std::deque<std::pair<std::uint64_t, std::string>> replies_;  // the newest few
};

}  // namespace sinew::logger
