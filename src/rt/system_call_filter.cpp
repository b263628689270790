#include "tactus/rt/system_call_filter.h"

#include <errno.h>
#include <linux/audit.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <seccomp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <system_error>

namespace tactus {
namespace {

thread_local std::atomic<SystemCallFilter*> loaded_filter{nullptr};

constexpr int kCausedBySeccomp = 1;  // si_code; the kernel's SYS_SECCOMP, which glibc leaves out

static_assert(std::atomic<std::uint32_t>::is_always_lock_free);  // for the signal handler

#ifdef TACTUS_SANITIZED
// What a sanitizer does in any thread: its own memory and locks, its report, and the thread's end.
constexpr int kSanitizerCalls[] = {SYS_mmap,        SYS_munmap,    SYS_mprotect, SYS_madvise,
                                   SYS_futex,       SYS_gettid,    SYS_write,    SYS_sigaltstack,
                                   SYS_sched_yield, SYS_exit_group};
#else
constexpr std::array<int, 0> kSanitizerCalls{};
#endif

#if defined(__x86_64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

void failWithEnosys(ucontext_t& context) noexcept {
#if defined(__x86_64__)
  context.uc_mcontext.gregs[REG_RAX] = -ENOSYS;
#elif defined(__aarch64__)
  context.uc_mcontext.regs[0] = -ENOSYS;
#else
#error "which register holds the result of a system call here?"
#endif
}

void check(int result, const char* what) {
  if (result < 0) throw std::system_error(-result, std::generic_category(), what);
}

/// Made here, as libseccomp 2.5 does not look whether it got the memory for it.
std::vector<sock_filter> makeProgram(std::span<const int> allowed) {
  std::vector<sock_filter> program = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, arch)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
  };
  const auto allow = [&program](int number) {
    if (number < 0) check(-EINVAL, "allowing a system call in the loop's filter");
    program.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<unsigned>(number), 0, 1));
    program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
  };
  for (const int number : allowed) allow(number);
  for (const int number : kSanitizerCalls) allow(number);
  allow(SYS_rt_sigreturn);  // the way out of the handler
  program.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
  return program;
}

void unblockSigsys() noexcept {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGSYS);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);
}

}  // namespace

SystemCallFilter::SystemCallFilter(std::span<const int> allowed) : program_(makeProgram(allowed)) {
  struct sigaction action {};
  action.sa_sigaction = onForbiddenCall;
  action.sa_flags = SA_SIGINFO | SA_RESTART;
  sigemptyset(&action.sa_mask);
  if (sigaction(SIGSYS, &action, nullptr) != 0) check(-errno, "taking SIGSYS");
}

int SystemCallFilter::load() noexcept {
  unblockSigsys();  // a forbidden call while it is blocked would end the process
  loaded_filter = this;
  sock_fprog program{static_cast<unsigned short>(program_.size()), program_.data()};
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return errno;
  // No sandbox, hence no reason to slow this thread down against speculation.
  const long result =
      syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_SPEC_ALLOW, &program);
  return result == 0 ? 0 : errno;
}

void SystemCallFilter::onForbiddenCall(int, siginfo_t* info, void* context) noexcept {
  if (info->si_code != kCausedBySeccomp) return;  // sent by somebody, at any instruction
  failWithEnosys(*static_cast<ucontext_t*>(context));
  SystemCallFilter* const filter = loaded_filter;
  if (filter == nullptr) return;
  int none = -1;
  filter->first_.compare_exchange_strong(none, info->si_syscall);
  ++filter->count_;
}

Refusal systemCallFilterRefusal(int error) {
  return {"loading the loop's system call filter: " + std::generic_category().message(error),
          "a call that could block the loop would go unnoticed",
          "a kernel with CONFIG_SECCOMP_FILTER, and a container whose profile allows seccomp()"};
}

std::string systemCallName(int number) {
  const std::unique_ptr<char, decltype(&std::free)> name(
      seccomp_syscall_resolve_num_arch(SCMP_ARCH_NATIVE, number), std::free);
  return name ? name.get() : "system call " + std::to_string(number);
}

}  // namespace tactus
