#include <cmath>

#include "tactus/bench/extreme_case.h"

/// What creeps up with time.
namespace tactus {
namespace {

/// Contact, then nothing: whatever fades has time to fade below the smallest normal number.
void addSilences(std::vector<ExtremeCase>& cases) {
  cases.push_back({"silence",
                   "obstacles vanish, then 15 minutes of nothing",
                   {obstaclesAre({bandText(60.0, ", vanishes_s: 12"),
                                  profileText(17000.0, ", vanishes_s: 12")}),
                    {"simulation.duration_s", "920"}},
                   [](Scene& scene) { scene.plant.modules[0].quantised = false; }});
  ExtremeCase fades{"silence", "a reading that halves every second for 20 minutes"};
  setHold(1200.0, fades.overrides);
  fades.reading = [](double t_s, TactileSample& sample) {
    const double force_N = 8.0 * std::exp2(-t_s);
    sample = {force_N, 0.5 * force_N, -0.1 * force_N, 0.2 * force_N, sample.sequence};
  };
  cases.push_back(fades);
  for (ExtremeCase* extreme : {&cases[cases.size() - 1], &cases[cases.size() - 2]})
    extreme->is_long = true;
}

void addHours(std::vector<ExtremeCase>& cases) {
  const auto add = [&](const char* name, const std::string& obstacle, const char* noise_N,
                       const char* duration_s) {
    cases.push_back({"hours",
                     name,
                     {obstaclesAre({obstacle}),
                      {"simulation.tactile_module.noise_N", noise_N},
                      {"simulation.duration_s", duration_s}}});
    cases.back().is_long = true;
  };
  add("two hours on a 17000 N/m profile, noise 0.02 N", profileText(17000.0), "0.02", "7200");
  add("half an hour on a 60 N/m band, no noise", bandText(60.0), "0", "1800");
}

}  // namespace

void addLongCases(std::vector<ExtremeCase>& cases) {
  addSilences(cases);
  addHours(cases);
}

}  // namespace tactus
