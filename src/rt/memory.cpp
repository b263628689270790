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

rlim_t memoryLimit() {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  return limit.rlim_cur;
}

/// Once future memory is locked, too, a limit makes allocations fail that went well before.
bool isLimited() {
  const rlim_t limit = memoryLimit();
  if (limit == RLIM_INFINITY) return false;
  void* const beyond = mmap(nullptr, limit + 1, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (beyond == MAP_FAILED) return true;
  munmap(beyond, limit + 1);
  return false;
}

int lockAll() {
  if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) return errno;
  if (!isLimited()) return 0;
  munlockall();
  return EPERM;
}

std::string limitText() {
  const rlim_t limit = memoryLimit();
  if (limit == RLIM_INFINITY) return "is unlimited";
  return "is " + std::to_string(limit / 1024) + " KiB";
}

Refusal refusal(const std::string& what, int error) {
  return {what + ": " + std::generic_category().message(error),
          "a page that is not in memory delays a cycle by microseconds to many milliseconds",
          "LimitMEMLOCK=infinity in the systemd unit, or 'USER - memlock unlimited' in "
          "/etc/security/limits.d/, or CAP_IPC_LOCK in a container (RLIMIT_MEMLOCK " +
              limitText() + ")"};
}

}  // namespace

std::optional<Refusal> lockMemory(std::size_t heap_bytes) {
  keepHeapInOnePiece();
  const int error = lockAll();
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
