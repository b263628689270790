#include "tactus/scene/drive_loader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "tactus/canopen/moteus_frames.h"
#include "tactus/scene/key_words.h"

namespace tactus {
namespace {

constexpr double kTurns_per_rad = 1.0 / (2.0 * std::numbers::pi);

int findJoint(const LoadingRobot& l, const std::string& joint, const std::string& path) {
  const std::vector<std::string>& names = l.chain.joint_names;
  const auto found = std::ranges::find(names, joint);
  if (found == names.end()) {
    l.fail(path, inQuotes(joint) + " is no moving joint on the way to the tip",
           fmt::format("one of {}", fmt::join(names, ", ")));
  }
  return static_cast<int>(found - names.begin());
}

/// What is given in the unit of the joint. The other unit is refused.
DriveUnits chooseUnits(const LoadingRobot& l, const DriveSection& drive, int joint,
                       const std::string& path) {
  const bool is_prismatic = l.chain.joints[joint].type == JointType::kPrismatic;
  const std::string unit = is_prismatic ? "m" : "rad";
  const std::string other_unit = is_prismatic ? "rad" : "m";
  const DriveUnits& other = is_prismatic ? drive.radians : drive.metres;
  const auto refuse = [&](const std::optional<double>& value, const std::string& stem) {
    if (!value) return;
    l.fail(fmt::format("{}.{}{}", path, stem, other_unit),
           fmt::format("joint {} is {}", inQuotes(drive.joint),
                       is_prismatic ? "prismatic" : "revolute"),
           stem + unit);
  };
  refuse(other.counts_per_unit, "counts_per_");
  refuse(other.turns_per_unit, "turns_per_");
  refuse(other.offset, "offset_");
  refuse(other.max_following_error, "max_following_error_");
  DriveUnits units = is_prismatic ? drive.metres : drive.radians;
  const bool is_moteus = drive.config.kind == DriveKind::kMoteus;
  std::optional<double>& given = is_moteus ? units.turns_per_unit : units.counts_per_unit;
  const std::string key = (is_moteus ? "turns_per_" : "counts_per_") + unit;
  if (is_moteus ? units.counts_per_unit : units.turns_per_unit) {
    l.fail(fmt::format("{}.{}_per_{}", path, is_moteus ? "counts" : "turns", unit),
           fmt::format("the drive is of kind {}", wordOf(kDriveKindWords, drive.config.kind)), key);
  }
  if (!given && is_moteus && !is_prismatic) given = kTurns_per_rad;
  if (!given) l.fail(path + "." + key, "is missing", "a number in 1/" + unit);
  units.counts_per_unit = given;
  return units;
}

/// A moteus is on CAN FD, and has no CANopen to be told about.
void checkMoteus(const LoadingRobot& l, const DriveSection& drive, const DriveConfig& config,
                 const std::string& path) {
  if (!l.can.buses[config.bus].data_bit_rate_per_s) {
    l.fail(path + ".kind", fmt::format("a moteus on {}, which is classic CAN", drive.interface),
           "a bus with data_bit_rate_per_s");
  }
  for (const auto& [key, file] : {std::pair{".eds", &drive.eds}, {".profile", &drive.profile}})
    if (*file) l.fail(path + key, "a moteus is no CANopen device", "not this key");
}

/// Positions and velocities are counts in an INTEGER32 on the bus; of a moteus they are turns, of
/// which its float tells 1e-3 at this many.
void checkCounts(const LoadingRobot& l, const DriveConfig& drive, const std::string& path) {
  constexpr double kMaxTurns = 1e4;
  const bool is_moteus = drive.kind == DriveKind::kMoteus;
  const double kMaxCount = is_moteus ? kMaxTurns : std::numeric_limits<std::int32_t>::max();
  const JointLimits& limits = l.chain.limits;
  const bool is_prismatic = l.chain.joints[drive.joint].type == JointType::kPrismatic;
  const std::string key =
      fmt::format("{}.{}_per_{}", path, is_moteus ? "turns" : "counts", is_prismatic ? "m" : "rad");
  const double farthest = std::max(std::abs(limits.lower[drive.joint] - drive.offset),
                                   std::abs(limits.upper[drive.joint] - drive.offset)) +
                          drive.max_following_error;
  if (!std::isfinite(farthest)) {
    l.fail(path + ".joint", "the joint turns without limits, and its counts would overflow",
           "a joint with limits in the URDF");
  }
  const double largest = std::max(farthest, limits.max_velocity[drive.joint]);
  if (drive.counts_per_unit * largest > kMaxCount) {
    l.fail(key,
           fmt::format("{:.4g} {}", drive.counts_per_unit * largest,
                       is_moteus ? "turns at the joint's limits are too many"
                                 : "counts at the joint's limits do not fit into 32 bits"),
           fmt::format("at most {:.6g}",
                       is_moteus ? kMaxCount / largest : std::floor(kMaxCount / largest)));
  }
}

DriveConfig makeDrive(const LoadingRobot& l, std::size_t i) {
  const DriveSection& given = l.config.drives.joints[i];
  const std::string path = fmt::format("drives.joints[{}]", i);
  DriveConfig drive = given.config;
  drive.joint = findJoint(l, given.joint, path + ".joint");
  drive.bus = findBus(l, given.interface, path + ".interface");
  if (drive.sign == 0) l.fail(path + ".sign", "'0' is no sign", "1 or -1");
  const DriveUnits units = chooseUnits(l, given, drive.joint, path);
  drive.counts_per_unit = *units.counts_per_unit;
  drive.offset = units.offset.value_or(drive.offset);
  drive.max_following_error = units.max_following_error.value_or(drive.max_following_error);
  drive.max_velocity = l.chain.limits.max_velocity[drive.joint];
  checkCounts(l, drive, path);
  if (drive.kind == DriveKind::kMoteus) {
    checkMoteus(l, given, drive, path);
    return drive;
  }
  if (drive.home != MoteusHome::kOutput)
    l.fail(path + ".home", "the drive is no moteus", "not this key");
  applySheet(l.sheets[i], drive);
  return drive;
}

/// From the entries before it.
void checkIsDistinct(const LoadingRobot& l, std::size_t i) {
  const std::string path = fmt::format("drives.joints[{}]", i);
  const DriveSection& drive = l.config.drives.joints[i];
  if (drive.config.node_id == l.can.canopen.master_node_id) {
    l.fail(path + ".node_id", fmt::format("{} is the master's", drive.config.node_id),
           "another one than can.master_node_id");
  }
  const bool is_beside_moteus = std::ranges::any_of(l.config.drives.joints, [&](const auto& other) {
    return other.interface == drive.interface && other.config.kind == DriveKind::kMoteus;
  });
  if (drive.config.node_id == kEveryMoteus && is_beside_moteus) {
    l.fail(path + ".node_id", "127 is that of every moteus on the same bus",
           "1 to 126 on a bus with a moteus");
  }
  for (std::size_t k = 0; k < i; ++k) {
    const DriveSection& other = l.config.drives.joints[k];
    if (other.joint == drive.joint) {
      l.fail(path + ".joint",
             fmt::format("{} has a drive already, in entry {}", inQuotes(drive.joint), k),
             "each joint once");
    }
    if (other.interface == drive.interface && other.config.node_id == drive.config.node_id) {
      l.fail(path + ".node_id",
             fmt::format("{} is that of joint {} on the same bus", drive.config.node_id,
                         inQuotes(other.joint)),
             "each node id once a bus");
    }
  }
}

}  // namespace

std::string listOfBuses(const LoadingRobot& l) {
  std::vector<std::string> names;
  for (const BusConfig& bus : l.can.buses) names.push_back(bus.interface);
  return fmt::format("{}", fmt::join(names, ", "));
}

int findBus(const LoadingRobot& l, const std::string& interface, const std::string& path) {
  const std::vector<BusConfig>& buses = l.can.buses;
  const auto bus = std::ranges::find(buses, interface, &BusConfig::interface);
  if (bus == buses.end()) {
    l.fail(path, inQuotes(interface) + " is none of can.buses", "one of " + listOfBuses(l));
  }
  return static_cast<int>(bus - buses.begin());
}

std::vector<DriveConfig> loadDrives(const LoadingRobot& l) {
  if (l.config.drives.joints.empty()) {
    l.fail("drives.joints", "is missing", "a list of one drive a moving joint beside can");
  }
  std::vector<DriveConfig> drives;
  for (std::size_t i = 0; i < l.config.drives.joints.size(); ++i) {
    checkIsDistinct(l, i);
    drives.push_back(makeDrive(l, i));
  }
  for (std::size_t j = 0; j < l.chain.joint_names.size(); ++j) {
    if (std::ranges::count(drives, static_cast<int>(j), &DriveConfig::joint) == 1) continue;
    l.fail("drives.joints", "no drive of joint " + inQuotes(l.chain.joint_names[j]),
           "one a moving joint");
  }
  std::ranges::sort(drives, {}, &DriveConfig::joint);
  return drives;
}

}  // namespace tactus
