#include "tactus/rt/memory.h"

#include <gtest/gtest.h>
#include <sys/mman.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>

#include "support/child_process.h"

namespace tactus {
namespace {

using test::holdsInChild;

#ifndef TACTUS_SANITIZED
// Sanitizers replace malloc, and turn mlockall() into nothing for the sake of their shadow memory.

long lockedMemory_kB() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmLck:")) return std::stol(line.substr(6));
  }
  return -1;
}

TEST(LockMemory, locksOrSaysThatItCannot) {
  EXPECT_TRUE(holdsInChild([] {
    const bool is_granted = !lockMemory(1 << 20).has_value();
    return is_granted == (lockedMemory_kB() > 0);
  }));
}

TEST(LockMemory, isGrantedWhereThereIsNoLimit) {
  EXPECT_TRUE(holdsInChild([] {
    const bool is_unlimited = test::setLimit(RLIMIT_MEMLOCK, RLIM_INFINITY);  // root may
    return !is_unlimited || !lockMemory(1 << 20).has_value();
  }));
}

TEST(LockMemory, isRefusedWithoutTheRight) {
  EXPECT_TRUE(holdsInChild([] {
    if (!test::setLimit(RLIMIT_MEMLOCK, 0) || !test::dropCapabilities()) return false;
    const auto refusal = lockMemory(0);
    return refusal && refusal->how_to_grant.find("LimitMEMLOCK") != std::string::npos &&
           refusal->how_to_grant.find("0 KiB") != std::string::npos &&
           !refusal->why_it_matters.empty() && lockedMemory_kB() == 0;
  }));
}

TEST(LockMemory, isRefusedUnderALimitThatLaterAllocationsWouldMeet) {
  EXPECT_TRUE(holdsInChild([] {
    constexpr rlim_t kEnoughForNow = rlim_t{1} << 30;
    const bool is_limited = test::setLimit(RLIMIT_MEMLOCK, kEnoughForNow) ||
                            test::setLimit(RLIMIT_MEMLOCK, 8 << 20);  // an ordinary user's
    if (!is_limited || !test::dropCapabilities()) return false;
    return lockMemory(0).has_value() && lockedMemory_kB() == 0;
  }));
}

constexpr std::size_t kHeap = 32 << 20;

/// Many small blocks and a large one, as a program would need them.
long faultsOfUsingTheHeap(std::size_t large) {
  const long before = threadPageFaults().minor;
  auto* const block = static_cast<volatile char*>(std::malloc(large));
  for (std::size_t i = 0; i < large; i += 4096) block[i] = 1;
  void* small[200];
  for (void*& pointer : small) pointer = std::calloc(1, 1000);
  for (void* const pointer : small) std::free(pointer);
  std::free(const_cast<char*>(block));
  return threadPageFaults().minor - before;
}

TEST(LockMemory, leavesAHeapThatDoesNotFault) {
  EXPECT_TRUE(holdsInChild([] {
    faultsOfUsingTheHeap(1 << 20);  // its own code and stack
    lockMemory(kHeap);
    return faultsOfUsingTheHeap(kHeap / 2) == 0 && faultsOfUsingTheHeap(kHeap / 2) == 0;
  }));
  EXPECT_TRUE(holdsInChild([] {
    if (!test::setLimit(RLIMIT_MEMLOCK, 0) || !test::dropCapabilities()) return false;
    faultsOfUsingTheHeap(1 << 20);
    return lockMemory(kHeap).has_value() && faultsOfUsingTheHeap(kHeap / 2) == 0;
  })) << "where the lock is refused";
  EXPECT_FALSE(holdsInChild([] {
    faultsOfUsingTheHeap(1 << 20);
    return faultsOfUsingTheHeap(kHeap / 2) == 0;
  })) << "the test sees no faults at all";
}

bool isHeapReadyInOtherThreads() {
  lockMemory(kHeap);
  long faults = -1;
  std::thread([&] {
    faultsOfUsingTheHeap(1 << 20);
    faults = faultsOfUsingTheHeap(kHeap / 2);
  }).join();
  return faults == 0;
}

TEST(LockMemoryDeathTest, leavesTheHeapToOtherThreads) {
  // Starts the program anew: threads of other tests would have left heaps of their own behind.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(_exit(isHeapReadyInOtherThreads() ? 0 : 1), ::testing::ExitedWithCode(0), "");
}
#endif

TEST(ThreadPageFaults, countThoseOfThisThreadAlone) {
  constexpr std::size_t kBytes = 1 << 20;
  auto* const memory = static_cast<volatile char*>(
      mmap(nullptr, kBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
  ASSERT_NE(const_cast<char*>(memory), MAP_FAILED);
  const PageFaults before = threadPageFaults();
  PageFaults others;
  std::thread([&] {
    const PageFaults start = threadPageFaults();
    for (std::size_t i = 0; i < kBytes / 2; i += 4096) memory[i] = 1;
    others.minor = threadPageFaults().minor - start.minor;
  }).join();
  for (std::size_t i = kBytes / 2; i < kBytes; i += 4096) memory[i] = 1;
  EXPECT_GT(others.minor, 0);
  EXPECT_GT(threadPageFaults().minor, before.minor);
  EXPECT_GE(threadPageFaults().major, before.major);
  munmap(const_cast<char*>(memory), kBytes);
}

}  // namespace
}  // namespace tactus
