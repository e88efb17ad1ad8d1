#include "tools/launch/output.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "components/base/types/printable.h"

namespace sinew::launch {

namespace {

constexpr std::size_t kLongestLine = 64 * 1024;
constexpr std::array<std::string_view, 6> kColours = {"\x1b[36m", "\x1b[32m", "\x1b[33m",
                                                      "\x1b[35m", "\x1b[34m", "\x1b[31m"};
constexpr std::string_view kColourEnd = "\x1b[0m";

}  // namespace

LineSplitter::LineSplitter(Line line) : line_(std::move(line)) {}

void LineSplitter::Add(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t free_bytes = kLongestLine - rest_.size();
    const std::string_view piece = bytes.substr(0, std::min(bytes.find('\n'), free_bytes));
    rest_.append(piece);
    bytes.remove_prefix(piece.size());
    if (!bytes.empty() && bytes.front() == '\n') {
      bytes.remove_prefix(1);
      Emit();
    } else if (rest_.size() == kLongestLine) {
      Emit();
    }
  }
}

void LineSplitter::Finish() {
  if (!rest_.empty()) Emit();
}

void LineSplitter::Emit() {
  if (!rest_.empty() && rest_.back() == '\r') rest_.pop_back();
  line_(rest_);
  rest_.clear();
}

Output::Output(std::ostream& out, std::ostream& error, bool colour, std::vector<std::string> names)
    : out_(out), error_(error), colour_(colour) {
  std::size_t width = 0;
  for (std::string& name : names) {
    name = types::Printable(name);
    width = std::max(width, name.size());
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string prefix = names[i] + std::string(width - names[i].size(), ' ') + " | ";
    if (colour_) {
      prefix = std::string(kColours[i % kColours.size()]) + prefix + std::string(kColourEnd);
    }
    prefixes_.push_back(std::move(prefix));
  }
}

void Output::FromProcess(std::size_t index, bool is_error, std::string_view line) {
  std::ostream& stream = is_error ? error_ : out_;
  stream << prefixes_[index] + types::Printable(line, types::Lines::kMany) + '\n' << std::flush;
}

void Output::Say(std::string_view text) {
  error_ << "sinew launch: " + types::Printable(text, types::Lines::kMany) + '\n' << std::flush;
}

bool Output::broken() const { return !out_.good(); }

bool WantsColour(int file_descriptor) {
  const char* no_colour = std::getenv("NO_COLOR");
  return ::isatty(file_descriptor) == 1 && (no_colour == nullptr || *no_colour == '\0');
}

}  // namespace sinew::launch
