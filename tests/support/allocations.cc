#include "tests/support/allocations.h"

#include <atomic>
#include <cstddef>

namespace {
std::atomic<long> allocations{0};
}

namespace sinew::test {

long Allocations() noexcept { return allocations.load(); }

}  // namespace sinew::test

#if !defined(SINEW_SANITIZED)
// The C library's own names; defining malloc in the program takes precedence over the shared
// library's.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) {
  ++allocations;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif
