#include "tactus/cli/e_stop_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "support/run_folder.h"

namespace tactus {
namespace {

class EmergencyStopFileTest : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  const test::RunFolder folder_;
};

TEST_F(EmergencyStopFileTest, HoldsWhereTheStopIs) {
  for (const char* before : {"", "0\n", "1\n"}) {
    std::ofstream(path("stop")) << before;
    EmergencyStopFile file(path("stop"));
    EXPECT_EQ(folder_.content("stop"), "0\n") << before;
    EXPECT_TRUE(file.write(true));
    EXPECT_EQ(folder_.content("stop"), "1\n");
  }
  EmergencyStopFile fresh(path("fresh"));
  EXPECT_EQ(folder_.content("fresh"), "0\n");
  EXPECT_TRUE(EmergencyStopFile("").write(true));
}

TEST_F(EmergencyStopFileTest, OverwritesNothingElse) {
  for (const char* wanted : {"robot: robot.yaml\n", "0", "1\n2\n", "00", "\n"}) {
    std::ofstream(path("scene.yaml")) << wanted;
    EXPECT_THROW(EmergencyStopFile(path("scene.yaml")), std::runtime_error) << wanted;
    EXPECT_EQ(folder_.content("scene.yaml"), wanted);
  }
  EXPECT_THROW(EmergencyStopFile("/dev/null"), std::runtime_error) << "no file to read it from";
  EXPECT_THROW(EmergencyStopFile(path("none/stop")), std::system_error);
}

TEST_F(EmergencyStopFileTest, AFifoGetsEachMove) {
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  EmergencyStopFile file(path("fifo"));
  EXPECT_TRUE(file.write(true));
  const int reader = ::open(path("fifo").c_str(), O_RDONLY | O_NONBLOCK);
  char bytes[8];
  const ssize_t size = ::read(reader, bytes, sizeof bytes);
  EXPECT_EQ(std::string(bytes, static_cast<std::size_t>(std::max<ssize_t>(0, size))), "0\n1\n");
  ::close(reader);
}

}  // namespace
}  // namespace tactus
