// Counts requests to the heap: linked into the bench, and preloaded into the process of the peers.
#include "heap_count.hpp"

#include <cerrno>
#include <cstddef>

namespace {

long requests = 0;

}  // namespace

extern "C" {

void* __libc_malloc(std::size_t size);                           // NOLINT(bugprone-reserved-identifier)
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT(bugprone-reserved-identifier)
void* __libc_realloc(void* old, std::size_t size);               // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT(bugprone-reserved-identifier)

long ajar_heap_count() noexcept { return requests; }

void* malloc(std::size_t size) {
  ++requests;
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  ++requests;
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  ++requests;
  return __libc_realloc(old, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++requests;
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  ++requests;
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : ENOMEM;
}
}
