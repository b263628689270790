#include "tactus/daemon/tool_requests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "support/tool_sight.h"
#include "tactus/daemon/control_requests.h"
#include "tactus/scene/reach_check.h"

namespace tactus {
namespace {

using test::placeAtStart;

/// What tells the tool, and the loop's side of the link.
class ToolRequestsTest : public ::testing::Test {
 protected:
  ToolRequestsTest() { see(true); }

  void see(bool is_running) {
    placeAtStart(scene.controller, is_running, sight);
    link.tool_sights.put(sight);
  }

  Json ask(const Json& request) { return Json::parse(requests.answer(request.dump())); }

  std::string refusal(const Json& request) {
    const Json answer = ask(request);
    EXPECT_EQ(answer.at("done"), false) << request;
    ToolOrder order;
    EXPECT_FALSE(link.tool_orders.pop(order)) << "half of it is done: " << request;
    return answer.value("error", "");
  }

  const Scene scene = test::shippedScene("commands");
  LoopLink link;
  ControlRequests requests{scene, link};
  ToolSight sight;
};

TEST_F(ToolRequestsTest, MovesToAPlaceAndTellsHowLongItTakes) {
  const Json answer = ask({{"do", "move"}, {"to_m", {0.95, 0.4, 0.25}}});
  ASSERT_EQ(answer.at("done"), true) << answer;
  EXPECT_EQ(answer.at("task").at("state"), "moving");
  const Vector3 line = Vector3(0.95, 0.4, 0.25) - Vector3(sight.p_BaseTool_m);
  EXPECT_NEAR(answer.at("task").at("duration_s").get<double>(), line.norm() / 0.1 + 0.3, 1e-9);
  ToolOrder order;
  ASSERT_TRUE(link.tool_orders.pop(order));
  EXPECT_EQ(order.number, answer.at("task").at("number"));
  EXPECT_EQ(order.kind, ToolOrder::Kind::kGo);
  EXPECT_EQ(Vector3(order.p_BaseTool_m), Vector3(0.95, 0.4, 0.25));
  EXPECT_EQ(order.R_BaseTool[0], sight.R_BaseTool[0]);
}

TEST_F(ToolRequestsTest, CountsFromWhereTheToolIs) {
  ASSERT_EQ(ask({{"do", "move"},
                 {"to_m", {0.0, 0.1, nullptr}},
                 {"relative", true},
                 {"speed_m_per_s", 0.05}})
                .at("done"),
            true);
  ToolOrder order;
  ASSERT_TRUE(link.tool_orders.pop(order));
  EXPECT_EQ(order.p_BaseTool_m[0], sight.p_BaseTool_m[0]);
  EXPECT_EQ(order.p_BaseTool_m[1], sight.p_BaseTool_m[1] + 0.1);
  EXPECT_EQ(order.p_BaseTool_m[2], sight.p_BaseTool_m[2]);
  EXPECT_EQ(order.limits.position.max_speed, 0.05);
}

TEST_F(ToolRequestsTest, FollowsWaypointsEachFromTheOneBefore) {
  const Json step = {{"to_m", {0.0, 0.05, 0.0}}, {"relative", true}, {"pause_s", 0.5}};
  const Json answer = ask({{"do", "follow"}, {"waypoints", {step, step, step}}});
  ASSERT_EQ(answer.at("done"), true) << answer;
  EXPECT_EQ(answer.at("task").at("waiting"), 2);
  ToolOrder order;
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(link.tool_orders.pop(order));
    EXPECT_NEAR(order.p_BaseTool_m[1], sight.p_BaseTool_m[1] + 0.05 * i, 1e-12);
    EXPECT_EQ(order.kind, i == 1 ? ToolOrder::Kind::kGo : ToolOrder::Kind::kGoNext);
    EXPECT_EQ(order.pause_s, 0.5);
  }
}

/// With a posture, elsewhere than the arm.
class PostureRequestsTest : public ToolRequestsTest {
 protected:
  static Scene leading(const std::string& components) {
    return test::shippedScene("commands", {{"task.components", components},
                                           {"task.max_return_speed_rad_per_s", "0.2"},
                                           {"redundancy.posture.positions",
                                            "[0.1, -0.5, 0.4, 0.5, 0.4, 0.9, 1.0, -0.6, 0.5]"}});
  }
};

TEST_F(PostureRequestsTest, MoveTheToolToWhereItIsThere) {
  for (const char* components : {"[x, y, z]", "[x, z]", "[x, y, z, rx, ry, rz]"}) {
    const Scene led = leading(components);
    ControlRequests asked(led, link);
    link.tool_sights.put(sight);
    const Json answer =
        Json::parse(asked.answer(Json{{"do", "move"}, {"to_posture", true}}.dump()));
    ASSERT_EQ(answer.at("done"), true) << answer;
    ToolOrder order;
    ASSERT_TRUE(link.tool_orders.pop(order));
    const TaskConfig& task = led.controller.task;
    const Pose there = tipPose(led.controller.chain, *led.controller.q_posture);
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(order.p_BaseTool_m[i], task.controls(i) ? there.p_AB[i] : sight.p_BaseTool_m[i]);
    const Matrix3 R =
        Eigen::Map<const Matrix3>(task.hasRotation() ? there.R_AB.data() : sight.R_BaseTool);
    EXPECT_EQ(Matrix3(Eigen::Map<const Matrix3>(order.R_BaseTool)), R);
  }
}

TEST_F(PostureRequestsTest, TellWhichJointIsFarthestFromIt) {
  const Scene led = leading("[x, y, z]");
  ControlRequests asked(led, link);
  const auto posture = [&] {
    return Json::parse(asked.answer(Json{{"do", "show"}}.dump())).at("task").at("posture");
  };
  const JointVector& q = *led.controller.q_posture;
  for (const double away : {0.0095, 0.0105}) {
    std::copy_n(q.data(), q.size(), sight.q);
    sight.q[4] -= away;
    sight.q[5] += 0.009;
    link.tool_sights.put(sight);
    const Json told = posture();
    EXPECT_EQ(told.at("joint"), led.joint_names[4]);
    EXPECT_NEAR(told.at("away").get<double>(), away, 1e-12);
    EXPECT_EQ(told.at("unit"), "rad");
    EXPECT_EQ(told.at("is_there"), away < 0.5 * led.hardware->start_tolerance);
  }
}

TEST_F(PostureRequestsTest, AreRefusedWhereTheyContradict) {
  EXPECT_NE(refusal({{"do", "move"}, {"to_posture", true}}).find("redundancy.posture"),
            std::string::npos)
      << "of a scene without one";
  EXPECT_TRUE(ask({{"do", "show"}}).at("task").at("posture").is_null());
  EXPECT_NE(refusal({{"do", "follow"}, {"waypoints", {{{"to_posture", true}}}}}).find("to_posture"),
            std::string::npos);
  EXPECT_NE(
      refusal({{"do", "move"}, {"to_posture", true}, {"to_m", {1, 0, 0}}}).find("to_m is given"),
      std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_posture", 1}}), "");
  EXPECT_NE(refusal({{"do", "move"}, {"to_posture", false}}).find("or to_posture"),
            std::string::npos);
  EXPECT_NE(
      refusal({{"do", "move"}, {"to_posture", true}, {"relative", true}}).find("relative is given"),
      std::string::npos);
  EXPECT_NE(refusal({{"do", "stream"}, {"to_posture", true}}).find("stream"), std::string::npos);
}

/// A stream to an arm whose task has these components.
Json turned(const std::string& components, const Json& rotate_rad, bool is_relative) {
  const Scene scene = test::shippedScene(
      "commands", {{"task.components", components}, {"task.max_return_speed_rad_per_s", "0.2"}});
  LoopLink link;
  ControlRequests requests(scene, link);
  ToolSight sight;
  placeAtStart(scene.controller, true, sight);
  link.tool_sights.put(sight);
  const Json request = {{"do", "stream"}, {"rotate_rad", rotate_rad}, {"relative", is_relative}};
  return Json::parse(requests.answer(request.dump()));
}

/// Of more than half a turn the other way round is shorter, and the tool would go that.
TEST(TurningToolRequests, RefuseARelativeTurnThatWouldGoTheOtherWayRound) {
  const std::string all = "[x, y, z, rx, ry, rz]";
  EXPECT_EQ(turned(all, {0.0, 0.0, 3.1}, true).at("done"), true);
  EXPECT_EQ(turned(all, {0.0, 0.0, 3.14159265}, true).at("done"), true);
  EXPECT_EQ(turned(all, {0.0, 0.0, 3.141592653589793}, true).at("done"), false) << "to which side";
  const Json far = turned(all, {0.0, 0.0, 3.5}, true);
  EXPECT_EQ(far.at("done"), false);
  EXPECT_NE(far.value("error", "").find("half a turn"), std::string::npos) << far;
  EXPECT_EQ(turned(all, {0.0, 0.0, 3.5}, false).at("done"), true) << "where it ends alone counts";
}

TEST(TurningToolRequests, RefuseARelativeTurnAboutWhatIsNotControlled) {
  const std::string some = "[x, y, z, rz]";
  EXPECT_EQ(turned(some, {0.0, 0.0, 0.1}, true).at("done"), true);
  const Json across = turned(some, {0.1, 0.0, 0.1}, true);
  EXPECT_EQ(across.at("done"), false);
  EXPECT_NE(across.value("error", "").find("rotate_rad[0]"), std::string::npos) << across;
}

TEST(FreeToolRequests, TellHowLongWhatIsControlledTakes) {
  const Scene scene = test::shippedScene("commands", {{"task.components", "[x, y]"}});
  const JointVector& q = scene.controller.q_start;
  const Pose X_BaseTool = tipPose(scene.controller.chain, q);
  Pose target = X_BaseTool;
  target.p_AB += Vector3(0.05, 0.0, 0.3);  // z has drifted meanwhile
  const Reach reach =
      followTo(scene.controller, q, target, scene.controller.task.commands->limits, scene.period_s);
  EXPECT_EQ(reach.problem, "");
  EXPECT_NEAR(reach.duration_s, 0.05 / 0.1 + 0.3, 1e-9);
}

/// The way is looked at in steps, which are long where it takes minutes.
TEST(SlowToolRequests, ReachWhatIsReachedFaster) {
  const std::vector<std::vector<Override>> gains = {
      {{"task.drift_gain_per_s", "20"}}, {{"redundancy.joint_limit_avoidance.gain", "5"}}};
  for (const std::vector<Override>& given : gains) {
    std::vector<Override> overrides = given;
    overrides.push_back({"task.commands.max_speed_m_per_s", "0.001"});
    const Scene scene = test::shippedScene("commands", overrides);
    Pose target = tipPose(scene.controller.chain, scene.controller.q_start);
    target.p_AB.y() += 0.3;
    const Reach reach = followTo(scene.controller, scene.controller.q_start, target,
                                 scene.controller.task.commands->limits, scene.period_s);
    EXPECT_EQ(reach.problem, "") << given.front().key;
    EXPECT_GT(reach.duration_s, 300.0);
  }
}

/// A post in the tool's way.
Scene blockedScene(const std::string& wait_beyond_m) {
  return test::shippedScene(
      "whole_arm/crops9_skin_two_links",
      {{"robot.limits.acceleration", "[2, 2, 2, 2, 2, 2, 2, 2, 2]"},
       {"task.source", "commands"},
       {"task.trajectory", "~"},
       {"task.drift_gain_per_s", "6.48"},
       {"task.max_return_speed_m_per_s", "0.113"},
       {"task.wait_beyond_m", wait_beyond_m},
       {"task.commands",
        "{max_speed_m_per_s: 0.203, max_acceleration_m_per_s2: 1.844, max_jerk_m_per_s3: 7.35}"},
       {"redundancy", "{joint_limit_avoidance: {}}"},
       {"clearance",
        "{safe_distance_m: 0.023, influence_distance_m: 0.0679, keep_out: [{post: {foot_m: "
        "[1.17548, 0.61132, 0.08303], axis: [-0.28508, -0.68783, 0.66755], height_m: 0.5251, "
        "radius_m: 0.0489}}]}"}});
}
const Vector3 kBehindThePost_m(0.37784, 0.02673, 0.08538);

/// A reference that ran ahead would pull the tool round what the arm keeps clear of. One that waits
/// for the tool waits before it for good.
TEST(BlockedToolRequests, AreRefusedWhereTheReferenceWouldWait) {
  const auto problem = [](const std::string& wait_beyond_m) {
    const Scene scene = blockedScene(wait_beyond_m);
    Pose target = tipPose(scene.controller.chain, scene.controller.q_start);
    target.p_AB += kBehindThePost_m;
    return followTo(scene.controller, scene.controller.q_start, target,
                    scene.controller.task.commands->limits, scene.period_s)
        .problem;
  };
  EXPECT_EQ(problem("0.5"), "");
  EXPECT_NE(problem("0.0059").find("out of reach"), std::string::npos);
}

TEST(BlockedToolRequests, AreJudgedByTheGainsThatWereSetLast) {
  const Scene scene = blockedScene("0.0059");
  LoopLink link;
  ControlRequests requests(scene, link);
  ToolSight sight;
  placeAtStart(scene.controller, true, sight);
  link.tool_sights.put(sight);
  const Json to_m = {kBehindThePost_m.x(), kBehindThePost_m.y(), kBehindThePost_m.z()};
  const Json target = {{"to_m", to_m}, {"relative", true}};
  const Json follow = {{"do", "follow"}, {"waypoints", {target}}};
  Json move = target;
  move["do"] = "move";
  const auto isDone = [&](const Json& request) {
    return Json::parse(requests.answer(request.dump())).at("done").get<bool>();
  };
  for (const bool is_set : {false, true}) {
    EXPECT_EQ(isDone(move), is_set);
    EXPECT_EQ(isDone(follow), is_set);
    if (is_set) break;
    ASSERT_TRUE(isDone({{"do", "set"}, {"values", {{"task.wait_beyond_m", 0.5}}}}));
  }
}

/// The tool is still on its way when the reference has ended.
TEST(SlowJointRequests, ReachWhatFastOnesReach) {
  Scene scene = test::shippedScene("commands");
  Pose target = tipPose(scene.controller.chain, scene.controller.q_start);
  target.p_AB.y() += 0.3;
  const ToolMotionLimits& limits = scene.controller.task.commands->limits;
  const auto reach = [&] {
    return followTo(scene.controller, scene.controller.q_start, target, limits, scene.period_s);
  };
  const JointVector q_fast = reach().q_end;
  for (const double velocity : {0.1, 0.05}) {
    scene.controller.limits.max_velocity.setConstant(velocity);
    EXPECT_EQ(reach().problem, "") << velocity;
    EXPECT_LT((reach().q_end - q_fast).norm(), 0.1) << velocity;
  }
  target.p_AB.y() += 5.0;
  EXPECT_NE(reach().problem.find("out of reach"), std::string::npos);
}

TEST_F(ToolRequestsTest, RefusesInOneLineAndDoesNothing) {
  const Json out = {{"do", "move"}, {"to_m", {3.0, 0.0, 0.0}}};
  EXPECT_NE(refusal(out).find("out of reach"), std::string::npos) << refusal(out);
  EXPECT_NE(refusal({{"do", "move"}}).find("no target"), std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 0.3}}}).find("three numbers"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, "x", 0.3}}}).find("to_m[1]"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 1e300, 0.3}}}).find("-100 to 100"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 0.3, 0.3}}, {"speed_m_per_s", 5}}).find("0.1"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 0.3, 0.3}}, {"sped", 5}}).find("sped"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"rotate_rad", {0, 0, 1}}}).find("orientation"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "follow"}, {"waypoints", Json::array()}}).find("waypoints"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 0.3, 0.3}}, {"relative", 5}}).find("relative"),
            std::string::npos);
  const Json far = {{"to_m", {0.9, 0.3, 0.3}}};
  EXPECT_NE(refusal({{"do", "follow"}, {"waypoints", {far, 5}}}).find("no object"),
            std::string::npos);
  const Json flat = {{"to_m", {0.0, 0.0}}};
  const Json here = {{"to_m", {0.0, 0.0, 0.0}}, {"relative", true}};
  EXPECT_EQ(refusal({{"do", "follow"}, {"waypoints", {here, flat}}}),
            "waypoint 2: request: to_m is no vector, expected three numbers");
  Json many = Json::array();
  for (int i = 0; i < 257; ++i) many.push_back(far);
  EXPECT_NE(refusal({{"do", "follow"}, {"waypoints", many}}).find("at most 256"),
            std::string::npos);
}

