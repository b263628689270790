#include "tactus/cli/robot_draft.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tactus/run/arm_check.h"
#include "tactus/run/clearance_check.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/path_check.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/urdf_bodies.h"
#include "tactus/scene/urdf_capsules.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr double kAssumedToFullSpeed_s = 0.2;
constexpr double kMostAcceleration = 50.0;  ///< rad/s^2 or m/s^2

std::string chooseTip(const SourceFile& urdf, const std::vector<ArmEnd>& ends,
                      const std::string& tip) {
  if (!tip.empty()) return tip;
  if (ends.size() == 1) return ends.front().link;
  std::vector<std::string> names;
  for (const ArmEnd& end : ends)
    names.push_back(fmt::format("{} ({} joints)", inQuotes(end.link), end.moving_joints));
  constexpr std::size_t kShown = 8;
  if (names.size() > kShown) names.erase(names.begin() + kShown, names.end());
  failAt(beginOf(urdf.path), "tip",
         fmt::format("{} links end the arm: {}{}", ends.size(), fmt::join(names, ", "),
                     ends.size() > kShown ? ", ..." : ""),
         "expected --tip with the tool's link");
}

/// The file as robot.yaml in a folder names it. Where the way to the folder has a link in it, ".."
/// would lead elsewhere by the folder's name than on the disk.
std::string referenceFrom(const std::string& folder, const std::string& path) {
  const fs::path robot = fs::absolute(folder) / "robot.yaml";
  const fs::path from = fs::weakly_canonical(robot).parent_path();
  const fs::path urdf = fs::weakly_canonical(fs::absolute(path));
  const bool is_behind_link = from != robot.lexically_normal().parent_path();
  return (is_behind_link ? urdf : urdf.lexically_relative(from)).string();
}

std::vector<double> assumedAcceleration(const UrdfChain& chain) {
  std::vector<double> accelerations;
  for (const double speed : chain.limits.max_velocity) {
    const double exact = std::min(speed / kAssumedToFullSpeed_s, kMostAcceleration);
    const double unit = std::pow(10.0, std::floor(std::log10(exact)) - 1.0);
    accelerations.push_back(unit * std::max(1.0, std::floor(exact / unit * (1.0 + 1e-9))));
  }
  return accelerations;
}

void findMasses(RobotDraft& draft) {
  try {
    for (const BodyInertia& body : loadUrdfBodies(draft.urdf, draft.chain))
      draft.masses_kg.push_back(body.mass_kg);
  } catch (const InputError& error) {
    draft.mass_problem = error.what();
  }
}

Scene loadDraft(const RobotDraft& draft, const std::string& folder) {
  return loadScene({{resolvePath(folder + "/.", "scene.yaml"), draft.scene_text},
                    {resolvePath(folder + "/.", "robot.yaml"), draft.robot_text},
                    {resolvePath(folder + "/.", draft.urdf_reference), draft.urdf.text}},
                   {});
}

std::string commentedOut(const std::string& text) {
  std::string result;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size() - 1) + 1;
    const std::string line = text.substr(from, end - from);
    result += line[0] == '#' ? line : "# " + line;
    from = end;
  }
  return result;
}

/// The joints do not follow, or it is beyond the arm's reach.
bool leadsTooFar(const std::string& folder, const RobotDraft& draft) {
  try {
    return !checkPath(loadDraft(draft, folder)).empty();
  } catch (const InputError&) {
    return true;
  }
}

/// By the Jacobian of the start alone a way may lead too far.
void shortenMotion(const std::string& folder, RobotDraft& draft) {
  constexpr int kHalvings = 6;
  for (int i = 0; i < kHalvings && leadsTooFar(folder, draft); ++i) {
    draft.motion.displacement_m *= 0.5;
    draft.motion.rotation_vector_rad *= 0.5;
    draft.scene_text = draftSceneText(draft);
  }
}

/// As `check --capsules` proposes them, where the robot takes them.
void addCapsules(const std::string& folder, RobotDraft& draft) {
  const Scene scene = loadDraft(draft, folder);
  std::string capsules = proposeCapsules(scene);
  draft.are_radii_assumed = capsules.find("The radius is an assumption") != std::string::npos;
  capsules.erase(0, std::string_view("# For robot.yaml. ").size()).insert(0, "# ");
  try {
    draft.robot_text = draftRobotText(draft, capsules + touchingCapsules(scene, capsules));
    loadDraft(draft, folder);
  } catch (const InputError&) {  // none, or more than a robot takes
    draft.robot_text = draftRobotText(draft, commentedOut(capsules));
  }
}

}  // namespace

RobotDraft draftRobot(const std::string& urdf_path, const std::string& folder,
                      const std::string& tip) {
  RobotDraft draft;
  draft.urdf_path = urdf_path;
  SourceReader reader(readFromDisk);
  draft.urdf = reader.readFirst(urdf_path);
  const std::vector<ArmEnd> ends = armEnds(draft.urdf);
  for (const ArmEnd& end : ends) draft.ends.push_back(end.link);
  draft.tip = chooseTip(draft.urdf, ends, tip);
  draft.urdf_reference = referenceFrom(folder, urdf_path);
  draft.completed = completeLimits(draft.urdf, draft.tip);
  if (!draft.completed.text.empty()) {
    draft.urdf.text = draft.completed.text;
    draft.urdf_reference = fs::path(urdf_path).stem().string() + "_with_limits.urdf";
  }
  draft.chain = loadUrdfChain(draft.urdf, {draft.tip, "tip", beginOf(urdf_path)}, {});
  findMasses(draft);
  draft.max_acceleration = assumedAcceleration(draft.chain);
  const SerialChain chain(draft.chain.joints, draft.chain.tip);
  draft.home = findHome(chain, draft.chain.limits);
  draft.X_BaseTool = tipPose(chain, draft.home.q);
  draft.motion = findFirstMotion(chain, draft.chain.limits, draft.home);
  draft.robot_text = draftRobotText(draft, "");
  draft.scene_text = draftSceneText(draft);
  shortenMotion(folder, draft);
  addCapsules(folder, draft);
  draft.warnings = checkArm(loadDraft(draft, folder));
  return draft;
}

}  // namespace tactus
