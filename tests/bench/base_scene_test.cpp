#include "tactus/bench/base_scene.h"

#include <gtest/gtest.h>

#include "tactus/bench/arm_bases.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

const std::string kScenes = TACTUS_SOURCE_DIR "/config/scenes/";

std::string refusalOf(const std::string& scene, const BaseNeeds& needs) {
  try {
    loadBase(kScenes + scene, needs);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A study would read what is not there.
TEST(BaseScene, IsRefusedWhereItLacksWhatAStudyVaries) {
  EXPECT_EQ(refusalOf("scenario2_estimated.yaml", {.obstacles = 2}), "");
  EXPECT_NE(refusalOf("free_motion.yaml", {}).find("controller.variant: "), std::string::npos);
  const std::string few = refusalOf("robots/kuka_iiwa7_contact.yaml", {.obstacles = 2});
  EXPECT_NE(few.find("simulation.obstacles: "), std::string::npos) << few;
  EXPECT_NE(few.find("expected at least 2"), std::string::npos) << few;
  const std::string one = refusalOf("scenario2_estimated.yaml", {.modules = 2});
  EXPECT_NE(one.find("expected at least 2"), std::string::npos) << one;
  EXPECT_NE(refusalOf("commands.yaml", {}).find("task.trajectory: "), std::string::npos);
  EXPECT_THROW(armBases(kScenes + "free_motion.yaml"), InputError);
}

}  // namespace
}  // namespace tactus
