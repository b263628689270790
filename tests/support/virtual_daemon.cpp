// The daemon's cycle, its control socket and the plant in one process, without CAN and real time:
// for clients of the socket, and much faster. The socket is in RUNTIME_DIRECTORY.
//
// usage: virtual_daemon [--log FOLDER PACE] SCENE.yaml [KEY=VALUE...]
//
// With a folder, which exists, it writes log and status as the daemon does, at PACE times the speed
// of the clock.
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <thread>

#include "support/virtual_robot_cell.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/loop_side.h"
#include "tactus/daemon/telemetry.h"
#include "tactus/scene/command_scene.h"

namespace {

using namespace tactus;

volatile std::sig_atomic_t is_over = 0;

void keepPace(std::chrono::steady_clock::time_point start, std::int64_t t_ns, double pace) {
  const std::chrono::nanoseconds passed(
      static_cast<std::int64_t>(static_cast<double>(t_ns) / pace));
  std::this_thread::sleep_until(start + passed);
}

int run(int argc, char** argv) {
  std::string folder;
  double pace = 0.0;
  if (argc > 3 && std::strcmp(argv[1], "--log") == 0) {
    folder = argv[2];
    pace = std::atof(argv[3]);
    argc -= 3;
    argv += 3;
  }
  if (argc < 2) return 2;
  std::signal(SIGTERM, [](int) { is_over = 1; });
  const Scene scene = loadScene(argv[1], parseOverrides({argv + 2, argv + argc}));
  test::VirtualRobotCell cell(scene);
  LoopLink link;
  std::optional<Telemetry> telemetry;
  if (!folder.empty()) telemetry.emplace(scene, folder, link);
  const ControlSocket socket(scene, link);
  LoopSide side(link);
  bool is_said = false;
  const auto start = std::chrono::steady_clock::now();
  for (long i = 0; !is_over; ++i) {
    cell.step();
    side.finish({.skipped = cell.input.missed_cycles, .late_in_a_row = cell.input.late_in_a_row},
                {}, cell.cycle);
    if (!is_said && cell.cycle.report().mode == Mode::kRunning) {
      is_said = true;
      std::puts("running");
      std::fflush(stdout);
    }
    if (telemetry && i % 20 == 19) telemetry->drain();
    if (telemetry && i % 10 == 9) keepPace(start, cell.t_ns, pace);
    if (!telemetry && i % 10 == 9) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  if (telemetry) telemetry->finish({});
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "virtual_daemon: %s\n", error.what());
    return 3;
  }
}
