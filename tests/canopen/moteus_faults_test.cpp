#include "tactus/canopen/moteus_faults.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace tactus {
namespace {

/// Those that moteus' documentation lists, and no other: limits of a valid mode are no faults.
TEST(MoteusFaults, HaveANameEach) {
  std::set<std::string> names;
  for (int code = -1; code < 300; ++code) {
    const bool is_known = (code >= 1 && code <= 7) || (code >= 32 && code <= 50);
    const char* const name = moteusFaultName(code);
    EXPECT_EQ(name != nullptr, is_known) << code;
    const bool is_new = name == nullptr || names.insert(name).second;
    EXPECT_TRUE(is_new) << code;
  }
  EXPECT_STREQ(moteusFaultName(33), "motor driver fault");
  EXPECT_STREQ(moteusFaultName(39), "start outside of position limits");
  EXPECT_STREQ(moteusFaultName(50), "velocity control error");
}

}  // namespace
}  // namespace tactus
