#include "tactus/io/bus_ids.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace tactus {
namespace {

bool contains(const std::vector<IdFilter>& filters, const IdFilter& wanted) {
  return std::ranges::any_of(filters, [&](const IdFilter& filter) {
    return filter.id == wanted.id && filter.mask == wanted.mask &&
           filter.is_extended == wanted.is_extended && filter.is_fd == wanted.is_fd;
  });
}

TEST(BusIds, OfAMoteusAreItsCommandAndItsReplyOfEitherLength) {
  HardwareConfig hardware;
  hardware.buses = {{"can0", 1e6, 5e6}};
  hardware.drives = {{.kind = DriveKind::kMoteus, .node_id = 2},
                     {.kind = DriveKind::kMoteus, .joint = 1, .node_id = 100}};
  const BusIds ids = busIds(hardware, 0);
  EXPECT_TRUE(contains(ids.sent, {0x8002, 0x1FFFFFFF, true, true}));
  EXPECT_TRUE(contains(ids.received, {0x200, 0x7FF, false, true}));
  EXPECT_TRUE(contains(ids.received, {0x200, 0x1FFFFFFF, true, true}));
  EXPECT_TRUE(contains(ids.received, {0x6400, 0x1FFFFFFF, true, true}));
  EXPECT_EQ(ids.received.size(), 3u) << "0x6400 has more than 11 bits";
  EXPECT_EQ(ids.sent.size(), 3u) << "no SYNC and no NMT, but the probe";
  hardware.drives[1].kind = DriveKind::kCia402;
  const BusIds mixed = busIds(hardware, 0);
  EXPECT_TRUE(contains(mixed.sent, {0x080}));
  EXPECT_TRUE(contains(mixed.received, {0x1E4}));
}

}  // namespace
}  // namespace tactus
