#include "soak/soak.h"

#include <fmt/format.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "campaign/going_on.h"
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

Scene beginScene(const std::string& path, const SoakScene& soak_scene) {
  writeScene(path, soak_scene);
  return loadSoakScene(path, {});
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

Scene loadSoakScene(const std::string& path, const std::vector<Override>& settings) {
  Scene scene = loadScene(path, settings);
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->e_stop.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake.emplace();
  return scene;
}

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
             kVariantsOfSoak[number % kVariantsOfSoak.size()], number % 4 == 0},
      stage_{beginScene(folder + "/soak.yaml", scene_), {}, {}},
      began_s_(tally.t_s) {
  ++tally_.lives;
  cell_.emplace(stage_.scene);
  stage_.promise = campaign::promiseOf(stage_.scene, *cell_);
}

void Life::start() {
  writeScene(folder_ + "/soak.yaml", scene_);
  run_folder_.emplace(folder_, "log");
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
    const Latencies::Times times = daemon_->finishCycle(cell);
    for (std::size_t i = 0; i < times.size(); ++i) tally_.histograms[i].add(times[i]);
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

}  // namespace tactus::soak
