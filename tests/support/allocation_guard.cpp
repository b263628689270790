#include "support/allocation_guard.h"

#include <unistd.h>

#include <cstdlib>

#ifdef TACTUS_SANITIZED
// Sanitizers own malloc, but report each call of it.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));
#else
#include <cerrno>
// What malloc and its kin do in glibc, under the names that stay when a program replaces them.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
}
#endif

namespace tactus::test {
namespace {

thread_local bool armed = false;

void refuseWhileArmed() {
  if (!armed) return;
  armed = false;  // abort() may allocate
  constexpr char kMessage[] = "heap used while an allocation guard is armed\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  std::abort();
}

#ifdef TACTUS_SANITIZED
[[maybe_unused]] const int hooks_installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { refuseWhileArmed(); },
    [](const volatile void*) { refuseWhileArmed(); });
#endif

}  // namespace

AllocationGuard::AllocationGuard() { armed = true; }
AllocationGuard::~AllocationGuard() { armed = false; }

}  // namespace tactus::test

#ifndef TACTUS_SANITIZED
using tactus::test::refuseWhileArmed;

// operator new and new[] end here, too: libstdc++ calls malloc through the same symbol.
extern "C" {

void* malloc(std::size_t size) {
  refuseWhileArmed();
  return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
  refuseWhileArmed();
  return __libc_calloc(count, size);
}

void* realloc(void* old, std::size_t size) {
  refuseWhileArmed();
  return __libc_realloc(old, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  refuseWhileArmed();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  *result = memalign(alignment, size);
  return *result == nullptr ? ENOMEM : 0;
}

void free(void* pointer) {
  refuseWhileArmed();
  __libc_free(pointer);
}

}  // extern "C"
#endif
