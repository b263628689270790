#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "tactus/cli/robot_draft.h"
#include "tactus/math/trajectory.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/urdf_tree.h"
#include "tactus/scene/yaml_word.h"

/// The texts of the files that `tactus init` writes.
namespace tactus {
namespace {

/// A calibration that is of full rank and of no module.
constexpr const char* kModuleDraft = R"(#   interface: FILL_IN
#   first_id: 0x100          # of its four frames
#   link: FILL_IN            # its x axis has to run along the cover, from the cover's start
#   length_m: FILL_IN        # of the cover along x: a ruler
#   cover_radius_m: FILL_IN  # around x: a ruler
#   calibration:             # of no module as init writes it: `calibrate fit --write` replaces it
#     - [1, -1, 0, 0, 1, -1, 0, 0]              # F_y
#     - [0, 0, 1, -1, 0, 0, 1, -1]              # F_z
#     - [0, 0, -0.04, 0.04, 0, 0, -0.26, 0.26]  # M_y, m
#     - [0.04, -0.04, 0, 0, 0.26, -0.26, 0, 0]  # M_z, m
)";

constexpr const char* kGpioDraft = R"(# gpio:
#   chip: FILL_IN            # as gpiochip0
#   e_stop: {line: FILL_IN, active_low: FILL_IN}   # input, active: stop
#   enable: {line: FILL_IN, active_low: FILL_IN}   # input, active: the arm may move
#   brake: {line: FILL_IN, active_low: FILL_IN}    # output, active: brakes released
)";

constexpr const char* kControllerDraft = R"(
# Once robot.yaml has a tactile module, and `tactus calibrate` has measured it. docs/tuning.md says
# what else the arm may do in a contact, and how to choose the gains.
# controller:
#   variant: null_limit      # the null space gives way, and the tool where that would not do
#   activation_force_N: 4    # ASSUMED: what may push on the cover, beside the threshold of 1.2 N
# stiffness:
#   assumed_N_per_m: 2000    # ASSUMED
)";

bool isPrismatic(const RobotDraft& draft, std::size_t joint) {
  return draft.chain.joints[joint].type == JointType::kPrismatic;
}

bool isEndless(const RobotDraft& draft, std::size_t joint) {
  const auto j = static_cast<Eigen::Index>(joint);
  return !(draft.chain.limits.upper[j] - draft.chain.limits.lower[j] < kNoLimit);
}

const char* unitOf(const RobotDraft& draft, std::size_t joint) {
  return isPrismatic(draft, joint) ? "m" : "rad";
}

std::string said(double value, const char* unit) {
  return std::abs(value) < kNoLimit ? fmt::format("{:.4g} {}", value, unit) : std::string("-");
}

std::string jointTable(const RobotDraft& draft) {
  std::string text = fmt::format("#   {:<20}{:>14}{:>14}{:>14}{:>12}{:>12}\n", "joint", "from",
                                 "to", "speed", "effort", "its mass");
  for (std::size_t i = 0; i < draft.chain.joints.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(i);
    const char* unit = unitOf(draft, i);
    const std::string mass = i < draft.masses_kg.size() && draft.masses_kg[i] > 0.0
                                 ? fmt::format("{:.4g} kg", draft.masses_kg[i])
                                 : "-";
    text += fmt::format(
        "#   {:<20}{:>14}{:>14}{:>14}{:>12}{:>12}\n", escaped(draft.chain.joint_names[i]),
        said(draft.chain.limits.lower[j], unit), said(draft.chain.limits.upper[j], unit),
        said(draft.chain.limits.max_velocity[j], isPrismatic(draft, i) ? "m/s" : "rad/s"),
        said(draft.chain.max_effort[j], isPrismatic(draft, i) ? "N" : "Nm"), mass);
  }
  if (!draft.mass_problem.empty())
    text += "# Masses could not be read: " + escaped(draft.mass_problem) + "\n";
  return text;
}

std::string assumedLimitsText(const RobotDraft& draft) {
  std::string text;
  for (const AssumedLimit& limit : draft.completed.assumed)
    text += fmt::format("# ASSUMED in the URDF's copy, as {} has none: {} of joint {}. Measure.\n",
                        escaped(draft.urdf_path), limit.what, escaped(limit.joint));
  return text;
}

/// Three drives fill a bus at 1 kHz and 1 Mbit/s.
std::string drivesDraft(const RobotDraft& draft) {
  constexpr std::size_t kDrivesABus = 3;
  const std::size_t joints = draft.chain.joints.size();
  std::string text = "# can:\n#   buses:\n";
  for (std::size_t bus = 0; bus * kDrivesABus < joints; ++bus)
    text += fmt::format("#     - {{interface: can{}}}\n", bus);
  text += "# drives:\n#   joints:\n";
  for (std::size_t i = 0; i < joints; ++i)
    text += fmt::format(
        "#     - {{joint: {}, interface: can{}, node_id: {}, counts_per_{}: FILL_IN}}{}\n",
        yamlWord(draft.chain.joint_names[i]), i / kDrivesABus, i % kDrivesABus + 1,
        unitOf(draft, i),
        isEndless(draft, i) ? "  # its counts end: needs limits in the URDF" : "");
  return text;
}

/// On the way to the tip or fixed to it, behind at least one joint.
bool canCarryModule(const RobotDraft& draft, const UrdfTree& tree, int link) {
  while (link >= 0) {
    const auto on_chain = std::ranges::find(draft.chain.links, link, &PlacedLink::link);
    if (on_chain != draft.chain.links.end()) return on_chain->frame.joint >= 0;
    const UrdfJoint& joint = tree.joints[tree.joint_above[link]];
    if (joint.type != "fixed") return false;
    link = joint.parent;
  }
  return false;
}

