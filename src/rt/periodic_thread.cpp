#include "tactus/rt/periodic_thread.h"

#include <signal.h>

#include <system_error>

#include "tactus/rt/periodic_timer.h"

namespace tactus {
namespace {

// The thread must not use a lock once its filter is loaded, so both sides ask again and again.
constexpr std::int64_t kAskAgain_ns = 1'000'000;

/// Signals are for other threads to handle, but for those that this one causes itself.
void blockSignals() noexcept {
  sigset_t signals;
  sigfillset(&signals);
  for (const int own : {SIGSYS, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGABRT}) {
    sigdelset(&signals, own);
  }
  pthread_sigmask(SIG_SETMASK, &signals, nullptr);
}

void check(int error, const char* what) {
  if (error != 0) throw std::system_error(error, std::generic_category(), what);
}

}  // namespace

void PeriodicThread::setUp() {
  PeriodicSchedule(0, config_.period_ns);  // throws here, where it can be caught
  PeriodicTimer timer(kAskAgain_ns);
  create();
  while (stage_.load() == Stage::kSettingUp) timer.wait();
  refusals_ = realTimeRefusals(config_.real_time, outcome_);
  if (filter_error_ != 0) refusals_.push_back(systemCallFilterRefusal(filter_error_));
}

void PeriodicThread::create() {
  pthread_attr_t attributes;
  check(pthread_attr_init(&attributes), "preparing the loop's thread");
  int error = pthread_attr_setstack(&attributes, stack_.lowest(), stack_.size_bytes());
  if (error == 0) error = pthread_create(&thread_, &attributes, run, this);
  pthread_attr_destroy(&attributes);
  check(error, "starting the loop's thread");
  is_joinable_ = true;
}

void PeriodicThread::start() noexcept {
  Stage ready = Stage::kReady;
  stage_.compare_exchange_strong(ready, Stage::kStarted);
}

void PeriodicThread::join() noexcept {
  if (!is_joinable_) return;
  Stage ready = Stage::kReady;
  stage_.compare_exchange_strong(ready, Stage::kCancelled);
  pthread_join(thread_, nullptr);
  is_joinable_ = false;
}

void* PeriodicThread::run(void* self) noexcept {
  auto& thread = *static_cast<PeriodicThread*>(self);
  thread.setUpInside();
  PeriodicTimer timer(kAskAgain_ns);
  while (thread.stage_.load() == Stage::kReady) timer.wait();
  if (thread.stage_.load() == Stage::kStarted) thread.runCycles();
  return nullptr;
}

void PeriodicThread::setUpInside() noexcept {
  pthread_setname_np(pthread_self(), "tactus-loop");
  blockSignals();
  outcome_ = applyRealTime(config_.real_time);
  if (config_.filter != nullptr) filter_error_ = config_.filter->load();
  stage_ = Stage::kReady;
}

void PeriodicThread::runCycles() noexcept {
  const PageFaults before = threadPageFaults();
  PeriodicTimer timer(config_.period_ns);
  while (cycle_(timer.wait())) {
  }
  const PageFaults after = threadPageFaults();
  page_faults_ = {after.minor - before.minor, after.major - before.major};
}

}  // namespace tactus
