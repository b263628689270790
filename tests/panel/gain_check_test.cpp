#include "tactus/panel/gain_check.h"

#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/gain_plan.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

class GainCheckTest : public testing::Test {
 protected:
  Json checkOf(const Json& values, const Scene& running) {
    return check_.check(RunStart{scene_.sources, scene_.overrides}, shown(running), values);
  }
  Json checkOf(const Json& values) { return checkOf(values, scene_); }

  static Json shown(const Scene& running) {
    Json ordered = Json::object();
    for (const GainKey& key : gainKeys())
      ordered[key.path] = gainAt(running.controller.gains, key.offset);
    // As it comes over the socket: what is infinite is null.
    return Json::parse(Json{{"scene", "-"}, {"ordered", ordered}}.dump());
  }

  const Scene scene_ = test::shippedScene("commands");
  GainCheck check_;
};

TEST_F(GainCheckTest, SaysWhatTactusCheckSaysOfTheSceneWithTheseValues) {
  for (const char* T_s : {"0.09", "0.1", "0.2", "0.4"}) {
    const Json answer = checkOf({{"controller.time_constant_s", T_s}});
    const Scene changed = loadScene(scene_.sources, {{"controller.time_constant_s", T_s}});
    EXPECT_DOUBLE_EQ(answer.at("margin_deg"), phaseMargin_deg(changed)) << T_s;
    EXPECT_EQ(answer.at("running_deg"), phaseMargin_deg(scene_));
  }
}

TEST_F(GainCheckTest, RefusesWithTheWordsOfTheDaemon) {
  const double least_deg = leastMargin_deg(scene_);
  for (const Override& setting : std::vector<Override>{{"controller.time_constant_s", "0.02"},
                                                       {"controller.damping", "0"},
                                                       {"controller.variant", "none"},
                                                       {"no.such", "1"}}) {
    std::string reason;
    try {
      planSettings(scene_, {setting}, least_deg);
    } catch (const InputError& error) {
      reason = error.what();
    }
    ASSERT_FALSE(reason.empty()) << setting.key;
    EXPECT_EQ(checkOf({{setting.key, setting.value}}).at("refused"), reason);
  }
}

TEST_F(GainCheckTest, CountsFromWhatRunsAndNotFromTheStart) {
  const Scene running = loadScene(scene_.sources, {{"controller.damping", "0.8"}});
  const Json answer = checkOf({{"controller.time_constant_s", "0.15"}}, running);
  const Scene both = loadScene(
      scene_.sources, {{"controller.damping", "0.8"}, {"controller.time_constant_s", "0.15"}});
  EXPECT_DOUBLE_EQ(answer.at("margin_deg"), phaseMargin_deg(both));
  EXPECT_DOUBLE_EQ(answer.at("running_deg"), phaseMargin_deg(running));
  EXPECT_DOUBLE_EQ(checkOf(Json::object(), scene_).at("running_deg"), phaseMargin_deg(scene_));
}

/// Of the same files and gains, as after a start with another --set.
TEST_F(GainCheckTest, JudgesByTheSettingsOfTheLastStart) {
  const Scene other = loadScene(scene_.sources, {{"controller.variant", "null_task"}});
  checkOf(Json::object());
  const Json answer =
      check_.check(RunStart{other.sources, other.overrides}, shown(scene_), Json::object());
  EXPECT_NE(phaseMargin_deg(other), phaseMargin_deg(scene_));
  EXPECT_EQ(answer.at("running_deg"), phaseMargin_deg(other));
}

TEST_F(GainCheckTest, TellsWhatWaitsForAMomentWithoutContact) {
  EXPECT_EQ(checkOf({{"controller.contact_threshold_N", "1.3"}}).at("waits_for_free"), true);
  EXPECT_EQ(checkOf({{"controller.damping", "0.6"}}).at("waits_for_free"), false);
}

TEST_F(GainCheckTest, TakesTextsAlone) {
  for (const Json& values : {Json(1), Json::array(), Json{{"controller.damping", 0.6}},
                             Json{{"controller.damping", nullptr}}})
    EXPECT_THROW(checkOf(values), InputError) << values;
}

}  // namespace
}  // namespace tactus
