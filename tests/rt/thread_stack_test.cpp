#include "tactus/rt/thread_stack.h"

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <system_error>
#include <vector>

namespace tactus {
namespace {

const auto kPage = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));

TEST(ThreadStack, isInMemoryFromTheStart) {
  const ThreadStack stack(256 * 1024);
  std::vector<unsigned char> is_resident(stack.size_bytes() / kPage);
  ASSERT_EQ(mincore(stack.lowest(), stack.size_bytes(), is_resident.data()), 0);
  EXPECT_TRUE(std::all_of(is_resident.begin(), is_resident.end(), [](int x) { return x & 1; }));
}

TEST(ThreadStack, isRoundedUpToPagesAndAligned) {
  for (const std::size_t bytes : {std::size_t{1}, kPage - 1, kPage, kPage + 1, 10 * kPage}) {
    const ThreadStack stack(bytes);
    EXPECT_GE(stack.size_bytes(), bytes);
    EXPECT_LT(stack.size_bytes(), bytes + kPage);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(stack.lowest()) % kPage, 0u);
  }
}

TEST(ThreadStackDeathTest, endsTheProcessWhenItOverflows) {
  const ThreadStack stack(kPage);
  auto* const lowest = static_cast<volatile char*>(stack.lowest());
  lowest[0] = 1;
  lowest[stack.size_bytes() - 1] = 1;
  EXPECT_DEATH(lowest[-1] = 1, "");
}

TEST(ThreadStack, saysThatThereIsNotSoMuchMemory) {
  EXPECT_THROW(ThreadStack{std::size_t{1} << 60}, std::system_error);
}

}  // namespace
}  // namespace tactus
