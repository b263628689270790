#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/cli/commission_run.h"
#include "tactus/scene/located_error.h"

/// What the options allow a motion, and whether it is enough to measure by.
namespace tactus {
namespace {

/// Of the travel: what two measured places may be wrong by is then a seventh of it.
constexpr double kLeastTravel_errors = 15.0;
/// Of what nobody need see: a motion of as much or less is never seen, and the next is no longer.
constexpr double kLeastTravel_unseen = 1.5;
/// Of the following error that ends a motion, by the fewest counts that a joint may have: of one
/// whose counts are rounded by as much any motion would look stuck.
constexpr double kLeastError_counts = 2.0;
constexpr double kLeastFactor = 1.5;  ///< that the option takes

/// Whoever filled them in: a comparison with NaN would bound nothing.
void checkBounds(const MotionBounds& bounds, double most_travel, double most_speed,
                 const char* kind) {
  const auto isWithin = [](double value, double most) { return value > 0.0 && value <= most; };
  const bool is_good =
      isWithin(bounds.max_travel, most_travel) && isWithin(bounds.max_speed, most_speed) &&
      isWithin(bounds.max_acceleration, 1.0) && isWithin(bounds.max_following_error, 1.0) &&
      isWithin(bounds.measuring_error, 1.0) && isWithin(bounds.unseen, most_travel) &&
      bounds.margin >= 0.0 && bounds.margin <= 1.0;
  if (!is_good)
    throw InputError(
        fmt::format("the bounds of {} joints are not finite, or out of range, "
                    "expected those that the options take",
                    kind));
}

/// How the options name the bounds of one kind of joint.
struct BoundNames {
  const char *travel, *unit, *error, *error_unit;
  double error_unit_size;  ///< rad or m
};

constexpr BoundNames kRevoluteNames{"--travel", "rad", "--error", "deg", std::numbers::pi / 180.0};
constexpr BoundNames kPrismaticNames{"--slide", "m", "--slide-error", "m", 1.0};

void checkIsMeasurable(const MotionBounds& bounds, double most_travel, const BoundNames& names) {
  constexpr double kDigit = 1e-5, kRounding = 1e-6;  // so that what is told is accepted
  const double least =
      std::max(kLeastTravel_errors * bounds.measuring_error, kLeastTravel_unseen * bounds.unseen);
  if (bounds.max_travel >= least * (1.0 - kRounding)) return;
  if (least > most_travel) {
    const double most = most_travel / kLeastTravel_errors / names.error_unit_size;
    throw InputError(fmt::format(
        "{}: by {:g} {} no motion is long enough to be measured, expected at most {:g} {}",
        names.error, bounds.measuring_error / names.error_unit_size, names.error_unit,
        std::floor(most / kDigit) * kDigit, names.error_unit));
  }
  throw InputError(fmt::format(
      "{}: {:g} {} is too short to be seen and measured, expected at least {:g} {}", names.travel,
      bounds.max_travel, names.unit, std::ceil(least / kDigit - kRounding) * kDigit, names.unit));
}

void checkIsCountable(const Scene& scene, const CommissionConfig& config) {
  for (const DriveConfig& drive : config.hardware.drives) {
    const double error = config.bounds(drive.joint).max_following_error;
    const double most = drive.counts_per_unit * error / kLeastError_counts;
    constexpr double kDigit = 0.01, kRounding = 1e-6;  // so that what is told is accepted
    if (config.file_factor <= most * (1.0 + kRounding)) continue;
    const auto& name = scene.joint_names[static_cast<std::size_t>(drive.joint)];
    const std::string told = fmt::format(
        "--file-factor: by {:g} the {:g} counts/{} of {} are too few to tell whether it "
        "follows a motion",
        config.file_factor, drive.counts_per_unit, unitOf(scene.controller.chain.type(drive.joint)),
        escaped(name));
    if (most >= kLeastFactor)
      throw InputError(fmt::format("{}, expected at most {:g}", told,
                                   std::floor(most / kDigit + kRounding) * kDigit));
    throw InputError(fmt::format("{}, expected a finer encoder, of {:g} counts or more", told,
                                 kLeastFactor * kLeastError_counts / error));
  }
}

}  // namespace

CommissionConfig commissionConfig(const Scene& scene, const CommissionOptions& options) {
  CommissionConfig config;
  config.hardware = *scene.hardware;
  config.period_s = scene.period_s;
  config.revolute = options.revolute;
  config.prismatic = options.prismatic;
  config.file_factor = options.file_factor;
  for (int joint = 0; joint < scene.controller.chain.size(); ++joint)
    config.is_prismatic.push_back(scene.controller.chain.type(joint) == JointType::kPrismatic);
  checkBounds(config.revolute, kMostTravel_rad, kMostSpeed_rad_per_s, "revolute");
  checkBounds(config.prismatic, kMostTravel_m, kMostSpeed_m_per_s, "prismatic");
  if (!(config.file_factor >= 1.0 && config.file_factor <= 1e4))
    throw InputError("--file-factor: is no factor, expected one from 1 to 10000");
  checkIsMeasurable(config.revolute, kMostTravel_rad, kRevoluteNames);
  checkIsMeasurable(config.prismatic, kMostTravel_m, kPrismaticNames);
  if (!options.is_scan_alone) checkIsCountable(scene, config);
  return config;
}

}  // namespace tactus
