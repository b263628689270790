#pragma once

#include <linux/filter.h>
#include <signal.h>
#include <sys/syscall.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tactus/rt/refusal.h"

namespace tactus {

/// All that the daemon's loop asks of the kernel, on a ThreadStack (glibc gives its own stacks back
/// with madvise() when a thread ends).
inline constexpr std::array<int, 9> kLoopSystemCalls{
    SYS_clock_nanosleep,  // to the next cycle
    SYS_clock_gettime,    // where the vDSO cannot read the clock, and for CPU time
    SYS_recvmmsg,         // CAN, once a bus and cycle
    SYS_sendmmsg,         // CAN, once a bus and cycle
    SYS_ioctl,            // GPIO lines, levels of inputs and outputs
    SYS_read,             // GPIO lines, edge events (without waiting)
    SYS_getrusage,        // page faults, once after the last cycle
    SYS_rt_sigprocmask,   // glibc ends a thread with signals blocked
    SYS_exit,             // of the thread
};

struct ForbiddenCalls {
  std::uint32_t count = 0;
  int first = -1;  ///< number of the first one; -1: none
};

/// Seccomp filter for one thread: a system call that is not on the list is not made, fails with
/// ENOSYS and is counted, so that the loop can come to rest in its next cycle. A tripwire for our
/// own mistakes, no sandbox. What it cannot catch: a forbidden call made while SIGSYS is blocked
/// (libc does so inside fork and posix_spawn) ends the process.
class SystemCallFilter {
 public:
  /// Native numbers (SYS_...). Builds the program and takes SIGSYS for the whole process. Throws
  /// std::system_error. Has to outlive the threads that load it.
  explicit SystemCallFilter(std::span<const int> allowed);
  SystemCallFilter(const SystemCallFilter&) = delete;
  SystemCallFilter& operator=(const SystemCallFilter&) = delete;

  /// For the calling thread, until it ends. Allocates nothing. Returns 0 or errno.
  int load() noexcept;

  ForbiddenCalls forbiddenCalls() const noexcept { return {count_.load(), first_.load()}; }

 private:
  static void onForbiddenCall(int signal, siginfo_t* info, void* context) noexcept;

  std::vector<sock_filter> program_;
  std::atomic<std::uint32_t> count_{0};
  std::atomic<int> first_{-1};
};

Refusal systemCallFilterRefusal(int error);

/// "getpid", or the number of a call that has no name here.
std::string systemCallName(int number);

}  // namespace tactus
