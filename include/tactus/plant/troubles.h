#pragma once

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tactus/plant/plant_bus.h"
#include "tactus/plant/trouble.h"

namespace tactus {

/// The script: which troubles are at work when. A trouble works from `from_s` on and has ended at
/// `until_s`, both counted from start().
class TroubleScript {
 public:
  explicit TroubleScript(std::vector<Trouble> troubles) : troubles_(std::move(troubles)) {}

  void start(std::int64_t t_ns) noexcept { start_ns_ = t_ns; }
  bool hasStarted() const noexcept { return start_ns_ != kNever_ns; }

  /// When the next one begins or ends, after t_ns.
  std::int64_t nextChange_ns(std::int64_t t_ns) const noexcept;
  bool isActive(Trouble::Kind kind, std::int64_t t_ns) const noexcept;
  bool isActive(Trouble::Kind kind, int bus, std::int64_t t_ns) const noexcept;
  /// One of this kind, on this bus, for this frame or node id; the script's id 0 is any.
  bool isActive(Trouble::Kind kind, int bus, std::uint32_t id, std::int64_t t_ns) const noexcept;
  /// The longest of the delays that work on this id of the bus.
  std::int64_t delay_ns(int bus, std::uint32_t id, std::int64_t t_ns) const noexcept;

 private:
  bool isActive(const Trouble& trouble, std::int64_t t_ns) const noexcept;
  std::int64_t begin_ns(const Trouble& trouble) const noexcept;
  std::int64_t end_ns(const Trouble& trouble) const noexcept;

  std::vector<Trouble> troubles_;
  std::int64_t start_ns_ = kNever_ns;
};

/// What happens to the frames of one bus on their way to who should hear them: they vanish, come
/// late, twice, in wrong order or with wrong bits.
class FrameTroubles {
 public:
  /// 16 frames a millisecond for as long as the longest delay that a scene may have.
  static constexpr std::size_t kCapacity = 4096;

  explicit FrameTroubles(int bus);

  void add(BusDelivery delivery, const TroubleScript& script, std::int64_t t_ns) noexcept;
  std::int64_t nextDelivery_ns() const noexcept;
  /// The one due at nextDelivery_ns().
  BusDelivery pop() noexcept;
  /// Once a trouble has ended: lets go what waits for a frame to swap with.
  void release(std::int64_t t_ns) noexcept;

 private:
  struct Late {
    std::int64_t due_ns;
    BusDelivery delivery;
  };

  void corrupt(CanFrame& frame) noexcept;
  void insert(const BusDelivery& delivery, std::int64_t due_ns) noexcept;

  int bus_;
  std::vector<Late> line_;  ///< by time, in the order they came; never grows beyond kCapacity
  BusDelivery held_;        ///< to be swapped with the next one
  bool has_held_ = false;
  std::mt19937 random_;
};

}  // namespace tactus
