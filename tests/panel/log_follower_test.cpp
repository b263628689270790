#include "tactus/panel/log_follower.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "support/shipped_scene.h"
#include "support/telemetry.h"

namespace tactus {
namespace {

/// Waits for what another thread does, without a limit but that of the test program.
template <class Condition>
void await(const Condition& condition) {
  while (!condition()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

/// The news of several looks in one.
struct CollectedNews {
  std::vector<ForceBin> bins;
  std::vector<Json> contacts;
  LogNews last;

  void look(LogFollower& follower) {
    last = follower.news();
    bins.insert(bins.end(), last.bins.begin(), last.bins.end());
    contacts.insert(contacts.end(), last.contacts.begin(), last.contacts.end());
  }
};

CycleRecord cycleWith(const Scene& scene, int cycle, double force_N) {
  CycleRecord record;
  record.t_s = 0.001 * cycle;
  record.gains = scene.controller.gains;
  record.force_sensor_N[0] = force_N;
  record.force_contact_N = std::max(0.0, force_N - record.gains.force.contact_threshold_N);
  return record;
}

TEST(LogFollowerTest, TellsAGrowingLogWithEachPeakAndContact) {
  const Scene scene = test::shippedScene("commands");
  const test::TemporaryFile file(".ulg");
  UlogWriter writer(file.path(), describeLog(scene));
  writer.flush();
  LogFollower follower(file.path());
  CollectedNews news;
  const auto write = [&](int from, int to, double force_N) {
    for (int i = from; i < to; ++i) writer.write(cycleWith(scene, i, i == 1234 ? 8.25 : force_N));
    writer.flush();
  };
  write(0, 1000, 0.0);
  await([&] { return news.look(follower), news.last.is_live; });
  EXPECT_EQ(news.last.links, scene.module_links);
  write(1000, 2000, 5.0);
  await([&] { return news.look(follower), !news.last.lasting.empty(); });
  EXPECT_TRUE(news.contacts.empty());
  write(2000, 3001, 0.0);
  await([&] {
    return news.look(follower),
           !news.contacts.empty() && !news.bins.empty() && news.bins.back().to_s > 2.98;
  });
  EXPECT_TRUE(news.last.lasting.empty());
  EXPECT_EQ(news.contacts.front().at("peak_force_N"), 8.25);
  const Json& high = news.contacts.front().at("trace").at("high").front();
  EXPECT_EQ(*std::ranges::max_element(high), 8.25);
  EXPECT_LE(news.contacts.front().at("trace").at("t").front(), -0.19);
  double most_N = 0.0, cycles = 0.0;
  for (const ForceBin& bin : news.bins) {
    most_N = std::max(most_N, bin.most_N[0]);
    cycles += std::round(1e3 * (bin.to_s - bin.from_s)) + 1.0;
  }
  EXPECT_EQ(most_N, 8.25);
  EXPECT_GE(cycles, 2980.0);
  ASSERT_TRUE(follower.start().has_value());
  EXPECT_EQ(follower.start()->sources.size(), scene.sources.size());
}

/// While it reads the past it looks at them once a minute only.
TEST(LogFollowerTest, TellsContactsThatLastOnceThePastWasRead) {
  const Scene scene = test::shippedScene("commands");
  const test::TemporaryFile file(".ulg");
  UlogWriter writer(file.path(), describeLog(scene));
  for (int i = 0; i < 1000; ++i) writer.write(cycleWith(scene, i, 5.0));
  writer.flush();
  LogFollower follower(file.path());
  LogNews news;
  await([&] { return news = follower.news(), news.is_live; });
  const auto write = [&](int from, int to) {
    for (int i = from; i < to; ++i) writer.write(cycleWith(scene, i, 5.0));
    writer.flush();
    const double read_s = 0.001 * to - 0.02;  // complete bins
    await([&] {
      return news = follower.news(), !news.bins.empty() && news.bins.back().to_s > read_s;
    });
  };
  write(1000, 1050);
  ASSERT_EQ(news.lasting.size(), 1u);
  const double first_end_s = news.lasting.front().at("end_s");
  write(1050, 1150);
  EXPECT_EQ(news.lasting.front().at("end_s"), first_end_s) << "not at each record";
}

TEST(LogFollowerTest, EndsWhileALogStandsStill) {
  const Scene scene = test::shippedScene("commands");
  const test::TemporaryFile file(".ulg");
  UlogWriter writer(file.path(), describeLog(scene));
  writer.flush();
  { const LogFollower follower(file.path()); }
  SUCCEED();  // it would wait for ever
}

TEST(LogFollowerTest, SaysWhatIsWrongWithALog) {
  const test::TemporaryFile file(".ulg");
  file.setContent("no log at all, but long enough to look like one");
  LogFollower follower(file.path());
  LogNews news;
  await([&] { return news = follower.news(), !news.problem.empty(); });
  EXPECT_NE(news.problem.find(file.path()), std::string::npos) << news.problem;
  LogFollower missing("/nonexistent/run.ulg");
  await([&] { return news = missing.news(), !news.problem.empty(); });
  EXPECT_NE(news.problem.find("/nonexistent/run.ulg"), std::string::npos);
}

}  // namespace
}  // namespace tactus
