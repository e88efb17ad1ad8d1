// A progress bar for long work: one line on stderr, drawn ten times a second, only on a terminal.
//
//   ProgressBar bar("import", "samples", total);
//   bar.Update(done);            // as often as you like
//   bar.Finish();                // removes the line; so does the destructor
//
//   import  [##########----------]  52 %  12.9k of 24.8k samples, 310k/s, 0:00 left
//
// One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace sinew::tools {

class ProgressBar {
 public:
  // total 0: not known; the bar then shows count and rate only.
  ProgressBar(std::string what, std::string unit, std::uint64_t total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void Update(std::uint64_t done, std::uint64_t total);  // total may become known late
  void Update(std::uint64_t done) { Update(done, total_); }
  void Finish();

  // The text of the line; pure, for tests.
  static std::string Line(const std::string& what, const std::string& unit, std::uint64_t done,
                          std::uint64_t total, double elapsed_s);

 private:
  using Clock = std::chrono::steady_clock;

  const std::string what_;
  const std::string unit_;
  std::uint64_t total_;
  const bool visible_;
  const Clock::time_point start_;
  Clock::time_point next_;
  bool drawn_ = false;
};

}  // namespace sinew::tools
