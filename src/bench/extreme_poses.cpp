#include <fmt/format.h>

#include "tactus/bench/extreme_case.h"
#include "tactus/bench/random.h"

/// Arms in poses from which they hardly can answer, touched on either side.
namespace tactus {
namespace {

constexpr double kDuration_s = 14.0;
constexpr double kVanishes_s = 8.0;
constexpr double kPressing_m = 0.03;
constexpr double kPressing_Hz = 0.1;  ///< in and out once within 5 s, away for as long

constexpr const char* kAllComponents = "[x, y, z, rx, ry, rz]";

/// The pose at which the cases are built, as a function of the arm's limits.
using Start = std::function<JointVector(const JointLimits& limits)>;

ExtremeCase pressed(std::string group, std::string name, const Start& start, double side,
                    double stiffness) {
  ExtremeCase extreme{std::move(group), fmt::format("{}, {:g} N/m from the {}", name, stiffness,
                                                    side > 0.0 ? "left" : "right")};
  setHold(kDuration_s, extreme.overrides);
  extreme.change = [=](Scene& scene) {
    scene.controller.q_start = start(scene.controller.limits);
    addBeside({0.6, side, 0.001}, stiffness, kPressing_m, kPressing_Hz, kVanishes_s, scene);
  };
  return extreme;
}

void addBothSides(std::vector<ExtremeCase>& cases, const std::string& group,
                  const std::string& name, const Start& start,
                  const std::vector<Override>& overrides = {}) {
  for (const double side : {1.0, -1.0}) {
    for (const double stiffness : {200.0, 7000.0}) {
      ExtremeCase extreme = pressed(group, name, start, side, stiffness);
      extreme.overrides.insert(extreme.overrides.end(), overrides.begin(), overrides.end());
      cases.push_back(extreme);
    }
  }
}

JointVector within(const JointLimits& limits, const std::function<double(int)>& share) {
  JointVector q = 0.5 * (limits.lower + limits.upper);
  for (int i = 0; i < q.size(); ++i) q[i] += 0.5 * share(i) * (limits.upper[i] - limits.lower[i]);
  return q;
}

Start evenly(double share, bool alternates) {
  return [=](const JointLimits& limits) {
    return within(limits, [=](int i) { return alternates && i % 2 == 1 ? -share : share; });
  };
}

Start bentBy(double angle_rad) {
  return [=](const JointLimits& limits) {
    const JointVector bent = JointVector::Constant(limits.lower.size(), angle_rad);
    return JointVector(bent.cwiseMax(limits.lower).cwiseMin(limits.upper));
  };
}

Start atRandom(int seed) {
  return [=](const JointLimits& limits) {
    BenchRandom random(static_cast<std::uint64_t>(seed));
    return within(limits, [&](int) { return random.uniform(-0.9, 0.9); });
  };
}

void addDirections(std::vector<ExtremeCase>& cases) {
  for (int i = 1; i <= 12; ++i)
    addBothSides(cases, "direction", fmt::format("random pose {}", i), atRandom(i));
}

/// Hardly any null space is left that moves the contact point.
void addTaskDirections(std::vector<ExtremeCase>& cases) {
  const Override all{"task.components", kAllComponents};
  const Start home = [](const JointLimits&) {
    JointVector q(9);
    q << 0.05435, -0.55466, 0.46559, 0.45517, 0.44598, 0.91397, 1.07822, -0.66951, 0.58605;
    return q;
  };
  addBothSides(cases, "k_n near zero", "six components", home, {all});
  const std::pair<const char*, const char*> kHeavy[] = {
      {"wrist locked", "[1, 1, 1, 1, 1, 1, 1e6, 1e6, 1e6]"},
      {"base locked", "[1e6, 1e6, 1e6, 1, 1, 1, 1, 1, 1]"},
      {"joints before the contact locked", "[1e6, 1e6, 1e6, 1e6, 1, 1, 1, 1, 1]"}};
  for (const auto& [name, weights] : kHeavy) {
    addBothSides(cases, "k_n near zero", fmt::format("six components, {}", name), home,
                 {all, {"redundancy.weights", weights}});
  }
  // Such light joints would leave their limits' zones faster than a cycle can follow.
  addBothSides(cases, "k_n near zero", "six components, weights from 1e-6 to 1e6", home,
               {all,
                {"redundancy.weights", "[1e6, 1e-6, 1e6, 1e-6, 1e6, 1e-6, 1e6, 1e-6, 1e6]"},
                {"redundancy.joint_limit_avoidance.gain", "0"}});
}

void addSingularPoses(std::vector<ExtremeCase>& cases) {
  const Override all{"task.components", kAllComponents};
  for (const double bend : {0.0, 1e-9, 1e-4, 0.02, 0.1}) {
    const std::string name = fmt::format("stretched, bent by {:g} rad", bend);
    addBothSides(cases, "pose", name, bentBy(bend));
    addBothSides(cases, "pose", name + ", six components", bentBy(bend), {all});
  }
  addBothSides(cases, "pose", "folded", evenly(0.95, false));
  addBothSides(cases, "pose", "folded in turn", evenly(0.95, true));
  addBothSides(cases, "joint limits", "all at their limits", evenly(1.0, false));
  addBothSides(cases, "joint limits", "all at their limits in turn", evenly(1.0, true));
  addBothSides(cases, "joint limits", "all at their limits, no cost of them", evenly(1.0, true),
               {{"redundancy.joint_limit_avoidance.gain", "0"}});
}

/// The tool is led out of reach and back while the arm is in contact, on one side of the straight
/// arm and on the other.
void addPassages(std::vector<ExtremeCase>& cases) {
  for (const double away_m : {0.02, 0.2}) {
    for (const double stiffness : {60.0, 7e3, 1e5}) {
      for (const char* components : {"[x, y, z]", kAllComponents}) {
        ExtremeCase extreme{"through singular",
                            fmt::format("{:g} m beyond reach and back, {:g} N/m, {}", away_m,
                                        stiffness, components)};
        const std::string leg = "speed_m_per_s: 0.1, pause_s: 1";
        extreme.overrides = {
            {"task.components", components},
            {"task.trajectory.line", "~"},
            {"task.trajectory.waypoints",
             fmt::format(
                 "[{{displacement_m: [{}, 0, 0], {}}}, {{displacement_m: [-0.1, 0.2, 0], {}}}, "
                 "{{displacement_m: [{}, -0.2, 0], {}}}, {{displacement_m: [-0.1, 0, 0], {}}}]",
                 away_m, leg, leg, away_m, leg, leg)},
            {"start", "[0, -0.15, 0.05, 0.1, 0.05, 0.1, 0, 0.1, 0.05]"},
            {"simulation.duration_s", "35"}};
        extreme.change = [=](Scene& scene) {
          addBeside({0.5, 1.0, 0.02}, stiffness, 0.0, 0.0, 30.0, scene);
          addBeside({0.8, -1.0, 0.02}, stiffness, 0.0, 0.0, 30.0, scene);
        };
        cases.push_back(extreme);
      }
    }
  }
}

}  // namespace

void addPoseCases(std::vector<ExtremeCase>& cases) {
  addDirections(cases);
  addTaskDirections(cases);
  addSingularPoses(cases);
  addPassages(cases);
}

}  // namespace tactus
