// Lines of many processes in one stream, each prefixed with its process's name.
//
// A line goes out whole or not at all. Colours only when asked for (a terminal, and NO_COLOR
// unset). One thread.
#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::launch {

// Cuts a byte stream into lines without their end; a line longer than 64 KiB is cut there.
class LineSplitter {
 public:
  using Line = std::function<void(std::string_view)>;
  explicit LineSplitter(Line line);
  void Add(std::string_view bytes);
  void Finish();  // hands out what has no line end

 private:
  void Emit();

  Line line_;
  std::string rest_;
};

class Output {
 public:
  Output(std::ostream& out, std::ostream& error, bool colour, std::vector<std::string> names);

  void FromProcess(std::size_t index, bool is_error, std::string_view line);
  // The launcher's own word, on the error stream.
  void Say(std::string_view text);
  bool broken() const;  // the reader of our output is gone

 private:
  std::ostream& out_;
  std::ostream& error_;
  bool colour_;
  std::vector<std::string> prefixes_;
};

// True for a terminal unless NO_COLOR is set.
bool WantsColour(int file_descriptor);

}  // namespace sinew::launch
