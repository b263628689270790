#include "tactus/daemon/control_requests.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "support/written_scene.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

/// A daemon without a loop of its own: what the loop would do with orders, in virtual time.
class ControlRequestsTest : public testing::Test {
 protected:
  Json ask(const Json& request) { return Json::parse(requests_.answer(request.dump())); }
  Json set(const char* key, double value) {
    return ask({{"do", "set"}, {"values", {{key, value}}}});
  }

  void pass(double duration_s, const GainWatchInput& seen = {.force_N = 5.0}) {
    for (int i = 0; i < static_cast<int>(1e3 * duration_s); ++i) {
      GainOrder order;
      if (link_->gain_orders.take(order)) change_.order(order);
      change_.update(seen);
      link_->gain_reports.put(change_.report());
      if (const std::string news = requests_.look(); !news.empty()) news_ = news;
    }
  }
  double damping() const { return change_.gains().force.damping; }

  const Scene scene_ = test::shippedScene("scenario2_tactus");
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
  ControlRequests requests_{scene_, *link_};
  GainChange change_{scene_.controller.gains, 0.001};
  std::string news_;
};

constexpr const char* kDamping = "controller.damping";

/// Clients may be in another folder.
TEST_F(ControlRequestsTest, NamesItsSceneByTheWholePath) {
  const test::WrittenScene written(0.7);
  const std::string path = std::filesystem::relative(written.path()).string();
  ControlRequests requests(loadScene(path, {}), *link_);
  const Json answer = Json::parse(requests.answer(R"({"do": "show"})"));
  EXPECT_EQ(std::filesystem::path(answer.at("scene").get<std::string>()).lexically_normal(),
            std::filesystem::path(written.path()).lexically_normal());
}

TEST_F(ControlRequestsTest, SetsAndTellsWhatBecomesOfIt) {
  const double before = damping();
  const Json answer = set(kDamping, 0.8);
  EXPECT_EQ(answer.at("done"), true) << answer;
  EXPECT_EQ(answer.at("changes"), Json({{kDamping, {{"from", before}, {"to", 0.8}}}}));
  EXPECT_EQ(answer.at("kept").at(kDamping), before);
  EXPECT_EQ(answer.at("ordered").at(kDamping), 0.8);
  pass(0.1);
  EXPECT_EQ(ask({{"do", "show"}}).at("state"), "ramping");
  pass(1.0);
  EXPECT_EQ(ask({{"do", "show"}}).at("state"), "on_trial");
  EXPECT_EQ(damping(), 0.8);
  pass(5.0);
  const Json kept = ask({{"do", "show"}});
  EXPECT_EQ(kept.at("state"), "kept");
  EXPECT_EQ(kept.at("kept").at(kDamping), 0.8);
  EXPECT_EQ(news_, "gains: change 1 kept");
}

TEST_F(ControlRequestsTest, NothingOfAChangeWithAMistakeHappens) {
  const Json answer = ask({{"do", "set"}, {"values", {{kDamping, 0.8}, {"controller.order", 1}}}});
  EXPECT_EQ(answer.at("done"), false);
  EXPECT_NE(answer.at("error").get<std::string>().find("restart"), std::string::npos);
  GainOrder order;
  EXPECT_FALSE(link_->gain_orders.take(order));
}

TEST_F(ControlRequestsTest, UndoesWhatWasKeptAndWhatWasNot) {
  const double first = damping();
  EXPECT_EQ(ask({{"do", "undo"}}).at("done"), false);
  set(kDamping, 0.8);
  pass(6.0);
  set(kDamping, 0.9);
  pass(1.0);
  EXPECT_EQ(damping(), 0.9);
  EXPECT_EQ(ask({{"do", "undo"}}).at("done"), true);
  pass(6.0);
  EXPECT_EQ(damping(), 0.8);
  ask({{"do", "undo"}});
  pass(6.0);
  EXPECT_EQ(damping(), first);
}

TEST_F(ControlRequestsTest, TellsWhyGainsWentBack) {
  const double before = damping();
  pass(1.0);
  set(kDamping, 0.8);
  pass(1.0);
  pass(0.01, {.has_fault = true});
  pass(2.0);
  EXPECT_EQ(damping(), before);
  const Json shown = ask({{"do", "show"}});
  EXPECT_EQ(shown.at("trouble"), "the arm has a fault");
  EXPECT_EQ(news_, "gains: change 1 gone back: the arm has a fault");
  EXPECT_EQ(shown.at("ordered").at(kDamping), before);
  EXPECT_EQ(ask({{"do", "undo"}}).at("done"), false) << "nothing was kept";
}

TEST_F(ControlRequestsTest, AReloadOfNothingNewHasNoTroubleOfAChangeBefore) {
  set(kDamping, 0.8);
  pass(1.0);
  pass(0.01, {.has_fault = true});
  pass(2.0);
  EXPECT_NE(ask({{"do", "show"}}).at("trouble"), "");
  const Json answer = ask({{"do", "reload"}});
  EXPECT_EQ(answer.at("done"), true);
  EXPECT_TRUE(answer.at("changes").empty());
  EXPECT_EQ(answer.at("trouble"), "");
}

