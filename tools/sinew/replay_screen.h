// Keys and the line of `sinew replay` on a terminal. Pure text: replay.cc reads the keys.
//
//   space pause or resume, s one tick, left and right 5 s, down and up 60 s, + and - rate, q quit
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "components/record/logger/player/play_control.h"

namespace sinew::tools {

// Bytes as a terminal sends them, to requests (play_control.h). One thread.
class KeyDecoder {
 public:
  // The request that this byte completes; nothing: none, or a key without meaning.
  std::optional<std::string> Take(char byte);

 private:
  std::string escape_;  // ESC [ of an arrow key, so far
};

// One line of at most `width` columns, e.g.
//   12.5 of 60.0 s [####----------------] x2 paused, pass 1  space s <- -> + - q
std::string ReplayLine(const logger::PlayStatus& status, std::size_t width);

}  // namespace sinew::tools
