#include "tactus/panel/panel_state.h"

#include <gtest/gtest.h>

namespace tactus {
namespace {

LogNews newsWith(double from_s, int bins, double force_N) {
  LogNews news;
  news.links = {"link4"};
  news.is_live = true;
  for (int i = 0; i < bins; ++i) {
    news.bins.emplace_back(from_s + 0.01 * i);
    news.bins.back().least_N[0] = news.bins.back().most_N[0] = force_N;
  }
  return news;
}

Json stateOf(const char* run, int x = 0) { return {{"run", run}, {"x", x}}; }

TEST(PanelStateTest, TellsOnlyWhatIsNew) {
  PanelState state;
  Json event = state.update(stateOf("a"), newsWith(0.0, 3, 1.0));
  EXPECT_EQ(event.at("begins"), true);
  EXPECT_EQ(event.at("force").at("t").size(), 3u);
  EXPECT_TRUE(state.update(stateOf("a"), newsWith(0.0, 0, 1.0)).is_null());
  event = state.update(stateOf("a", 1), newsWith(0.0, 0, 1.0));
  EXPECT_EQ(event.dump(), R"({"state":{"run":"a","x":1}})");
  event = state.update(stateOf("a", 1), newsWith(0.1, 1, 2.0));
  EXPECT_EQ(event.dump(), R"({"force":{"t":[0.1],"low":[[2.0]],"high":[[2.0]]}})");
}

TEST(PanelStateTest, ForgetsTheRunBefore) {
  PanelState state;
  LogNews news = newsWith(0.0, 3, 1.0);
  news.contacts = {{{"start_s", 1.0}}};
  state.update(stateOf("a"), news);
  EXPECT_EQ(state.all().at("contacts").size(), 1u);
  EXPECT_EQ(state.update(stateOf("b"), LogNews{}).at("begins"), true);
  EXPECT_TRUE(state.all().at("contacts").empty());
  EXPECT_TRUE(state.all().at("force").at("t").empty());
}

TEST(PanelStateTest, TellsThePastOnceItWasRead) {
  PanelState state;
  LogNews past = newsWith(0.0, 100, 1.0);
  past.is_live = false;
  EXPECT_FALSE(state.update(stateOf("a"), past).contains("force"));
  const Json event = state.update(stateOf("a"), newsWith(1.0, 10, 7.0));
  EXPECT_EQ(event.at("force").at("t").size(), 110u);
}

TEST(PanelStateTest, TellsOfNoContactThatLastsWhereTheLogIsBehind) {
  PanelState state;
  LogNews news = newsWith(0.0, 100, 5.0);
  news.lasting = {{{"start_s", 0.5}}};
  news.is_live = false;  // the past is being read
  state.update(stateOf("a"), news);
  EXPECT_TRUE(state.all().at("lasting").empty());
  news.is_live = true;
  state.update(stateOf("a"), news);
  EXPECT_EQ(state.all().at("lasting").size(), 1u);
  news.problem = "the log has ended";
  state.update(stateOf("a"), news);
  EXPECT_TRUE(state.all().at("lasting").empty());
}

TEST(PanelStateTest, IsBoundedHoweverMuchComes) {
  PanelState state;
  state.update(stateOf("a"), newsWith(0.0, 1, 1.0));
  for (int i = 0; i < 200; ++i) {
    LogNews news = newsWith(i, 100, i == 190 ? 9.0 : 1.0);
    news.contacts = {{{"start_s", i}, {"trace", "long"}}};
    const Json event = state.update(stateOf("a"), news);
    ASSERT_LE(event.at("force").at("t").size(), 40u);
  }
  const Json all = state.all();
  EXPECT_LE(all.at("force").at("t").size(), 1200u);
  EXPECT_GE(all.at("force").at("t").front(), 169.0);
  const Json& high = all.at("force").at("high").front();
  EXPECT_EQ(*std::ranges::max_element(high), 9.0);  // the peak is still there
  EXPECT_EQ(all.at("contacts").size(), 50u);
  EXPECT_FALSE(all.at("contacts").front().contains("trace"));
  EXPECT_TRUE(all.at("contacts").back().contains("trace"));
}

}  // namespace
}  // namespace tactus
