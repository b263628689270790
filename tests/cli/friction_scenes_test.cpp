#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/closed_loop.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

struct RubbedRun {
  double peak_N = 0.0;
  double rest_N = 0.0;
  JointVector lowest, highest;  ///< where the joints were, m or rad
};

RubbedRun rub(const Scene& scene) {
  test::ClosedLoop loop(scene.controller, scene.plant, scene.period_s);
  RubbedRun run;
  run.lowest = run.highest = scene.controller.q_start;
  while (loop.time_s() < scene.duration_s) {
    loop.step();
    EXPECT_EQ(loop.output().fault, Fault::kNone);
    run.peak_N = std::max(run.peak_N, loop.robot().trueForce_N());
    run.lowest = run.lowest.cwiseMin(loop.output().q_desired);
    run.highest = run.highest.cwiseMax(loop.output().q_desired);
  }
  run.rest_N = loop.robot().trueForce_N();
  return run;
}

/// A scene whose obstacles all rub.
Scene rubbing(const std::string& name, const std::string& arm, double mu, double mu_max) {
  Scene scene = test::shippedScene(name, {{"simulation.arm", arm}});
  for (ObstacleConfig& obstacle : scene.plant.obstacles) obstacle.friction_coefficient = mu;
  scene.controller.force_control->friction_coefficient = mu_max;
  scene.controller.tactile_modules.front().max_force_N = kNoLimit;
  return scene;
}

RubbedRun rub(const std::string& name, const std::string& arm, double mu, double mu_max) {
  return rub(rubbing(name, arm, mu, mu_max));
}

TEST(FrictionScenes, KeepTheForceWhereTheLawWithoutFrictionSlidesOn) {
  for (const char* scene : {"scenario3_tactus", "scenario3_tactus_fast"}) {
    EXPECT_GT(rub(scene, "quasi_static", 0.3, 0.0).rest_N, 10.0) << scene;
    const RubbedRun run = rub(scene, "quasi_static", 0.3, 0.5);
    EXPECT_LT(run.peak_N, 1.05 * 5.0) << scene;
    EXPECT_LT(run.rest_N, 1.05 * 5.0) << scene;
    EXPECT_GT(run.rest_N, 0.9 * 5.0) << scene;
  }
}

TEST(FrictionScenes, KeepItWithMassAndFlexibleGears) {
  for (const char* arm : {"rigid_gears", "flexible_gears"}) {
    const RubbedRun run = rub("scenario3_tactus_fast", arm, 0.3, 0.7);
    EXPECT_LT(run.peak_N, 1.1 * 5.0) << arm;
    EXPECT_LT(run.rest_N, 1.05 * 5.0) << arm;
    EXPECT_GT(run.rest_N, 0.5 * 5.0) << arm;
  }
}

/// The arm as a real one may be, which bounces for good where the law follows each tilt.
TEST(FrictionScenes, ComeToRestOnFlexibleGearsWithOrdinaryRoom) {
  for (const char* name : {"real/real_scenario3", "real/real_scenario3_fast"}) {
    const RubbedRun run = rub(rubbing(name, "flexible_gears", 0.3, 0.5));
    EXPECT_LT(run.peak_N, 1.3 * 5.0) << name;
    EXPECT_NEAR(run.rest_N, 5.0, 0.05 * 5.0) << name;
  }
}

/// With the moment about the link's axis the normal is known, and the law needs no cone: the force
/// at rest is 5 N along the normal, and friction adds to it across.
TEST(FrictionScenes, KeepItWithoutAConeWhereTheMomentAboutTheAxisIsFelt) {
  for (const char* arm : {"quasi_static", "flexible_gears"}) {
    for (const double mu : {0.0, 0.3, 0.5}) {
      SCOPED_TRACE(fmt::format("{}, {}", arm, mu));
      Scene scene = rubbing("scenario3_tactus_fast", arm, mu, 0.0);
      scene.controller.tactile_modules.front().feels_moment_x = true;
      scene.plant.modules.front().channels.moment_x = TactileChannelRow::Constant(0.03);
      scene.plant.modules.front().noise_N = 0.025;  // 0.05 N of force and 2 mNm
      const RubbedRun run = rub(scene);
      const double most_N = 5.0 * std::hypot(1.0, mu);
      EXPECT_LT(run.peak_N, 1.15 * most_N);
      EXPECT_LT(run.rest_N, 1.05 * most_N);
      EXPECT_GT(run.rest_N, 0.8 * 5.0);
    }
  }
}

/// Each joint in turn is left a part of the way that it takes else: the others have to do it.
/// Returns how many of them rest in contact; others do not come to it.
int leaveLessWay(const Scene& free, double share) {
  int touching = 0;
  const RubbedRun undisturbed = rub(free);
  for (int joint = 0; joint < 9; ++joint) {
    const double start = free.controller.q_start[joint];
    for (const double end : {undisturbed.lowest[joint], undisturbed.highest[joint]}) {
      if (std::abs(end - start) < 0.02) continue;
      Scene scene = free;
      JointLimits& limits = scene.controller.limits;
      (end < start ? limits.lower : limits.upper)[joint] = start + share * (end - start);
      const RubbedRun run = rub(scene);
      EXPECT_LT(run.peak_N, 1.05 * 5.0) << joint;
      EXPECT_LT(run.rest_N, 1.05 * 5.0) << joint;
      const double reached = end < start ? run.lowest[joint] : run.highest[joint];
      touching += run.rest_N > 0.8 * 5.0 && std::abs(reached - start) > 0.5 * share * 0.02 ? 1 : 0;
    }
  }
  return touching;
}

/// Without rows for them: up to 146 N.
TEST(FrictionScenes, KeepItWhereAJointComesToItsLimit) {
  for (const char* name : {"scenario3_tactus", "scenario3_tactus_fast"}) {
    for (const bool is_avoided : {true, false}) {
      for (const double share : {0.05, 0.5}) {
        SCOPED_TRACE(fmt::format("{}, {}, {}", name, is_avoided, share));
        Scene free = rubbing(name, "quasi_static", 0.3, 0.5);
        free.controller.has_joint_limit_avoidance = is_avoided;
        EXPECT_GE(leaveLessWay(free, share), 3);
      }
    }
  }
}

/// There rows come in when a limit has cut the retreat for the first time.
TEST(FrictionScenes, KeepItWithoutFrictionWhereAJointComesToItsLimit) {
  int touching = 0;
  for (const bool is_avoided : {true, false}) {
    for (const double share : {0.05, 0.5}) {
      SCOPED_TRACE(fmt::format("{}, {}", is_avoided, share));
      Scene free = rubbing("scenario3_tactus", "quasi_static", 0.0, 0.0);
      free.controller.has_joint_limit_avoidance = is_avoided;
      touching += leaveLessWay(free, share);
    }
  }
  EXPECT_GE(touching, 12);
}

}  // namespace
}  // namespace tactus
