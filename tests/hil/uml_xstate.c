// Preloaded into User Mode Linux: lets it restore its guest's vector registers on processors whose
// register state is larger than the kernel package knows of (those with AMX). ptrace takes nothing
// but the whole state there (EFAULT), so what the guest has of it is laid over what is there.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <elf.h>
#include <errno.h>
#include <stdarg.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/types.h>
#include <sys/uio.h>

typedef long (*Ptrace)(int, pid_t, void*, void*);

static Ptrace libc_ptrace;

__attribute__((constructor)) static void find(void) {
  libc_ptrace = (Ptrace)dlsym(RTLD_NEXT, "ptrace");
}

static long set_whole_state(pid_t pid, void* set, const struct iovec* part) {
  static char whole[1 << 16];
  struct iovec state = {whole, sizeof whole};
  long status = libc_ptrace(PTRACE_GETREGSET, pid, set, &state);
  if (status != 0) return status;
  if (part->iov_len > state.iov_len) {
    errno = EFAULT;
    return -1;
  }
  memcpy(whole, part->iov_base, part->iov_len);
  return libc_ptrace(PTRACE_SETREGSET, pid, set, &state);
}

long ptrace(enum __ptrace_request request, ...) {
  va_list arguments;
  va_start(arguments, request);
  pid_t pid = va_arg(arguments, pid_t);
  void* address = va_arg(arguments, void*);
  void* data = va_arg(arguments, void*);
  va_end(arguments);
  long status = libc_ptrace(request, pid, address, data);
  if (status < 0 && errno == EFAULT && request == PTRACE_SETREGSET &&
      address == (void*)NT_X86_XSTATE)
    return set_whole_state(pid, address, data);
  return status;
}
