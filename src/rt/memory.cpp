#include "tactus/rt/memory.h"

#include <errno.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <system_error>

namespace tactus {
namespace {

// None of these can fail with these arguments; sanitizers, whose malloc has no such options, say
// so.
void keepHeapInOnePiece() {
  mallopt(M_TRIM_THRESHOLD, -1);  // freed memory stays mapped
  mallopt(M_MMAP_MAX, 0);         // large blocks come from the heap, too
  // A thread's own arena would not be the touched one, and its 128 MiB of addresses count as
  // locked.
  mallopt(M_ARENA_MAX, 1);
}

bool touchHeap(std::size_t bytes) {
  if (bytes == 0) return true;
  auto* const heap = static_cast<volatile char*>(std::malloc(bytes));
  if (heap == nullptr) return false;
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  for (std::size_t i = 0; i < bytes; i += page) heap[i] = 0;
  std::free(const_cast<char*>(heap));
  return true;
}

std::string memoryLimit() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  if (limit.rlim_cur == RLIM_INFINITY) return "is unlimited";
  return "is " + std::to_string(limit.rlim_cur / 1024) + " KiB";
}

Refusal refusal(const std::string& what, int error) {
  return {what + ": " + std::generic_category().message(error),
          "a page that is not in memory delays a cycle by microseconds to many milliseconds",
          "LimitMEMLOCK=infinity in the systemd unit, or 'USER - memlock unlimited' in "
          "/etc/security/limits.d/, or CAP_IPC_LOCK in a container (RLIMIT_MEMLOCK " +
              memoryLimit() + ")"};
}

}  // namespace

std::optional<Refusal> lockMemory(std::size_t heap_bytes) {
  keepHeapInOnePiece();
  const int error = mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : errno;
  const bool is_touched = touchHeap(heap_bytes);  // useful without the lock, too
  if (error != 0) return refusal("locking memory", error);
  if (!is_touched)
    return refusal("touching " + std::to_string(heap_bytes) + " bytes of heap", ENOMEM);
  return std::nullopt;
}

PageFaults threadPageFaults() noexcept {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return {usage.ru_minflt, usage.ru_majflt};
}

}  // namespace tactus