TEST_F(ControlRequestsTest, GoesBackAfterItsTime) {
  ask({{"do", "set"}, {"values", {{kDamping, 0.8}}}, {"for_s", 3}});
  pass(2.0);
  EXPECT_EQ(damping(), 0.8);
  pass(3.0);
  EXPECT_NE(damping(), 0.8);
  EXPECT_EQ(ask({{"do", "show"}}).at("trouble"), "3 s are over");
}

TEST_F(ControlRequestsTest, RefusesWhatIsNoRequest) {
  for (const char* text : {"",
                           "[]",
                           "1",
                           "{",
                           "{}",
                           R"({"do":1})",
                           R"({"do":"jump"})",
                           R"({"do":"set"})",
                           R"({"do":"set","values":{}})",
                           R"({"do":"set","values":{"controller.damping":[1]}})",
                           R"({"do":"set","values":{"controller.damping":{}}})",
                           R"({"do":"set","values":{"controller.damping":1e999}})",
                           R"({"do":"set","values":{"controller.damping":"nan"}})",
                           R"({"do":"set","values":{"controller.damping":true}})",
                           R"({"do":"set","values":{"":1}})",
                           R"({"do":"set","values":{"..":1}})",
                           R"({"do":"set","values":{"controller.damping":0.8},"for_s":-1})",
                           R"({"do":"set","values":{"controller.damping":0.8},"for_s":"x"})",
                           "\xff\xfe",
                           "\0"}) {
    const Json answer = Json::parse(requests_.answer(text));
    EXPECT_EQ(answer.at("done"), false) << text;
    EXPECT_FALSE(answer.at("error").get<std::string>().empty()) << text;
  }
  GainOrder order;
  EXPECT_FALSE(link_->gain_orders.take(order));
}

TEST_F(ControlRequestsTest, TakesATimeWithinWhatItSays) {
  const auto refusal = [&](double for_s) {
    const Json answer = ask({{"do", "set"}, {"values", {{kDamping, 0.8}}}, {"for_s", for_s}});
    return answer.at("done").get<bool>() ? "" : answer.at("error").get<std::string>();
  };
  const std::string range = "expected 0.001 to 86400";
  for (const double for_s : {-1.0, 0.0, 0.9e-3, 86400.1})
    EXPECT_NE(refusal(for_s).find(range), std::string::npos) << for_s << ": " << refusal(for_s);
  EXPECT_EQ(ask({{"do", "set"}, {"values", {{kDamping, 0.8}}}, {"for_s", nullptr}}).at("error"),
            "request: for_s is no number, expected one");
  EXPECT_EQ(refusal(0.001), "");
  EXPECT_EQ(refusal(86400.0), "");
}

/// Of a good request, some bytes are others.
TEST_F(ControlRequestsTest, SurvivesDamage) {
  test::Random random(1921);
  const std::string good = R"({"do":"set","values":{"controller.damping":0.8},"for_s":60})";
  for (int i = 0; i < 3000; ++i) {
    std::string text = good;
    for (int k = random.integer(1, 3); k > 0; --k)
      text[static_cast<std::size_t>(random.index(static_cast<int>(text.size())))] =
          static_cast<char>(random.integer(0, 255));
    const Json answer = Json::parse(requests_.answer(text), nullptr, false);
    ASSERT_TRUE(answer.is_object() && answer.contains("done")) << text;
  }
}

/// What `tactus save` wrote, and the daemon has read, is no change of somebody else's, whatever
/// gains come after.
TEST(SavedSceneFile, IsTheOneThatWasReadAfterAnUndoToo) {
  test::WrittenScene file(0.7);
  const std::string first = file.hash();
  const auto link = std::make_unique<LoopLink>();
  ControlRequests requests(loadScene(file.path(), {}), *link);
  const auto ask = [&](const char* request) { return Json::parse(requests.answer(request)); };
  ask(R"({"do": "set", "values": {"controller.damping": 0.8}})");
  EXPECT_EQ(ask(R"({"do": "show"})").at("scene_hash"), first);
  file.write(0.8);
  const std::string saved = file.hash();
  EXPECT_EQ(ask(R"({"do": "reload"})").at("scene_hash"), saved);
  EXPECT_EQ(ask(R"({"do": "undo"})").at("scene_hash"), saved);
  EXPECT_EQ(ask(R"({"do": "set", "values": {"controller.damping": 0.9}})").at("scene_hash"), saved);
  std::ofstream(file.path()) << "controller: [";
  EXPECT_EQ(ask(R"({"do": "reload"})").at("done"), false);
  EXPECT_EQ(ask(R"({"do": "show"})").at("scene_hash"), saved);
}

}  // namespace
}  // namespace tactus
