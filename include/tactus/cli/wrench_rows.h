#pragma once

#include <array>
#include <string>

#include "tactus/analysis/channel_window.h"
#include "tactus/control/tactile_channels.h"

namespace tactus {

/// The rows of a calibration, in its order.
struct WrenchRow {
  const char* name;
  const char* unit;     ///< of what it tells
  const char* comment;  ///< as robot.yaml has it
};
inline constexpr std::array<WrenchRow, 5> kWrenchRows = {{{"F_y", "N", "F_y"},
                                                          {"F_z", "N", "F_z"},
                                                          {"M_y", "Nm", "M_y, m"},
                                                          {"M_z", "Nm", "M_z, m"},
                                                          {"M_x", "Nm", "M_x, m"}}};

/// Mean, sigma and drift of each channel, a row each, with a line that says what they are.
std::string channelTable(const ChannelFigures& figures);

/// What a calibration makes of counts; zero for M_x where it has no row.
Wrench5 wrenchFrom(const TactileChannels& channels, const ChannelVector& counts);
/// Its sigma, of that of the counts.
Wrench5 noiseFrom(const TactileChannels& channels, const ChannelVector& sigma);

}  // namespace tactus
