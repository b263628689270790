#include "tactus/rt/spsc_queue.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <random>
#include <thread>
#include <vector>

namespace tactus {
namespace {

TEST(SpscQueue, refusesACapacityThatIsNoPowerOfTwo) {
  for (const std::size_t capacity : {0u, 3u, 5u, 1000u}) {
    EXPECT_THROW(SpscQueue<int>{capacity}, std::invalid_argument) << capacity;
  }
  for (const std::size_t capacity : {1u, 2u, 64u}) {
    EXPECT_EQ(SpscQueue<int>{capacity}.capacity(), capacity);
  }
}

TEST(SpscQueue, isEmptyAtFirstAndLeavesTheElementAlone) {
  SpscQueue<int> queue(4);
  int element = 42;
  EXPECT_FALSE(queue.pop(element));
  EXPECT_EQ(element, 42);
}

TEST(SpscQueue, dropsAndCountsWhatDoesNotFit) {
  SpscQueue<int> queue(4);
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.dropped(), 0u);
  for (int i = 4; i < 7; ++i) EXPECT_FALSE(queue.push(i));
  EXPECT_EQ(queue.dropped(), 3u);
  int element = -1;
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(queue.pop(element));
    EXPECT_EQ(element, i);
  }
  EXPECT_FALSE(queue.pop(element));
  EXPECT_TRUE(queue.push(7));
  EXPECT_EQ(queue.dropped(), 3u);
}

TEST(SpscQueue, behavesAsABoundedDequeUnderAnyOrderOfCalls) {
  std::mt19937_64 random(11);
  for (const std::size_t capacity : {1u, 2u, 8u, 64u}) {
    SpscQueue<std::uint64_t> queue(capacity);
    std::deque<std::uint64_t> expected;
    std::uint64_t dropped = 0;
    for (int step = 0; step < 100'000; ++step) {
      const bool is_filling = (step / 500) % 2 == 0;  // to reach both ends
      if (random() % 8 < (is_filling ? 6u : 2u)) {
        const std::uint64_t value = random();
        const bool fits = expected.size() < capacity;
        ASSERT_EQ(queue.push(value), fits);
        fits ? expected.push_back(value) : void(++dropped);
      } else {
        std::uint64_t value = 0;
        ASSERT_EQ(queue.pop(value), !expected.empty());
        if (expected.empty()) continue;
        ASSERT_EQ(value, expected.front());
        expected.pop_front();
      }
    }
    EXPECT_EQ(queue.dropped(), dropped);
    EXPECT_GT(dropped, 0u);
  }
}

TEST(SpscQueue, showsNothingBeforeItIsCommitted) {
  SpscQueue<int> queue(2);
  int* const place = queue.reserve();
  ASSERT_NE(place, nullptr);
  *place = 7;
  EXPECT_EQ(queue.front(), nullptr);
  EXPECT_EQ(queue.reserve(), place) << "until then it is the same place";
  queue.commit();
  ASSERT_EQ(queue.front(), place) << "no copy was made";
  EXPECT_EQ(*queue.front(), 7);
}

TEST(SpscQueue, keepsAnElementUntilItIsReleased) {
  SpscQueue<int> queue(2);
  queue.push(1);
  queue.push(2);
  EXPECT_EQ(*queue.front(), 1);
  EXPECT_EQ(*queue.front(), 1);
  EXPECT_EQ(queue.reserve(), nullptr) << "its place is not free yet";
  EXPECT_EQ(queue.dropped(), 1u);
  queue.release();
  EXPECT_EQ(*queue.front(), 2);
  EXPECT_NE(queue.reserve(), nullptr);
}

/// Large enough to be seen torn.
struct Record {
  std::array<std::uint64_t, 13> words;
};

Record recordOf(std::uint64_t number) {
  Record record;
  for (std::size_t i = 0; i < record.words.size(); ++i) record.words[i] = number * 31 + i;
  return record;
}

TEST(SpscQueue, keepsOrderAndWholeRecordsBetweenTwoThreads) {
  constexpr std::uint64_t kSent = 20'000;  // each a change of threads where they share a CPU
  for (const std::size_t capacity : {1u, 4u, 256u}) {
    SpscQueue<Record> queue(capacity);
    std::thread producer([&] {
      for (std::uint64_t number = 0; number < kSent; ++number) {
        while (!queue.push(recordOf(number))) std::this_thread::yield();
      }
    });
    Record record;
    std::uint64_t wrong = 0;
    for (std::uint64_t number = 0; number < kSent; ++number) {
      while (!queue.pop(record)) std::this_thread::yield();
      wrong += record.words != recordOf(number).words;
    }
    producer.join();
    EXPECT_EQ(wrong, 0u) << "capacity " << capacity;
    EXPECT_FALSE(queue.pop(record));
  }
}

TEST(SpscQueue, handsOverWholeRecordsThatWereFilledInPlace) {
  constexpr std::uint64_t kSent = 200'000;
  SpscQueue<Record> queue(4);
  std::thread producer([&] {
    for (std::uint64_t number = 0; number < kSent; ++number) {
      Record* place = nullptr;
      while (!(place = queue.reserve())) std::this_thread::yield();
      for (std::size_t i = 0; i < place->words.size(); ++i) place->words[i] = number * 31 + i;
      queue.commit();
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t number = 0; number < kSent; ++number) {
    const Record* record = nullptr;
    while (!(record = queue.front())) std::this_thread::yield();
    wrong += record->words != recordOf(number).words;
    queue.release();
  }
  producer.join();
  EXPECT_EQ(wrong, 0u);
  EXPECT_EQ(queue.front(), nullptr);
}

TEST(SpscQueue, losesExactlyWhatItCountedAsDropped) {
  constexpr std::uint64_t kSent = 200'000;
  SpscQueue<Record> queue(8);
  std::vector<bool> accepted(kSent);
  std::atomic<bool> is_done{false};
  std::thread producer([&] {
    for (std::uint64_t number = 0; number < kSent; ++number) {
      accepted[number] = queue.push(recordOf(number));
    }
    is_done = true;
  });
  std::vector<Record> received;
  for (Record record; !is_done;) {
    while (queue.pop(record)) received.push_back(record);
  }
  producer.join();
  for (Record record; queue.pop(record);) received.push_back(record);
  ASSERT_EQ(received.size() + queue.dropped(), kSent);
  auto next = received.begin();
  for (std::uint64_t number = 0; number < kSent; ++number) {
    if (!accepted[number]) continue;
    ASSERT_EQ(next->words, recordOf(number).words);
    ++next;
  }
}

}  // namespace
}  // namespace tactus
