#pragma once

#include <array>
#include <cstdint>

#include "tactus/record/side_topic.h"
#include "tactus/record/ulog_messages.h"
#include "tactus/record/ulog_topic.h"
#include "tactus/record/ulog_writer.h"

namespace tactus {

/// What a log says before its first cycle, and how to read the cycles.
struct UlogDefinitions {
  /// Parameters come as logged: with slashes, and rounded to float. Infos are those of type char[].
  LogDescription description;
  TopicLayout topic;
  std::uint16_t cycle_id = 0;  ///< which data messages are cycles
  struct Side {
    bool is_there = false;  ///< not in a log of an older version
    SideLayout layout;
    std::uint16_t id = 0;  ///< which data messages are of it
  };
  std::array<Side, kSideTopics> sides;  ///< as sideTopics()
};

/// Reads up to the subscription of the cycles. Throws InputError, also for a log that ends before.
UlogDefinitions readDefinitions(UlogMessages& messages);

}  // namespace tactus
