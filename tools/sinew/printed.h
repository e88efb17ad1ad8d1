// Output of a command: text of others, such as names in a recording, cannot control the terminal.
#pragma once

#include <memory>
#include <ostream>

namespace sinew::tools {

// While it lives, control characters but line ends and tabs that are written to the stream come out
// as text (types::Printable). One thread at a time, as of the stream.
class PrintableOnly {
 public:
  explicit PrintableOnly(std::ostream& stream);
  ~PrintableOnly();
  PrintableOnly(const PrintableOnly&) = delete;
  PrintableOnly& operator=(const PrintableOnly&) = delete;

 private:
  std::ostream& stream_;
  std::unique_ptr<std::streambuf> filter_;
  std::streambuf* before_;
};

// std::printf to std::cout, whose filter it passes.
[[gnu::format(printf, 1, 2)]] void Print(const char* format, ...);

// Past the filter, where there is one: for colours, bars and screens of this program, and for the
// bytes of a file.
std::ostream& Unfiltered(std::ostream& stream);

// Characters of the terminal at a file descriptor.
struct TerminalSize {
  int columns = 80, rows = 24;  // where there is none
};
TerminalSize SizeOfTerminal(int file_descriptor);

}  // namespace sinew::tools
