#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/home_pose.h"
#include "tactus/scene/scene.h"
#include "tactus/scene/urdf_completion.h"
#include "tactus/scene/urdf_loader.h"

namespace tactus {

/// What a URDF cannot say, and what finds it.
struct UnknownPart {
  std::string what, how;
};
const std::vector<UnknownPart>& unknownParts();

/// What `tactus init` makes of a URDF; nothing of it is on the disk yet.
struct RobotDraft {
  std::string urdf_path;          ///< as given
  std::string urdf_reference;     ///< as robot.yaml names it
  SourceFile urdf;                ///< that robot.yaml names, by its path
  CompletedUrdf completed;        ///< text is empty where the URDF is used as it is
  std::vector<std::string> ends;  ///< links that nothing hangs on
  std::string tip;
  UrdfChain chain;
  std::vector<double> masses_kg;         ///< that move with each joint alone; empty: not known
  std::string mass_problem;              ///< why not
  bool are_radii_assumed = false;        ///< of capsules on the ways from joint to joint
  std::vector<double> max_acceleration;  ///< assumed
  HomePose home;
  Pose X_BaseTool;  ///< there
  Waypoint motion;
  std::string robot_text, scene_text;
  std::vector<std::string> warnings;  ///< what `tactus check` will doubt about the arm
};

/// robot.yaml and scene.yaml of a folder, for a URDF. tip: empty means the only end. They are
/// loaded before this returns. Throws InputError.
RobotDraft draftRobot(const std::string& urdf_path, const std::string& folder,
                      const std::string& tip);

/// Its parts as text.
std::string draftRobotText(const RobotDraft& draft, const std::string& capsules);
std::string draftSceneText(const RobotDraft& draft);

/// The components of its task, as a scene spells them.
std::vector<std::string> draftTask(const RobotDraft& draft);

/// "[0.1, -0.2]", each number as short as it is exact to six digits.
std::string numberList(const double* values, std::size_t count);

}  // namespace tactus
