#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/bench/physics_trial.h"

namespace tactus::physics {

/// What an obstacle meets. kRigid: rigid gears and, at the contact, the arm's stiffness in series;
/// kBare: without that; kFlexible: flexible gears, and that of links and cover.
enum class Gears { kRigid, kBare, kFlexible };

struct Case {
  std::string scene;  ///< of config/scenes
  Gears gears = Gears::kRigid;
  double stiffness_N_per_m = 0.0;  ///< of one obstacle, without foam, where the last one of the
                                   ///< scene stands; 0: the scene's own
  double friction_coefficient = 0.0;
};

const char* gearsName(Gears gears);
/// scenes_folder: config/scenes, from here or as installed.
Scene sceneOf(const Case& one, const std::string& scenes_folder);
/// The same with an arm that follows its drives like a line.
Scene quasiStaticSceneOf(const Case& one, const std::string& scenes_folder);

/// The paper's scenes.
std::vector<Case> paperCases();
/// Static contacts from 60 to 1e6 N/m, by null_limit and, fewer, by the paper's law.
std::vector<Case> contactCases();
/// An arm without masses in its files, which are assumed.
std::vector<Case> otherArmCases();

/// The plants, and with half their steps: MuJoCo only where there is something to explain.
struct Comparison {
  Trial quasi_static, built_in, built_in_half, mujoco;
  std::optional<Trial> mujoco_half;

  /// Of the built-in plant's peak, against MuJoCo's with the smallest step tried.
  double error() const;
  /// Halving its own step changes the peak in one of both by more than a tenth.
  bool isChaotic() const;
};

Comparison compare(const Case& one, const std::string& scenes_folder);

}  // namespace tactus::physics