/// As by Ctrl-C while the way is looked at.
TEST_F(ToolRequestsTest, TellsTheToolNothingForWhoHasLeft) {
  const Json there = {{"to_m", {0.95, 0.4, 0.25}}};
  Json move = there, stream = there;
  move["do"] = "move";
  stream["do"] = "stream";
  for (const Json& request : {move, stream, Json{{"do", "follow"}, {"waypoints", {there}}}}) {
    for (const bool is_asked : {false, true}) {
      const std::string answer =
          requests.answer(request.dump(), {.waits = [=] { return is_asked; }});
      EXPECT_EQ(Json::parse(answer).at("done"), is_asked) << answer;
      ToolOrder order;
      EXPECT_EQ(link.tool_orders.pop(order), is_asked) << request;
    }
  }
  const Json hold = {{"do", "hold"}};
  EXPECT_EQ(Json::parse(requests.answer(hold.dump(), {.waits = [] { return false; }})).at("done"),
            true);
}

/// As many waypoints as there may be take seconds: each is a moment to think better of it.
TEST_F(ToolRequestsTest, ChecksNoMoreWaypointsOnceAHoldComesOrWhoAskedHasLeft) {
  const Json there = {{"to_m", {0.95, 0.4, 0.25}}};
  const Json follow = {{"do", "follow"}, {"waypoints", std::vector<Json>(256, there)}};
  int asked = 0;
  const auto isThird = [&] { return ++asked == 3; };
  const auto refusalOf = [&](const Asker& asker) {
    asked = 0;
    const Json answer = Json::parse(requests.answer(follow.dump(), asker));
    ToolOrder order;
    EXPECT_FALSE(link.tool_orders.pop(order));
    return answer.value("error", "");
  };
  EXPECT_EQ(refusalOf({.hold_comes = isThird}), "a hold has come meanwhile");
  EXPECT_EQ(asked, 3);
  EXPECT_EQ(refusalOf({.waits = [&] { return !isThird(); }}), "who asked has left");
  EXPECT_EQ(asked, 3);
}

