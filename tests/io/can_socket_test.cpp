#include "tactus/io/can_socket.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <system_error>

/// What needs a CAN interface is checked in tests/hil/can_socket_check.cpp.
namespace tactus {
namespace {

constexpr IdFilter kAny[] = {{0, 0}};

std::string errorOf(const std::string& interface) {
  try {
    const CanSocket socket(interface, kAny, kAny);
  } catch (const std::system_error& error) {
    return error.what();
  }
  return "";
}

TEST(CanSocket, SaysWhichInterfaceIsMissingAndHowToBringItUp) {
  const std::string error = errorOf("can_missing");
  EXPECT_EQ(error.rfind("can_missing: no such network interface", 0), 0u) << error;
  EXPECT_NE(error.find("ip link set can_missing up"), std::string::npos) << error;
}

TEST(CanSocket, RefusesNamesThatNoInterfaceCanHave) {
  for (const std::string& name : {std::string(), std::string(16, 'c'), std::string(5000, 'c')}) {
    EXPECT_NE(errorOf(name).find("is no name of a network interface"), std::string::npos);
    EXPECT_THROW(transmitQueueLength(name), std::system_error);
    EXPECT_THROW(InterfaceLock{name}, std::system_error);
  }
}

/// Without CAN in the kernel as with it.
TEST(CanSocket, RefusesAnInterfaceThatIsNoCan) {
  const std::string error = errorOf("lo");
  EXPECT_EQ(error.rfind("lo: ", 0), 0u) << error;
  EXPECT_TRUE(error.find("this kernel opens no CAN sockets") != std::string::npos ||
              error.find("is no CAN interface") != std::string::npos)
      << error;
}

TEST(CanSocket, TellsTheQueueLengthOfAnInterface) {
  EXPECT_GE(transmitQueueLength("lo"), 0);
  EXPECT_THROW(transmitQueueLength("can_missing"), std::system_error);
}

TEST(InterfaceLock, IsHeldByOneAtATime) {
  const std::string name = "can" + std::to_string(getpid());  // tests may run side by side
  {
    const InterfaceLock lock(name);
    const InterfaceLock other(name + "x");
    try {
      const InterfaceLock second(name);
      ADD_FAILURE() << "held twice";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()).rfind(name + ": another tactusd", 0), 0u);
    }
  }
  const InterfaceLock again(name);
}

}  // namespace
}  // namespace tactus
