#include "tactus/record/run_folder.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <fstream>
#include <optional>

#include "support/child_process.h"
#include "support/run_folder.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

std::string errorOfRunIn(const std::string& directory) {
  try {
    const RunFolder folder(directory, "arm");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool isLocked(const std::string& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool is_locked = ::flock(fd, LOCK_SH | LOCK_NB) != 0;
  ::close(fd);
  return is_locked;
}

TEST(RunFolders, BelongToOneRunAtATime) {
  const test::RunFolder parent;
  std::optional<RunFolder> folder(std::in_place, parent.path(), "arm");
  EXPECT_EQ(folder->path(), parent.path() + "/arm");
  EXPECT_TRUE(isLocked(folder->path()));
  for (const char* const name : {"arm/summary.json", "arm/run.1.ulg", "arm/run.next.ulg"})
    std::ofstream(parent.path() + "/" + name) << "its own";
  const std::string refusal =
      parent.path() + "/arm:1:1: -o: another run writes there, expected another folder";
  EXPECT_EQ(errorOfRunIn(parent.path()), refusal);
  EXPECT_TRUE(test::holdsInChild([&] { return errorOfRunIn(parent.path()) == refusal; }));
  EXPECT_EQ(parent.content("arm/run.1.ulg"), "its own");
  folder.reset();
  EXPECT_FALSE(isLocked(parent.path() + "/arm"));
  EXPECT_EQ(errorOfRunIn(parent.path()), "");
  EXPECT_FALSE(parent.has("arm/run.1.ulg") || parent.has("arm/summary.json"));
}

/// Nobody has to tidy up behind a run that was killed.
TEST(RunFolders, AreFreeWhenTheirProcessIsGone) {
  const test::RunFolder parent;
  EXPECT_TRUE(test::holdsInChild([&] {
    const RunFolder folder(parent.path(), "arm");
    _exit(isLocked(folder.path()) ? 0 : 1);
    return false;
  }));
  EXPECT_EQ(errorOfRunIn(parent.path()), "");
}

}  // namespace
}  // namespace tactus
