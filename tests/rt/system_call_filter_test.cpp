#include "tactus/rt/system_call_filter.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <thread>
#include <vector>

#include "support/child_process.h"
#include "tactus/rt/thread_stack.h"

// What runs under a filter must not allocate, hence no std::thread and no GoogleTest there. A
// machine without seccomp fails these tests: the daemon could not be confined on it.
namespace tactus {
namespace {

using test::holdsInChild;

/// Result and errno of one call.
struct Outcome {
  long result = 0;
  int error = 0;
};

Outcome call(long number) noexcept {
  errno = 0;
  const long result = syscall(number);
  return {result, errno};
}

/// Runs a function in a thread of its own under a filter, until the end of the thread.
template <typename Function>
class FilteredThread {
 public:
  FilteredThread(SystemCallFilter& filter, Function function)
      : filter_(filter), function_(function) {
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstack(&attributes, stack_.lowest(), stack_.size_bytes());
    EXPECT_EQ(pthread_create(&thread_, &attributes, run, this), 0);
    pthread_attr_destroy(&attributes);
  }
  ~FilteredThread() {
    EXPECT_EQ(pthread_join(thread_, nullptr), 0);
    EXPECT_EQ(load_error_, 0) << "this machine refuses seccomp filters";
  }

 private:
  static void* run(void* self) noexcept {
    auto& thread = *static_cast<FilteredThread*>(self);
    thread.load_error_ = thread.filter_.load();
    if (thread.load_error_ == 0) thread.function_();
    return nullptr;
  }

