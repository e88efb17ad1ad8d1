// libFuzzer's way into one harness: SINEW_FUZZ_RUN is its function. A property that does not hold
// ends the process, and libFuzzer keeps the input.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/harness.h"

// noexcept: a Violation must not be caught by anybody.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) noexcept {
  sinew::fuzz::SINEW_FUZZ_RUN({data, size});
  return 0;
}
