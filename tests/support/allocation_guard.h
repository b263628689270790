#pragma once

/// Shows that code does not touch the heap: while a guard lives, every allocation and release on
/// its thread, whichever library asks for it, ends the program.
namespace tactus::test {

class AllocationGuard {
 public:
  AllocationGuard();
  ~AllocationGuard();
  AllocationGuard(const AllocationGuard&) = delete;
  AllocationGuard& operator=(const AllocationGuard&) = delete;
};

}  // namespace tactus::test
