#include "tactus/plant/power_state.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace tactus {
namespace {

using enum PowerState;

const std::vector<PowerState> kAll = {
    kNotReadyToSwitchOn, kSwitchOnDisabled, kReadyToSwitchOn,     kSwitchedOn,
    kOperationEnabled,   kQuickStopActive,  kFaultReactionActive, kFault};

/// The transitions of CiA 402 that a control word may cause, 2 to 12 and 15.
const std::set<std::pair<PowerState, PowerState>> kLegal = {
    {kSwitchOnDisabled, kReadyToSwitchOn}, {kReadyToSwitchOn, kSwitchedOn},
    {kSwitchedOn, kOperationEnabled},      {kOperationEnabled, kSwitchedOn},
    {kSwitchedOn, kReadyToSwitchOn},       {kReadyToSwitchOn, kSwitchOnDisabled},
    {kOperationEnabled, kReadyToSwitchOn}, {kOperationEnabled, kSwitchOnDisabled},
    {kSwitchedOn, kSwitchOnDisabled},      {kOperationEnabled, kQuickStopActive},
    {kQuickStopActive, kSwitchOnDisabled}, {kFault, kSwitchOnDisabled}};

TEST(PowerState, EveryControlWordLeadsAlongALegalTransitionOrNowhere) {
  std::set<std::pair<PowerState, PowerState>> seen;
  for (const PowerState state : kAll)
    for (int word = 0; word <= 0xFFFF; ++word)
      for (const bool is_edge : {false, true}) {
        const PowerState next = commanded(state, static_cast<std::uint16_t>(word), is_edge);
        if (next != state) seen.insert({state, next});
      }
  EXPECT_EQ(seen, kLegal) << "each legal one, and no other";
}

TEST(PowerState, TheUsualWordsEnableADrive) {
  PowerState state = kSwitchOnDisabled;
  EXPECT_EQ(state = commanded(state, 0x0F, false), kSwitchOnDisabled) << "not by itself";
  EXPECT_EQ(state = commanded(state, 0x06, false), kReadyToSwitchOn);
  EXPECT_EQ(state = commanded(state, 0x07, false), kSwitchedOn);
  EXPECT_EQ(state = commanded(state, 0x0F, false), kOperationEnabled);
  EXPECT_EQ(commanded(state, 0x0F, true), kOperationEnabled);
  EXPECT_EQ(commanded(state, 0x0B, false), kQuickStopActive);
  EXPECT_EQ(commanded(state, 0x00, false), kSwitchOnDisabled);
  EXPECT_EQ(commanded(kFault, 0x8F, false), kFault) << "only the edge resets";
  EXPECT_EQ(commanded(kFault, 0x80, true), kSwitchOnDisabled);
  EXPECT_EQ(commanded(kFaultReactionActive, 0x80, true), kFaultReactionActive);
  EXPECT_EQ(commanded(kQuickStopActive, 0x0F, false), kQuickStopActive);
}

TEST(PowerState, StopsEndWhereTheStandardSays) {
  EXPECT_EQ(atStandstill(kQuickStopActive), kSwitchOnDisabled);
  EXPECT_EQ(atStandstill(kFaultReactionActive), kFault);
  EXPECT_EQ(atStandstill(kOperationEnabled), kOperationEnabled);
}

TEST(PowerState, ShowsTheBitsOfTheStandard) {
  struct Row {
    PowerState state;
    int mask, value;
  };
  for (const Row& row : std::vector<Row>{{kNotReadyToSwitchOn, 0x4F, 0x00},
                                         {kSwitchOnDisabled, 0x4F, 0x40},
                                         {kReadyToSwitchOn, 0x6F, 0x21},
                                         {kSwitchedOn, 0x6F, 0x23},
                                         {kOperationEnabled, 0x6F, 0x27},
                                         {kQuickStopActive, 0x6F, 0x07},
                                         {kFaultReactionActive, 0x4F, 0x0F},
                                         {kFault, 0x4F, 0x08}})
    EXPECT_EQ(stateBits(row.state) & row.mask, row.value);
}

}  // namespace
}  // namespace tactus
