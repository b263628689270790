#include "tactus/rt/thread_stack.h"

#include <errno.h>
#include <sys/mman.h>
#include <unistd.h>

#include <string>
#include <system_error>

namespace tactus {

ThreadStack::ThreadStack(std::size_t bytes)
    : guard_bytes_(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
      mapped_bytes_((bytes + guard_bytes_ - 1) / guard_bytes_ * guard_bytes_ + guard_bytes_) {
  mapping_ = mmap(nullptr, mapped_bytes_, PROT_READ | PROT_WRITE,
                  MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK | MAP_POPULATE, -1, 0);
  if (mapping_ == MAP_FAILED) {
    throw std::system_error(errno, std::generic_category(),
                            "mapping a stack of " + std::to_string(bytes) + " bytes");
  }
  if (mprotect(mapping_, guard_bytes_, PROT_NONE) != 0) {
    const int error = errno;
    munmap(mapping_, mapped_bytes_);
    throw std::system_error(error, std::generic_category(), "protecting the end of a stack");
  }
}

ThreadStack::~ThreadStack() { munmap(mapping_, mapped_bytes_); }

}  // namespace tactus
