#include <gtest/gtest.h>
#include <signal.h>

#include "support/child_process.h"
#include "support/hardware_files.h"
#include "tactus/daemon/daemon_run.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

/// Before anything moves no signal of a terminal may end or suspend the daemon any more: whichever
/// comes waits until the loop can bring the arm to rest.
TEST(DaemonSignals, NoneOfATerminalEndsOrSuspendsIt) {
  Scene scene = test::hardwareFiles().load();
  for (BusConfig& bus : scene.hardware->buses) bus.interface = "none0";
  EXPECT_TRUE(test::holdsInChild([&] {
    try {
      runDaemon(scene, {});
      return false;
    } catch (const RunError&) {  // there is no such bus
    }
    sigset_t blocked;
    bool are_blocked = pthread_sigmask(SIG_BLOCK, nullptr, &blocked) == 0;
    for (const int signal : {SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGTSTP})
      are_blocked = are_blocked && sigismember(&blocked, signal) == 1;
    struct sigaction action {};
    return are_blocked && sigaction(SIGTTOU, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
  }));
}

}  // namespace
}  // namespace tactus
