#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "soak/soak.h"
#include "tactus/daemon/measured_start.h"
#include "tactus/record/run_log.h"
#include "tactus/scene/input_error.h"
#include "tactus/supervisor/joint_reader.h"

/// How a daemon ends, and what has to be true then.
namespace tactus::soak {
namespace {

using campaign::Observation;
using campaign::Plan;

constexpr int kRestart_ms = 5000;
constexpr int kLeastAlone_ms = 1500, kMostAlone_ms = 4000;  ///< of the plant without a daemon
constexpr double kRestVelocity = 1e-3;                      ///< m/s or rad/s
/// m/s^2 or rad/s^2 of the plant's drives, which may be as fast as their joints when the power
/// goes.
constexpr double kQuickStop = 10.0;

}  // namespace

void Life::end() {
  if (random_.chance(0.6)) return cutPower();
  stop();
  finish();
}

void Life::cutPower() {
  ++tally_.power_cuts;
  account();
  daemon_.reset();
  const std::string log = log_folder_ + "/" + logName(0);
  const auto size = static_cast<double>(std::filesystem::file_size(log));
  const double lost = random_.chance(0.5) ? random_.logUniform(1.0, 1e6) : 0.0;
  std::filesystem::resize_file(log, static_cast<std::uintmax_t>(size - std::min(lost, 0.5 * size)));
  if (random_.chance(0.3)) std::ofstream(log_folder_ + "/run.next.ulg") << "ULog";
  takeReplay(0);
  Plant& plant = cell_->plant;
  const double stop_s = fastestJoint() / kQuickStop;
  for (int i = random_.integer(kLeastAlone_ms, kMostAlone_ms) + static_cast<int>(1e3 * stop_s);
       i > 0; --i)
    plant.advance(cell_->t_ns += 1'000'000);
  if (fastestJoint() > kRestVelocity)
    complain("a drive moves though the daemon has lost its power");
  if (!cell_->areDrivesLimp()) complain("a drive has torque though the daemon has lost its power");
  startAgain();
}

double Life::fastestJoint() const {
  double fastest = 0.0;
  for (int joint = 0; joint < stage_.scene.controller.chain.size(); ++joint)
    fastest = std::max(fastest, std::abs(cell_->plant.drive(joint).velocity()));
  return fastest;
}

/// As task.commands.start_measured does; false: the scene cannot begin there.
bool Life::findArm() {
  const Scene& scene = stage_.scene;
  JointReader reader(*scene.hardware, scene.period_s);
  const std::vector<Fault> bus_faults(scene.hardware->buses.size(), Fault::kNone);
  Plant& plant = cell_->plant;
  while (!reader.isDone()) {
    plant.advance(cell_->t_ns += 1'000'000);
    for (int bus = 0; bus < plant.buses(); ++bus) {
      FrameBatch frames;
      plant.take(bus, frames);
      reader.receive(bus, frames.frames());
    }
    reader.update(bus_faults);
    for (int bus = 0; bus < plant.buses(); ++bus)
      for (const CanFrame& frame : reader.outbox(bus)) plant.send(bus, frame, cell_->t_ns);
    if (!cell_->areDrivesLimp()) complain("a drive has torque while the arm is looked for");
  }
  if (reader.report().fault != Fault::kNone) {
    complain(fmt::format("is not found: {}", faultName(reader.report().fault)));
    return false;
  }
  writeScene(folder_ + "/soak.yaml", scene_);
  const std::string start = startText(startAt(scene, reader.q()));
  try {
    stage_.scene = loadSoakScene(folder_ + "/soak.yaml", {{"start", start}});
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (what.find("outside the limits") == std::string::npos) complain("is not accepted: " + what);
    ++tally_.left["beyond limits at a restart"];
    return false;
  }
  ++tally_.found;
  return true;
}

/// Where the arm stands now.
void Life::startAgain() {
  const bool is_told = scene_.base == "commands";
  const bool is_found = is_told && random_.chance(0.5) && findArm();
  VirtualRobotCell cell(stage_.scene);
  cell.plant = std::move(cell_->plant);
  cell.t_ns = cell_->t_ns;
  cell_.emplace(std::move(cell));
  start();
  const JointVector& home = stage_.scene.controller.q_start;
  double away = 0.0;
  for (int i = 0; i < home.size(); ++i) {
    const double counts = cell_->plant.drive(i).objects().getSigned(0x6064);
    away = std::max(away, std::abs(counts / stage_.promise.counts_per_unit[i] - home[i]));
  }
  const Observation last = play({}, {kRestart_ms, 200, 1000, 0});
  const bool is_running = last.mode == Mode::kRunning;
  if (is_running && away > stage_.promise.start_tolerance + 1e-3)
    complain(fmt::format("runs {:.3f} from its start", away));
  if (!is_running) ++tally_.left[fmt::format("{} at a restart", faultName(last.fault))];
  const bool may_refuse =
      (last.fault == Fault::kNotAtStart && !is_found) || last.fault == Fault::kTareRefused;
  if (!is_running && !may_refuse)
    complain(fmt::format("does not start again: {}", faultName(last.fault)));
  stop();
  finish();
}

void Life::stop() {
  Plan plan;
  const auto add = [&](const char* name, int from_ms) {
    plan.injections.push_back(
        campaign::drawInjection(random_, stage_.scene, campaign::kindOf(name), from_ms));
  };
  if (random_.chance(0.3)) add("forbidden_call", 0);
  add("stop_request", random_.integer(0, 300));
  const Observation last = play(plan, {20'000, 200, 0, 0});
  if (last.mode != Mode::kOff) complain("a stop request does not end it");
}

void Life::account() {
  tally_.cycles += daemon_->cycles();
  tally_.missed_cycles += daemon_->missedCycles();
  for (std::size_t i = 0; i < tally_.drawn.size(); ++i)
    tally_.drawn[i].add(daemon_->latencies().drawn()[i]);
}

/// Its figures have to be those of this run, and its log all of it.
void Life::finish() {
  account();
  daemon_->finish(*cell_);
  std::ifstream in(log_folder_ + "/summary.json");
  const Json summary = Json::parse(in);
  const Json& loop = summary.at("loop");
  if (loop.at("cycles") != daemon_->cycles()) complain("loop.cycles is wrong");
  if (loop.at("missed_cycles") != daemon_->missedCycles()) complain("loop.missed_cycles is wrong");
  if (loop.at("dropped_records") != 0) complain("records were dropped");
  for (std::size_t i = 0; i < Latencies::kNames.size(); ++i)
    for (const std::string& problem : daemon_->latencies().drawn()[i].compare(
             Latencies::kNames[i], loop.at(Latencies::kNames[i])))
      complain(problem);
  const Json& log = summary.at("log");
  if (log.at("state") != "complete") complain("the log has stopped: " + log.dump());
  const bool is_whole = log.at("removed_files") == 0;
  const auto cycles = summary.at("cycles").get<long long>();
  daemon_.reset();
  if (cycles > 0) takeReplay(is_whole ? cycles : 0);
}

}  // namespace tactus::soak
