#include "campaign/frame_trouble.h"

#include <utility>

namespace tactus::campaign {
namespace {

void flipBit(CanFrame& frame, unsigned bit) {
  if (frame.size == 0) {
    frame.id ^= 1U << bit % 11;
    return;
  }
  const unsigned at = bit % (8U * frame.size);
  frame.data[at / 8] = static_cast<std::uint8_t>(frame.data[at / 8] ^ (1U << at % 8));
}

}  // namespace

FrameGate::Passing FrameGate::pass(const SeenFrame& seen, CanFrame& frame) {
  if (!trouble_) seen_.push_back(seen);
  if (!trouble_ || passed_++ != trouble_->ordinal) return {};
  troubled_ms_ = seen.t_ms;
  using enum FrameTrouble::How;
  switch (trouble_->how) {
    case kLost:
      return {0};
    case kDoubled:
      return {2};
    case kDelayed:
      held_ = {seen, frame};
      return {0};
    case kFlipped:
      has_spoilt_command_ = seen.is_sent;
      flipBit(frame, trouble_->bit);
  }
  return {};
}

std::optional<FrameGate::Held> FrameGate::takeHeld() { return std::exchange(held_, std::nullopt); }

}  // namespace tactus::campaign
