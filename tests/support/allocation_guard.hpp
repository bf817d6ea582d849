#pragma once

// Counts heap requests of the whole program: include in one source of a test program only.
// Eigen and operator new both end in malloc, so this sees them all. Off under sanitizers, which own malloc.

#include <cstddef>
#include <cstdlib>

namespace ajar::test {
inline thread_local long allocations = 0;
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT
void* malloc(std::size_t size) {        // NOLINT
  ++ajar::test::allocations;
  return __libc_malloc(size);
}
}
#endif
