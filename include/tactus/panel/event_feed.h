#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace tactus {

/// The newest events for as many readers as there are, none of which holds up the others.
class EventFeed {
 public:
  using Event = std::shared_ptr<const std::string>;
  static constexpr std::size_t kKept = 64;

  struct Batch {
    std::vector<Event> events;
    std::uint64_t number = 0;  ///< to go on from
    bool is_lost = false;      ///< the reader was too slow: events are missing
  };

  void publish(std::string event);
  std::uint64_t number() const;
  /// Waits for events behind that number; after the time, or at the end, there may be none.
  Batch wait(std::uint64_t number, std::chrono::milliseconds time) const;
  void end();
  bool hasEnded() const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable is_new_;
  std::deque<Event> events_;
  std::uint64_t number_ = 0;  ///< of the newest event
  bool has_ended_ = false;
};

}  // namespace tactus
