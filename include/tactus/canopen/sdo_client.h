#pragma once

#include <cstdint>

#include "tactus/canopen/can_frame.h"

namespace tactus {

enum class SdoStatus : std::uint8_t { kIdle, kBusy, kDone, kAborted, kTimedOut };

/// An entry of a node's object dictionary.
struct ObjectEntry {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  int size = 4;  ///< bytes, 1..4

  bool operator==(const ObjectEntry&) const = default;
};

/// Expedited SDO transfers with one node (CiA 301, 7.2.4), one at a time. Knows no clock: time is
/// counted in cycles.
///
/// Answers that nobody asked for (in idle, of another node, of another entry, of wrong size) are
/// ignored. Answers to this transfer that break the protocol end it, and the node is told by an
/// abort: a segmented or unknown answer, data of another length than the entry's.
class SdoClient {
 public:
  SdoClient(int node_id, int timeout_cycles) noexcept;

  /// Begins a transfer, in place of one that is still going on. `value`: its low entry.size bytes.
  void download(const ObjectEntry& entry, std::uint32_t value) noexcept;
  void upload(const ObjectEntry& entry) noexcept;

  void receive(const CanFrame& frame) noexcept;
  /// Once a cycle, after all frames: sends request or abort, counts the time-out.
  void update(FrameBatch& out) noexcept;

  SdoStatus status() const noexcept { return status_; }
  const ObjectEntry& entry() const noexcept { return entry_; }
  std::uint32_t value() const noexcept { return value_; }  ///< last uploaded; upper bytes are 0
  /// Of kAborted, the node's or the one told to it.
  std::uint32_t abortCode() const noexcept { return abort_code_; }

 private:
  void begin(const ObjectEntry& entry) noexcept;
  void receiveAbort(const CanFrame& frame) noexcept;
  void receiveUpload(const CanFrame& frame) noexcept;
  void refuse(std::uint32_t abort_code) noexcept;
  CanFrame frameFor(std::uint8_t command, std::uint32_t data) const noexcept;

  int node_id_;
  int timeout_cycles_;
  SdoStatus status_ = SdoStatus::kIdle;
  ObjectEntry entry_;
  bool is_upload_ = false;
  std::uint32_t value_ = 0;
  std::uint32_t abort_code_ = 0;
  int waited_cycles_ = 0;
  CanFrame pending_;  ///< request or abort to be sent
  bool has_pending_ = false;
};

}  // namespace tactus
