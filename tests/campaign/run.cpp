#include "campaign/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "campaign/going_on.h"
#include "campaign/play.h"
#include "campaign/rest_meter.h"
#include "campaign/user.h"

namespace tactus::campaign {
namespace {

constexpr int kAlone_ms = 1500;  ///< of the plant, after the end

void trace(const Observation& before, const Observation& now) {
  if (now.mode != before.mode || now.fault != before.fault)
    std::printf("%6d ms  %s (%s)\n", now.t_ms, modeName(now.mode), faultName(now.fault));
  if (now.enable != before.enable)
    std::printf("%6d ms  enable %s\n", now.t_ms, now.enable ? "on" : "off");
  if (now.is_brake_open != before.is_brake_open)
    std::printf("%6d ms  brake %s\n", now.t_ms, now.is_brake_open ? "opens" : "closes");
}

}  // namespace

Result simulate(const Stage& stage, const Plan& plan, bool is_traced) {
  Play play(stage, plan);
  User user(plan);
  Judges judges;
  GoingOnJudge going_on;
  RestMeter rest(plan);
  Result result;
  Observation before = play.now();
  const auto judge = [&] {
    const Look look{stage.promise, before, play.now(), result.violations};
    judges.look(look);
    going_on.look(look);
    rest.look(look);
    if (is_traced) trace(before, play.now());
    before = play.now();
    ++result.cycles;
  };
  while (true) {
    CycleInput input = play.input();
    if (!user.act(play.now_ms(), play.now().mode, input)) break;
    play.step(input);
    judge();
  }
  going_on.end(play.now_ms());
  for (int i = 0; play.now().mode == Mode::kOff && i < kAlone_ms; ++i) {
    play.stepAlone();
    judge();
  }
  compareGoingOn(stage, plan, going_on, result.violations, result.cycles);
  result.peak = going_on.peak();
  result.rest_mode = rest.mode();
  result.rest_fault = rest.fault();
  result.rest_ms = rest.rest_ms();
  result.mode = play.now().mode;
  result.fault = play.now().fault;
  return result;
}

}  // namespace tactus::campaign