  SystemCallFilter& filter_;
  Function function_;
  int load_error_ = -1;
  ThreadStack stack_{1 << 20};
  pthread_t thread_{};
};

template <typename Function>
void runFiltered(SystemCallFilter& filter, Function function) {
  FilteredThread<Function>(filter, function);
}

void expectForbidden(const SystemCallFilter& filter, std::uint32_t count, int first) {
  EXPECT_EQ(filter.forbiddenCalls().count, count);
  EXPECT_EQ(filter.forbiddenCalls().first, first) << systemCallName(filter.forbiddenCalls().first);
}

TEST(SystemCallFilter, letsAThreadDoWhatIsAllowedAndEnd) {
  SystemCallFilter filter(kLoopSystemCalls);
  Outcome sleep{-1, 0}, time{-1, 0};
  runFiltered(filter, [&]() noexcept {
    timespec moment{};
    time.result = syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &moment);
    sleep.result = syscall(SYS_clock_nanosleep, CLOCK_MONOTONIC, TIMER_ABSTIME, &moment, nullptr);
  });
  EXPECT_EQ(time.result, 0);
  EXPECT_EQ(sleep.result, 0);
  expectForbidden(filter, 0, -1);
}

TEST(SystemCallFilter, makesAForbiddenCallFailAndCountsIt) {
  SystemCallFilter filter(kLoopSystemCalls);
  Outcome first, second;
  ForbiddenCalls between;
  runFiltered(filter, [&]() noexcept {
    first = call(SYS_getpid);
    between = filter.forbiddenCalls();
    second = call(SYS_getppid);
  });
  for (const Outcome& outcome : {first, second}) {
    EXPECT_EQ(outcome.result, -1);
    EXPECT_EQ(outcome.error, ENOSYS);
  }
  EXPECT_EQ(between.count, 1u) << "the thread itself has to see it";
  EXPECT_EQ(between.first, SYS_getpid);
  expectForbidden(filter, 2, SYS_getpid);
  EXPECT_EQ(systemCallName(filter.forbiddenCalls().first), "getpid");
}

TEST(SystemCallFilter, forbidsWhatTheListLacksWhateverItIs) {
  for (const int number : {SYS_getpid, SYS_openat, SYS_socket, SYS_nanosleep, SYS_fsync, SYS_execve,
                           SYS_fork, SYS_kill, 100'000}) {
    SystemCallFilter filter(kLoopSystemCalls);
    Outcome outcome;
    runFiltered(filter, [&]() noexcept { outcome = call(number); });
    EXPECT_EQ(outcome.error, ENOSYS) << number;
    expectForbidden(filter, 1, number);
  }
}

TEST(SystemCallFilter, leavesOtherThreadsFree) {
  SystemCallFilter filter(kLoopSystemCalls);
  std::atomic<bool> is_loaded{false}, is_over{false};
  {
    FilteredThread thread(filter, [&]() noexcept {
      is_loaded = true;
      while (!is_over) {
        timespec moment{0, 1'000'000};
        clock_nanosleep(CLOCK_MONOTONIC, 0, &moment, nullptr);
      }
    });
    while (!is_loaded) std::this_thread::yield();
    EXPECT_EQ(syscall(SYS_getpid), getpid());
    std::thread([] { EXPECT_EQ(syscall(SYS_getpid), getpid()); }).join();
    is_over = true;
  }
  EXPECT_EQ(syscall(SYS_getpid), getpid());
  expectForbidden(filter, 0, -1);
}

TEST(SystemCallFilter, countsEachFilterApart) {
  SystemCallFilter strict(kLoopSystemCalls);
  std::vector<int> more(kLoopSystemCalls.begin(), kLoopSystemCalls.end());
  more.push_back(SYS_getpid);
  SystemCallFilter loose(more);
  Outcome allowed;
  runFiltered(strict, []() noexcept { call(SYS_getpid); });
  runFiltered(loose, [&]() noexcept { allowed = call(SYS_getpid); });
  EXPECT_EQ(allowed.result, getpid());
  expectForbidden(strict, 1, SYS_getpid);
  expectForbidden(loose, 0, -1);
}

TEST(SystemCallFilter, worksInAThreadThatHadBlockedAllSignals) {
  SystemCallFilter filter(kLoopSystemCalls);
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  runFiltered(filter, []() noexcept { call(SYS_getpid); });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  expectForbidden(filter, 1, SYS_getpid);
}

// Not under the thread sanitizer (CMakePresets.json): it runs a handler of SIGSYS at any
// instruction, in its own locks, too, and then waits for itself.
TEST(SystemCallFilter, leavesASigsysThatSomebodySentWithoutEffect) {
  SystemCallFilter filter(kLoopSystemCalls);
  EXPECT_EQ(raise(SIGSYS), 0);
  std::atomic<bool> is_over{false};
  std::thread sender([&, to = pthread_self()] {
    while (!is_over) pthread_kill(to, SIGSYS);
  });
  volatile long sum = 0;  // comes out wrong if the handler changes a register
  for (long i = 0; i < 1'000'000; ++i) sum = sum + i;
  is_over = true;
  sender.join();
  EXPECT_EQ(sum, 499'999'500'000);
  expectForbidden(filter, 0, -1);
}

#if defined(__x86_64__)
TEST(SystemCallFilter, forbidsCallsOfAnotherAbiWithoutEndingTheProcess) {
  constexpr int kX32Getpid = 0x40000000 | SYS_getpid;
  SystemCallFilter filter(kLoopSystemCalls);
  Outcome outcome;
  runFiltered(filter, [&]() noexcept { outcome = call(kX32Getpid); });
  EXPECT_EQ(outcome.error, ENOSYS);
  expectForbidden(filter, 1, kX32Getpid);
}
#endif

TEST(SystemCallFilterDeathTest, letsAThreadEndTheProcess) {
  EXPECT_DEATH(
      {
        SystemCallFilter filter(kLoopSystemCalls);
        runFiltered(filter, []() noexcept { std::abort(); });
      },
      "");
}

TEST(SystemCallFilter, needsNoPrivilege) {
  EXPECT_TRUE(holdsInChild([] {
    SystemCallFilter filter(kLoopSystemCalls);
    if (!test::dropCapabilities()) return false;
    runFiltered(filter, []() noexcept { call(SYS_getpid); });
    return filter.forbiddenCalls().count == 1;
  }));
}

TEST(SystemCallFilter, refusesANumberThatIsNoSystemCall) {
  const int none[] = {-1};
  EXPECT_THROW(SystemCallFilter{none}, std::system_error);
}

/// libseccomp, which writes its program into a file, crashes where memory is short.
TEST(SystemCallFilter, needsNoFile) {
  EXPECT_TRUE(holdsInChild([] {
    if (!test::setLimit(RLIMIT_NOFILE, 0)) return false;
    const SystemCallFilter filter(kLoopSystemCalls);
    return true;
  }));
}

TEST(SystemCallFilter, takesACallTwice) {
  const int twice[] = {SYS_exit, SYS_exit, SYS_rt_sigreturn};
  EXPECT_NO_THROW(SystemCallFilter{twice});
}

TEST(SystemCallFilter, namesCallsThatHaveNoName) {
  EXPECT_EQ(systemCallName(SYS_recvmmsg), "recvmmsg");
  EXPECT_EQ(systemCallName(100'000), "system call 100000");
  EXPECT_EQ(systemCallName(-1), "system call -1");
}

TEST(SystemCallFilter, saysWhyItMatters) {
  const Refusal refusal = systemCallFilterRefusal(EINVAL);
  EXPECT_NE(refusal.what.find("Invalid argument"), std::string::npos);
  EXPECT_NE(refusal.why_it_matters, "");
  EXPECT_NE(refusal.how_to_grant, "");
}

}  // namespace
}  // namespace tactus
