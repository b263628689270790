#pragma once

#include <cstdint>

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
  bool has_gains = false;      ///< a log of an older version has none
  GainsLayout gains;
  std::uint16_t gains_id = 0;  ///< which data messages are gains
};

/// Reads up to the subscription of the cycles. Throws InputError, also for a log that ends before.
UlogDefinitions readDefinitions(UlogMessages& messages);

}  // namespace tactus