TEST_F(ToolRequestsTest, RefusesWhileTheArmDoesNotRun) {
  see(false);
  EXPECT_NE(refusal({{"do", "move"}, {"to_m", {0.9, 0.3, 0.3}}}).find("does not run"),
            std::string::npos);
  EXPECT_NE(refusal({{"do", "hold"}}).find("does not run"), std::string::npos);
  ToolOrder hold;
  EXPECT_FALSE(link.tool_holds.take(hold));
}

TEST_F(ToolRequestsTest, TellsWhatHoldsTheToolOff) {
  ASSERT_EQ(ask({{"do", "move"}, {"to_m", {0.95, 0.4, 0.25}}}).at("done"), true);
  sight.report = {1, ToolState::kBlocked, 0};
  sight.force_N[0] = 4.5;
  sight.position_m[0] = 0.2;
  see(true);
  const Json task = ask({{"do", "show"}}).at("task");
  EXPECT_EQ(task.at("state"), "blocked");
  EXPECT_EQ(task.at("contact").at("force_N"), 4.5);
  EXPECT_EQ(task.at("contact").at("module"), "link4");
  EXPECT_EQ(requests.look(),
            "task: order 1 blocked by a contact of 4.50 N on link4, 0.200 m along it");
  EXPECT_EQ(requests.look(), "");
}

