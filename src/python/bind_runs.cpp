#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/python/bindings.h"
#include "tactus/python/columns.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/run/log_replay.h"
#include "tactus/run/logged_contacts.h"
#include "tactus/run/simulation.h"

namespace py = pybind11;

namespace tactus {
namespace {

constexpr long long kCyclesBetweenLooks = 8192;

/// Adds cycles; Ctrl-C ends it.
class Collector {
 public:
  explicit Collector(Columns& columns) : columns_(columns) {}

  void operator()(const CycleRecord& record) {
    columns_.add(record);
    if (++cycles_ % kCyclesBetweenLooks == 0) lookForSignals();
  }

 private:
  Columns& columns_;
  long long cycles_ = 0;
};

/// (columns, summary as JSON)
py::tuple simulateScene(const Scene& scene) {
  auto columns =
      std::make_unique<Columns>(describeLog(scene).shape, [](std::string_view) { return true; });
  std::string summary;
  {
    const LockRelease release;
    columns->reserve(cyclesToReserve(scene));
    const SimulationResult result = simulate(scene, Collector(*columns));
    summary = jsonText(summaryJson(scene, result.figures, result.real_time_factor));
  }
  return py::make_tuple(std::move(columns), textOf(summary));
}

/// What the path's clock lacks at the end of a run to the path's end, or to the run's if that is
/// before: the reference waited, or the arm went slowly.
double pathLeft_s(const Scene& scene, double path_time_s) {
  const long long cycles = std::llround(scene.duration_s / scene.period_s);
  const double last_s = static_cast<double>(cycles - 1) * scene.period_s;
  const double end_s = Trajectory(scene.controller.task.trajectory, Pose{}).end_s();
  return std::max(0.0, std::min(last_s, end_s) - path_time_s);
}

/// The summary as JSON, of a run that keeps no cycle and has the figures of sweeps alone: half the
/// time.
std::string runFigures(const Scene& scene) {
  long long cycles = 0;
  double path_time_s = 0.0;
  const auto look = [&](const CycleRecord& record) {
    path_time_s = record.path_time_s;
    if (++cycles % kCyclesBetweenLooks == 0) lookForSignals();
  };
  const SimulationResult result = simulate(scene, look, FigureSet::kOfSweep);
  Json json = summaryJson(scene, result.figures, result.real_time_factor);
  json["path_left_s"] = pathLeft_s(scene, path_time_s);
  return jsonText(json);
}

/// Of pairs of a name and a number or a text; of one name the last.
template <typename Pair>
py::dict dictOf(const std::vector<Pair>& pairs) {
  py::dict dict;
  for (const auto& [name, value] : pairs) {
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, double>)
      dict[textOf(name)] = value;
    else
      dict[textOf(name)] = textOf(value);
  }
  return dict;
}

/// (columns, whether it was cut off, which part of its run, infos, parameters, sources, overrides)
py::tuple readLog(const std::string& path) {
  std::unique_ptr<Columns> columns;
  LogDescription description;
  bool is_cut_off = false;
  int part = 0;
  {
    const LockRelease release;
    std::ifstream in = openLog(path);
    UlogReader reader(in, path);
    description = reader.description();
    part = logPart(description, path).part;
    columns = std::make_unique<Columns>(description.shape,
                                        [&](std::string_view field) { return reader.has(field); });
    Collector collect(*columns);
    CycleRecord record;
    while (reader.next(record)) collect(record);
    is_cut_off = reader.cutOff();
  }
  return py::make_tuple(std::move(columns), is_cut_off, part, dictOf(description.infos),
                        dictOf(description.parameters), dictOf(description.sources),
                        dictOf(description.overrides));
}

std::string replay(const std::vector<std::string>& logs, const std::vector<std::string>& settings) {
  if (logs.empty()) throw py::value_error("no log, expected at least one");
  const ReplayRequest request{logs, settings, ""};
  return jsonText(replayJson(request, replayLogs(request, [](double) { lookForSignals(); })));
}

std::string contacts(const std::string& path) {
  return jsonText(contactsJson(readContacts({path})));
}

template <typename Enum>
py::tuple names(std::size_t count, const char* (*name)(Enum)) {
  py::tuple names(count);
  for (std::size_t i = 0; i < count; ++i) names[i] = name(static_cast<Enum>(i));
  return names;
}

}  // namespace

void bindRuns(py::module_& module) {
  module.def("simulate", &simulateScene, py::arg("scene"));
  module.def("figures", &runFigures, py::arg("scene"), WithoutLock());
  module.def("read_log", &readLog, py::arg("path"));
  module.def("replay", &replay, py::arg("logs"), py::arg("settings"), WithoutLock());
  module.def("contacts", &contacts, py::arg("path"), WithoutLock());
  module.attr("FAULTS") = names<Fault>(faultTable().size(), faultName);
  module.attr("MODES") = names<Mode>(kModeCount, modeName);
}

}  // namespace tactus
