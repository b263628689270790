#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/shipped_scene.h"
#include "tactus/cli/simulation.h"

namespace tactus {
namespace {

TEST(SimulationFault, IsToldWithTheForceThatTheLogHas) {
  Scene scene = test::shippedScene("scenario1_none");
  const double limit_N = 3.0;
  scene.controller.tactile_modules.front().max_force_N = limit_N;
  std::vector<CycleRecord> faulty;
  const FaultReport end = simulate(scene, [&](const CycleRecord& record) {
                            if (record.fault != 0) faulty.push_back(record);
                          }).figures.end;
  ASSERT_FALSE(faulty.empty());
  const CycleRecord& first = faulty.front();
  EXPECT_EQ(end.fault, Fault::kTactileInvalid);
  EXPECT_EQ(end.time_s, first.t_s);
  EXPECT_EQ(end.detail.value, std::hypot(first.tactile_force_y_N[0], first.tactile_force_z_N[0]));
  EXPECT_GT(end.detail.value, limit_N);
  EXPECT_LT(end.detail.value, limit_N + 1.0) << "of the first sample beyond it";
  EXPECT_EQ(end.detail.limit, limit_N);
  EXPECT_STREQ(end.detail.unit, "N");
}

TEST(SimulationFault, IsNoneInARunAsPlanned) {
  Scene scene = test::shippedScene("scenario1_multi_space");
  scene.duration_s = 0.1;
  EXPECT_EQ(simulate(scene, [](const CycleRecord&) {}).figures.end.fault, Fault::kNone);
}

}  // namespace
}  // namespace tactus