TEST_F(ToolRequestsTest, FullQueuesAreTold) {
  int taken = 0;
  while (ask({{"do", "stream"}, {"to_m", {0.95, 0.3, 0.25}}}).at("done") == true) ++taken;
  EXPECT_EQ(taken, static_cast<int>(LoopLink::kToolOrders));
}

TEST_F(ToolRequestsTest, SlowMovesReachAsFarAsFastOnes) {
  const Json answer = ask({{"do", "move"}, {"to_m", {0.95, 0.4, 0.25}}, {"speed_m_per_s", 0.0001}});
  ASSERT_EQ(answer.at("done"), true) << answer;
  EXPECT_GT(answer.at("task").at("duration_s"), 1000.0);
}

TEST_F(ToolRequestsTest, AStreamHasOneNumber) {
  const Json target = {{"do", "stream"}, {"to_m", {0.95, 0.3, 0.25}}};
  const Json first = ask(target).at("task").at("number");
  EXPECT_EQ(ask(target).at("task").at("number"), first);
  EXPECT_NE(ask({{"do", "move"}, {"to_m", {0.95, 0.3, 0.25}}}).at("task").at("number"), first);
  EXPECT_NE(ask(target).at("task").at("number"), first);
}

/// Whoever holds the tool need not be faster than who streams.
TEST_F(ToolRequestsTest, AHoldHoldsUntilAStreamHasPaused) {
  const Json target = {{"do", "stream"}, {"to_m", {0.95, 0.3, 0.25}}};
  const auto orders = [&] {
    ToolOrder order;
    int count = link.tool_holds.take(order) ? 1 : 0;
    while (link.tool_orders.pop(order)) ++count;
    return count;
  };
  const auto pause = [&](double s) { link.pulse.cycles += std::lround(s / scene.period_s); };
  const double timeout_s = scene.controller.task.commands->stream_timeout_s;
  EXPECT_EQ(ask(target).at("done"), true);
  EXPECT_EQ(ask({{"do", "hold"}}).at("done"), true);
  orders();
  for (int i = 0; i < 5; ++i) {
    pause(0.9 * timeout_s);
    EXPECT_NE(refusal(target).find("a hold or a stop has ended this stream"), std::string::npos);
  }
  EXPECT_EQ(ask({{"do", "hold"}}).at("done"), true);
  EXPECT_EQ(ask({{"do", "move"}, {"to_m", {0.95, 0.3, 0.25}}}).at("done"), true);
  EXPECT_EQ(orders(), 2);
  EXPECT_NE(refusal(target).find("pause for"), std::string::npos) << "after a move, too";
  pause(1.1 * timeout_s);
  EXPECT_EQ(ask(target).at("done"), true);
  EXPECT_EQ(ask(target).at("done"), true);
  pause(1.1 * timeout_s);  // it is late
  EXPECT_EQ(ask({{"do", "hold"}}).at("done"), true);
  EXPECT_EQ(ask(target).at("done"), true) << "another one, that began after the hold";
}

