#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace tactus {

/// In ns; 0 for no values. What else the machine does only adds: the fastest is the code's own
/// time.
struct TimeStatistics {
  double fastest = 0.0;
  double median = 0.0;
  double p90 = 0.0;
};

TimeStatistics statistics(std::vector<double> times_ns);

/// Times of one call in caches that hold what it needs: `batch` makes `calls` calls, and each of
/// `batches` batches counts with its mean. A batch before them is not timed. `prepare` runs before
/// each, untimed.
TimeStatistics timeWarm(int batches, int calls, const std::function<void()>& prepare,
                        const std::function<void()>& batch);

/// Makes caches forget: walks more memory than the second level holds, as other programs do between
/// the cycles of a daemon.
class CacheWalker {
 public:
  static constexpr std::size_t kBytes = std::size_t{16} << 20;

  CacheWalker() : memory_(kBytes / sizeof(unsigned)) {}
  void walk() noexcept;

 private:
  std::vector<unsigned> memory_;
};

/// The same with the caches walked before each of `calls` calls, after `prepare`; without the time
/// of a clock call.
TimeStatistics timeCold(int calls, CacheWalker& walker, const std::function<void(int)>& prepare,
                        const std::function<void(int)>& call);

}  // namespace tactus
