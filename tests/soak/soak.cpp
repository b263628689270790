#include "soak/soak.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "campaign/going_on.h"
#include "tactus/record/run_folder.h"
#include "tactus/record/run_log.h"
#include "tactus/scene/scene_loader.h"

namespace tactus::soak {
namespace {

using campaign::Injection;
using campaign::InjectionKind;
using campaign::Observation;
using campaign::Plan;
using campaign::Play;
using campaign::Violation;

constexpr std::array kVariantsOfSoak = {"null_limit", "null_space", "task_space", "null_task",
                                        "null_joint"};
constexpr int kMostTrouble_ms = 5000;  ///< but for hands
constexpr int kBoot_ms = 5000;
constexpr int kAlone_ms = 1500;  ///< of the plant, after the end
constexpr std::size_t kMostViolations = 100;
constexpr double kRestVelocity = 1e-3;  ///< m/s or rad/s

Scene loadSoakScene(const std::string& path, const SoakScene& soak_scene) {
  writeScene(path, soak_scene);
  Scene scene = loadScene(path, {});
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->e_stop.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake.emplace();
  return scene;
}

/// A life's, which has nothing in common with its neighbours'.
std::uint64_t seedOf(std::uint64_t seed, int number) {
  return (seed * 0x9E3779B97F4A7C15U) ^ (0xD1B54A32D192ED03U * (static_cast<unsigned>(number) + 1));
}

/// Of drives these alone leave joints where they are.
constexpr std::array<std::string_view, 10> kDriveStays = {
    "drive_fault", "drive_silent",      "feedback_lost", "heartbeat_lost",      "fault_shown",
    "off_shown",   "emergency_message", "node_reset",    "communication_reset", "node_stopped"};

bool mayMoveJoints(const InjectionKind& kind) {
  return kind.where == InjectionKind::Where::kDrive &&
         std::ranges::find(kDriveStays, kind.name) == kDriveStays.end();
}

/// stays: the arm is not to be moved by anybody but its controller.
const InjectionKind& drawKind(test::Random& random, bool stays) {
  if (random.chance(0.25)) return campaign::hand();
  static const std::vector<const InjectionKind*> kinds = campaign::injectionKinds();
  while (true) {
    const InjectionKind& kind = *kinds[random.index(static_cast<int>(kinds.size()))];
    const bool is_end = kind.lasts && &kind != &campaign::push();
    if (!is_end && !(stays && mayMoveJoints(kind))) return kind;
  }
}

/// Whoever pushes puts back again, and every drive is mended.
Injection mended(test::Random& random, Injection x) {
  const bool is_hand = x.kind->is_followed && x.kind->high > 0.0;
  if (!is_hand && x.until_ms > x.from_ms + kMostTrouble_ms)
    x.until_ms = x.from_ms + static_cast<int>(random.logUniform(5.0, kMostTrouble_ms));
  return x;
}

}  // namespace

Life::Life(std::uint64_t seed, int number, const std::string& folder, Tally& tally,
           std::function<bool()> minutely)
    : folder_(folder),
      log_folder_(folder + "/log"),
      seed_(seedOf(seed, number)),
      number_(number),
      tally_(tally),
      minutely_(std::move(minutely)),
      random_(seed_),
      scene_{number % 2 == 0 ? "commands" : "scenario1_none",
             kVariantsOfSoak[number % kVariantsOfSoak.size()]},
      stage_{loadSoakScene(folder + "/soak.yaml", scene_), {}, {}},
      began_s_(tally.t_s) {
  ++tally_.lives;
  cell_.emplace(stage_.scene);
  stage_.promise = campaign::promiseOf(stage_.scene, *cell_);
}

void Life::start() {
  writeScene(folder_ + "/soak.yaml", scene_);
  prepareRunFolder(folder_, "log");
  if (std::filesystem::exists(log_folder_ + "/run.next.ulg"))
    complain("a file that a lost daemon had begun is still there");
  daemon_.emplace(stage_.scene, log_folder_, seed_);
  client_.emplace(random_, folder_ + "/soak.yaml", scene_, tally_.requests);
}

void Life::run(double duration_s) {
  next_minute_s_ = 60.0 * (std::floor(tally_.t_s / 60.0) + 1.0);
  next_replay_s_ = tally_.t_s + random_.uniform(20.0, 180.0);  // while all of the log is there
  play({}, {kBoot_ms, 200, 1000, 0});
  const double end_s = began_s_ + duration_s;
  while (goes_on_ && tally_.t_s < end_s) {
    const Plan plan = drawEpisode();
    int over_ms = 0;
    for (const Injection& x : plan.injections) over_ms = std::max(over_ms, x.until_ms + 150);
    const int come_ms = random_.chance(0.1) ? random_.integer(10, over_ms + 10)
                                            : over_ms + random_.integer(50, 1500);
    const int off_ms = static_cast<int>(random_.logUniform(50.0, 600.0));
    const int run_ms = static_cast<int>(random_.logUniform(1000.0, 60'000.0));
    const Observation last = play(plan, {come_ms, off_ms, run_ms, over_ms});
    ++tally_.episodes;
    tally_.troubles += static_cast<long long>(plan.injections.size());
    judgeSubnormals(*cell_);
    if (last.mode != Mode::kRunning) leave(last, plan);
    if (tally_.t_s > next_replay_s_) takeReplay(0);
  }
}

/// Only an arm that stands elsewhere may not go on.
void Life::leave(const Observation& last, const Plan& plan) {
  goes_on_ = false;
  ++tally_.left[faultName(last.fault)];
  if (last.fault != Fault::kNotAtStart)
    complain(fmt::format("does not go on: {} ({}) after{}", modeName(last.mode),
                         faultName(last.fault), plan.text()));
}

Plan Life::drawEpisode() {
  Plan plan;
  const double many = random_.uniform(0.0, 1.0);
  const int count = many < 0.25 ? 0 : many < 0.6 ? 1 : many < 0.9 ? 2 : 3;
  int from_ms = random_.integer(1, 500);
  for (int i = 0; i < count; ++i) {
    const Injection x =
        campaign::drawInjection(random_, stage_.scene, drawKind(random_, number_ == 0), from_ms);
    plan.injections.push_back(mended(random_, x));
    from_ms += random_.chance(0.2) ? 0 : random_.integer(0, 400);
  }
  return plan;
}

Observation Life::play(const Plan& plan, Operator user) {
  Plan unnoted = plan;
  unnoted.frame = campaign::FrameTrouble{.ordinal = -1};  // of no frame; without one all are noted
  Play play(stage_, std::move(*cell_), unnoted, [this](VirtualRobotCell& cell) {
    const test::LoopTimes times = daemon_->finishCycle(cell);
    tally_.histograms[0].add(times.wake_latency_ns);
    tally_.histograms[1].add(times.read_ns);
    tally_.histograms[2].add(times.control_ns);
    tally_.histograms[3].add(times.write_ns);
  });
  campaign::Judges judges;
  campaign::GoingOnJudge going_on;
  std::vector<Violation> found;
  Observation before = play.now();
  while (before.mode != Mode::kOff) {
    CycleInput input = play.input();
    if (!user.act(play.now_ms(), before.mode, input)) break;
    if (tally_.t_s > next_ask_s_) ask();
    play.step(input);
    const campaign::Look look{stage_.promise, before, play.now(), found};
    judges.look(look);
    going_on.look(look);
    count(before, play.now());
    before = play.now();
    if (!passTime(play.cell())) goes_on_ = false;
  }
  going_on.end(play.now_ms());
  tally_.peak = std::max(tally_.peak, going_on.peak());
  if (before.mode == Mode::kOff) endAlone(play, judges, found);
  note(plan, found);
  cell_.emplace(play.cell());
  return before;
}

void Life::endAlone(Play& play, campaign::Judges& judges, std::vector<Violation>& found) {
  for (int i = 0; i < kAlone_ms; ++i) {
    const Observation before = play.now();
    play.stepAlone();
    judges.look({stage_.promise, before, play.now(), found});
  }
}

void Life::ask() {
  next_ask_s_ = tally_.t_s + random_.logUniform(1.0, 20.0);
  const double what = random_.uniform(0.0, 1.0);
  if (what < 0.08) return client_->changeGains();
  if (what < 0.15) return client_->talkNonsense();
  client_->tell();
}

void Life::count(const Observation& before, const Observation& now) {
  if (now.fault != before.fault && now.fault != Fault::kNone) ++tally_.faults[faultName(now.fault)];
  if (now.mode == before.mode) return;
  const bool is_end = now.mode == Mode::kFault || now.mode == Mode::kRetreating;
  tally_.stops += is_end && before.mode != Mode::kRetreating ? 1 : 0;
  tally_.holds += now.mode == Mode::kHolding && now.fault == Fault::kNone ? 1 : 0;
  tally_.goings_on += now.mode == Mode::kRunning ? 1 : 0;
}

bool Life::passTime(const VirtualRobotCell& cell) {
  tally_.t_s = began_s_ + 1e-9 * static_cast<double>(cell.t_ns);
  if (tally_.t_s < next_minute_s_) return true;
  next_minute_s_ += 60.0;
  return minutely_();
}

/// A cycle more, of a copy: what fades has to end at zero.
void Life::judgeSubnormals(const VirtualRobotCell& cell) {
  ControlCycle cycle = cell.cycle;
  std::feclearexcept(FE_UNDERFLOW);
  cycle.update(cell.input);
  cycle.prepare();
  if (std::fetestexcept(FE_UNDERFLOW) != 0) complain("a cycle calculates with subnormal numbers");
}

void Life::note(const Plan& plan, const std::vector<Violation>& found) {
  for (const Violation& violation : found)
    complain(fmt::format("{}: {} {} at {} ms of{}", violation.judge, violation.what,
                         violation.detail, violation.t_ms, plan.text()));
}

void Life::complain(const std::string& what) {
  if (tally_.violations.size() >= kMostViolations) return;
  tally_.violations.push_back(fmt::format("life {}, {:.3f} s ({}): {}", number_,
                                          tally_.t_s - began_s_, scene_.variant, what));
  fmt::print("VIOLATION {}\n", tally_.violations.back());
}

void Life::takeReplay(long long expected_cycles) {
  next_replay_s_ = tally_.t_s + random_.logUniform(60.0, 7200.0);
  if (daemon_) daemon_->drain();
  for (const std::string& problem : replaySample(log_folder_, expected_cycles, tally_.replays))
    complain(problem);
}

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
  for (int i = random_.integer(kAlone_ms, 4000); i > 0; --i)
    plant.advance(cell_->t_ns += 1'000'000);
  for (int joint = 0; joint < stage_.scene.controller.chain.size(); ++joint)
    if (std::abs(plant.drive(joint).velocity()) > kRestVelocity)
      complain("a drive moves though the daemon has lost its power");
  if (!cell_->areDrivesLimp()) complain("a drive has torque though the daemon has lost its power");
  startAgain();
}

/// Where the arm stands now.
void Life::startAgain() {
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
  const Observation last = play({}, {kBoot_ms, 200, 1000, 0});
  const bool is_running = last.mode == Mode::kRunning;
  if (is_running && away > stage_.promise.start_tolerance + 1e-3)
    complain(fmt::format("runs {:.3f} from its start", away));
  if (!is_running) ++tally_.left[fmt::format("{} at a restart", faultName(last.fault))];
  const bool may_refuse = last.fault == Fault::kNotAtStart || last.fault == Fault::kTareRefused;
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
