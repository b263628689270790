#include "tactus/panel/event_feed.h"

#include <algorithm>

namespace tactus {

void EventFeed::publish(std::string event) {
  {
    const std::lock_guard lock(mutex_);
    events_.push_back(std::make_shared<const std::string>(std::move(event)));
    if (events_.size() > kKept) events_.pop_front();
    ++number_;
  }
  is_new_.notify_all();
}

std::uint64_t EventFeed::number() const {
  const std::lock_guard lock(mutex_);
  return number_;
}

EventFeed::Batch EventFeed::wait(std::uint64_t number, std::chrono::milliseconds time) const {
  std::unique_lock lock(mutex_);
  is_new_.wait_for(lock, time, [&] { return number_ != number || has_ended_; });
  Batch batch{{}, number_, number > number_ || number_ - number > events_.size()};
  if (batch.is_lost) return batch;
  const auto count = static_cast<std::ptrdiff_t>(number_ - number);
  batch.events.assign(events_.end() - count, events_.end());
  return batch;
}

void EventFeed::end() {
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  is_new_.notify_all();
}

bool EventFeed::hasEnded() const {
  const std::lock_guard lock(mutex_);
  return has_ended_;
}

}  // namespace tactus
