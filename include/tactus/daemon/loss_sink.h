#pragma once

#include "tactus/daemon/record_sink.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A line on standard error for each tactile module without which the arm goes on, and when it is
/// back.
class LossSink final : public RecordSink {
 public:
  explicit LossSink(const Scene& scene) : scene_(scene) {}

  void add(const LoopRecord& record) override;

 private:
  const Scene& scene_;
  std::uint64_t modules_lost_ = 0;  ///< as told
};

}  // namespace tactus
