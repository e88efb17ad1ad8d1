// Recordings that are well formed, but too short or with too little motion for the request.
// The caller reports it as a result; it is no usage error.
#pragma once

#include <stdexcept>

namespace sinew::identify {

struct TooLittleData : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

}  // namespace sinew::identify
