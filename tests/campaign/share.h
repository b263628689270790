#pragma once

#include <atomic>
#include <thread>
#include <vector>

namespace tactus::campaign {

/// Work for as many threads as there are jobs; `work` gets every number below count once.
template <typename Work>
void share(int jobs, int count, const Work& work) {
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  for (int job = 0; job < jobs; ++job)
    threads.emplace_back([&] {
      for (int i = next++; i < count; i = next++) work(i);
    });
  for (std::thread& thread : threads) thread.join();
}

}  // namespace tactus::campaign
