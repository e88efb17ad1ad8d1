#include "tools/sinew/printed.h"

#include <sys/ioctl.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <iostream>
#include <streambuf>
#include <string>
#include <string_view>

#include "components/base/types/printable.h"

namespace sinew::tools {

namespace {

class Filter final : public std::streambuf {
 public:
  explicit Filter(std::streambuf* out) : out_(out) {}
  std::ostream& out() { return out_; }

 protected:
  int_type overflow(int_type c) override {
    if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
    const char letter = traits_type::to_char_type(c);
    return xsputn(&letter, 1) == 1 ? c : traits_type::eof();
  }
  std::streamsize xsputn(const char* letters, std::streamsize count) override {
    const std::string_view text(letters, static_cast<std::size_t>(count));
    if (types::IsPrintable(text, types::Lines::kMany)) return out_.rdbuf()->sputn(letters, count);
    const std::string printable = types::Printable(text, types::Lines::kMany);
    const auto size = static_cast<std::streamsize>(printable.size());
    return out_.rdbuf()->sputn(printable.data(), size) == size ? count : 0;
  }
  int sync() override { return out_.rdbuf()->pubsync(); }

 private:
  std::ostream out_;
};

}  // namespace

PrintableOnly::PrintableOnly(std::ostream& stream)
    : stream_(stream), filter_(std::make_unique<Filter>(stream.rdbuf())) {
  before_ = stream_.rdbuf(filter_.get());
}

PrintableOnly::~PrintableOnly() { stream_.rdbuf(before_); }

void Print(const char* format, ...) {
  std::va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, arguments);
  std::string text(static_cast<std::size_t>(std::max(size, 0)) + 1, '\0');
  std::vsnprintf(text.data(), text.size(), format, again);
  va_end(again);
  va_end(arguments);
  text.pop_back();
  std::cout << text;
}

std::ostream& Unfiltered(std::ostream& stream) {
  auto* filter = dynamic_cast<Filter*>(stream.rdbuf());
  return filter != nullptr ? filter->out() : stream;
}

TerminalSize SizeOfTerminal(int file_descriptor) {
  winsize size{};
  const bool known = ::ioctl(file_descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 1;
  return known ? TerminalSize{size.ws_col, size.ws_row} : TerminalSize{};
}

}  // namespace sinew::tools
