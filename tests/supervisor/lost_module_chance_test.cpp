#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/replay.h"

/// An arm with a skin whose modules have troubles by chance on the buses, one or several at a time:
/// judged every cycle.
namespace tactus {
namespace {

using test::VirtualRobotCell;

constexpr int kSkinModules = 3;
constexpr int kSeen_ms = 34;  ///< max_sample_age_s, a sample, and the news on the bus
constexpr double kSkinShare = 0.25;

struct ModuleTroubleByChance {
  enum class Kind { kSilent, kBroken, kFrameMissing, kSaturated } kind;
  int module, from_ms, until_ms;

  bool isAtWork(int t_ms) const { return t_ms >= from_ms && t_ms < until_ms; }
};

using Troubles = std::vector<ModuleTroubleByChance>;

struct PlaceOnBus {
  int bus;
  std::uint32_t first_id;
};
constexpr std::array<PlaceOnBus, kSkinModules> kPlaces = {{{3, 0x100}, {3, 0x110}, {4, 0x100}}};

Troubles drawTroubles(test::Random& random) {
  Troubles troubles;
  const int count = random.integer(1, 4);
  for (int i = 0; i < count; ++i) {
    ModuleTroubleByChance trouble{};
    trouble.kind =
        static_cast<ModuleTroubleByChance::Kind>(random.index(random.chance(0.1) ? 4 : 3));
    trouble.module = random.index(kSkinModules);
    trouble.from_ms = random.integer(1, 3000);
    trouble.until_ms = trouble.from_ms + static_cast<int>(random.logUniform(2.0, 3000.0));
    troubles.push_back(trouble);
  }
  return troubles;
}

void spoilFrame(const Troubles& troubles, int t_ms, int bus, CanFrame& frame) {
  using enum ModuleTroubleByChance::Kind;
  const CanFrame original = frame;
  for (const ModuleTroubleByChance& trouble : troubles) {
    const PlaceOnBus& place = kPlaces[trouble.module];
    const std::uint32_t k = original.id - place.first_id;
    if (!trouble.isAtWork(t_ms) || bus != place.bus || k > 3) continue;
    if (trouble.kind == kSilent || (trouble.kind == kFrameMissing && k == 2)) frame.id = 0x7FF;
    if (trouble.kind == kBroken) frame.data[1] |= 2;
    if (trouble.kind == kSaturated) frame.data[1] |= 1;
  }
}

struct ChanceRun {
  bool was_lost = false, has_stopped = false;
};

/// Every cycle: within all limits; no module that tells nothing is taken for one that does; slow as
/// long as one is lost, and not for ever.
ChanceRun playTroubles(const Scene& scene, const Troubles& troubles, std::uint64_t seed) {
  VirtualRobotCell cell(scene);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  int t_ms = 0;
  cell.on_frame = [&](int bus, CanFrame& frame) { spoilFrame(troubles, t_ms, bus, frame); };
  std::vector<CycleRecord> records{cell.record()};
  std::array<int, kSkinModules> silent_ms{};
  int lost_ms = 0, quiet_ms = 0;
  ChanceRun run;
  const JointLimits& limits = scene.controller.limits;
  for (t_ms = 1; t_ms < 9000; ++t_ms) {
    cell.step();
    cell.cycle.prepare();
    const CycleRecord record = cell.record();
    records.push_back(record);
    bool is_quiet = true;
    for (int i = 0; i < kSkinModules; ++i) {
      const bool is_silent = std::ranges::any_of(
          troubles, [&](const auto& x) { return x.module == i && x.isAtWork(t_ms); });
      silent_ms[i] = is_silent ? silent_ms[i] + 1 : 0;
      is_quiet = is_quiet && !is_silent;
      const bool is_lost = (record.modules_lost >> i & 1U) != 0;
      const bool is_running = cell.cycle.report().mode == Mode::kRunning;
      if (is_running && silent_ms[i] > kSeen_ms) {
        EXPECT_TRUE(is_lost) << "seed " << seed << ", module " << i << " at " << t_ms;
      }
      if (is_lost) {
        EXPECT_EQ(record.force_sensor_N[i], 0.0) << "seed " << seed;
      }
    }
    lost_ms = record.modules_lost != 0 ? lost_ms + 1 : 0;
    quiet_ms = is_quiet ? quiet_ms + 1 : 0;
    run.was_lost = run.was_lost || lost_ms > 0;
    run.has_stopped = run.has_stopped || cell.cycle.report().mode != Mode::kRunning;
    if (!run.has_stopped && lost_ms > 200) {
      EXPECT_EQ(record.speed_share, kSkinShare) << "seed " << seed << " at " << t_ms;
    }
    if (!run.has_stopped && quiet_ms > 2300) {
      EXPECT_EQ(record.speed_share, 1.0) << "seed " << seed << " at " << t_ms;
    }
    for (int i = 0; i < limits.max_velocity.size(); ++i) {
      const CycleRecord& before = records[records.size() - 2];
      const double share = run.has_stopped ? 1.0 : record.speed_share;
      EXPECT_LE(std::abs(record.dq[i]), share * limits.max_velocity[i] * (1.0 + 1e-9));
      EXPECT_LE(std::abs(record.dq[i] - before.dq[i]), 1e-3 * limits.max_acceleration[i] + 1e-9);
    }
    if (::testing::Test::HasFailure()) break;
    if (cell.cycle.isFinished()) break;
  }
  const Controller controller(scene.controller);
  Replayer replayer(controller, scene.controller.chain.size(), scene.period_s);
  ReplayComparison comparison({9, 3, false, kSkinModules, false, true});
  for (const CycleRecord& recorded : records) {
    if (!isCommanding(static_cast<Mode>(recorded.mode))) break;
    comparison.add(recorded, replayer.replay(recorded));
  }
  EXPECT_EQ(comparison.differingCycles(), 0) << "seed " << seed;
  return run;
}

TEST(LostModuleByChance, LeavesTheArmSlowOrAtRest) {
  const Scene scene =
      test::shippedScene("whole_arm/crops9_skin_two_links",
                         {{"robot.module_lost", "go_on_slowly"}, {"controller.variant", "none"}});
  int lost = 0, stopped = 0;
  for (std::uint64_t seed = 1; seed <= 40 && !HasFailure(); ++seed) {
    test::Random random(seed);
    const ChanceRun run = playTroubles(scene, drawTroubles(random), seed);
    lost += run.was_lost ? 1 : 0;
    stopped += run.has_stopped ? 1 : 0;
  }
  std::printf("of 40 runs %d lost a module, %d stopped\n", lost, stopped);
  EXPECT_GT(lost, 20) << "this test is blind";
  EXPECT_GT(stopped, 3) << "this test is blind";
}

}  // namespace
}  // namespace tactus
