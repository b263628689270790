#include "tactus/commission/object_reader.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactus/canopen/canopen.h"

namespace tactus {

ObjectReader::ObjectReader(int node_id, std::vector<ObjectEntry> entries, int timeout_cycles,
                           int tries)
    : node_id_(node_id),
      entries_(std::move(entries)),
      sdo_(node_id, timeout_cycles),
      tries_(tries) {
  values_.reserve(entries_.size());
}

/// Of what other masters ask there is nothing to be counted.
void ObjectReader::receive(const CanFrame& frame) noexcept {
  sdo_.receive(frame);
  if (!isDataFrame(frame, cob_id::kSdoAnswer + static_cast<std::uint32_t>(node_id_), 8)) return;
  const bool is_ours = std::ranges::any_of(entries_, [&frame](const ObjectEntry& entry) {
    return readLittleEndian(frame, 1, 2) == entry.index && frame.data[3] == entry.subindex;
  });
  if (is_ours) ++answers_;
}

void ObjectReader::update(FrameBatch& out) noexcept {
  if (isDone()) return;
  judge();
  const bool may_ask = sdo_.status() != SdoStatus::kBusy && !isDone();
  if (may_ask) {
    sdo_.upload(entries_[values_.size()]);
    ++requests_;
  }
  sdo_.update(out);
}

void ObjectReader::judge() noexcept {
  switch (sdo_.status()) {
    case SdoStatus::kIdle:
    case SdoStatus::kBusy:
      return;
    case SdoStatus::kTimedOut:
      if (++tried_ < tries_) return;
      is_silent_ = values_.empty();
      if (is_silent_) return;
      values_.emplace_back();  // some drives say nothing where they have no such entry
      break;
    case SdoStatus::kAborted:
      values_.emplace_back();
      break;
    case SdoStatus::kDone:
      values_.emplace_back(sdo_.value());
      break;
  }
  tried_ = 0;
}

BusReader::BusReader(const std::vector<int>& node_ids, const std::vector<ObjectEntry>& entries,
                     int timeout_cycles, int tries, int pace_cycles)
    : pace_cycles_(pace_cycles) {
  for (const int id : node_ids) nodes_.emplace_back(id, entries, timeout_cycles, tries);
}

void BusReader::receive(const CanFrame& frame) noexcept {
  for (ObjectReader& node : nodes_) node.receive(frame);
}

void BusReader::update(FrameBatch& out) noexcept {
  const auto begun = std::min<std::size_t>(nodes_.size(), 1 + cycles_ / pace_cycles_);
  for (std::size_t i = 0; i < begun; ++i) nodes_[i].update(out);
  ++cycles_;
}

bool BusReader::isDone() const noexcept {
  return std::ranges::all_of(nodes_, [](const ObjectReader& node) { return node.isDone(); });
}

int readingPace(double bit_rate_per_s, double period_s) noexcept {
  constexpr double kFrameBits = 135.0;  // eight bytes, all stuff bits
  constexpr double kShare = 0.5;
  return std::max(
      1, static_cast<int>(std::ceil(2.0 * kFrameBits / kShare / bit_rate_per_s / period_s)));
}

}  // namespace tactus
