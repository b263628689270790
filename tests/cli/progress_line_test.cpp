#include "tactus/cli/progress_line.h"

#include <gtest/gtest.h>

namespace tactus {
namespace {

TEST(ProgressLine, SaysNothingOfWhatIsDoneSoon) {
  EXPECT_EQ(progressText("run", 0.1, 0.5), "");
  EXPECT_EQ(progressText("run", 0.9, 1.99), "");
}

TEST(ProgressLine, SaysHowLongItWillStillTake) {
  EXPECT_EQ(progressText("run", 0.25, 10.0), "run                               25 %, 30 s left");
  EXPECT_EQ(progressText("run", 0.01, 10.0), "run                                1 %, 17 min left");
  EXPECT_EQ(progressText("run", 1.0, 10.0), "run                              100 %, 0 s left");
}

TEST(ProgressLine, SaysNoTimeBeforeAnythingIsDone) {
  EXPECT_EQ(progressText("run", 0.0, 10.0), "run                                0 %");
}

}  // namespace
}  // namespace tactus
