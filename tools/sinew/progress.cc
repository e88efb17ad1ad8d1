#include "tools/sinew/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "components/base/types/text.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace {

constexpr int kBarWidth = 20;

// 950, 12.9k, 3.1M
std::string Short(double value) {
  if (value < 1e3) return types::Text("%.0f", value);
  return value < 1e6 ? types::Text("%.1fk", value / 1e3) : types::Text("%.1fM", value / 1e6);
}

}  // namespace

ProgressBar::ProgressBar(std::string what, std::string unit, std::uint64_t total)
    : what_(std::move(what)),
      unit_(std::move(unit)),
      total_(total),
      visible_(::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(start_ + std::chrono::milliseconds(200)) {}  // short work shows nothing

ProgressBar::~ProgressBar() { Finish(); }

std::string ProgressBar::Line(const std::string& what, const std::string& unit, std::uint64_t done,
                              std::uint64_t total, double elapsed_s) {
  const double rate = elapsed_s > 0.0 ? static_cast<double>(done) / elapsed_s : 0.0;
  const std::string speed = Short(rate) + "/s";
  if (total == 0) return what + "  " + Short(static_cast<double>(done)) + " " + unit + ", " + speed;
  const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total));
  const int filled = static_cast<int>(share * kBarWidth);
  const auto seconds =
      rate > 0.0 ? std::llround(static_cast<double>(total - std::min(done, total)) / rate) : 0LL;
  return what + "  [" + std::string(static_cast<std::size_t>(filled), '#') +
         std::string(static_cast<std::size_t>(kBarWidth - filled), '-') + "] " +
         types::Text("%3.0f %%", std::floor(100.0 * share)) + "  " +
         Short(static_cast<double>(done)) + " of " + Short(static_cast<double>(total)) + " " +
         unit + ", " + speed + ", " + types::Text("%lld:%02lld left", seconds / 60, seconds % 60);
}

void ProgressBar::Update(std::uint64_t done, std::uint64_t total) {
  total_ = total;
  if (!visible_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  drawn_ = true;
  Unfiltered(std::cerr) << "\r\x1b[K";
  std::cerr << Line(what_, unit_, done, total, std::chrono::duration<double>(now - start_).count())
            << std::flush;
}

void ProgressBar::Finish() {
  if (drawn_) Unfiltered(std::cerr) << "\r\x1b[K" << std::flush;
  drawn_ = false;
}

}  // namespace sinew::tools
