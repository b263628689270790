#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "support/shipped_scene.h"
#include "support/written_scene.h"
#include "tactus/daemon/control_requests.h"
#include "tactus/scene/scene_loader.h"

/// Requests that come while gains go back, are kept unseen, or are refused: what the daemon
/// believes of the loop's gains is what the loop has.
namespace tactus {
namespace {

constexpr const char* kTried = "controller.damping";
constexpr const char* kOther = "task.drift_gain_per_s";

class ChangesInBetween : public testing::Test {
 protected:
  Json ask(const Json& request) { return Json::parse(requests_.answer(request.dump())); }
  Json show() { return ask({{"do", "show"}}); }
  Json set(const char* key, double value) {
    return ask({{"do", "set"}, {"values", {{key, value}}}});
  }
  Json setFor(const char* key, double value, double for_s) {
    return ask({{"do", "set"}, {"values", {{key, value}}}, {"for_s", for_s}});
  }

  Json undo() { return ask({{"do", "undo"}}); }

  /// The loop alone: the socket's thread does not look.
  void loop(double duration_s, const GainWatchInput& seen = {.force_N = 5.0}) {
    for (int i = 0; i < static_cast<int>(1e3 * duration_s); ++i) {
      takeOrder();
      change_.update(seen);
      report();
    }
  }
  void pass(double duration_s, const GainWatchInput& seen = {.force_N = 5.0}) {
    for (int i = 0; i < static_cast<int>(50.0 * duration_s); ++i) {
      loop(0.02, seen);
      requests_.look();
    }
  }
  void takeOrder() {
    GainOrder order;
    if (link_->gain_orders.take(order)) change_.order(order);
  }
  void report() {
    if (change_.report() == reported_) return;
    link_->gain_reports.put(reported_ = change_.report());
  }
  void tryGains() {
    set(kTried, 0.8);
    pass(2.0);
    ASSERT_EQ(show().at("state"), "on_trial");
  }
  void keepGains(std::initializer_list<double> values) {
    for (const double value : values) {
      set(kTried, value);
      pass(10.0);
      ASSERT_EQ(show().at("kept").at(kTried), value);
    }
  }
  double running() const { return change_.gains().force.damping; }
  void expectSame(double damping) {
    EXPECT_EQ(running(), damping);
    EXPECT_EQ(change_.kept().force.damping, damping);
    EXPECT_EQ(show().at("kept").at(kTried), damping);
    EXPECT_EQ(show().at("ordered").at(kTried), damping);
    EXPECT_EQ(show().at("state"), "kept");
  }

