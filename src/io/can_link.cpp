#include "tactus/io/can_link.h"

#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace tactus {
namespace {

using Bytes = std::span<const char>;

constexpr std::size_t kAnswerBytes = 32768;  ///< as much as the kernel gives at most

constexpr std::size_t aligned(std::size_t size) { return (size + 3) & ~std::size_t{3}; }

/// What lies at the front; zeros if there is less.
template <typename Value>
Value frontOf(Bytes bytes) {
  Value value{};
  if (bytes.size() >= sizeof(value)) std::memcpy(&value, bytes.data(), sizeof(value));
  return value;
}

Bytes behind(Bytes bytes, std::size_t size) { return bytes.subspan(std::min(size, bytes.size())); }

/// The contents of an attribute; empty if it is not there.
Bytes attribute(Bytes attributes, int type) {
  while (attributes.size() >= sizeof(rtattr)) {
    const auto header = frontOf<rtattr>(attributes);
    if (header.rta_len < sizeof(rtattr) || header.rta_len > attributes.size()) return {};
    if ((header.rta_type & NLA_TYPE_MASK) == type)
      return attributes.subspan(sizeof(rtattr), header.rta_len - sizeof(rtattr));
    attributes = behind(attributes, aligned(header.rta_len));
  }
  return {};
}

struct Request {
  nlmsghdr header;
  ifinfomsg link;
};

Request requestFor(unsigned index) {
  Request request{};
  request.header.nlmsg_len = sizeof(request);
  request.header.nlmsg_type = RTM_GETLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST;
  request.link.ifi_family = AF_UNSPEC;
  request.link.ifi_index = static_cast<int>(index);
  return request;
}

}  // namespace

std::optional<CanLink> parseCanLink(std::span<const char> message) {
  const auto header = frontOf<nlmsghdr>(message);
  if (header.nlmsg_type != RTM_NEWLINK || header.nlmsg_len > message.size()) return std::nullopt;
  const Bytes attributes =
      behind(message.first(header.nlmsg_len), NLMSG_HDRLEN + aligned(sizeof(ifinfomsg)));
  const Bytes info = attribute(attributes, IFLA_LINKINFO);
  const Bytes kind = attribute(info, IFLA_INFO_KIND);
  if (kind.empty()) return std::nullopt;
  CanLink link;
  link.kind.assign(kind.begin(), std::ranges::find(kind, '\0'));
  if (link.kind != "can") return link;  // what others call 1 and 5 means something else
  const Bytes data = attribute(info, IFLA_INFO_DATA);
  link.bit_rate_per_s = frontOf<can_bittiming>(attribute(data, IFLA_CAN_BITTIMING)).bitrate;
  link.data_bit_rate_per_s =
      frontOf<can_bittiming>(attribute(data, IFLA_CAN_DATA_BITTIMING)).bitrate;
  const auto state = frontOf<std::uint32_t>(attribute(data, IFLA_CAN_STATE));
  link.is_passive = state == CAN_STATE_ERROR_PASSIVE;
  link.is_bus_off = state == CAN_STATE_BUS_OFF;
  const auto modes = frontOf<can_ctrlmode>(attribute(data, IFLA_CAN_CTRLMODE)).flags;
  link.is_listen_only = (modes & CAN_CTRLMODE_LISTENONLY) != 0;
  link.is_loopback = (modes & CAN_CTRLMODE_LOOPBACK) != 0;
  link.is_one_shot = (modes & CAN_CTRLMODE_ONE_SHOT) != 0;
  link.presumes_ack = (modes & CAN_CTRLMODE_PRESUME_ACK) != 0;
  link.restart_ms = frontOf<std::uint32_t>(attribute(data, IFLA_CAN_RESTART_MS));
  return link;
}

std::optional<CanLink> canLink(const std::string& interface) {
  const unsigned index = if_nametoindex(interface.c_str());
  if (index == 0) return std::nullopt;
  const int descriptor = socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE);
  if (descriptor < 0) return std::nullopt;
  const Request request = requestFor(index);
  std::array<char, kAnswerBytes> answer;
  ssize_t size = send(descriptor, &request, sizeof(request), 0);
  if (size >= 0) size = recv(descriptor, answer.data(), answer.size(), 0);
  close(descriptor);
  if (size < 0) return std::nullopt;
  return parseCanLink({answer.data(), static_cast<std::size_t>(size)});
}

}  // namespace tactus
