#include <fmt/format.h>

#include "tactus/bench/extreme_case.h"

/// Contacts as soft and as stiff as can be, met as slowly and as fast as can be.
namespace tactus {
namespace {

constexpr bool kIsRigid[] = {false, true};

const char* armWord(bool is_rigid) { return is_rigid ? "rigid arm" : "compliant arm"; }

ExtremeCase onArm(bool is_rigid, ExtremeCase extreme) {
  extreme.name += fmt::format(", {}", armWord(is_rigid));
  if (is_rigid) extreme.change = makeArmRigid;
  return extreme;
}

void addStiffnesses(std::vector<ExtremeCase>& cases) {
  for (const double stiffness : {1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7}) {
    for (const bool is_rigid : kIsRigid) {
      cases.push_back(onArm(is_rigid, {"stiffness",
                                       fmt::format("{:g} N/m", stiffness),
                                       {obstaclesAre({profileText(stiffness)})}}));
    }
  }
}

ExtremeCase bandThenProfile(double band, double profile, double speed_factor, bool is_rigid) {
  ExtremeCase extreme{"band then profile",
                      fmt::format("{:g} then {:g} N/m, speed x {:g}", band, profile, speed_factor),
                      {obstaclesAre({bandText(band), profileText(profile)})}};
  setSpeed(speed_factor, extreme.overrides);
  return onArm(is_rigid, extreme);
}

void addBandsThenProfiles(std::vector<ExtremeCase>& cases) {
  for (const double band : {10.0, 30.0, 60.0, 200.0, 600.0})
    for (const double profile : {3e3, 7e3, 17e3, 1e5, 1e6})
      for (const bool is_rigid : kIsRigid)
        cases.push_back(bandThenProfile(band, profile, 1.0, is_rigid));
  for (const double speed_factor : {0.2, 5.0})
    for (const double band : {10.0, 600.0})
      for (const double profile : {3e3, 17e3, 1e6})
        for (const bool is_rigid : kIsRigid)
          cases.push_back(bandThenProfile(band, profile, speed_factor, is_rigid));
}

/// The profile behind its foam, as in the paper's third scenario.
void addSpeeds(std::vector<ExtremeCase>& cases) {
  const std::string foam =
      ", foam: [{stiffness_N_per_m: 1400, until_force_N: 9}, "
      "{stiffness_N_per_m: 1800, until_force_N: 16}]";
  for (const double factor : {0.2, 0.5, 1.0, 2.4, 5.0}) {
    ExtremeCase extreme{"speed",
                        fmt::format("profile behind foam, speed x {:g}", factor),
                        {obstaclesAre({profileText(17000, foam)})}};
    setSpeed(factor, extreme.overrides);
    cases.push_back(extreme);
  }
}

}  // namespace

void addContactCases(std::vector<ExtremeCase>& cases) {
  addStiffnesses(cases);
  addBandsThenProfiles(cases);
  addSpeeds(cases);
}

}  // namespace tactus
