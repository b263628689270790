#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tactus {

/// work(i) for each i below `count`, on all cores.
template <typename Work>
void inParallel(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> workers;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) workers.emplace_back(take);
  take();
}

}  // namespace tactus
