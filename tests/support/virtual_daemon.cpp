// The daemon's cycle, its control socket and the plant in one process, without CAN and real time:
// for clients of the socket, and much faster. The socket is in RUNTIME_DIRECTORY.
//
// usage: virtual_daemon SCENE.yaml [KEY=VALUE...]
#include <csignal>
#include <cstdio>
#include <thread>

#include "support/virtual_robot_cell.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/scene/command_scene.h"

namespace {

volatile std::sig_atomic_t is_over = 0;

}  // namespace

int main(int argc, char** argv) {
  using namespace tactus;
  if (argc < 2) return 2;
  std::signal(SIGTERM, [](int) { is_over = 1; });
  const Scene scene = loadScene(argv[1], parseOverrides({argv + 2, argv + argc}));
  test::VirtualRobotCell cell(scene);
  LoopLink link;
  const ControlSocket socket(scene, link);
  bool is_said = false;
  for (long i = 0; !is_over; ++i) {
    cell.step();
    ToolOrder order;
    while (link.tool_orders.pop(order)) cell.cycle.order(order);
    GainOrder gains;
    if (link.gain_orders.take(gains)) cell.cycle.order(gains);
    cell.cycle.prepare();
    link.gain_reports.put(cell.cycle.gainReport());
    if (cell.cycle.toolReport()) {
      ToolSight sight;
      cell.cycle.fill(sight);
      link.tool_sights.put(sight);
    }
    if (!is_said && cell.cycle.report().mode == Mode::kRunning) {
      is_said = true;
      std::puts("running");
      std::fflush(stdout);
    }
    if (i % 10 == 9) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return 0;
}
