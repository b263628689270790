#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string_view>

#include "tactus/daemon/control_requests.h"
#include "tactus/scene/scene_loader.h"

namespace {

using namespace tactus;

void require(bool is_well) {
  if (!is_well) std::abort();
}

bool isGood(double limit) { return std::isfinite(limit) && limit > 0.0; }

void judge(const ToolOrder& order) {
  require(order.number != 0 && order.pause_s >= 0.0 && std::isfinite(order.pause_s));
  for (const double p : order.p_BaseTool_m) require(std::isfinite(p));
  for (const double r : order.R_BaseTool) require(std::isfinite(r));
  require(isGood(order.limits.position.max_speed) && isGood(order.limits.rotation.max_speed));
}

/// A daemon's side of the socket, and a loop whose arm stands at its start.
struct Daemon {
  Daemon() {
    const Pose X = tipPose(scene.controller.chain, scene.controller.q_start);
    ToolSight sight;
    sight.is_running = true;
    std::copy_n(scene.controller.q_start.data(), scene.controller.q_start.size(), sight.q);
    std::copy_n(X.p_AB.data(), 3, sight.p_BaseTool_m);
    std::copy_n(X.R_AB.data(), 9, sight.R_BaseTool);
    link.tool_sights.put(sight);
  }

  const Scene scene = loadScene(TACTUS_SOURCE_DIR "/config/scenes/home.yaml", {});
  LoopLink link;
  ControlRequests requests{scene, link};
};

}  // namespace

/// Whatever is asked is answered, and what is ordered is fit for the loop.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Daemon daemon;
  const Json answer = Json::parse(
      daemon.requests.answer({reinterpret_cast<const char*>(data), size}), nullptr, false);
  require(answer.is_object() && answer.at("done").is_boolean());
  ToolOrder order;
  while (daemon.link.tool_orders.pop(order)) judge(order);
  GainOrder gains;
  if (!daemon.link.gain_orders.take(gains)) return 0;
  require(std::isfinite(gains.gains.force.time_constant_s) && !std::isnan(gains.for_s));
  daemon.link.gain_reports.put({.number = gains.number, .state = GainState::kKept});
  daemon.requests.look();
  return 0;
}
