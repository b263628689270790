#include "tactus/daemon/summary_sink.h"

#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "tactus/record/run_error.h"

namespace tactus {

SummarySink::SummarySink(const Scene& scene, const std::string& folder, const LogState& log)
    : scene_(scene), path_(folder + "/summary.json"), log_(log), summary_(scene.controller, 0) {}

void SummarySink::add(const LoopRecord& record) {
  times_.wake_latency.add(record.cycle.wake_latency_ns);
  times_.read.add(record.cycle.read_ns);
  times_.control.add(record.cycle.step_ns);
  times_.write.add(record.cycle.write_ns);
  if (record.is_in_motion) summary_.add(record.cycle);
}

void SummarySink::finish(const RunEnd& end) {
  LoopFigures loop = end.loop;
  loop.wake_latency = times_.wake_latency;
  loop.read = times_.read;
  loop.control = times_.control;
  loop.write = times_.write;
  RunFigures figures = summary_.figures();
  figures.end = end.fault;
  try {
    const Json loop_json = loopJson(loop);
    const HardwareFigures hardware{log_, loop_json};
    writeSummary(path_, scene_, figures, 1.0, &hardware);
  } catch (const std::runtime_error& error) {
    std::remove(path_.c_str());    // half of one
    throw RunError(error.what());  // of input, too: the arm has moved
  }
}

}  // namespace tactus
