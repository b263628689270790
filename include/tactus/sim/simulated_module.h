#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "tactus/control/robot.h"
#include "tactus/math/filter.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// Force and moment (F_y, F_z, M_y, M_z) in the module's frame, N and Nm.
using Wrench4 = Eigen::Vector4d;

/// The electronics of the tactile module: filters at its own rate, and every sample period turns
/// force and moment into eight channels of signed 24-bit counts, and back by its calibration. After
/// a lost sample the one before stays.
class SimulatedModule {
 public:
  explicit SimulatedModule(const SimulatedModuleConfig& config);

  /// One step at the module's rate.
  void update(const Wrench4& wrench) noexcept;

  const TactileSample& sample() const noexcept { return sample_; }
  /// The channels of the sample; zero unless quantised.
  const std::array<std::int32_t, 8>& counts() const noexcept { return counts_; }

 private:
  bool isLost() noexcept;
  Wrench4 measure(const Wrench4& wrench) noexcept;

  SimulatedModuleConfig config_;
  std::array<ButterworthLowPass, 4> filters_;
  Eigen::Matrix<double, 8, 4> channels_from_wrench_;  ///< pseudoinverse of the calibration
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  int steps_a_sample_;
  int steps_to_sample_ = 0;
  TactileSample sample_;
  std::array<std::int32_t, 8> counts_{};
};

}  // namespace tactus
