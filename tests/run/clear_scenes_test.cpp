#include <gtest/gtest.h>

#include "support/shipped_scene.h"
#include "tactus/control/nearest_body.h"
#include "tactus/run/simulation.h"

/// The scenes of config/scenes/whole_arm: what they keep clear of they would touch without.
namespace tactus {
namespace {

struct ClearRun {
  double nearest_m = kNoLimit;
  RunFigures figures;
};

ClearRun runClearScene(const Scene& scene, const ClearanceConfig& clearance) {
  const SerialChain& chain = scene.controller.chain;
  const BodyDistances distances(chain, clearance);
  ClearRun run;
  const auto look = [&](const CycleRecord& record) {
    ChainPose pose;
    chain.computePose(Eigen::Map<const JointVector>(record.q, chain.size()), pose);
    run.nearest_m = std::min(run.nearest_m, nearestBody(distances, pose).distance_m);
  };
  run.figures = simulate(scene, look).figures;
  return run;
}

TEST(ClearScenes, TouchOnlyWithoutTheirClearance) {
  for (const char* name : {"whole_arm/crops9_rail", "whole_arm/kuka_iiwa7_folding"}) {
    Scene scene = test::shippedScene(name);
    const ClearanceConfig clearance = *scene.controller.clearance;
    const ClearRun kept = runClearScene(scene, clearance);
    EXPECT_GE(kept.nearest_m, clearance.safe_distance_m - 1e-12) << name;
    EXPECT_LT(kept.nearest_m, clearance.safe_distance_m + 2e-3) << name;
    EXPECT_EQ(kept.figures.end.fault, Fault::kNone) << name;
    EXPECT_LT(kept.figures.peak_force_N, 5.5) << name;
    scene.controller.clearance.reset();
    EXPECT_LT(runClearScene(scene, clearance).nearest_m, 0.0) << name;
  }
}

}  // namespace
}  // namespace tactus