/// Else it would lead the tool on as soon as the arm runs again, unseen. One that is refused while
/// the arm stands still has not paused, either.
TEST_F(ToolRequestsTest, AStopHoldsUntilAStreamHasPaused) {
  const Json target = {{"do", "stream"}, {"to_m", {0.95, 0.3, 0.25}}};
  const double timeout_s = scene.controller.task.commands->stream_timeout_s;
  const auto pause = [&](double share) {
    link.pulse.cycles += std::lround(share * timeout_s / scene.period_s);
  };
  for (const bool is_held : {false, true}) {
    EXPECT_EQ(ask(target).at("done"), true);
    if (is_held) {
      EXPECT_EQ(ask({{"do", "hold"}}).at("done"), true);
    }
    for (ToolOrder order; link.tool_orders.pop(order);) continue;
    see(false);
    for (int i = 0; i < 5; ++i) {
      pause(0.9);
      EXPECT_NE(refusal(target).find("does not run"), std::string::npos);
    }
    ++sight.run;
    see(true);
    for (int i = 0; i < 5; ++i) {
      EXPECT_NE(refusal(target).find("a hold or a stop has ended this stream"), std::string::npos);
      pause(0.9);
    }
    pause(0.2);
    EXPECT_EQ(ask(target).at("done"), true) << "it has paused";
    for (ToolOrder order; link.tool_orders.pop(order);) continue;
    pause(1.1);
  }
}

