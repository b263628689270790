#pragma once

#include <optional>
#include <span>
#include <string>

namespace tactus {

/// What the kernel knows of an interface's CAN controller.
struct CanLink {
  std::string kind;              ///< "can": a controller; "vcan", "vxcan": none
  long bit_rate_per_s = 0;       ///< 0: not set, or no controller
  long restart_ms = 0;           ///< after bus-off; 0: never by itself
  long data_bit_rate_per_s = 0;  ///< of CAN FD; 0: not set
  bool is_passive = false;       ///< error-passive, as where nobody acknowledges
  bool is_bus_off = false;       ///< sends and hears nothing until it is started anew
  bool is_listen_only = false;   ///< sends nothing, not even acknowledgements
  bool is_loopback = false;      ///< hears itself, and acknowledges what it sends
  bool is_one_shot = false;      ///< does not repeat what was disturbed or has lost arbitration
  bool presumes_ack = false;     ///< takes for sent what nobody has acknowledged
};

/// From an RTM_NEWLINK message of rtnetlink, whole or not. nullopt: says nothing of that kind.
std::optional<CanLink> parseCanLink(std::span<const char> message);

/// Asks the kernel. nullopt: no such interface, or no link of a kind.
std::optional<CanLink> canLink(const std::string& interface);

}  // namespace tactus
