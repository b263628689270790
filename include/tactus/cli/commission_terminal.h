#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tactus/cli/commission_desk.h"
#include "tactus/io/can_socket.h"
#include "tactus/io/gpio_lines.h"
#include "tactus/rt/periodic_timer.h"

namespace tactus {

/// The cycle of commissioning on real buses and lines, a wake-up at a time, with an engineer at
/// standard input. SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP (Ctrl-Z) and the end of input or
/// output stop it for good.
class CommissionTerminal final : public CommissionDesk {
 public:
  /// reads_input: false where nothing is asked, so that the end of the input is none. Throws
  /// std::system_error or std::runtime_error for what cannot be had.
  CommissionTerminal(const CommissionConfig& config, bool reads_input);

  void runCycle() override;
  CommissionCycle& cycle() override { return cycle_; }
  void stopMotion() override { stops_motion_ = true; }
  std::optional<std::pair<int, Fault>> takeBusFault() override;
  void say(const std::string& text) override;
  std::optional<std::string> takeLine() override;
  void forgetTyped() override;
  bool isStopped() const override;

 private:
  struct Bus {
    Bus(const HardwareConfig& hardware, int index, double period_s);
    InterfaceLock lock;
    CanSocket socket;
    FrameBatch frames;
  };

  void readInput();

  CommissionCycle cycle_;
  bool reads_input_;
  std::vector<std::unique_ptr<Bus>> buses_;
  std::optional<GpioLines> lines_;
  PeriodicTimer timer_;
  CommissionInput input_;
  std::optional<std::pair<int, Fault>> bus_fault_;
  std::string typed_;
  bool is_engineer_gone_ = false;
  bool stops_motion_ = false;
  bool are_lines_written_ = true;
};

}  // namespace tactus
