#include "tactus/daemon/tool_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <vector>

#include "tactus/daemon/request_refusal.h"
#include "tactus/math/rotation.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/reach_check.h"

namespace tactus {
namespace {

using Kind = ToolOrder::Kind;

constexpr double kMaxPosition_m = 100.0;
constexpr double kMaxTurn_rad = 4.0;
constexpr double kMaxPause_s = 86400.0;
constexpr double kLeastSpeed = 1e-5;  ///< m/s or rad/s
/// Of start_tolerance: a scene that begins there judges the drives' positions.
constexpr double kThere = 0.5;
constexpr const char* kNoRoom = "too many orders at once, expected some milliseconds between them";

const char* stateName(ToolState state) noexcept {
  switch (state) {
    case ToolState::kMoving:
      return "moving";
    case ToolState::kBlocked:
      return "blocked";
    case ToolState::kArrived:
      return "arrived";
    case ToolState::kGivenUp:
      return "given_up";
    case ToolState::kLate:
      return "late";
    case ToolState::kStopped:
      return "stopped";
    case ToolState::kHolding:
      break;
  }
  return "holding";
}

void setSpeed(const Json& request, const char* name, MotionLimits& limits) {
  const auto found = request.find(name);
  if (found == request.end()) return;
  limits.max_speed = numberOf(*found, name, kLeastSpeed, limits.max_speed);
}

Json vectorJson(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Pose poseOf(const ToolSight& sight) {
  return {Eigen::Map<const Matrix3>(sight.R_BaseTool),
          Eigen::Map<const Vector3>(sight.p_BaseTool_m)};
}

}  // namespace

void ToolRequests::refresh() { link_.tool_sights.take(sight_); }

void ToolRequests::requireArm() {
  if (!scene_.controller.task.commands)
    throw InputError("the scene's task is a trajectory, expected task.source: commands");
  refresh();
  if (!sight_.is_running)
    throw InputError("the arm does not run, expected mode running; `tactus status` says why");
}

/// By the loop's clock.
bool ToolRequests::isStreamAlive() const {
  const std::int64_t cycles = link_.pulse.cycles.load(std::memory_order_relaxed) - streamed_cycle_;
  return static_cast<double>(cycles) * scene_.period_s <=
         scene_.controller.task.commands->stream_timeout_s;
}

void ToolRequests::requireNoHold() {
  is_stream_held_ = is_stream_held_ && isStreamAlive();
  streamed_cycle_ = link_.pulse.cycles.load(std::memory_order_relaxed);
  if (is_stream_held_)
    throw InputError(
        fmt::format("a hold has ended this stream, expected it to pause for {} s first",
                    scene_.controller.task.commands->stream_timeout_s));
}

/// Where the tool is in the posture, as far as the task controls it.
Pose ToolRequests::toolInPosture(const Json& request, const Pose& from) const {
  for (const char* key : {"to_m", "rotate_rad"})
    if (request.contains(key))
      refuseRequest(fmt::format("{} is given beside to_posture", key), "one of them");
  if (flagOf(request, "relative"))
    refuseRequest("relative is given beside to_posture", "one of them");
  if (!scene_.controller.q_posture)
    refuseRequest("to_posture is given, but the scene leads to no posture",
                  "redundancy.posture in the scene");
  const TaskConfig& task = scene_.controller.task;
  Pose X = tipPose(scene_.controller.chain, *scene_.controller.q_posture);
  if (!task.hasRotation()) X.R_AB = from.R_AB;
  for (int i = 0; i < 3; ++i)
    if (!task.controls(i)) X.p_AB[i] = from.p_AB[i];
  return X;
}

/// The joint that is farthest from the posture.
Json ToolRequests::postureJson() const {
  if (!scene_.controller.q_posture) return nullptr;
  const JointVector away = (jointsOf(sight_) - *scene_.controller.q_posture).cwiseAbs();
  Eigen::Index joint = 0;
  const double most = away.maxCoeff(&joint);
  return {{"joint", scene_.joint_names[static_cast<std::size_t>(joint)]},
          {"away", most},
          {"unit", unitOf(scene_.controller.chain.type(static_cast<int>(joint)))},
          {"is_there", scene_.hardware && most <= kThere * scene_.hardware->start_tolerance}};
}

ToolRequests::Target ToolRequests::target(const Json& request, const Pose& from, Kind kind) const {
  const TaskConfig& task = scene_.controller.task;
  Target target{{.kind = kind, .limits = task.commands->limits}, from};
  if (flagOf(request, "to_posture"))
    target.X_BaseTool = toolInPosture(request, from);
  else
    aim(request, from, target.X_BaseTool);
  ToolOrder& order = target.order;
  setSpeed(request, "speed_m_per_s", order.limits.position);
  setSpeed(request, "speed_rad_per_s", order.limits.rotation);
  if (request.contains("pause_s"))
    order.pause_s = numberOf(request.at("pause_s"), "pause_s", 0.0, kMaxPause_s);
  std::copy_n(target.X_BaseTool.p_AB.data(), 3, order.p_BaseTool_m);
  std::copy_n(target.X_BaseTool.R_AB.data(), 9, order.R_BaseTool);
  return target;
}

void ToolRequests::aim(const Json& request, const Pose& from, Pose& X_BaseTool) const {
  const TaskConfig& task = scene_.controller.task;
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
  if (is_relative && turn.norm() > std::numbers::pi)
    refuseRequest(fmt::format("rotate_rad turns by {:.4g} rad", turn.norm()),
                  "at most half a turn");
  const Matrix3 R = rotationMatrix(turn);
  X_BaseTool.R_AB = is_relative ? Matrix3(R * from.R_AB) : R;
}

JointVector ToolRequests::jointsOf(const ToolSight& sight) const {
  return Eigen::Map<const Eigen::VectorXd>(sight.q, scene_.controller.chain.size());
}

Reach ToolRequests::reach(const std::string& what, const JointVector& q,
                          const Target& target) const {
  Reach reach =
      followTo(scene_.controller, q, target.X_BaseTool, target.order.limits, scene_.period_s);
  if (!reach.problem.empty()) throw InputError(fmt::format("{}: {}", what, reach.problem));
  return reach;
}

Json ToolRequests::move(const Json& request) {
  refuseUnknown(request, {"do", "to_m", "rotate_rad", "relative", "to_posture", "speed_m_per_s",
                          "speed_rad_per_s"});
  requireArm();
  const bool is_stream = wishOf(request) == "stream";
  if (is_stream && flagOf(request, "to_posture"))
    refuseRequest("to_posture is given, but the way of a stream is not checked", "move");
  const Target goal = target(request, poseOf(sight_), is_stream ? Kind::kStream : Kind::kGo);
  double duration_s = 0.0;
  if (is_stream)
    requireNoHold();
  else
    duration_s = reach("move", jointsOf(sight_), goal).duration_s;
  return order(goal.order, duration_s);
}

/// A mistake says in which of up to 256 it is.
ToolRequests::Target ToolRequests::asked(const std::string& what, const Json& waypoint,
                                         const Pose& from, Kind kind) const {
  try {
    if (!waypoint.is_object()) refuseRequest("no object", "to_m and more");
    refuseUnknown(waypoint, {"to_m", "rotate_rad", "relative", "speed_m_per_s", "speed_rad_per_s",
                             "pause_s"});
    return target(waypoint, from, kind);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", what, error.what()));
  }
}

Json ToolRequests::follow(const Json& request) {
  refuseUnknown(request, {"do", "waypoints"});
  requireArm();
  const auto found = request.find("waypoints");
  if (found == request.end() || !found->is_array() || found->empty())
    refuseRequest("no waypoints", "a list of them");
  if (found->size() > ToolOrders::kMaxWaiting)
    refuseRequest(fmt::format("{} waypoints", found->size()),
                  fmt::format("at most {}", ToolOrders::kMaxWaiting));
  std::vector<ToolOrder> orders;
  Pose from = poseOf(sight_);
  JointVector q = jointsOf(sight_);
  for (const Json& waypoint : *found) {
    const std::string what = fmt::format("waypoint {}", orders.size() + 1);
    const Target next = asked(what, waypoint, from, orders.empty() ? Kind::kGo : Kind::kGoNext);
    q = reach(what, q, next).q_end;
    orders.push_back(next.order);
    from = next.X_BaseTool;
  }
  if (!link_.tool_orders.hasRoom(orders.size())) throw InputError(kNoRoom);
  ++number_;
  is_streaming_ = false;
  for (ToolOrder& order : orders) {
    order.number = number_;
    order.run = sight_.run;
    link_.tool_orders.push(order);
  }
  told_ = {number_, ToolState::kMoving, static_cast<int>(orders.size()) - 1};
  return show();
}

Json ToolRequests::hold(const Json& request) {
  refuseUnknown(request, {"do"});
  requireArm();
  const bool is_stream_held = is_stream_held_ || (is_streaming_ && isStreamAlive());
  ToolOrder hold;
  hold.limits = scene_.controller.task.commands->limits;
  Json json = order(hold, 0.0);
  is_stream_held_ = is_stream_held;
  return json;
}

/// All of a stream has one number.
Json ToolRequests::order(const ToolOrder& order, double duration_s) {
  if (!link_.tool_orders.hasRoom(1)) throw InputError(kNoRoom);
  const bool is_stream = order.kind == Kind::kStream;
  if (!is_stream || !is_streaming_) ++number_;
  is_streaming_ = is_stream;
  ToolOrder numbered = order;
  numbered.number = number_;
  numbered.run = sight_.run;
  link_.tool_orders.push(numbered);
  told_ = {number_, order.kind == Kind::kHold ? ToolState::kHolding : ToolState::kMoving, 0};
  Json json = show();
  if (duration_s > 0.0) json["duration_s"] = duration_s;
  return json;
}

/// The module that feels most, if it is in contact; else -1.
int ToolRequests::leaning() const {
  const auto modules = static_cast<int>(scene_.controller.tactile_modules.size());
  if (modules == 0) return -1;
  const int most =
      static_cast<int>(std::max_element(sight_.force_N, sight_.force_N + modules) - sight_.force_N);
  const double least_N = scene_.controller.gains.force.transition.release_force_N;
  return sight_.force_N[most] > least_N ? most : -1;
}

Json ToolRequests::show() {
  if (!scene_.controller.task.commands) return nullptr;
  refresh();
  // What the loop says may be of an order before the last one.
  const ToolReport& report = sight_.report.number == number_ ? sight_.report : told_;
  const Pose X = poseOf(sight_);
  Json json = {{"number", number_},
               {"state", stateName(report.state)},
               {"waiting", report.waiting},
               {"is_running", sight_.is_running},
               {"p_BaseTool_m", vectorJson(X.p_AB)},
               {"rotation_vector_rad", vectorJson(rotationVector(X.R_AB))},
               {"posture", postureJson()},
               {"contact", nullptr}};
  const int module = leaning();
  if (module < 0) return json;
  const TactileModuleConfig& config = scene_.controller.tactile_modules[module];
  ChainPose pose;
  scene_.controller.chain.computePose(jointsOf(sight_), pose);
  const Pose X_BaseModule = framePose(pose, config.link);
  const Vector3 p = X_BaseModule.p_AB + X_BaseModule.R_AB.col(0) * sight_.position_m[module];
  json["contact"] = {{"module", scene_.module_links[module]},
                     {"force_N", sight_.force_N[module]},
                     {"position_m", sight_.position_m[module]},
                     {"p_BaseContact_m", vectorJson(p)}};
  return json;
}

std::string ToolRequests::eventText() const {
  std::string text =
      fmt::format("task: order {} {}", sight_.report.number, stateName(sight_.report.state));
  if (sight_.report.state != ToolState::kBlocked && sight_.report.state != ToolState::kGivenUp)
    return text;
  const int module = leaning();
  if (module < 0) return text + ", held off by no contact";
  return text + fmt::format(" by a contact of {:.2f} N on {}, {:.3f} m along it",
                            sight_.force_N[module], scene_.module_links[module],
                            sight_.position_m[module]);
}

std::string ToolRequests::look() {
  if (!scene_.controller.task.commands || number_ == 0) return "";
  refresh();
  const ToolReport& report = sight_.report;
  if (report.number == 0 || (report.number == looked_.number && report.state == looked_.state))
    return "";
  looked_ = report;
  return eventText();
}

}  // namespace tactus
