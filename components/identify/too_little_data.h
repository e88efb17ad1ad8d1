// Recordings that are well formed, but too short or too still for what is asked of them. Whoever
// assesses recordings reports it as a result; it is no mistake of the command.
#pragma once

#include <stdexcept>

namespace sinew::identify {

struct TooLittleData : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

}  // namespace sinew::identify
