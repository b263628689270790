#include "tactus/daemon/tool_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "tactus/daemon/request_refusal.h"
#include "tactus/daemon/tool_target.h"
#include "tactus/math/rotation.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/reach_check.h"

namespace tactus {
namespace {

using Kind = ToolOrder::Kind;

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

constexpr const char* kHoldCame = "a hold has come meanwhile";

/// To look how far a way can be gone takes time, in which who asked may have thought better of it,
/// and in which no hold is to wait.
void requireAsker(const Asker& asker) {
  if (asker.waits && !asker.waits()) throw InputError("who asked has left");
  if (asker.hold_comes && asker.hold_comes()) throw InputError(kHoldCame);
}

void requireNotOvertaken(const Asker& asker) {
  if (asker.is_overtaken) throw InputError(kHoldCame);
}

Json vectorJson(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

Pose poseOf(const ToolSight& sight) {
  return {Eigen::Map<const Matrix3>(sight.R_BaseTool),
          Eigen::Map<const Vector3>(sight.p_BaseTool_m)};
}

}  // namespace

void ToolRequests::refresh() { link_.tool_sights.take(sight_); }

void ToolRequests::requireCommands() const {
  if (!scene_.controller.task.commands)
    throw InputError("the scene's task is a trajectory, expected task.source: commands");
}

void ToolRequests::requireArm() {
  requireCommands();
  refresh();
  if (!sight_.is_running)
    throw InputError("the arm does not run, expected mode running; `tactus status` says why");
}

/// By the loop's clock. A target that waited here, behind what takes long, makes no pause.
bool ToolRequests::isStreamAlive(const Asker& asker) const {
  const std::int64_t now = link_.pulse.cycles.load(std::memory_order_relaxed);
  const std::int64_t cycles = asker.came_after_cycle.value_or(now) - streamed_cycle_;
  return static_cast<double>(cycles) * scene_.period_s <=
         scene_.controller.task.commands->stream_timeout_s;
}

/// Of a stream each target counts as heard, also one that is refused. A stop of the arm ends it
/// like a hold, and one that began while the arm stood still has not begun: nobody has seen it come
/// on, and the tool would leave at once.
void ToolRequests::hearStream(const Asker& asker) {
  requireCommands();
  refresh();
  const bool has_outlived_stop = is_streaming_ && sight_.run != stream_run_;
  is_stream_held_ = !sight_.is_running || asker.is_overtaken ||
                    (isStreamAlive(asker) && (is_stream_held_ || has_outlived_stop));
  streamed_cycle_ = link_.pulse.cycles.load(std::memory_order_relaxed);
}

void ToolRequests::requireNoHold() const {
  if (is_stream_held_)
    throw InputError(
        fmt::format("a hold or a stop has ended this stream, expected it to pause for {} s first",
                    scene_.controller.task.commands->stream_timeout_s));
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

JointVector ToolRequests::jointsOf(const ToolSight& sight) const {
  return Eigen::Map<const Eigen::VectorXd>(sight.q, scene_.controller.chain.size());
}

Reach ToolRequests::reach(const std::string& what, const JointVector& q,
                          const ToolTarget& target) const {
  ControllerConfig config = scene_.controller;
  config.gains = gains_;
  Reach reach = followTo(config, q, target.X_BaseTool, target.order.limits, scene_.period_s);
  if (!reach.problem.empty()) throw InputError(fmt::format("{}: {}", what, reach.problem));
  return reach;
}

Json ToolRequests::move(const Json& request, const Asker& asker) {
  refuseUnknown(request, {"do", "to_m", "rotate_rad", "relative", "to_posture", "speed_m_per_s",
                          "speed_rad_per_s"});
  const bool is_stream = wishOf(request) == "stream";
  if (is_stream) hearStream(asker);
  requireArm();
  requireNotOvertaken(asker);
  if (is_stream && flagOf(request, "to_posture"))
    refuseRequest("to_posture is given, but the way of a stream is not checked", "move");
  const ToolTarget goal =
      toolTarget(scene_, request, poseOf(sight_), is_stream ? Kind::kStream : Kind::kGo);
  double duration_s = 0.0;
  if (is_stream)
    requireNoHold();
  else
    duration_s = reach("move", jointsOf(sight_), goal).duration_s;
  requireAsker(asker);
  return order(goal.order, duration_s);
}

/// A mistake says in which of up to 256 it is.
ToolTarget ToolRequests::asked(const std::string& what, const Json& waypoint, const Pose& from,
                               Kind kind) const {
  try {
    if (!waypoint.is_object()) refuseRequest("no object", "to_m and more");
    refuseUnknown(waypoint, {"to_m", "rotate_rad", "relative", "speed_m_per_s", "speed_rad_per_s",
                             "pause_s"});
    return toolTarget(scene_, waypoint, from, kind);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", what, error.what()));
  }
}

Json ToolRequests::follow(const Json& request, const Asker& asker) {
  refuseUnknown(request, {"do", "waypoints"});
  requireArm();
  requireNotOvertaken(asker);
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
    requireAsker(asker);
    const std::string what = fmt::format("waypoint {}", orders.size() + 1);
    const ToolTarget next = asked(what, waypoint, from, orders.empty() ? Kind::kGo : Kind::kGoNext);
    q = reach(what, q, next).q_end;
    orders.push_back(next.order);
    from = next.X_BaseTool;
  }
  if (!link_.tool_orders.hasRoom(orders.size())) throw InputError(kNoRoom);
  requireAsker(asker);
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
  ToolOrder hold;
  hold.limits = scene_.controller.task.commands->limits;
  is_stream_held_ = true;  // of one that goes on; another begins after a pause
  return order(hold, 0.0);
}

/// All of a stream has one number.
Json ToolRequests::order(const ToolOrder& order, double duration_s) {
  const bool is_hold = order.kind == Kind::kHold;
  if (!is_hold && !link_.tool_orders.hasRoom(1)) throw InputError(kNoRoom);
  const bool is_stream = order.kind == Kind::kStream;
  if (!is_stream || !is_streaming_) ++number_;
  is_streaming_ = is_stream;
  stream_run_ = sight_.run;
  ToolOrder numbered = order;
  numbered.number = number_;
  numbered.run = sight_.run;
  if (is_hold)
    link_.tool_holds.put(numbered);
  else
    link_.tool_orders.push(numbered);
  told_ = {number_, is_hold ? ToolState::kHolding : ToolState::kMoving, 0};
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
  const double least_N = gains_.force.transition.release_force_N;
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
