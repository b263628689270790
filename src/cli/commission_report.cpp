#include "tactus/cli/commission_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/cli/commission_text.h"
#include "tactus/record/fault_text.h"

namespace tactus {
namespace {

const DriveConfig* driveAt(const Scene& scene, const FoundNode& node) {
  for (const DriveConfig& drive : scene.hardware->drives)
    if (drive.bus == node.bus && drive.node_id == node.node_id) return &drive;
  return nullptr;
}

std::string hexOf(const std::optional<std::uint32_t>& value) {
  return value ? fmt::format("{:#010x}", *value) : std::string("none");
}

bool answers(const DriveConfig& drive, const std::vector<FoundNode>& nodes) {
  return std::ranges::any_of(nodes, [&](const FoundNode& node) {
    return node.bus == drive.bus && node.node_id == drive.node_id;
  });
}

std::string strokeText(const Scene& scene, int joint, const StrokeReport& stroke) {
  const SetupFailure& refused = stroke.drive.setup_failure;
  if (stroke.end == StrokeEnd::kWrongWay)
    return "its counts run against the command: encoder and motor of the drive disagree in sense; "
           "set its polarity (607E), or its wiring, right";
  if (stroke.end == StrokeEnd::kMovedAway)
    return fmt::format(
        "it moved by {} before it was told to: is it pushed, does it run away as its brake opens, "
        "or do its counts jump?",
        lengthText(scene, joint, stroke.detail.value));
  if (stroke.fault == Fault::kDriveSetupRefused && refused.index != 0)
    return "the drive refuses its set-up at " +
           refusalText(scene.hardware->drives[joint], stroke.drive);
  if (stroke.fault == Fault::kFollowingError)
    return fmt::format(
        "it does not follow, up to {} behind the command; is it stuck, or its "
        "brake closed?",
        lengthText(scene, joint, stroke.detail.value));
  std::string text =
      fmt::format("{}: {}", faultName(stroke.fault), faultRow(stroke.fault).detection);
  if (stroke.drive.emergency_code != 0)
    text += fmt::format("; emergency code {:#06x}", stroke.drive.emergency_code);
  return text;
}

}  // namespace

std::string nodesText(const Scene& scene, const std::vector<FoundNode>& nodes) {
  std::string text;
  for (const FoundNode& node : nodes) {
    const DriveConfig* const drive = driveAt(scene, node);
    text += fmt::format(
        "{:<22} vendor {} product {}  {}, {}\n", placeText(scene, node.bus, node.node_id),
        hexOf(node.vendor), hexOf(node.product), node.isDrive() ? "drive (402)" : "no 402 device",
        drive ? "in the file of " + jointText(scene, drive->joint) : "not in the file");
    if (node.isDrive() && !node.has_speed_limit)
      text +=
          "    has no limit of speed (607F): a setpoint that is changed on its way may move it at "
          "any speed\n";
    if (node.has_twin) text += "    two devices answer to this id: one of them needs another\n";
    if (node.node_id == scene.hardware->canopen.master_node_id)
      text += "    has the id of can.master_node_id: one of the two needs another\n";
  }
  for (const DriveConfig& drive : scene.hardware->drives)
    if (!answers(drive, nodes))
      text +=
          fmt::format("{:<22} does not answer, in the file of {}\n",
                      placeText(scene, drive.bus, drive.node_id), jointText(scene, drive.joint));
  return text;
}

Json nodesJson(const Scene& scene, const std::vector<FoundNode>& nodes) {
  const auto orNull = [](const auto& value) { return value ? Json(*value) : Json(); };
  Json found = Json::array(), missing = Json::array();
  for (const FoundNode& node : nodes) {
    const DriveConfig* const drive = driveAt(scene, node);
    found.push_back(
        {{"interface", scene.hardware->buses[static_cast<std::size_t>(node.bus)].interface},
         {"node_id", node.node_id},
         {"device_type", orNull(node.device_type)},
         {"vendor", orNull(node.vendor)},
         {"product", orNull(node.product)},
         {"is_drive", node.isDrive()},
         {"counts_per_turn", orNull(node.counts_per_turn)},
         {"has_twin", node.has_twin},
         {"has_speed_limit", node.has_speed_limit},
         {"joint",
          drive ? Json(scene.joint_names[static_cast<std::size_t>(drive->joint)]) : Json()}});
  }
  for (const DriveConfig& drive : scene.hardware->drives)
    if (!answers(drive, nodes))
      missing.push_back(
          {{"interface", scene.hardware->buses[static_cast<std::size_t>(drive.bus)].interface},
           {"node_id", drive.node_id},
           {"joint", scene.joint_names[static_cast<std::size_t>(drive.joint)]}});
  return {{"nodes", found}, {"missing", missing}};
}

std::string protectionText(const HardwareConfig& hardware) {
  std::string text;
  const auto& gpio = hardware.gpio;
  if (!gpio || !gpio->e_stop) text += "no e_stop line: this program does not see an e-stop\n";
  if (!gpio || !gpio->enable)
    text +=
        "no enable line: nothing but this program and the drives' own watch over its heartbeat "
        "ends a motion; have a switch at hand that takes the drives' power\n";
  if (!gpio || !gpio->brake)
    text +=
        "no brake line: a joint is held only by brakes that its drive opens and closes itself\n";
  else if (hardware.drives.size() > 1)
    text +=
        "one brake line for all joints: while one moves, the brakes of all are open, and the "
        "others "
        "have no power; support what would fall\n";
  return text;
}

std::string findingsText(const Scene& scene, const JointFindings& found) {
  const int joint = found.joint;
  const char* const unit = unitOf(scene.controller.chain.type(joint));
  static constexpr const char* kSources[] = {"measured",
                                             "as its drive says, confirmed by measuring",
                                             "as in the file, confirmed by measuring"};
  const JointScale& scale = found.scale;
  std::string text = fmt::format(
      "{}: {}, sign {:+}, {:.6g} counts/{} ({}; measured to {:.2g} %), offset {:.5g} {}\n",
      jointText(scene, joint), placeText(scene, found.bus, found.node_id), scale.sign,
      scale.counts_per_unit, unit, kSources[static_cast<std::size_t>(found.source)],
      100.0 * scale.uncertainty, scale.offset, unit);
  if (found.drive_counts_per_unit && found.source != ScaleSource::kDrive)
    text += fmt::format(
        "  its drive says {:.6g} counts/{} (608F, 6091): a gear that it does not know of?\n",
        *found.drive_counts_per_unit, unit);
  text += fmt::format(
      "  following error {}, lag {:.2g} ms with bus and cycle, acceleration {:.3g} {}/s^2 "
      "reached\n",
      lengthText(scene, joint, found.following_error), 1e3 * found.lag_s, found.acceleration, unit);
  const JointLimits& limits = scene.controller.limits;
  const auto compare = [&](const char* name, const std::optional<double>& end, double urdf,
                           bool is_upper) {
    if (!end) {
      text += fmt::format("  {} end not told\n", name);
      return;
    }
    text += fmt::format("  {} end {:.4g} {}, the URDF says {:.4g}", name, *end, unit, urdf);
    const bool is_beyond = is_upper ? urdf > *end : urdf < *end;
    text += is_beyond ? ": change the URDF, it lets the joint go too far\n" : "\n";
  };
  compare("upper", found.upper, limits.upper[joint], true);
  compare("lower", found.lower, limits.lower[joint], false);
  const double at_speed = found.lag_s * limits.max_velocity[joint];
  const double bears = scene.hardware->drives[static_cast<std::size_t>(joint)].max_following_error;
  if (std::isfinite(at_speed) && at_speed > 0.5 * bears)
    text += fmt::format(
        "  at the URDF's {:.3g} {}/s it is {:.3g} {} behind, of max_following_error_{} {:.3g}\n",
        limits.max_velocity[joint], unit, at_speed, unit, unit, bears);
  return text;
}

std::string troubleText(const Scene& scene, int joint, const JointTrouble& trouble) {
  const std::string who = placeText(scene, trouble.bus, trouble.node_id);
  const std::string name = jointText(scene, joint);
  const auto because = [&]() -> std::string {
    switch (trouble.kind) {
      case JointTroubleKind::kNone:
        return "nothing";
      case JointTroubleKind::kStopped:
        return "stopped";
      case JointTroubleKind::kNoNode:
        return "no drive that answers moves it, beside those of other joints";
      case JointTroubleKind::kNodeSilent:
        return who + " no longer answers";
      case JointTroubleKind::kTwoDevices:
        return fmt::format(
            "two devices answer as {}, and would move together: one needs another id", who);
      case JointTroubleKind::kOtherHasPower:
        return fmt::format("{} has power (status word {:#06x}): who commands it?", who,
                           static_cast<unsigned>(trouble.value));
      case JointTroubleKind::kOtherSilent:
        return who + " no longer answers, so that nobody knows whether it has power";
      case JointTroubleKind::kStroke:
        return who + ": " + strokeText(scene, joint, trouble.stroke);
      case JointTroubleKind::kMovedBetween:
        return fmt::format(
            "it moved by {:.0f} counts while {} had no power: does its brake hold, and does its "
            "encoder keep its counts?",
            trouble.value, who);
      case JointTroubleKind::kMovedShort:
        return fmt::format("it went {:.0f} counts of {:.0f}, and {} says nothing of it",
                           trouble.value, trouble.limit, who);
      case JointTroubleKind::kFewerCounts:
        return fmt::format(
            "the places that were measured allow at most {:.4g} counts/{}, but no fewer than "
            "{:.4g} "
            "were expected: it moved further than it should; if the places are right, set its "
            "counts in robot.yaml right, or raise --file-factor",
            trouble.value, unitOf(scene.controller.chain.type(joint)), trouble.limit);
      case JointTroubleKind::kStillOpen:
        return fmt::format(
            "{:.0f} motions were not enough to tell its counts from the places that were measured: "
            "are its counts in robot.yaml far too few?",
            trouble.value);
      case JointTroubleKind::kSignsDisagree:
        return "the way it was seen to go, and the places that were measured, have opposite senses";
      case JointTroubleKind::kCannotTell:
        return fmt::format(
            "the places that were measured contradict each other, by {} where {} would be told",
            lengthText(scene, joint, trouble.value), lengthText(scene, joint, trouble.limit));
    }
    return {};
  };
  return fmt::format("{} is not finished: {}\n", name, because());
}

}  // namespace tactus
