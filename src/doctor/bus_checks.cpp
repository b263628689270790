#include "tactus/doctor/bus_checks.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "tactus/io/can_socket.h"

namespace tactus {
namespace {

constexpr int kCanHardware = 280;  ///< ARPHRD_CAN
constexpr unsigned kUp = 1;        ///< IFF_UP
constexpr long kFdMtu = 72;        ///< CANFD_MTU

std::string bringUp(const BusConfig& bus) {
  const std::string fd = bus.data_bit_rate_per_s
                             ? fmt::format(" dbitrate {:.0f} fd on", *bus.data_bit_rate_per_s)
                             : "";
  return fmt::format("ip link set {} up type can bitrate {:.0f}{} restart-ms 0", bus.interface,
                     bus.bit_rate_per_s, fd);
}

/// A controller's settings can be changed only while it is down.
std::string setAnew(const BusConfig& bus) {
  return fmt::format("ip link set {} down, then {}", bus.interface, bringUp(bus));
}

bool isUp(const std::filesystem::path& folder) {
  const std::string text = readText(folder / "flags").value_or("0x0");
  unsigned flags = 0;
  if (text.starts_with("0x"))
    std::from_chars(text.data() + 2, text.data() + text.size(), flags, 16);
  return (flags & kUp) != 0;
}

/// "pci", "usb", "spi", "platform"; empty for an interface without hardware.
std::string hardwareBus(const std::filesystem::path& folder) {
  std::error_code none;
  return std::filesystem::read_symlink(folder / "device/subsystem", none).filename().string();
}

Finding checkAdapter(const std::filesystem::path& folder, const BusConfig& bus,
                     const std::optional<CanLink>& link) {
  const std::string name = "can_adapter";
  const std::string hardware = hardwareBus(folder);
  const std::string why = "frames wait for the host's polling, milliseconds at worst";
  const std::string mend = "use a controller on PCI Express or in the processor";
  if (hardware == "usb")
    return {name, Level::kWarning, bus.interface + ": adapter on USB", why, mend};
  if (link && (link->kind == "vcan" || link->kind == "vxcan"))
    return {name, Level::kNote, bus.interface + ": virtual, there is no drive behind it"};
  if (hardware.empty())  // slcan is a controller without a device, before Linux 6.0 of no kind
    return {name, Level::kWarning, bus.interface + ": adapter on a serial line", why, mend};
  return {name, Level::kOk, fmt::format("{}: controller on {}", bus.interface, hardware)};
}

Finding checkBitRate(const BusConfig& bus, const CanLink& link) {
  const double rate_per_s = static_cast<double>(link.bit_rate_per_s);
  if (rate_per_s == bus.bit_rate_per_s)
    return {"can_bit_rate", Level::kOk,
            fmt::format("{}: {} bit/s", bus.interface, link.bit_rate_per_s)};
  return {"can_bit_rate", Level::kNotFit,
          fmt::format("{}: {} bit/s, but robot.yaml says {:.0f}", bus.interface,
                      link.bit_rate_per_s, bus.bit_rate_per_s),
          "no frame gets through, or the bus carries less than was reckoned with", setAnew(bus)};
}

Finding checkDataBitRate(const BusConfig& bus, const CanLink& link) {
  const double rate_per_s = static_cast<double>(link.data_bit_rate_per_s);
  if (rate_per_s == *bus.data_bit_rate_per_s)
    return {"can_data_bit_rate", Level::kOk,
            fmt::format("{}: data at {} bit/s", bus.interface, link.data_bit_rate_per_s)};
  return {"can_data_bit_rate", Level::kNotFit,
          fmt::format("{}: data at {} bit/s, but robot.yaml says {:.0f}", bus.interface,
                      link.data_bit_rate_per_s, *bus.data_bit_rate_per_s),
          "no frame of CAN FD gets through", setAnew(bus)};
}

/// A controller says it by its MTU, and a virtual interface, too.
Finding checkFd(const std::filesystem::path& folder, const BusConfig& bus, bool has_controller) {
  if (readNumber(folder / "mtu").value_or(0) >= kFdMtu)
    return {"can_fd", Level::kOk, bus.interface + ": carries CAN FD"};
  return {"can_fd", Level::kNotFit,
          bus.interface + ": not set up for CAN FD, but robot.yaml has data_bit_rate_per_s",
          "tactusd does not start without it",
          has_controller ? setAnew(bus)
                         : fmt::format("ip link set {0} down, then ip link set {0} mtu {1} up",
                                       bus.interface, kFdMtu)};
}

/// Modes are kept while an interface is down, so each is named to be switched off.
std::vector<Finding> checkModes(const BusConfig& bus, const CanLink& link) {
  std::vector<Finding> findings;
  const auto find = [&](Level level, const char* what, const char* why, const char* mode) {
    findings.push_back({"can_mode", level, fmt::format("{}: {}", bus.interface, what), why,
                        fmt::format("{} {} off", setAnew(bus), mode)});
  };
  if (link.is_listen_only)
    find(Level::kNotFit, "listens only", "nothing is sent, not even acknowledgements",
         "listen-only");
  if (link.is_loopback)
    find(Level::kNotFit, "hears itself", "what is sent counts as received by drives", "loopback");
  if (link.is_one_shot)
    find(Level::kNotFit, "sends each frame only once",
         "what is disturbed, or loses the bus to another frame, is lost", "one-shot");
  if (link.presumes_ack)
    find(Level::kWarning, "takes frames for acknowledged that nobody has acknowledged",
         "a cut cable or a bus without power is noticed late", "presume-ack");
  if (findings.empty())
    findings.push_back({"can_mode", Level::kOk, bus.interface + ": sends, repeats and listens"});
  return findings;
}

Finding checkState(const BusConfig& bus, const CanLink& link) {
  const std::string mend = fmt::format(
      "look at cable, termination, power and bit rate, then ip link set {0} down, and "
      "ip link set {0} up",
      bus.interface);
  if (link.is_bus_off)
    return {"can_state", Level::kNotFit, bus.interface + ": off the bus after too many errors",
            "no frame gets through until it is started anew", mend};
  if (link.is_passive)
    return {"can_state", Level::kWarning, bus.interface + ": error-passive",
            "frames were not acknowledged, or disturbed: nobody may be on the bus", mend};
  return {"can_state", Level::kOk, bus.interface + ": on the bus"};
}

Finding checkRestart(const BusConfig& bus, const CanLink& link) {
  if (link.restart_ms == 0)
    return {"can_restart", Level::kOk, bus.interface + ": stays off after bus-off"};
  return {"can_restart", Level::kWarning,
          fmt::format("{}: starts again {} ms after bus-off", bus.interface, link.restart_ms),
          "a broken bus comes and goes by itself instead of staying off until somebody has looked",
          setAnew(bus)};
}

Finding checkQueue(const std::filesystem::path& folder, const BusConfig& bus) {
  const auto length = readNumber(folder / "tx_queue_len");
  const std::string what =
      fmt::format("{}: transmit queue of {} frames", bus.interface, length.value_or(0));
  if (length && *length <= kMaxTransmitQueue) return {"can_queue", Level::kOk, what};
  return {"can_queue", Level::kWarning, what, "what waits in a long queue is old when it is sent",
          fmt::format("ip link set {} txqueuelen 10", bus.interface)};
}

}  // namespace

std::vector<Finding> checkBus(const MachineRoot& root, const BusConfig& bus,
                              const std::optional<CanLink>& link) {
  const auto folder = root / "sys/class/net" / bus.interface;
  const auto missing = [&](const char* problem, const std::string& mend) {
    return Finding{"can_interface", Level::kNotFit, fmt::format("{} {}", bus.interface, problem),
                   "tactusd does not start without it", mend};
  };
  const auto hardware = readNumber(folder / "type");
  if (!hardware)
    return {missing("is missing", "load the adapter's driver; `ip link` lists the interfaces")};
  if (*hardware != kCanHardware)
    return {missing("is no CAN interface", "name another one in robot.yaml")};
  const bool has_controller = link && link->kind == "can";
  std::vector<Finding> findings;
  if (isUp(folder)) {
    findings.push_back({"can_interface", Level::kOk, bus.interface + " is up"});
  } else {
    findings.push_back(missing("is down", has_controller
                                              ? bringUp(bus)
                                              : fmt::format("ip link set {} up", bus.interface)));
  }
  findings.push_back(checkAdapter(folder, bus, link));
  if (has_controller) {
    findings.push_back(checkBitRate(bus, *link));
    if (bus.data_bit_rate_per_s) findings.push_back(checkDataBitRate(bus, *link));
    for (Finding& finding : checkModes(bus, *link)) findings.push_back(std::move(finding));
    findings.push_back(checkRestart(bus, *link));
    if (isUp(folder)) findings.push_back(checkState(bus, *link));
  }
  if (bus.data_bit_rate_per_s) findings.push_back(checkFd(folder, bus, has_controller));
  findings.push_back(checkQueue(folder, bus));
  return findings;
}

}  // namespace tactus
