#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/sdo_client.h"

namespace tactus {

/// Reads entries of one node's object dictionary, one after the other. Two devices with one node id
/// both answer each request.
class ObjectReader {
 public:
  /// tries: of each entry, until the node answers.
  ObjectReader(int node_id, std::vector<ObjectEntry> entries, int timeout_cycles, int tries);

  void receive(const CanFrame& frame) noexcept;
  void update(FrameBatch& out) noexcept;  ///< once a cycle, after all frames

  bool isDone() const noexcept { return values_.size() == entries_.size() || is_silent_; }
  /// It was asked for the first entry and said nothing at all.
  bool isSilent() const noexcept { return is_silent_; }
  int nodeId() const noexcept { return node_id_; }
  /// More answers came than requests went; a single one may be a frame that its sender repeated.
  bool isAnsweredTwice() const noexcept { return answers_ >= requests_ + kMostRepeated + 1; }
  /// Nothing where the node refused, said nothing, or was not asked any more.
  std::optional<std::uint32_t> value(std::size_t entry) const noexcept {
    return entry < values_.size() ? values_[entry] : std::nullopt;
  }

 private:
  static constexpr int kMostRepeated = 1;

  void judge() noexcept;

  int node_id_;
  std::vector<ObjectEntry> entries_;
  std::vector<std::optional<std::uint32_t>> values_;
  SdoClient sdo_;
  int tries_;
  int tried_ = 0;                   ///< of this entry
  int requests_ = 0, answers_ = 0;  ///< of all entries
  bool is_silent_ = false;
};

/// Reads the same entries of several nodes of a bus, side by side. So that they fit its queues and
/// its bit rate, a node is begun only every so many cycles.
class BusReader {
 public:
  BusReader(const std::vector<int>& node_ids, const std::vector<ObjectEntry>& entries,
            int timeout_cycles, int tries, int pace_cycles);

  void receive(const CanFrame& frame) noexcept;
  void update(FrameBatch& out) noexcept;  ///< once a cycle, after all frames
  bool isDone() const noexcept;
  const std::vector<ObjectReader>& nodes() const noexcept { return nodes_; }

 private:
  std::vector<ObjectReader> nodes_;
  int pace_cycles_;
  long cycles_ = 0;
};

/// Cycles in which a bus carries a request and its answer with room to spare.
int readingPace(double bit_rate_per_s, double period_s) noexcept;

}  // namespace tactus