/// Who streams before the arm runs has not seen it come on, either.
TEST_F(ToolRequestsTest, AStreamThatBeganWhileTheArmStoodStillHasToPause) {
  const Json target = {{"do", "stream"}, {"to_m", {0.95, 0.3, 0.25}}};
  see(false);
  EXPECT_NE(refusal(target).find("does not run"), std::string::npos);
  see(true);
  link.pulse.cycles += 10;
  EXPECT_NE(refusal(target).find("a hold or a stop has ended this stream"), std::string::npos);
  link.pulse.cycles +=
      std::lround(1.1 * scene.controller.task.commands->stream_timeout_s / scene.period_s);
  EXPECT_EQ(ask(target).at("done"), true);
}

/// What its targets wait for here is no pause of who streams.
TEST_F(ToolRequestsTest, AHoldHoldsAStreamWhoseTargetsWaited) {
  const std::string target = R"({"do": "stream", "to_m": [0.95, 0.3, 0.25]})";
  const auto answer = [&](const Asker& asker) {
    return Json::parse(requests.answer(target, asker)).at("done").get<bool>();
  };
  EXPECT_TRUE(answer({}));
  const std::int64_t came = link.pulse.cycles;
  link.pulse.cycles += 1000;  // something took long
  EXPECT_EQ(ask({{"do", "hold"}}).at("done"), true);
  EXPECT_FALSE(answer({.came_after_cycle = came}));
  EXPECT_FALSE(answer({.came_after_cycle = link.pulse.cycles})) << "it has been heard just now";
  link.pulse.cycles += 1000;
  EXPECT_TRUE(answer({.came_after_cycle = link.pulse.cycles}));
}

