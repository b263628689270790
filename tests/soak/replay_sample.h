#pragma once

#include <string>
#include <vector>

namespace tactus::soak {

/// What was replayed so far.
struct ReplayCounts {
  long long samples = 0, files = 0;
  long long unknown = 0;  ///< samples without a cycle whose state the logs tell
  long long cycles = 0;   ///< compared to the bit
  long long skipped = 0;  ///< of which the logs that are there do not tell the state
};

/// Replays the log in a folder, as far as it is there. Lines that say what is wrong; at_least: so
/// many cycles have to be in it.
std::vector<std::string> replaySample(const std::string& folder, long long at_least,
                                      ReplayCounts& counts);

}  // namespace tactus::soak
