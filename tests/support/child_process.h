#pragma once

#include <gtest/gtest.h>
#include <linux/capability.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

/// For what a test cannot undo in its own process: limits, privileges, locked memory.
namespace tactus::test {

/// Whether `check` holds in a child process of its own, which must not use GoogleTest. An exception
/// there ends it: it must not go on with the tests of its parent. One that is suspended is ended.
template <typename Check>
bool holdsInChild(const Check& check) {
  const pid_t child = fork();
  if (child == 0) [&]() noexcept { _exit(check() ? 0 : 1); }();
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, WUNTRACED), child);
  if (WIFSTOPPED(status)) {
    ADD_FAILURE() << "suspended by signal " << WSTOPSIG(status);
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
  }
  EXPECT_TRUE(WIFEXITED(status)) << "ended by signal " << WTERMSIG(status);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// Of root, too: this thread may do no more than an ordinary user.
inline bool dropCapabilities() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  __user_cap_data_struct none[2] = {};
  return syscall(SYS_capset, &header, none) == 0;
}

inline bool setLimit(__rlimit_resource resource, rlim_t value) {
  const rlimit limit{value, value};
  return setrlimit(resource, &limit) == 0;
}

}  // namespace tactus::test
