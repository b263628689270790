#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>

#include "support/child_process.h"
#include "tactus/cli/commission_terminal.h"

/// Signals that reach commissioning while a joint may move.
namespace tactus {
namespace {

/// A program that was ended or suspended would leave a brake open, with nobody who watches.
TEST(CommissionSignals, EachOfATerminalStopsTheMotion) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) {
    SCOPED_TRACE(signal);
    EXPECT_TRUE(test::holdsInChild([signal] {
      const CommissionTerminal desk({}, false);
      return !desk.isStopped() && raise(signal) == 0 && desk.isStopped();
    }));
  }
}

/// As a terminal sends them to a program in the background that reads or writes.
TEST(CommissionSignals, TheBackgroundSuspendsNothing) {
  EXPECT_TRUE(test::holdsInChild([] {
    const CommissionTerminal desk({}, false);
    return std::ranges::all_of(std::initializer_list<int>{SIGTTIN, SIGTTOU}, [](int signal) {
      struct sigaction action {};
      return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
    });
  }));
}

}  // namespace
}  // namespace tactus
