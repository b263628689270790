// The daemon's cycle, its control socket and the plant in one process, without CAN and real time:
// for clients of the socket, and much faster. The socket is in RUNTIME_DIRECTORY.
//
// usage: virtual_daemon [--log FOLDER PACE] SCENE.yaml [KEY=VALUE...]
//
// With a folder, which exists, it writes log and status as the daemon does, at PACE times the speed
// of the clock. However it ends, it says how long the arm takes to its rest: as the daemon's loop
// does, which is told to stop, or where the program aborts, as the drives do that hear no more.
#include <unistd.h>

#include <atomic>
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

constexpr int kPatience_cycles = 100'000;

template <typename Advance>
void bringToRest(const char* how, const test::VirtualRobotCell& cell, const Advance& advance) {
  const std::int64_t start_ns = cell.t_ns;
  for (int i = 0; i < kPatience_cycles && !cell.areDrivesLimp(); ++i) advance();
  std::printf("%s %s after %lld ms\n", how, cell.areDrivesLimp() ? "at rest" : "moving",
              static_cast<long long>((cell.t_ns - start_ns) / 1'000'000));
  std::fflush(stdout);
}

/// An abort: the cycle is gone, and the plant, which is part of this process, goes on alone.
class LastBreath {
 public:
  explicit LastBreath(test::VirtualRobotCell& cell) {
    cell_ = &cell;
    end_ = std::set_terminate(onTerminate);
  }
  ~LastBreath() { std::set_terminate(end_); }
  LastBreath(const LastBreath&) = delete;
  LastBreath& operator=(const LastBreath&) = delete;

  /// Of the thread that plays the cell; never returns if another one has aborted.
  static void look() {
    if (!is_aborting_) return;
    watchDrives();
    while (true) pause();
  }

 private:
  static void watchDrives() {
    bringToRest("aborted:", *cell_, [] {
      FrameBatch frames;
      cell_->plant.advance(cell_->t_ns);
      for (int bus = 0; bus < cell_->plant.buses(); ++bus) cell_->plant.take(bus, frames);
      cell_->t_ns += 1'000'000;
    });
    is_watched_ = true;
  }

  static void onTerminate() {
    is_aborting_ = true;
    if (gettid() == getpid()) watchDrives();
    for (int i = 0; i < 5000 && !is_watched_; ++i) usleep(1000);  // there may be no other any more
    end_();
  }

  static inline test::VirtualRobotCell* cell_ = nullptr;
  static inline std::terminate_handler end_ = nullptr;
  static inline std::atomic<bool> is_aborting_{false}, is_watched_{false};
};

void stop(test::VirtualRobotCell& cell) {
  cell.input.stop_requested = true;
  bringToRest("stopped:", cell, [&] {
    LastBreath::look();
    cell.step();
  });
}

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
  const LastBreath last_breath(cell);
  const auto start = std::chrono::steady_clock::now();
  bool is_said = false;
  const auto play = [&](long i) {
    LastBreath::look();
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
  };
  try {
    for (long i = 0; !is_over; ++i) play(i);
  } catch (const std::exception&) {  // as the daemon's loop, when its telemetry ends
    stop(cell);
    throw;
  }
  stop(cell);
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