std::string moduleLinksText(const RobotDraft& draft) {
  UrdfTree tree;
  parseUrdf(draft.urdf, tree);
  std::string text;
  std::string line = "#   # The links that a module may be around:";
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (!canCarryModule(draft, tree, static_cast<int>(i))) continue;
    const std::string word = " " + yamlWord(tree.links[i]);
    constexpr std::size_t kLongestLine = 100;
    if (line.size() + word.size() > kLongestLine) {
      text += line + "\n";
      line = "#   #  ";
    }
    line += word;
  }
  return text + line + "\n";
}

std::string draftTaskText(const RobotDraft& draft) {
  return fmt::format("{}", fmt::join(draftTask(draft), ", "));
}

std::string lineText(const Waypoint& way) {
  const bool turns = !way.rotation_vector_rad.isZero();
  const Vector3& v = turns ? way.rotation_vector_rad : way.displacement_m;
  return fmt::format("{{{}: {}, {}: {:.6g}}}", turns ? "rotation_vector_rad" : "displacement_m",
                     numberList(v.data(), 3), turns ? "angular_speed_rad_per_s" : "speed_m_per_s",
                     turns ? way.angular_speed_rad_per_s : way.speed_m_per_s);
}

}  // namespace

const std::vector<UnknownPart>& unknownParts() {
  static const std::vector<UnknownPart> parts = {
      {"buses, node ids, counts, signs and offsets of the drives", "tactus commission"},
      {"GPIO lines of e-stop, enable and brake",
       "gpioinfo and the cabinet's drawing; tactus doctor"},
      {"link, length and radius of the tactile module", "a ruler"},
      {"calibration of the tactile module", "tactus calibrate record, then fit"},
  };
  return parts;
}

std::vector<std::string> draftTask(const RobotDraft& draft) {
  const TaskConfig& task = draft.home.task;
  std::vector<std::string> words;
  for (int i = 0; i < task.size; ++i)
    words.emplace_back(wordOf(kComponentWords, task.components[i]));
  return words;
}

std::string numberList(const double* values, std::size_t count) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < count; ++i)
    words.push_back(fmt::format("{:.6g}", values[i] == 0.0 ? 0.0 : values[i]));
  return fmt::format("[{}]", fmt::join(words, ", "));
}

std::string draftRobotText(const RobotDraft& draft, const std::string& capsules) {
  const Vector3& tool = draft.X_BaseTool.p_AB;
  std::string text = fmt::format(
      "# {}, begun by `tactus init` from its URDF: what is ASSUMED, and what FILL_IN stands for,\n"
      "# somebody has to look at. docs/robot.md leads from here to the first touch.\nurdf: {}\n"
      "tip: {}\n\n",
      escaped(draft.chain.robot_name), yamlWord(draft.urdf_reference), yamlWord(draft.tip));
  text += fmt::format(
      "# The tool is at ({:.4f}, {:.4f}, {:.4f}) m then; smallest singular value for {}: {:.3g}.\n"
      "# Far from limits and singular poses by calculation: look what the arm would touch there.\n"
      "home: {}\n\n",
      tool.x(), tool.y(), tool.z(), draftTaskText(draft), draft.home.smallest_singular_value,
      numberList(draft.home.q.data(), static_cast<std::size_t>(draft.home.q.size())));
  text +=
      "# Limits of position, speed and effort are the URDF's; lower them there to what drives and\n"
      "# cables bear.\n" +
      assumedLimitsText(draft) + jointTable(draft);
  text += fmt::format(
      "limits:\n  # ASSUMED: full speed within 0.2 s, at most 50. Take it from the drives' "
      "sheets.\n"
      "  acceleration: {}  # m/s^2 or rad/s^2\n\n",
      numberList(draft.max_acceleration.data(), draft.max_acceleration.size()));
  text += capsules + (capsules.empty() ? "" : "\n");
  text +=
      "# What no URDF says. Fill in, and take away the # before:\n"
      "# - buses and drives. Counts per m or rad within a factor of ten, from encoder and gear: "
      "`tactus\n#   commission` finds their exact number, signs and offsets, and which drive moves "
      "which joint.\n#   Buses and node ids below are an order to begin with, three drives a "
      "bus.\n" +
      drivesDraft(draft);
  text += "# - the tactile module, if there is one:\n# tactile_module:\n" + moduleLinksText(draft) +
          kModuleDraft;
  return text +
         "# - the lines of e-stop, enable and brake: gpioinfo lists them, `tactus doctor` looks "
         "whether they\n#   are free. Without enable tactusd moves the arm as soon as it is "
         "started.\n" +
         kGpioDraft;
}

std::string draftSceneText(const RobotDraft& draft) {
  constexpr double kStart_s = 0.5;
  const double end_s = Trajectory({kStart_s, {draft.motion}}, Pose{}).end_s();
  return fmt::format(
             "# A first motion without contact: small and slow.\nrobot: robot.yaml\n\ntask:\n"
             "  components: [{}]\n  trajectory:\n    start_s: {}\n    line: {}\n\n"
             "simulation:\n  duration_s: {}\n",
             draftTaskText(draft), kStart_s, lineText(draft.motion), std::ceil(end_s) + 1.0) +
         kControllerDraft;
}

}  // namespace tactus
