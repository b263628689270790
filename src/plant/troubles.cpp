#include "tactus/plant/troubles.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

using Kind = Trouble::Kind;

std::int64_t nanoseconds(double t_s) {
  constexpr double kLongest_s = 1e9;
  return std::llround(1e9 * std::min(t_s, kLongest_s));
}

bool concerns(const Trouble& trouble, int bus, std::uint32_t id) {
  return trouble.bus == bus && (trouble.id == 0 || trouble.id == id);
}

}  // namespace

std::int64_t TroubleScript::nextChange_ns(std::int64_t t_ns) const noexcept {
  std::int64_t next_ns = kNever_ns;
  if (!hasStarted()) return next_ns;
  for (const Trouble& trouble : troubles_)
    for (const std::int64_t edge_ns : {begin_ns(trouble), end_ns(trouble)})
      if (edge_ns > t_ns) next_ns = std::min(next_ns, edge_ns);
  return next_ns;
}

bool TroubleScript::isActive(const Trouble& trouble, std::int64_t t_ns) const noexcept {
  return hasStarted() && t_ns >= begin_ns(trouble) && t_ns < end_ns(trouble);
}

bool TroubleScript::isActive(Kind kind, std::int64_t t_ns) const noexcept {
  return std::any_of(troubles_.begin(), troubles_.end(), [&](const Trouble& trouble) {
    return trouble.kind == kind && isActive(trouble, t_ns);
  });
}

bool TroubleScript::isActive(Kind kind, int bus, std::int64_t t_ns) const noexcept {
  return std::any_of(troubles_.begin(), troubles_.end(), [&](const Trouble& trouble) {
    return trouble.kind == kind && trouble.bus == bus && isActive(trouble, t_ns);
  });
}

bool TroubleScript::isActive(Kind kind, int bus, std::uint32_t id,
                             std::int64_t t_ns) const noexcept {
  return std::any_of(troubles_.begin(), troubles_.end(), [&](const Trouble& trouble) {
    return trouble.kind == kind && concerns(trouble, bus, id) && isActive(trouble, t_ns);
  });
}

std::int64_t TroubleScript::delay_ns(int bus, std::uint32_t id, std::int64_t t_ns) const noexcept {
  std::int64_t longest_ns = 0;
  for (const Trouble& trouble : troubles_)
    if (trouble.kind == Kind::kDelay && concerns(trouble, bus, id) && isActive(trouble, t_ns))
      longest_ns = std::max(longest_ns, nanoseconds(trouble.delay_s));
  return longest_ns;
}

std::int64_t TroubleScript::begin_ns(const Trouble& trouble) const noexcept {
  return start_ns_ + nanoseconds(trouble.from_s);
}

std::int64_t TroubleScript::end_ns(const Trouble& trouble) const noexcept {
  return start_ns_ + nanoseconds(trouble.until_s);
}

FrameTroubles::FrameTroubles(int bus) : bus_(bus), random_(static_cast<unsigned>(bus) + 1U) {
  line_.reserve(kCapacity);
}

void FrameTroubles::add(BusDelivery delivery, const TroubleScript& script,
                        std::int64_t t_ns) noexcept {
  CanFrame& frame = delivery.item.frame;
  const std::uint32_t id = frame.id;
  if (frame.kind == FrameKind::kError) {
    insert(delivery, t_ns);
    return;
  }
  if (script.isActive(Kind::kDrop, bus_, id, t_ns)) return;
  if (script.isActive(Kind::kCorrupt, bus_, id, t_ns)) corrupt(frame);
  const bool is_swapped = script.isActive(Kind::kReorder, bus_, id, t_ns);
  if (is_swapped && !has_held_) {
    held_ = delivery;
    has_held_ = true;
    return;
  }
  const std::int64_t due_ns = t_ns + script.delay_ns(bus_, id, t_ns);
  insert(delivery, due_ns);
  if (script.isActive(Kind::kDuplicate, bus_, id, t_ns)) insert(delivery, due_ns);
  if (is_swapped) release(t_ns);
}

std::int64_t FrameTroubles::nextDelivery_ns() const noexcept {
  return line_.empty() ? kNever_ns : line_.front().due_ns;
}

BusDelivery FrameTroubles::pop() noexcept {
  const BusDelivery delivery = line_.front().delivery;
  line_.erase(line_.begin());
  return delivery;
}

void FrameTroubles::release(std::int64_t t_ns) noexcept {
  if (has_held_) insert(held_, t_ns);
  has_held_ = false;
}

/// A burst of one to three bits somewhere in the data.
void FrameTroubles::corrupt(CanFrame& frame) noexcept {
  if (frame.size == 0) return;
  const unsigned flips = 1U + static_cast<unsigned>(random_() % 3U);
  const auto first = static_cast<unsigned>(random_() % (8U * frame.size));
  for (unsigned i = 0; i < flips; ++i) {
    const unsigned bit = (first + i) % (8U * frame.size);
    frame.data[bit / 8] = static_cast<std::uint8_t>(frame.data[bit / 8] ^ (1U << bit % 8));
  }
}

void FrameTroubles::insert(const BusDelivery& delivery, std::int64_t due_ns) noexcept {
  if (line_.size() == kCapacity) return;
  const auto after =
      std::upper_bound(line_.begin(), line_.end(), due_ns,
                       [](std::int64_t t_ns, const Late& late) { return t_ns < late.due_ns; });
  line_.insert(after, {due_ns, delivery});
}

}  // namespace tactus