  const Scene scene_ = test::shippedScene("scenario2_tactus");
  const double before_ = scene_.controller.gains.force.damping;
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
  ControlRequests requests_{scene_, *link_};
  GainChange change_{scene_.controller.gains, 0.001};
  GainReport reported_;
};

TEST_F(ChangesInBetween, ARefusedDurationLeavesTheTrialAsItWas) {
  tryGains();
  EXPECT_EQ(setFor(kTried, 0.9, -1.0).at("done"), false);
  pass(0.1, {.has_fault = true});
  EXPECT_EQ(show().at("trouble"), "the arm has a fault");
  pass(1.0);
  expectSame(before_);
  set(kOther, 3.0);
  pass(10.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, ARefusedUndoLetsTheTrialBeKept) {
  tryGains();
  EXPECT_EQ(ask({{"do", "undo"}, {"for_s", "x"}}).at("done"), false);
  pass(10.0);
  expectSame(0.8);
}

TEST_F(ChangesInBetween, WhatGoesBackDoesNotReturnWithTheNext) {
  tryGains();
  pass(0.06, {.has_fault = true});
  ASSERT_EQ(show().at("state"), "going_back");
  EXPECT_EQ(undo().at("done"), false);
  const Json answer = set(kOther, 3.0);
  EXPECT_EQ(answer.at("changes").size(), 1U);
  EXPECT_EQ(answer.at("ordered").at(kTried), before_);
  pass(20.0);
  expectSame(before_);
  EXPECT_EQ(change_.gains().task.drift_gain_per_s, 3.0);
}

TEST_F(ChangesInBetween, NorDoesWhatWasForATime) {
  setFor(kTried, 0.8, 3.0);
  pass(3.8);
  ASSERT_EQ(show().at("state"), "going_back");
  set(kOther, 3.0);
  pass(30.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, WhatIsForATimeIsNotKeptByTheNext) {
  setFor(kTried, 0.8, 60.0);
  pass(2.0);
  const Json answer = set(kOther, 3.0);
  EXPECT_EQ(answer.at("done"), false);
  EXPECT_NE(answer.at("error").get<std::string>().find("for_s"), std::string::npos);
  EXPECT_EQ(setFor(kOther, 3.0, 60.0).at("done"), true);
  pass(70.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, WhatWasKeptUnseenIsWhereTheNextGoesBackTo) {
  tryGains();
  loop(5.0);
  ASSERT_EQ(change_.report().state, GainState::kKept);
  set(kOther, 3.0);
  pass(1.0);
  pass(0.06, {.has_fault = true});
  pass(10.0);
  expectSame(0.8);
  EXPECT_EQ(undo().at("changes").at(kTried).at("to"), before_);
}

TEST_F(ChangesInBetween, WhatFailedUnseenDoesNotReturn) {
  tryGains();
  loop(0.03, {.has_fault = true});
  loop(0.2);
  ASSERT_EQ(running(), before_);
  set(kOther, 3.0);
  pass(10.0);
  expectSame(before_);
}

/// Between the answer and the cycle that takes the order.
TEST_F(ChangesInBetween, WhatFailsAsTheNextArrivesTakesItAlong) {
  tryGains();
  set(kOther, 3.0);
  change_.update({.has_fault = true});
  loop(1.0);
  requests_.look();
  EXPECT_EQ(show().at("trouble"), "the arm has a fault");
  expectSame(before_);
  EXPECT_NE(change_.gains().task.drift_gain_per_s, 3.0);
}

/// Between the answer and the cycle that takes the order, too.
TEST_F(ChangesInBetween, WhatIsKeptAsTheNextArrivesIsKnown) {
  set(kTried, 0.8);
  pass(5.0);
  for (int i = 0; i < 5000 && change_.report().state != GainState::kKept; ++i) {
    change_.update({.force_N = 5.0});
    if (change_.report().state == GainState::kOnTrial && i == 0) set(kOther, 3.0);
  }
  ASSERT_EQ(change_.report().state, GainState::kKept);
  loop(1.0);
  requests_.look();
  pass(0.06, {.has_fault = true});
  pass(1.0);
  expectSame(0.8);
}

/// A key that waits for a moment without contact.
constexpr const char* kFree = "controller.contact_threshold_N";

TEST_F(ChangesInBetween, WhatWaitsWaitsWithTheNextToo) {
  set(kFree, 0.6);
  pass(1.0);
  ASSERT_EQ(show().at("state"), "waiting");
  set(kOther, 3.0);
  pass(10.0);
  EXPECT_EQ(show().at("state"), "waiting");
  EXPECT_NE(change_.gains().force.contact_threshold_N, 0.6);
  pass(2.0, {});
  EXPECT_EQ(change_.gains().force.contact_threshold_N, 0.6);
  EXPECT_EQ(change_.gains().task.drift_gain_per_s, 3.0);
}

TEST_F(ChangesInBetween, WhatIsOnTrialIsWatchedWhileTheNextWaits) {
  tryGains();
  EXPECT_EQ(set(kFree, 0.6).at("done"), true);
  pass(1.0);
  EXPECT_EQ(running(), 0.8);
  EXPECT_EQ(show().at("state"), "waiting");
  pass(0.06, {.force_N = 5.0, .has_fault = true});
  ASSERT_EQ(show().at("state"), "going_back");
  EXPECT_EQ(set(kFree, 0.6).at("done"), false);
  pass(1.0);
  expectSame(before_);
  EXPECT_EQ(set(kFree, 0.6).at("done"), true);
}

TEST_F(ChangesInBetween, WhatIsForATimeGoesBackWhileTheNextWaits) {
  setFor(kTried, 0.8, 5.0);
  pass(2.0);
  setFor(kFree, 0.6, 5.0);
  pass(1.0);
  EXPECT_EQ(running(), 0.8);
  pass(6.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, AnUndoDoesNotWaitForWhatHasNotBegun) {
  tryGains();
  set(kFree, 0.6);
  pass(1.0);
  ASSERT_EQ(show().at("state"), "waiting");
  undo();
  pass(8.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, AnUndoOfWhatIsKeptMeanwhileIsNoChange) {
  tryGains();
  undo();
  while (change_.report().state != GainState::kKept) change_.update({.force_N = 5.0});
  report();
  requests_.look();
  pass(10.0);
  expectSame(before_);
  EXPECT_EQ(undo().at("done"), false) << "nothing is left to undo";
}

TEST_F(ChangesInBetween, AnUndoOfAnUndoOnItsWayLeadsFurtherBack) {
  keepGains({0.7, 0.8, 0.9});
  undo();
  pass(2.0);
  ASSERT_EQ(show().at("state"), "on_trial");
  undo();
  pass(10.0);
  expectSame(0.7);
  undo();
  pass(10.0);
  expectSame(before_);
  EXPECT_EQ(undo().at("done"), false);
}

TEST_F(ChangesInBetween, AnUndoOfATrialAndAnotherLeadFurtherBackToo) {
  keepGains({0.7, 0.8});
  set(kTried, 0.9);
  pass(2.0);
  undo();
  undo();
  pass(10.0);
  expectSame(0.7);
  undo();
  pass(10.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, AnUndoThatIsKeptUnseenIsOneStepLessForTheNext) {
  keepGains({0.7, 0.8, 0.9});
  undo();
  pass(2.0);
  undo();
  while (change_.report().state != GainState::kKept) change_.update({.force_N = 5.0});
  report();
  requests_.look();
  EXPECT_EQ(change_.kept().force.damping, 0.8);
  pass(10.0);
  expectSame(0.7);
  undo();
  pass(10.0);
  expectSame(before_);
}

/// Two steps lead from 0.8 over 0.7 to 0.8: no gain differs, but the history is shorter.
TEST_F(ChangesInBetween, TwoStepsBackToTheSameGainsAreStepsAllTheSame) {
  keepGains({0.8, 0.7, 0.8});
  undo();
  undo();
  pass(10.0);
  expectSame(0.8);
  undo();
  pass(10.0);
  expectSame(before_);
}

TEST_F(ChangesInBetween, AnUndoOfWhatWasKeptWaitsForAKeyThatWaits) {
  keepGains({0.8});
  set(kFree, 0.6);
  pass(10.0, {});
  keepGains({0.9});
  undo();
  undo();
  pass(1.0);
  EXPECT_EQ(show().at("state"), "waiting");
  undo();
  pass(1.0);
  EXPECT_EQ(show().at("state"), "waiting") << "what runs has the key, too";
  EXPECT_EQ(change_.gains().force.contact_threshold_N, 0.6);
}

TEST_F(ChangesInBetween, NamesThatAreNotKnownAreRefused) {
  for (const char* what : {"set", "reload", "undo", "show", "hold"}) {
    Json request = {{"do", what}, {"values", {{kTried, 0.8}}}, {"dry_run", true}};
    if (request.at("do") != "set") request.erase("values");
    const Json answer = ask(request);
    EXPECT_EQ(answer.at("done"), false) << what;
    EXPECT_NE(answer.at("error").get<std::string>().find("dry_run"), std::string::npos) << what;
  }
  EXPECT_EQ(show().at("number"), 0);
}

TEST(ReadSceneFile, IsNotWhatARefusedReloadSaw) {
  test::WrittenScene file(0.7);
  const auto link = std::make_unique<LoopLink>();
  ControlRequests requests(loadScene(file.path(), {}), *link);
  const auto ask = [&](const char* request) { return Json::parse(requests.answer(request)); };
  const std::string first = file.hash();
  file.write(0.9);
  for (const char* refused :
       {R"({"do": "reload", "for_s": -1})", R"({"do": "reload", "only_read": true})",
        R"({"do": "reload", "only_read": 1})"}) {
    EXPECT_EQ(ask(refused).at("done"), false) << refused;
    EXPECT_EQ(ask(R"({"do": "show"})").at("scene_hash"), first) << "save would write over it";
  }
}

}  // namespace
}  // namespace tactus
