#include "soak/client.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactus/daemon/control_socket.h"
#include "tactus/io/packet_socket.h"
#include "tactus/scene/input_error.h"

namespace tactus::soak {
namespace {

constexpr double kWay_m = 0.06;  ///< of a target, at most, from where the tool is

struct Gain {
  const char* key;
  double low, high;
};

constexpr Gain kGains[] = {
    {"controller.time_constant_s", 0.08, 0.2},   {"controller.damping", 0.4, 1.0},
    {"controller.activation_force_N", 2.0, 5.0}, {"controller.contact_threshold_N", 0.8, 2.0},
    {"task.drift_gain_per_s", 0.5, 4.0},
};

}  // namespace

void writeScene(const std::string& path, const SoakScene& scene, const std::string& more) {
  std::ofstream(path) << fmt::format(
      "extends: {}/config/scenes/{}.yaml\nlog: {{max_bytes: 3e7, keep: 3}}\n"
      "simulation:\n  obstacles:\n"  // no law has to press hard
      "    - {{x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 60}}\n"
      "{}controller:\n  variant: {}\n{}",
      TACTUS_SOURCE_DIR, scene.base, scene.has_posture ? "redundancy: {posture: {}}\n" : "",
      scene.variant, more);
}

Client::Client(test::Random& random, std::string scene_path, SoakScene scene, RequestCounts& counts)
    : random_(random),
      scene_path_(std::move(scene_path)),
      scene_(std::move(scene)),
      counts_(counts) {}

/// What was asked first makes the daemon take what the loop has reported since, so that the answer
/// to the second hangs on nothing but the run.
void Client::ask(const Json& request, long long& accepted) {
  if (!connection_ || random_.chance(0.3)) connection_.emplace(controlPath());
  connection_->ask({{"do", "show"}});
  ++counts_.sent;
  try {
    connection_->ask(request);
    ++accepted;
  } catch (const InputError&) {
    ++counts_.refused;
  }
}

Json Client::target() {
  Json way = Json::array();
  for (int i = 0; i < 3; ++i) way.push_back(random_.uniform(-kWay_m, kWay_m));
  return {{"to_m", way}, {"relative", true}, {"speed_m_per_s", random_.logUniform(0.01, 0.1)}};
}

void Client::tell() {
  const double what = random_.uniform(0.0, 1.0);
  if (what < 0.2) return ask({{"do", "hold"}}, counts_.targets);
  if (scene_.has_posture && what < 0.3)
    return ask({{"do", "move"}, {"to_posture", true}}, counts_.targets);
  if (what < 0.8) {
    Json request = target();
    request["do"] = what < 0.7 ? "move" : "stream";
    return ask(request, counts_.targets);
  }
  Json waypoints = Json::array();
  for (int i = random_.integer(1, 4); i > 0; --i) {
    waypoints.push_back(target());
    waypoints.back()["pause_s"] = random_.uniform(0.0, 2.0);
  }
  ask({{"do", "follow"}, {"waypoints", waypoints}}, counts_.targets);
}

void Client::changeGains() {
  const double what = random_.uniform(0.0, 1.0);
  if (what < 0.25) return ask({{"do", "undo"}}, counts_.gains);
  if (what < 0.5) {
    const bool needs_restart = random_.chance(0.2);
    writeScene(scene_path_, scene_,
               needs_restart ? "  order: 1\n"
                             : fmt::format("  damping: {:.3f}\n", random_.uniform(0.4, 1.0)));
    return ask({{"do", "reload"}}, counts_.gains);
  }
  Json request = {{"do", "set"}, {"values", Json::object()}};
  for (int i = random_.integer(1, 3); i > 0; --i) {
    const Gain& gain = kGains[random_.index(std::size(kGains))];
    request["values"][gain.key] = random_.uniform(gain.low, gain.high);
  }
  if (random_.chance(0.3)) request["for_s"] = random_.uniform(1.0, 60.0);
  ask(request, counts_.gains);
}

/// Some leave before they are answered.
void Client::talkNonsense() {
  const PacketSocket socket = PacketSocket::connectTo(controlPath(), 1.0);
  std::string bytes(static_cast<std::size_t>(random_.logUniform(1.0, 40000.0)), '\0');
  for (char& byte : bytes) byte = static_cast<char>(random_.index(256));
  ++counts_.sent;
  ++counts_.refused;
  if (!socket.send(bytes) || random_.chance(0.5)) return;
  std::string answer(4096, '\0');
  socket.receive(answer);
}

}  // namespace tactus::soak
