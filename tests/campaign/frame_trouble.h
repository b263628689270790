#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/canopen/can_frame.h"

namespace tactus::campaign {

/// What befalls one frame of a run.
struct FrameTrouble {
  enum class How : std::uint8_t { kLost, kDoubled, kDelayed, kFlipped } how = How::kLost;
  int ordinal = 0;   ///< of the run's data frames in either direction, as they pass
  unsigned bit = 0;  ///< that is flipped, of the frame's data; of its id, if it has none
};
inline constexpr std::array<const char*, 4> kFrameTroubles = {"lost", "doubled", "delayed",
                                                              "flipped"};

struct SeenFrame {
  bool is_sent = false;  ///< by the daemon
  int bus = 0;
  std::uint32_t id = 0;
  int t_ms = 0;
};

/// Lets frames pass, and counts them.
class FrameGate {
 public:
  explicit FrameGate(std::optional<FrameTrouble> trouble) : trouble_(trouble) {}

  struct Passing {
    int copies = 1;  ///< that arrive now
  };
  /// May change the frame.
  Passing pass(const SeenFrame& seen, CanFrame& frame);

  struct Held {
    SeenFrame seen;
    CanFrame frame;
  };
  std::optional<Held> takeHeld();                   ///< what the cycle before kept back
  int troubled_ms() const { return troubled_ms_; }  ///< -1: not yet
  bool hasSpoiltCommand() const { return has_spoilt_command_; }
  const std::vector<SeenFrame>& seen() const { return seen_; }

 private:
  std::optional<FrameTrouble> trouble_;
  std::optional<Held> held_;
  int passed_ = 0;
  int troubled_ms_ = -1;
  bool has_spoilt_command_ = false;  ///< a flipped bit of what the daemon sent
  std::vector<SeenFrame> seen_;      ///< of a run without trouble
};

}  // namespace tactus::campaign
