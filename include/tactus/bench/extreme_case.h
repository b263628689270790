#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tactus/control/robot.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A law as the scene's values that choose it. To try another one: a line in extreme_laws.cpp.
struct ExtremeLaw {
  std::string name;
  std::vector<Override> overrides;
};
const std::vector<ExtremeLaw>& extremeLaws();

/// One row of the table of extremes: what is changed in the base scene, config/scenes/base/
/// crops9_contact.yaml, whose arm follows a line.
struct ExtremeCase {
  std::string group;
  std::string name;
  std::vector<Override> overrides{};
  /// What no key of a scene says, and what depends on where the arm starts.
  std::function<void(Scene& scene)> change{};
  /// What the tactile module says instead of what it felt.
  std::function<void(double t_s, TactileSample& sample)> reading{};
  bool is_long = false;  ///< takes minutes to hours of virtual time
};

/// All of them, group by group.
std::vector<ExtremeCase> extremeCases();

// The groups; each function appends its own.
void addContactCases(std::vector<ExtremeCase>& cases);
void addObstacleCases(std::vector<ExtremeCase>& cases);
void addSensorCases(std::vector<ExtremeCase>& cases);
void addPoseCases(std::vector<ExtremeCase>& cases);
void addGainCases(std::vector<ExtremeCase>& cases);
void addLongCases(std::vector<ExtremeCase>& cases);

/// The obstacles of the paper's scenes, as YAML; `rest` is more keys, as ", vanishes_s: 10".
std::string bandText(double stiffness_N_per_m, const std::string& rest = "");
std::string profileText(double stiffness_N_per_m, const std::string& rest = "");
Override obstaclesAre(const std::vector<std::string>& texts);

/// The line at a multiple of its speed, with time to come to rest behind it.
void setSpeed(double factor, std::vector<Override>& overrides);
/// No line: the tool stays where it is.
void setHold(double duration_s, std::vector<Override>& overrides);

void makeArmRigid(Scene& scene);

/// A vertical line beside the cover of the arm as it starts.
struct Beside {
  double along_share = 0.5;  ///< of the module's length
  double side = 1.0;         ///< +-1: left or right of the link
  double gap_m = 0.01;       ///< between cover and line; negative: inside
};
/// Adds it; its swing, if it has a frequency, goes `swing_m` towards the cover and back.
void addBeside(const Beside& place, double stiffness_N_per_m, double swing_m, double frequency_hz,
               double vanishes_s, Scene& scene);

}  // namespace tactus
