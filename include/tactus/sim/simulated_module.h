#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <random>

#include "tactus/control/robot.h"
#include "tactus/math/filter.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// The cells and electronics of the tactile module: filters at its own rate, and every sample
/// period turns force and moment into eight channels of signed 24-bit counts, and back by the
/// calibration that its reader knows, who tares and, if it is his part, filters them. After a lost
/// sample the one before stays; a late one comes at the latest with the next.
class SimulatedModule {
 public:
  /// at_rest: what it feels at the start without a contact, and has for long.
  explicit SimulatedModule(const SimulatedModuleConfig& config,
                           const std::optional<Wrench5>& at_rest = std::nullopt);

  /// One step at the module's rate.
  void update(const Wrench5& wrench) noexcept;

  const TactileSample& sample() const noexcept { return sample_; }
  /// The channels of the sample; zero unless quantised.
  const std::array<std::int32_t, 8>& counts() const noexcept { return counts_; }
  /// A channel of the sample is at its rail.
  bool isSaturated() const noexcept;

 private:
  using Channels = Eigen::Matrix<double, 8, 1>;

  Wrench5 filter(const Wrench5& wrench) noexcept;
  Wrench5 filterFromRest(const Wrench5& wrench) noexcept;
  double chance() noexcept;
  void deliver() noexcept;
  Wrench5 turned(const Wrench5& wrench) const noexcept;
  void distort(Channels& forces_N) const noexcept;
  Wrench5 measure(const Wrench5& wrench) noexcept;
  Wrench5 read(Channels& forces_N) noexcept;

  SimulatedModuleConfig config_;
  std::array<ButterworthLowPass, 5> filters_;
  /// Pseudoinverse of the calibration; that of M_x is zero where it is not told.
  Eigen::Matrix<double, 8, 4> channels_from_wrench_;
  Channels channels_from_moment_x_;
  std::optional<Wrench5> at_rest_;
  Wrench5 tare_ = Wrench5::Zero();
  double sin_error_ = 0.0, cos_error_ = 1.0;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  int steps_a_sample_;
  int steps_to_sample_ = 0;
  int steps_to_delivery_ = 0;  ///< of what was measured; 0: none is under way
  double t_s_ = 0.0;           ///< of channels that drift
  TactileSample measured_, sample_;
  std::array<std::int32_t, 8> measured_counts_{}, counts_{};
};

}  // namespace tactus
