#include "tactus/record/log_size.h"

#include <gtest/gtest.h>

#include <string>

#include "support/scene_files.h"

namespace tactus {
namespace {

TEST(LogSize, AFileHoldsItsSceneAndSomeCycles) {
  test::SceneFiles files;
  files.urdf += "<!--" + std::string(1'000'000, ' ') + "-->\n";
  EXPECT_NO_THROW(checkLogSize(files.load({{"log.max_bytes", "2e6"}})));
  try {
    checkLogSize(files.load({{"log.max_bytes", "1e6"}}));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what())
                  .find("--set log.max_bytes:1:1: log.max_bytes: 1000000 is too small, expected at "
                        "least 1"),
              0u)
        << error.what();
  }
}

}  // namespace
}  // namespace tactus
