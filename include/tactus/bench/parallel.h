#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "tactus/cli/progress_line.h"

namespace tactus {

/// work(i) for each i below `count`, on all cores. A terminal shows how far it has come. The first
/// exception ends all, and is thrown on.
template <typename Work>
void inParallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr problem;
  const auto take = [&](ProgressLine* line) {
    try {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i);
        if (line) line->show(static_cast<double>(i) / static_cast<double>(count));
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!problem) problem = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> workers;
    for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i)
      workers.emplace_back(take, nullptr);
    ProgressLine line("runs");
    take(&line);
  }
  if (problem) std::rethrow_exception(problem);
}

}  // namespace tactus
