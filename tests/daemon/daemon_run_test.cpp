#include "tactus/daemon/daemon_run.h"

#include <gtest/gtest.h>

namespace tactus {
namespace {

/// Shorter than half a period is not "until a signal", which would move the arm without end.
TEST(DaemonRun, EndsAfterACycleAtLeast) {
  EXPECT_EQ(motionCycles(0.0, 0.004), 0);
  EXPECT_EQ(motionCycles(0.001, 0.004), 1);
  EXPECT_EQ(motionCycles(0.001, 0.02), 1);
  EXPECT_EQ(motionCycles(10.0, 0.004), 2500);
  EXPECT_EQ(motionCycles(1e9, 1e-5), 100'000'000'000'000);
}

}  // namespace
}  // namespace tactus