/// What came before a hold, and is looked at behind it, moves nothing.
TEST_F(ToolRequestsTest, AHoldOvertakes) {
  const Asker overtaken{.is_overtaken = true};
  for (const char* request : {R"({"do": "move", "to_m": [0.95, 0.3, 0.25]})",
                              R"({"do": "stream", "to_m": [0.95, 0.3, 0.25]})",
                              R"({"do": "follow", "waypoints": [{"to_m": [0.95, 0.3, 0.25]}]})"}) {
    const Json answer = Json::parse(requests.answer(request, overtaken));
    EXPECT_EQ(answer.value("error", ""), "a hold has come meanwhile");
    ToolOrder order;
    EXPECT_FALSE(link.tool_orders.pop(order)) << request;
  }
  EXPECT_EQ(Json::parse(requests.answer(R"({"do": "show"})", overtaken)).at("done"), true);
}

TEST(ToolRequestsOfAPath, AreRefused) {
  const Scene scene = test::shippedScene("scenario2_tactus");
  LoopLink link;
  ControlRequests requests(scene, link);
  const Json answer = Json::parse(requests.answer(R"({"do":"move","to_m":[0.9,0.3,0.3]})"));
  EXPECT_NE(answer.at("error").get<std::string>().find("task.source: commands"), std::string::npos);
  EXPECT_EQ(Json::parse(requests.answer(R"({"do":"show"})")).at("task"), nullptr);
}

/// Whatever comes: an answer, and never an order that is not finite and within its limits.
TEST_F(ToolRequestsTest, SurviveDamage) {
  test::Random random(5001);
  const std::vector<std::string> good = {
      R"({"do":"move","to_m":[0.95,0.4,0.25],"speed_m_per_s":0.05,"relative":false})",
      R"({"do":"stream","to_m":[0.95,null,0.25]})", R"({"do":"hold"})",
      R"({"do":"follow","waypoints":[{"to_m":[0.95,0.4,0.25],"pause_s":1},{"to_m":[0,0,0.01],"relative":true}]})"};
  for (int run = 0; run < 3000; ++run) {
    std::string request = good[random.index(4)];
    for (int i = random.integer(1, 4); i > 0; --i) {
      const auto at = static_cast<std::size_t>(random.index(static_cast<int>(request.size())));
      if (random.chance(0.5))
        request[at] = static_cast<char>(random.integer(32, 126));
      else
        request.erase(at, 1);
      if (request.empty()) request = " ";
    }
    const Json answer = Json::parse(requests.answer(request));
    ASSERT_TRUE(answer.at("done").is_boolean());
    ToolOrder order;
    while (link.tool_orders.pop(order)) {
      for (const double p : order.p_BaseTool_m) ASSERT_LE(std::abs(p), 200.0);
      ASSERT_GT(order.limits.position.max_speed, 0.0);
      ASSERT_LE(order.limits.position.max_speed, 0.1);
      ASSERT_GE(order.pause_s, 0.0);
    }
  }
}

}  // namespace
}  // namespace tactus
