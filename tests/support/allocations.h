// Counts what this program takes from the heap, malloc included (Eigen does not use operator new).
// Link sinew_test_allocations. With a sanitizer, which owns malloc, the count stays 0.
#pragma once

namespace sinew::test {

long Allocations() noexcept;

}  // namespace sinew::test
