#include "tactus/panel/event_feed.h"

#include <gtest/gtest.h>

#include <thread>

namespace tactus {
namespace {

using namespace std::chrono_literals;

std::vector<std::string> textsOf(const EventFeed::Batch& batch) {
  std::vector<std::string> texts;
  for (const EventFeed::Event& event : batch.events) texts.push_back(*event);
  return texts;
}

TEST(EventFeedTest, GivesEachReaderAllThatIsNewToIt) {
  EventFeed feed;
  EXPECT_TRUE(textsOf(feed.wait(0, 0ms)).empty());
  feed.publish("a");
  feed.publish("b");
  EXPECT_EQ(textsOf(feed.wait(0, 0ms)), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(textsOf(feed.wait(1, 0ms)), (std::vector<std::string>{"b"}));
  EXPECT_EQ(feed.wait(1, 0ms).number, 2u);
  EXPECT_TRUE(feed.wait(2, 0ms).events.empty());
}

TEST(EventFeedTest, TellsASlowReaderThatEventsAreMissing) {
  EventFeed feed;
  for (std::size_t i = 0; i <= EventFeed::kKept; ++i) feed.publish("a");
  EXPECT_TRUE(feed.wait(0, 0ms).is_lost);
  EXPECT_FALSE(feed.wait(1, 0ms).is_lost);
  EXPECT_EQ(feed.wait(1, 0ms).events.size(), EventFeed::kKept);
  EXPECT_TRUE(feed.wait(1000, 0ms).is_lost);  // of another feed
}

TEST(EventFeedTest, WakesThoseThatWait) {
  EventFeed feed;
  std::vector<std::string> texts;
  std::thread reader([&] { texts = textsOf(feed.wait(0, 1h)); });
  feed.publish("a");
  reader.join();
  EXPECT_EQ(texts, std::vector<std::string>{"a"});
  std::thread other([&] { feed.wait(1, 1h); });
  feed.end();
  other.join();
  EXPECT_TRUE(feed.hasEnded());
}

}  // namespace
}  // namespace tactus
