#include "tactus/cli/commission_terminal.h"

#include <poll.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "tactus/canopen/can_robot.h"
#include "tactus/canopen/canopen.h"

namespace tactus {
namespace {

constexpr std::uint32_t kAnyNode = 0x780;  ///< mask of an id without its node
constexpr std::size_t kMaxTyped = 4096;
/// More than a terminal or a pipe holds: an input that never ends.
constexpr int kMostReads = 1024;

volatile sig_atomic_t was_interrupted = 0;

void noteInterrupt(int) { was_interrupted = 1; }

/// Hazard: a program that is suspended, by Ctrl-Z (SIGTSTP), leaves a brake open and lets a drive
/// go on, and nobody watches. In the background its terminal would suspend it, too (SIGTTIN,
/// SIGTTOU).
void catchInterrupts() {
  struct sigaction action {};
  action.sa_handler = noteInterrupt;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP})
    sigaction(signal, &action, nullptr);
  action.sa_handler = SIG_IGN;  // reading and say() hear of it, and the motion is ended
  for (const int signal : {SIGPIPE, SIGTTIN, SIGTTOU}) sigaction(signal, &action, nullptr);
}

/// Frames of all nodes, whichever there are.
CanSocket openForAllNodes(const HardwareConfig& hardware, int bus) {
  const std::array<IdFilter, 4> received = {{{cob_id::kEmergency, kAnyNode},
                                             {cob_id::kTpdo1, kAnyNode},
                                             {cob_id::kSdoAnswer, kAnyNode},
                                             {cob_id::kHeartbeat, kAnyNode}}};
  const auto master = static_cast<std::uint32_t>(hardware.canopen.master_node_id);
  const std::array<IdFilter, 5> sent = {{{cob_id::kNmt},
                                         {cob_id::kSync},
                                         {cob_id::kRpdo1, kAnyNode},
                                         {cob_id::kSdoRequest, kAnyNode},
                                         {cob_id::kHeartbeat + master}}};
  return {hardware.buses[static_cast<std::size_t>(bus)].interface, received, sent};
}

}  // namespace

CommissionTerminal::Bus::Bus(const HardwareConfig& hardware, int index, double period_s)
    : lock(hardware.buses[static_cast<std::size_t>(index)].interface),
      socket(openForAllNodes(hardware, index)) {
  socket.monitor() = BusMonitor(probeCycles(hardware.canopen, period_s));
}

CommissionTerminal::CommissionTerminal(const CommissionConfig& config, bool reads_input)
    : cycle_(config), reads_input_(reads_input), timer_(std::llround(1e9 * config.period_s)) {
  const HardwareConfig& hardware = config.hardware;
  for (std::size_t i = 0; i < hardware.buses.size(); ++i)
    buses_.push_back(std::make_unique<Bus>(hardware, static_cast<int>(i), config.period_s));
  if (hardware.gpio) lines_.emplace(*hardware.gpio, config.period_s);
  catchInterrupts();
}

bool CommissionTerminal::isStopped() const { return was_interrupted != 0 || is_engineer_gone_; }

void CommissionTerminal::runCycle() {
  const Wake wake = timer_.wait();
  readInput();
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    Bus& bus = *buses_[i];
    bus.socket.receive(bus.frames);
    bus.socket.monitor().update();
    input_.bus_faults[i] = bus.socket.monitor().fault();
    if (input_.bus_faults[i] != Fault::kNone && !bus_fault_)
      bus_fault_.emplace(static_cast<int>(i), input_.bus_faults[i]);
    cycle_.receive(static_cast<int>(i), bus.frames.frames());
  }
  if (lines_) input_.lines = lines_->read();
  input_.are_lines_lost = !input_.lines.is_valid || !are_lines_written_;
  input_.missed_cycles = static_cast<int>(std::min<std::int64_t>(wake.skipped, 1'000'000));
  input_.stop_requested = isStopped() || std::exchange(stops_motion_, false);
  cycle_.update(input_);
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    const int bus = static_cast<int>(i);
    if (!buses_[i]->socket.send(cycle_.outbox(bus).frames())) cycle_.noteHeldBack(bus);
    buses_[i]->socket.probe(cycle_.probe());
  }
  if (lines_) are_lines_written_ = lines_->write(cycle_.lines());
}

/// What is there, without waiting.
void CommissionTerminal::readInput() {
  if (is_engineer_gone_ || !reads_input_) return;
  pollfd polled{STDIN_FILENO, POLLIN, 0};
  if (poll(&polled, 1, 0) <= 0) return;
  std::array<char, 512> bytes;
  const ssize_t count = read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) {
    is_engineer_gone_ = true;
    return;
  }
  typed_.append(bytes.data(), static_cast<std::size_t>(count));
  if (typed_.size() > kMaxTyped) typed_ = "\n";  // whatever that was, it stops a motion
}

void CommissionTerminal::forgetTyped() {
  tcflush(STDIN_FILENO, TCIFLUSH);  // a line that is not yet ended, too; of a terminal alone
  pollfd polled{STDIN_FILENO, POLLIN, 0};
  int reads = 0;
  while (!isStopped() && poll(&polled, 1, 0) > 0) {
    readInput();
    is_engineer_gone_ = is_engineer_gone_ || ++reads > kMostReads;
  }
  typed_.clear();
}

std::optional<std::string> CommissionTerminal::takeLine() {
  const std::size_t end = typed_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = typed_.substr(0, end);
  typed_.erase(0, end + 1);
  return line;
}

void CommissionTerminal::say(const std::string& text) {
  const bool is_said = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  is_engineer_gone_ = is_engineer_gone_ || !is_said;
}

std::optional<std::pair<int, Fault>> CommissionTerminal::takeBusFault() {
  return std::exchange(bus_fault_, std::nullopt);
}

}  // namespace tactus
