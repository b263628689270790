#include "tactus/cli/plant_run.h"

#include <errno.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <time.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "tactus/cli/e_stop_file.h"
#include "tactus/io/can_socket.h"
#include "tactus/io/kernel_frame.h"
#include "tactus/io/raw_can_socket.h"
#include "tactus/rt/memory.h"
#include "tactus/rt/periodic_timer.h"
#include "tactus/rt/scheduling.h"

namespace tactus {
namespace {

constexpr std::size_t kHeapBytes = std::size_t{1} << 20;
constexpr int kPriority = 70;  // below the daemon's loop
/// Events are handled up to this much late, to wake up less often: at (k + 1/2) of it, since a
/// daemon on the same CPU wakes up at whole ones (PeriodicTimer), and no robot makes it late.
constexpr std::int64_t kGrid_ns = 100'000;
constexpr std::int64_t kLongestWait_ns = 1'000'000'000;

volatile sig_atomic_t is_stopping = 0;

void requestStop(int) { is_stopping = 1; }

/// Stop signals arrive only while waiting, so that none is overlooked.
sigset_t catchStopSignals() {
  sigset_t signals, while_waiting;
  sigemptyset(&signals);
  struct sigaction action {};
  action.sa_handler = requestStop;
  for (const int signal : {SIGTERM, SIGINT}) {
    sigaddset(&signals, signal);
    sigaction(signal, &action, nullptr);
  }
  pthread_sigmask(SIG_BLOCK, &signals, &while_waiting);
  sigdelset(&while_waiting, SIGTERM);
  sigdelset(&while_waiting, SIGINT);
  return while_waiting;
}

void becomeRealTime(std::FILE* notes) {
  const RealTimeRequest request{.priority = kPriority};
  std::vector<Refusal> refusals = realTimeRefusals(request, applyRealTime(request));
  if (const auto refusal = lockMemory(kHeapBytes)) refusals.push_back(*refusal);
  for (const Refusal& refusal : refusals)
    fmt::print(notes, "goes on without {}: {}; to grant it: {}\n", refusal.what,
               refusal.why_it_matters, refusal.how_to_grant);
}

/// Carries frames between the plant and the interfaces, as time goes by.
class PlantPump {
 public:
  PlantPump(const Scene& scene, const std::string& e_stop_file, std::FILE* notes)
      : plant_(scene.controller, scene.plant, *scene.hardware, scene.period_s, scene.troubles),
        notes_(notes) {
    for (const BusConfig& bus : scene.hardware->buses) {
      locks_.push_back(std::make_unique<InterfaceLock>(bus.interface, "tactus plant"));
      const bool is_fd = bus.data_bit_rate_per_s.has_value();
      sockets_.push_back(std::make_unique<RawCanSocket>(bus.interface, is_fd));
      polled_.push_back({sockets_.back()->descriptor(), POLLIN, 0});
      requireUp(bus.interface);
      if (is_fd) requireFd(bus.interface);
      interfaces_.push_back(bus.interface);
    }
    e_stop_.emplace(e_stop_file);  // it may be another plant's: that one holds the locks
  }

  void run(const sigset_t& signals_while_waiting) {
    start_ns_ = (now_ns() - kGrid_ns / 2) / kGrid_ns * kGrid_ns + kGrid_ns / 2;
    while (is_stopping == 0) {
      pump();
      wait(signals_while_waiting);
    }
  }

  PlantRunResult result() const {
    PlantRunResult result{plant_.counters(), 0, {}};
    for (const auto& socket : sockets_) result.interface_refused += socket->refused();
    if (const LinkContacts* links = plant_.world().linkContacts())
      result.unsensed = links->largest();
    return result;
  }

 private:
  void pump() {
    const std::int64_t t_ns = now_ns() - start_ns_;
    for (int bus = 0; bus < plant_.buses(); ++bus) {
      if (polled_[bus].revents == 0) continue;
      sockets_[bus]->receive(frames_);
      if (sockets_[bus]->isGone())
        failOnInterface(ENODEV, interfaces_[bus], "the interface has gone");
      for (const CanFrame& frame : frames_) plant_.send(bus, frame, t_ns);
    }
    plant_.advance(t_ns);
    for (int bus = 0; bus < plant_.buses(); ++bus) {
      plant_.take(bus, frames_);
      sockets_[bus]->send(frames_.frames());
    }
    moveEmergencyStop(t_ns);
  }

  void moveEmergencyStop(std::int64_t t_ns) {
    const bool is_pressed = plant_.emergencyStop(t_ns);
    if (is_pressed == is_pressed_) return;
    is_pressed_ = is_pressed;
    const bool is_written = e_stop_->write(is_pressed);
    fmt::print(notes_, "e-stop {} at {:.6f} s{}\n", is_pressed ? "pressed" : "released",
               1e-9 * static_cast<double>(t_ns),
               is_written ? "" : ", which nobody could be told: its file can't be written");
    std::fflush(notes_);
  }

  void wait(const sigset_t& signals_while_waiting) {
    const std::int64_t next_ns = plant_.nextEvent_ns();
    const std::int64_t t_ns = now_ns() - start_ns_;
    const std::int64_t due_ns = std::min(next_ns, t_ns + kLongestWait_ns);
    const std::int64_t wake_ns = (due_ns + kGrid_ns - 1) / kGrid_ns * kGrid_ns;
    const std::int64_t wait_ns = std::max<std::int64_t>(0, wake_ns - t_ns);
    const timespec timeout{wait_ns / 1'000'000'000, wait_ns % 1'000'000'000};
    ppoll(polled_.data(), polled_.size(), &timeout, &signals_while_waiting);
  }

  Plant plant_;
  std::optional<EmergencyStopFile> e_stop_;
  std::FILE* notes_;
  std::vector<std::string> interfaces_;
  std::vector<std::unique_ptr<InterfaceLock>> locks_;
  std::vector<std::unique_ptr<RawCanSocket>> sockets_;
  std::vector<pollfd> polled_;
  FrameBatch frames_;
  std::int64_t start_ns_ = 0;
  bool is_pressed_ = false;
};

}  // namespace

PlantRunResult runPlant(const Scene& scene, const std::string& e_stop_file, std::FILE* notes) {
  PlantPump pump(scene, e_stop_file, notes);
  const sigset_t while_waiting = catchStopSignals();
  becomeRealTime(notes);
  std::string interfaces;
  for (const BusConfig& bus : scene.hardware->buses) interfaces += " " + bus.interface;
  fmt::print(notes, "plant of {} ready on{}\n", scene.name, interfaces);
  std::fflush(notes);
  pump.run(while_waiting);
  return pump.result();
}

}  // namespace tactus
