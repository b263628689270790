#include "tactus/io/can_link.h"

#include <gtest/gtest.h>
#include <linux/can/netlink.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>

#include <cstring>
#include <string>

namespace tactus {
namespace {

template <typename Value>
std::string bytesOf(const Value& value) {
  return {reinterpret_cast<const char*>(&value), sizeof(value)};
}

std::string attribute(int type, const std::string& contents) {
  const rtattr header{static_cast<unsigned short>(sizeof(rtattr) + contents.size()),
                      static_cast<unsigned short>(type)};
  std::string bytes = bytesOf(header) + contents;
  bytes.resize((bytes.size() + 3) / 4 * 4, '\x55');
  return bytes;
}

/// As the kernel answers RTM_GETLINK.
std::string linkMessage(const std::string& kind, const std::string& data) {
  const std::string info =
      attribute(IFLA_INFO_KIND, kind + '\0') + attribute(IFLA_INFO_DATA | NLA_F_NESTED, data);
  const std::string attributes = attribute(IFLA_IFNAME, std::string("can0\0", 5)) +
                                 attribute(IFLA_LINKINFO | NLA_F_NESTED, info) +
                                 attribute(IFLA_TXQLEN, "1234");
  ifinfomsg link{};
  nlmsghdr header{};
  header.nlmsg_type = RTM_NEWLINK;
  header.nlmsg_len = static_cast<unsigned>(sizeof(header) + sizeof(link) + attributes.size());
  return bytesOf(header) + bytesOf(link) + attributes;
}

std::string controllerData(unsigned bit_rate_per_s, unsigned restart_ms) {
  can_bittiming timing{};
  timing.bitrate = bit_rate_per_s;
  timing.sample_point = 875;
  return attribute(IFLA_CAN_CTRLMODE, "12345678") + attribute(IFLA_CAN_BITTIMING, bytesOf(timing)) +
         attribute(IFLA_CAN_RESTART_MS, bytesOf(restart_ms));
}

TEST(CanLink, ReadsKindBitRateAndRestart) {
  const auto link = parseCanLink(linkMessage("can", controllerData(500'000, 100)));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "can");
  EXPECT_EQ(link->bit_rate_per_s, 500'000);
  EXPECT_EQ(link->restart_ms, 100);
}

TEST(CanLink, ReadsTheRateOfTheData) {
  can_bittiming timing{};
  timing.bitrate = 5'000'000;
  const auto link = parseCanLink(linkMessage(
      "can", controllerData(1'000'000, 0) + attribute(IFLA_CAN_DATA_BITTIMING, bytesOf(timing))));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->bit_rate_per_s, 1'000'000);
  EXPECT_EQ(link->data_bit_rate_per_s, 5'000'000);
  EXPECT_EQ(parseCanLink(linkMessage("can", controllerData(1, 0)))->data_bit_rate_per_s, 0);
}

TEST(CanLink, ReadsTheControllersModes) {
  const auto linkIn = [](unsigned modes) {
    const can_ctrlmode mode{.mask = 0xffff, .flags = modes};
    return *parseCanLink(
        linkMessage("can", attribute(IFLA_CAN_CTRLMODE, bytesOf(mode)) + controllerData(1, 0)));
  };
  for (unsigned mode = 1; mode <= 0x8000; mode *= 2) {
    EXPECT_EQ(linkIn(mode).is_loopback, mode == 0x01);
    EXPECT_EQ(linkIn(mode).is_listen_only, mode == 0x02);
    EXPECT_EQ(linkIn(mode).is_one_shot, mode == 0x08);
    EXPECT_EQ(linkIn(mode).presumes_ack, mode == 0x40);
  }
}

TEST(CanLink, ReadsWhetherTheControllerIsOnTheBus) {
  const auto linkIn = [](std::uint32_t state) {
    return *parseCanLink(linkMessage(
        "can", controllerData(1'000'000, 0) + attribute(IFLA_CAN_STATE, bytesOf(state))));
  };
  for (const std::uint32_t state :
       {CAN_STATE_ERROR_ACTIVE, CAN_STATE_ERROR_WARNING, CAN_STATE_ERROR_PASSIVE, CAN_STATE_BUS_OFF,
        CAN_STATE_STOPPED}) {
    EXPECT_EQ(linkIn(state).is_passive, state == CAN_STATE_ERROR_PASSIVE) << state;
    EXPECT_EQ(linkIn(state).is_bus_off, state == CAN_STATE_BUS_OFF) << state;
  }
}

TEST(CanLink, AnotherKindsAttributesAreNotTakenForACans) {
  const auto link = parseCanLink(linkMessage("vcan", controllerData(500'000, 100)));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->kind, "vcan");
  EXPECT_EQ(link->bit_rate_per_s, 0);
  EXPECT_EQ(link->restart_ms, 0);
}

TEST(CanLink, AControllerWithoutABitRateHasNone) {
  const auto link = parseCanLink(linkMessage("can", ""));
  ASSERT_TRUE(link);
  EXPECT_EQ(link->bit_rate_per_s, 0);
}

/// Sizes are the kernel's word, but not trusted. In memory of its own, so that sanitizers see it.
TEST(CanLink, ReadsNothingBehindAMessageCutOffOrCorrupt) {
  const std::string whole = linkMessage("can", controllerData(500'000, 100));
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::vector<char> cut(whole.begin(), whole.begin() + static_cast<long>(size));
    EXPECT_FALSE(parseCanLink(cut)) << size;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<char> corrupt(whole.begin(), whole.end());
    corrupt[i] = '\xFF';
    parseCanLink(corrupt);
    corrupt[i] = 0;
    parseCanLink(corrupt);
  }
  std::string error = whole;
  error[offsetof(nlmsghdr, nlmsg_type)] = NLMSG_ERROR;
  EXPECT_FALSE(parseCanLink(error));
}

TEST(CanLink, InterfacesOfTheKernelWithoutAKindSayNothing) {
  EXPECT_FALSE(canLink("lo"));
  EXPECT_FALSE(canLink("no-such-can"));
}

}  // namespace
}  // namespace tactus
