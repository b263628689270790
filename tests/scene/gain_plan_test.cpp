#include "tactus/scene/gain_plan.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>

#include "support/random.h"
#include "support/scene_files.h"
#include "support/shipped_scene.h"
#include "tactus/control/gain_ramp.h"
#include "tactus/control/joint_limit_avoidance.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/key_docs.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

using Settings = std::vector<Override>;

GainPlan plan(const Scene& running, const Settings& settings) {
  return planSettings(running, settings, leastMargin_deg(running));
}

/// What a change is refused with; empty: it is not.
std::string refusal(const Scene& running, const Settings& settings) {
  try {
    plan(running, settings);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(GainPlan, LaysSettingsOverWhatRuns) {
  const Scene running = test::shippedScene("scenario2_tactus", {{"controller.damping", "0.9"}});
  const GainPlan changed =
      plan(running, {{"controller.time_constant_s", "0.15"}, {"task.drift_gain_per_s", "4"}});
  EXPECT_EQ(changed.scene.controller.gains.force.time_constant_s, 0.15);
  EXPECT_EQ(changed.scene.controller.gains.task.drift_gain_per_s, 4.0);
  EXPECT_EQ(changed.scene.controller.gains.force.damping, 0.9);
  EXPECT_FALSE(changed.waits_for_free);
  EXPECT_EQ(changed.keys,
            (std::vector<std::string>{"controller.time_constant_s", "task.drift_gain_per_s"}));
  const GainPlan next = plan(changed.scene, {{"controller.contact_threshold_N", "1"}});
  EXPECT_EQ(next.scene.controller.gains.force.time_constant_s, 0.15);
  EXPECT_TRUE(next.waits_for_free);
}

/// A daemon may be told for months.
TEST(GainPlan, DoesNotGrowWithTheNumberOfChanges) {
  const Scene started = test::shippedScene("scenario2_tactus", {{"controller.damping", "0.9"}});
  Scene running = started;
  for (const char* T_s : {"0.15", "0.12", "0.11", "0.13"})
    running =
        plan(running, {{"controller.time_constant_s", T_s}, {"controller.damping", "0.8"}}).scene;
  EXPECT_EQ(running.overrides.size(), 2u);
  EXPECT_EQ(running.controller.gains.force.time_constant_s, 0.13);
  EXPECT_EQ(running.controller.gains.force.damping, 0.8);
}

TEST(GainPlan, SpeedLimitsAreLoweredAtOnceAndRaisedWithoutContact) {
  const Scene running = test::shippedScene("scenario2_tactus");
  const auto waits = [&](const char* value) {
    return plan(running, {{"controller.max_null_speed_rad_per_s", value}}).waits_for_free;
  };
  EXPECT_FALSE(waits("1"));
  EXPECT_TRUE(waits("6"));
}

/// The paper's laws of two spaces bounce on stiff obstacles, and between two sets of gains some
/// push several times harder.
TEST(GainPlan, LawsOfTwoSpacesWaitForAMomentWithoutContact) {
  for (const char* variant : {"null_task", "null_joint", "null_space", "task_space"}) {
    const Scene running =
        test::shippedScene("scenario2_estimated", {{"controller.variant", variant}});
    const bool has_two =
        std::string(variant) == "null_task" || std::string(variant) == "null_joint";
    EXPECT_EQ(plan(running, {{"controller.time_constant_s", "0.2"}}).waits_for_free, has_two)
        << variant;
    EXPECT_FALSE(plan(running, {}).waits_for_free) << "nothing changes";
  }
}

TEST(GainPlan, RefusesWhatNeedsARestart) {
  const Scene running = test::shippedScene("scenario2_estimated");
  const Settings live = {{"controller.damping", "0.6"}};
  for (const auto& [key, value] : Settings{{"controller.variant", "null_space"},
                                           {"controller.order", "1"},
                                           {"period_s", "0.002"},
                                           {"simulation.obstacles[0].x_m", "0.6"},
                                           {"task.trajectory.line.speed_m_per_s", "0.01"},
                                           {"robot.home[0]", "0.01"},
                                           {"stiffness.stiffest_N_per_m", "9000"}}) {
    Settings settings = live;
    settings.push_back({key, value});
    EXPECT_NE(refusal(running, settings).find("needs a restart"), std::string::npos) << key;
  }
}

/// Not the scene's line that names robot.yaml, which nobody has touched.
TEST(GainPlan, NamesTheRobotsKeyThatNeedsARestart) {
  const Scene running = test::shippedScene("scenario2_estimated", {{"robot.home[1]", "0.02"}});
  EXPECT_EQ(refusal(running, {{"controller.damping", "0.6"}, {"robot.home[0]", "0.01"}}),
            "--set robot.home[0]:1:1: robot.home[0]: needs a restart, nothing is changed, expected "
            "keys that `tactus keys` calls live or free");
}

/// With the key a stage would begin to exist.
TEST(GainPlan, RefusesSectionsThatDoNotExist) {
  const Scene running = test::shippedScene("scenario2_assumed");
  EXPECT_NE(refusal(running, {{"stiffness.estimate.max_N_per_m", "1e4"}}).find("restart"),
            std::string::npos);
  EXPECT_EQ(refusal(running, {{"controller.transition.distance_m", "0.04"}}), "");
}

/// A stage begins or ends with them, though no key of theirs is written anywhere.
TEST(GainPlan, RefusesSectionsWithoutKeysThatComeOrGo) {
  const auto loaded = [](const std::string& value) {
    return test::SceneFiles{}.load({{"redundancy.joint_limit_avoidance", value}});
  };
  const Scene without = loaded("~"), empty = loaded("{}"), written = loaded("{gain: 1}");
  const auto refusal_of = [](const Scene& running, const Scene& changed) -> std::string {
    try {
      planChange(running, changed, 0.0);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  const std::string key = "redundancy.joint_limit_avoidance: ";
  for (const Scene& there : {empty, written}) {
    EXPECT_NE(refusal_of(without, there).find(key + "is new and needs a restart"),
              std::string::npos);
    EXPECT_NE(refusal_of(there, without).find(key + "is gone, which needs a restart"),
              std::string::npos);
  }
  EXPECT_EQ(refusal_of(empty, written), "");
  EXPECT_EQ(refusal_of(written, loaded("{gain: 2}")), "");
}

TEST(GainPlan, RefusesAsAStartWould) {
  const Scene running = test::shippedScene("scenario2_tactus");
  EXPECT_NE(refusal(running, {{"controller.dampin", "1"}}).find("damping"), std::string::npos);
  EXPECT_NE(refusal(running, {{"controller.damping", "high"}}).find("a number"), std::string::npos);
  EXPECT_NE(refusal(running, {{"controller.damping", "nan"}}), "");
  EXPECT_NE(refusal(running, {{"controller.damping", "-1"}}).find("> 0"), std::string::npos);
  EXPECT_NE(refusal(running, {{"task.drift_gain_per_s", "2000"}}).find("too high"),
            std::string::npos);
}

/// And says which T would do: that one does.
TEST(GainPlan, RefusesGainsWithoutMargin) {
  const Scene running = test::shippedScene("scenario2_estimated");
  const std::string text = refusal(running, {{"controller.time_constant_s", "0.02"}});
  ASSERT_NE(text.find("expected at least "), std::string::npos) << text;
  double T_s = 0.0;
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("at least "), "at least %lf s", &T_s), 1) << text;
  EXPECT_EQ(refusal(running, {{"controller.time_constant_s", std::to_string(T_s)}}), "");
  EXPECT_NE(refusal(running, {{"controller.time_constant_s", std::to_string(0.95 * T_s)}}), "");
  // It speaks of what was asked for, not of the way there.
  const std::string near = refusal(running, {{"controller.time_constant_s", "0.07"}});
  EXPECT_NE(near.find("controller.time_constant_s: 0.07 s leaves"), std::string::npos) << near;
}

/// Likewise, and neither may gains pass on their way what they may not have at its end.
TEST(GainPlan, RefusesLimitsThatAreTooSteep) {
  const std::string gain = "redundancy.joint_limit_avoidance.gain";
  const std::string gradient = "redundancy.joint_limit_avoidance.gradient_at_limit";
  const Scene running = test::shippedScene("scenario2_tactus");
  const std::string text = refusal(running, {{gain, "1000"}});
  ASSERT_NE(text.find(gain + ": 1000 is too steep"), std::string::npos) << text;
  double most = 0.0;
  ASSERT_EQ(std::sscanf(text.c_str() + text.find("at most "), "at most %lf", &most), 1) << text;
  EXPECT_EQ(refusal(running, {{gain, std::to_string(most)}}), "");
  EXPECT_NE(refusal(running, {{gain, std::to_string(1.01 * most)}}), "");
  EXPECT_NE(
      refusal(running, {{"redundancy.joint_limit_avoidance.active_fraction", "0.0005"}}).find(gain),
      std::string::npos);
  const Scene steep = plan(running, {{gain, std::to_string(most)}}).scene;
  const std::string way = refusal(steep, {{gain, std::to_string(0.01 * most)}, {gradient, "352"}});
  EXPECT_NE(way.find("too steep"), std::string::npos) << way;
  EXPECT_NE(way.find("on the way there"), std::string::npos) << way;
}

/// What a step does to offsets in their zones has no eigenvalue above 1 at the bound, and with
/// nothing but the null space it has 1.
TEST(GainPlan, BoundsTheStepOffLimitsByItsSteepestJoint) {
  test::Random random(27);
  for (int i = 0; i < 200; ++i) {
    const int n = random.integer(2, 9), m = random.integer(0, n - 1);
    Scene scene = test::shippedScene("scenario2_tactus");
    ControllerConfig& config = scene.controller;
    config.limits.lower = random.vector(n, -3.0, -0.1);
    config.limits.upper = random.vector(n, 0.1, 3.0);
    config.weights = random.vector(n, 0.1, 10.0);
    JointLimitAvoidanceGains gains{1.0, random.uniform(0.5, 9.0), random.uniform(0.1, 1.0)};
    gains.gain = gains.active_fraction /
                 (scene.period_s * gains.gradient_at_limit * gainUse(config).narrowest_range);
    config.gains.joint_limit_avoidance = gains;
    config.gains.joint_limit_avoidance.gain = 0.999 * gains.gain;
    EXPECT_FALSE(findGainConflict(config.gains, gainUse(config), scene.period_s));
    config.gains.joint_limit_avoidance.gain = 1.001 * gains.gain;
    EXPECT_TRUE(findGainConflict(config.gains, gainUse(config), scene.period_s));
    const Eigen::VectorXd inv_sqrt = config.weights.cwiseSqrt().cwiseInverse();
    const ScaledVector inv_sqrt_scaled = scaled(JointVector(inv_sqrt), ScaledVector::Ones());
    const Eigen::VectorXd slope =
        JointLimitAvoidance(config.limits, inv_sqrt_scaled).zones(gains).slope.head(n);
    Eigen::MatrixXd N = Eigen::MatrixXd::Identity(n, n);
    for (int row = 0; row < m; ++row) {
      const Eigen::VectorXd a = N * random.vector(n, -1.0, 1.0);
      N -= a * a.transpose() / a.squaredNorm();
    }
    const Eigen::MatrixXd step =
        scene.period_s * inv_sqrt.asDiagonal() * N * Eigen::MatrixXd(slope.asDiagonal());
    const double largest = step.eigenvalues().real().maxCoeff();
    EXPECT_LE(largest, 1.0 + 1e-9);
    if (m == 0) {
      EXPECT_NEAR(largest, 1.0, 1e-9);
    }
  }
}

/// A scene that has less from the start may be changed for the better.
TEST(GainPlan, AcceptsMoreMarginThanBefore) {
  Scene running = test::shippedScene("scenario2_estimated");
  double T_s = 0.1;
  while (phaseMargin_deg(running) >= kMinPhaseMargin_deg)
    running = test::shippedScene("scenario2_estimated",
                                 {{"controller.time_constant_s", std::to_string(T_s *= 0.95)}});
  ASSERT_GT(phaseMargin_deg(running), 0.0);
  EXPECT_EQ(refusal(running, {{"controller.time_constant_s", std::to_string(1.01 * T_s)}}), "");
  EXPECT_NE(refusal(running, {{"controller.time_constant_s", std::to_string(0.99 * T_s)}}), "");
}

/// Whatever is accepted is within all ranges on all of its way.
TEST(GainPlan, WhatIsAcceptedIsFitOnTheWay) {
  test::Random random(1911);
  const Scene running = test::shippedScene("scenario2_tactus");
  const GainUse use = gainUse(running.controller);
  int accepted = 0;
  for (int i = 0; i < 80; ++i) {
    const GainKey& key = gainKeys()[random.index(static_cast<int>(gainKeys().size()))];
    const double now = gainAt(running.controller.gains, key.offset);
    if (!std::isfinite(now)) continue;
    const Settings settings = {{key.path, std::to_string(now * random.logUniform(0.5, 2.0))}};
    if (!refusal(running, settings).empty()) continue;
    ++accepted;
    const Gains to = plan(running, settings).scene.controller.gains;
    for (int k = 0; k <= 20; ++k) {
      const Gains between = gainsBetween(running.controller.gains, to, k / 20.0);
      ASSERT_FALSE(findGainProblem(between, use, running.period_s)) << settings[0].key;
    }
  }
  EXPECT_GT(accepted, 20);
}

TEST(GainPlan, AReloadIsOfTheFilesAsTheyAre) {
  namespace fs = std::filesystem;
  const std::string folder = testing::TempDir() + "tactus_reload";
  fs::create_directories(folder);
  const std::string path = folder + "/scene.yaml";
  const auto write = [&](const std::string& rest) {
    std::ofstream(path) << "extends: " TACTUS_SOURCE_DIR "/config/scenes/scenario2_tactus.yaml\n"
                        << rest;
  };
  write("controller:\n  damping: 0.7\n");
  const Scene running = loadScene(path, {});
  EXPECT_TRUE(planReload(running, {}, kMinPhaseMargin_deg).keys.empty());
  write("# a comment\ncontroller:\n  damping: 0.8\n");
  const GainPlan changed = planReload(running, {}, kMinPhaseMargin_deg);
  EXPECT_EQ(changed.keys, std::vector<std::string>{"controller.damping"});
  EXPECT_EQ(changed.scene.controller.gains.force.damping, 0.8);
  EXPECT_TRUE(
      planReload(running, {{"controller.damping", "0.7"}}, kMinPhaseMargin_deg).keys.empty());
  for (const char* wrong : {"controller:\n  variant: null_space\n", "controller:\n  damping: no\n",
                            "controller: [\n", "log:\n  keep: 3\n"}) {
    write(wrong);
    try {
      planReload(running, {}, kMinPhaseMargin_deg);
      ADD_FAILURE() << wrong;
    } catch (const InputError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with(path + ":")) << error.what();
    }
  }
  fs::remove_all(folder);
}

TEST(GainContext, AllGainsCanBeChangedAndNothingElse) {
  int gains = 0;
  for (const KeyRow& row : keyRows(sceneKeys())) {
    const auto found = std::ranges::find(gainKeys(), row.path, &GainKey::path);
    const bool is_gain = found != gainKeys().end();
    EXPECT_EQ(is_gain, row.spec->context != KeyContext::kRestart) << row.path;
    gains += is_gain ? 1 : 0;
  }
  EXPECT_EQ(gains, static_cast<int>(gainKeys().size()));
  for (const KeyRow& row : keyRows(robotKeys()))
    EXPECT_EQ(row.spec->context, KeyContext::kRestart) << row.path;
}

}  // namespace
}  // namespace tactus
