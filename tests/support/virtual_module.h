#pragma once

#include <array>

#include "support/hidden_calibration.h"
#include "tactus/cli/module_listener.h"
#include "tactus/plant/module_frames.h"
#include "tactus/sim/simulated_module.h"

namespace tactus::test {

/// A tactile module that somebody pushes on, with frames in virtual time; not one second passes.
class VirtualModule {
 public:
  VirtualModule(const TactileChannels& channels, double noise_N, std::uint32_t first_id)
      : module_(configOf(channels, noise_N)), first_id_(first_id) {}

  Wrench5 load = Wrench5::Zero();
  Wrench5 growth_per_s = Wrench5::Zero();  ///< of the load
  std::array<std::int32_t, 8> offset{};    ///< counts without load
  std::int32_t top = kModuleFullScale;     ///< counts at which amplifiers stop, of all channels
  bool is_silent = false, is_cable_broken = false;

  FrameSource source() {
    return {[this] { pass(0.5, nullptr); },
            [this](FrameBatch& frames) {
              frames.clear();
              pass(0.01, &frames);
              return t_s_;
            }};
  }

 private:
  static SimulatedModuleConfig configOf(const TactileChannels& channels, double noise_N) {
    SimulatedModuleConfig config;
    config.channels = channels;
    config.noise_N = noise_N;
    return config;
  }

  void pass(double duration_s, FrameBatch* frames) {
    for (double passed_s = 0.0; passed_s < duration_s - 1e-9; passed_s += 0.001) {
      t_s_ += 0.001;
      load += 0.001 * growth_per_s;
      module_.update(load);
      if (module_.sample().sequence == sequence_) continue;
      sequence_ = module_.sample().sequence;
      if (!frames || is_silent) continue;
      ModuleCounts counts = module_.counts();
      for (std::size_t i = 0; i < 8; ++i) counts[i] = std::clamp(counts[i] + offset[i], -top, top);
      for (const CanFrame& frame :
           moduleFrames(first_id_, static_cast<std::uint8_t>(sequence_), counts, is_cable_broken))
        frames->push(frame);
    }
  }

  SimulatedModule module_;
  std::uint32_t first_id_;
  std::uint32_t sequence_ = 0;
  double t_s_ = 100.0;
};

}  // namespace tactus::test
