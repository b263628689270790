#include "tactus/daemon/service_notify.h"

#include <gtest/gtest.h>

#include "support/notify_socket.h"
#include "tactus/io/service_manager.h"

namespace tactus {
namespace {

TEST(ServiceNotify, isReadyOnceAndOnlyWhenDrivesAreConfigured) {
  for (const Mode up : {Mode::kReady, Mode::kEnabling, Mode::kRunning, Mode::kHolding}) {
    test::NotifySocket manager;
    ServiceNotify notify;
    for (const Mode down : {Mode::kBoot, Mode::kFault, Mode::kStopping}) {
      notify.onMode(down, "not yet");
      EXPECT_EQ(manager.receive(), "STATUS=not yet") << modeName(down);
    }
    notify.onMode(up, "up");
    EXPECT_EQ(manager.receive(), "STATUS=up\nREADY=1") << modeName(up);
    notify.onMode(Mode::kFault, "fault: e-stop");
    EXPECT_EQ(manager.receive(), "STATUS=fault: e-stop");
    notify.onMode(Mode::kReady, "ready again");
    EXPECT_EQ(manager.receive(), "STATUS=ready again");
  }
}

TEST(ServiceNotify, saysThatItStopsAtTheEndAlone) {
  test::NotifySocket manager;
  ServiceNotify notify;
  notify.onMode(Mode::kStopping, "stopping");  // may yet go back to ready
  EXPECT_EQ(manager.receive(), "STATUS=stopping");
  notify.onMode(Mode::kOff, "off");
  EXPECT_EQ(manager.receive(), "STATUS=off\nSTOPPING=1");
  EXPECT_EQ(manager.receive(), "");
}

TEST(ServiceNotify, doesNothingWithoutAManager) {
  test::NotifySocket manager;
  const std::string address = getenv("NOTIFY_SOCKET");
  unsetenv("NOTIFY_SOCKET");
  ServiceNotify notify;
  notify.onMode(Mode::kReady, "ready");
  EXPECT_EQ(manager.receive(), "");
  setenv("NOTIFY_SOCKET", "@nobody listens here", 1);
  notify.onMode(Mode::kRunning, "running");  // a manager that has gone
  EXPECT_EQ(manager.receive(), "");
}

/// As one that is about to end, or was stopped.
TEST(ServiceNotify, doesNotWaitForAManagerThatHangs) {
  test::NotifySocket manager;
  ServiceNotify notify;
  manager.fill();
  EXPECT_FALSE(tellManager("WATCHDOG=1"));
  notify.onMode(Mode::kReady, "ready");
  notify.onMode(Mode::kFault, "fault: e-stop");
  notify.tellAgain();
  manager.readAll();
  notify.tellAgain();
  EXPECT_EQ(manager.receive(), "STATUS=fault: e-stop\nREADY=1");
  notify.tellAgain();
  notify.onMode(Mode::kReady, "ready");
  EXPECT_EQ(manager.receive(), "STATUS=ready");
  EXPECT_EQ(manager.receive(), "");
}

}  // namespace
}  // namespace tactus
