#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

#include "tactus/rt/memory.h"
#include "tactus/rt/periodic_schedule.h"
#include "tactus/rt/scheduling.h"
#include "tactus/rt/system_call_filter.h"
#include "tactus/rt/thread_stack.h"

namespace tactus {

struct PeriodicThreadConfig {
  std::int64_t period_ns = 1'000'000;
  RealTimeRequest real_time;
  SystemCallFilter* filter = nullptr;              ///< loaded before the first cycle; nullptr: none
  std::size_t stack_bytes = std::size_t{1} << 20;  ///< thread-local data included
};

/// Runs a function once a period in a thread of its own. Prepare before, finish after:
///
///     PeriodicThread thread(config, [&](const Wake& wake) noexcept { return ...; });
///     if (!thread.refusals().empty()) ...;  // no cycle has run; leave or go on
///     thread.start();
///     thread.join();
class PeriodicThread {
 public:
  /// `cycle` returns whether there is to be another one. Throws std::invalid_argument for a period
  /// that is none, std::system_error if there is no such thread to be had.
  template <typename Cycle>
  PeriodicThread(const PeriodicThreadConfig& config, Cycle cycle)
      : config_(config), cycle_(std::move(cycle)), stack_(config.stack_bytes) {
    static_assert(std::is_nothrow_invocable_r_v<bool, Cycle&, const Wake&>);
    setUp();
  }
  /// Waits for the last cycle, as join() does: only the function itself knows how to end at rest.
  ~PeriodicThread() { join(); }
  PeriodicThread(const PeriodicThread&) = delete;
  PeriodicThread& operator=(const PeriodicThread&) = delete;

  /// What the machine did not grant to the thread.
  const std::vector<Refusal>& refusals() const noexcept { return refusals_; }

  void start() noexcept;  ///< the first cycle is due in one to two periods
  void join() noexcept;   ///< a thread that was not started ends without a cycle

  /// Of the thread from the end of its set-up to its last cycle; valid after join().
  PageFaults pageFaults() const noexcept { return page_faults_; }

 private:
  enum class Stage { kSettingUp, kReady, kStarted, kCancelled };

  void setUp();
  void create();
  static void* run(void* self) noexcept;
  void setUpInside() noexcept;
  void runCycles() noexcept;

  const PeriodicThreadConfig config_;
  std::function<bool(const Wake&)> cycle_;
  ThreadStack stack_;
  pthread_t thread_{};
  bool is_joinable_ = false;
  std::atomic<Stage> stage_{Stage::kSettingUp};
  RealTimeOutcome outcome_;
  int filter_error_ = 0;
  std::vector<Refusal> refusals_;
  PageFaults page_faults_;
};

}  // namespace tactus
