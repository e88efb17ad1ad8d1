// Text from the formats of std::printf.
#pragma once

#include <string>

namespace sinew::types {

// As std::printf, into a string of whatever length it needs. Allocates; any thread.
__attribute__((format(printf, 1, 2))) std::string Text(const char* format, ...);

}  // namespace sinew::types
