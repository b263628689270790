#include "tactus/daemon/tool_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "tactus/daemon/request_refusal.h"
#include "tactus/math/rotation.h"

namespace tactus {
namespace {

constexpr double kMaxPosition_m = 100.0;
constexpr double kMaxTurn_rad = 4.0;
constexpr double kMaxPause_s = 86400.0;
constexpr double kLeastSpeed = 1e-5;  ///< m/s or rad/s

void setSpeed(const Json& request, const char* name, MotionLimits& limits) {
  const auto found = request.find(name);
  if (found == request.end()) return;
  limits.max_speed = numberOf(*found, name, kLeastSpeed, limits.max_speed);
}

/// Where the tool is in the posture, as far as the task controls it.
Pose toolInPosture(const Scene& scene, const Json& request, const Pose& from) {
  for (const char* key : {"to_m", "rotate_rad"})
    if (request.contains(key))
      refuseRequest(fmt::format("{} is given beside to_posture", key), "one of them");
  if (flagOf(request, "relative"))
    refuseRequest("relative is given beside to_posture", "one of them");
  if (!scene.controller.q_posture)
    refuseRequest("to_posture is given, but the scene leads to no posture",
                  "redundancy.posture in the scene");
  const TaskConfig& task = scene.controller.task;
  Pose X = tipPose(scene.controller.chain, *scene.controller.q_posture);
  if (!task.hasRotation()) X.R_AB = from.R_AB;
  for (int i = 0; i < 3; ++i)
    if (!task.controls(i)) X.p_AB[i] = from.p_AB[i];
  return X;
}

void aim(const TaskConfig& task, const Json& request, const Pose& from, Pose& X_BaseTool) {
  const bool is_relative = flagOf(request, "relative");
  const auto to_m = vectorOf(request, "to_m", kMaxPosition_m);
  const auto rotate_rad = vectorOf(request, "rotate_rad", kMaxTurn_rad);
  if (!to_m && !rotate_rad) refuseRequest("no target", "to_m, rotate_rad or to_posture");
  for (int i = 0; to_m && i < 3; ++i) {
    const std::optional<double>& value = (*to_m)[i];
    if (!value || (is_relative && *value == 0.0)) continue;
    if (!task.controls(i))
      refuseRequest(fmt::format("to_m[{}] is given, but the task does not control {}", i, "xyz"[i]),
                    "null");
    X_BaseTool.p_AB[i] = *value + (is_relative ? from.p_AB[i] : 0.0);
  }
  if (!rotate_rad) return;
  if (!task.hasRotation())
    refuseRequest("rotate_rad is given, but the task does not control the orientation",
                  "to_m alone");
  Vector3 turn;
  for (int i = 0; i < 3; ++i) {
    if (!(*rotate_rad)[i]) refuseRequest(fmt::format("rotate_rad[{}] is null", i), "three numbers");
    turn[i] = *(*rotate_rad)[i];
    if (is_relative && turn[i] != 0.0 && !task.controls(3 + i))
      refuseRequest(
          fmt::format("rotate_rad[{}] is given, but the task does not control r{}", i, "xyz"[i]),
          "0");
  }
  // The tool goes the shorter way round.
  if (is_relative && turn.norm() > kMostTurn_rad)
    refuseRequest(fmt::format("rotate_rad turns by {:.16g} rad", turn.norm()),
                  "less than half a turn, at most 3.14159265");
  const Matrix3 R = rotationMatrix(turn);
  X_BaseTool.R_AB = is_relative ? Matrix3(R * from.R_AB) : R;
}

}  // namespace

ToolTarget toolTarget(const Scene& scene, const Json& request, const Pose& from,
                      ToolOrder::Kind kind) {
  const TaskConfig& task = scene.controller.task;
  ToolTarget target{{.kind = kind, .limits = task.commands->limits}, from};
  if (flagOf(request, "to_posture"))
    target.X_BaseTool = toolInPosture(scene, request, from);
  else
    aim(task, request, from, target.X_BaseTool);
  ToolOrder& order = target.order;
  setSpeed(request, "speed_m_per_s", order.limits.position);
  setSpeed(request, "speed_rad_per_s", order.limits.rotation);
  if (request.contains("pause_s"))
    order.pause_s = numberOf(request.at("pause_s"), "pause_s", 0.0, kMaxPause_s);
  std::copy_n(target.X_BaseTool.p_AB.data(), 3, order.p_BaseTool_m);
  std::copy_n(target.X_BaseTool.R_AB.data(), 9, order.R_BaseTool);
  return target;
}

}  // namespace tactus
