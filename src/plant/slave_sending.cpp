#include "tactus/plant/slave_drive.h"
#include "tactus/plant/slave_pdo.h"

/// What a drive of the plant sends: feedback, emergencies and its NMT state.
namespace tactus {
namespace {

// Of the status word: the bits that tell the state (CiA 402), and what no state looks like.
constexpr std::uint32_t kStateBits = 0x6F;
constexpr std::uint32_t kNoState = 0x67;

CanFrame frameOf(std::uint32_t id, std::uint8_t size) {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  return frame;
}

}  // namespace

void SlaveDrive::sendTpdoAtSync() noexcept {
  const std::uint32_t type = objects_.get(0x1800, 2);
  if (type > 240) return;
  const bool is_due =
      type == 0 ? objects_.get(0x6041) != sent_status_ : ++syncs_since_tpdo_ >= type;
  if (is_due) sendTpdo();
}

void SlaveDrive::sendTpdoOnChange() noexcept {
  const bool is_on_change = objects_.get(0x1800, 2) >= 254;
  if (nmt_ == NodeState::kOperational && is_on_change && objects_.get(0x6041) != sent_status_)
    sendTpdo();
}

void SlaveDrive::sendTpdo() noexcept {
  syncs_since_tpdo_ = 0;
  sent_status_ = objects_.get(0x6041);
  const auto id = pdoId(objects_, kTransmitPdo);
  if (!id) return;
  CanFrame frame = frameOf(*id, 0);
  packFeedback(frame);
  outbox_.push(frame);
}

/// The truth, unless the drive is in trouble.
void SlaveDrive::packFeedback(CanFrame& frame) const noexcept {
  if (!troubles_.freezes_feedback && !troubles_.tells_nonsense) return packTpdo(objects_, frame);
  ObjectDictionary told = objects_;
  if (troubles_.freezes_feedback) {
    told.set(0x6041, 0, frozen_status_);
    told.set(0x6064, 0, frozen_position_);
  }
  if (troubles_.tells_nonsense) told.set(0x6041, 0, (told.get(0x6041) & ~kStateBits) | kNoState);
  packTpdo(told, frame);
}

void SlaveDrive::sendEmergency(std::uint16_t error_code) noexcept {
  if (!isConnected()) return;
  CanFrame frame = frameOf(idFrom(0x80), 8);
  frame.data[0] = static_cast<std::uint8_t>(error_code);
  frame.data[1] = static_cast<std::uint8_t>(error_code >> 8);
  frame.data[2] = static_cast<std::uint8_t>(objects_.get(0x1001));
  outbox_.push(frame);
}

void SlaveDrive::sendNmtState(std::uint8_t state) noexcept {
  CanFrame frame = frameOf(idFrom(0x700), 1);
  frame.data[0] = state;
  outbox_.push(frame);
}

}  // namespace tactus
