#include "tactus/control/stiffness_centre.h"

#include <gtest/gtest.h>

#include "support/random.h"
#include "tactus/control/contact_smoother.h"

/// Where changes of the force act, from readings made up of springs.
namespace tactus {
namespace {

constexpr double kCentreSample_s = 0.004;

double normal(test::Random& random) {
  return std::sqrt(-2.0 * std::log(random.uniform(1e-12, 1.0))) *
         std::cos(random.uniform(0.0, 6.283185307));
}

struct Spring {
  double stiffness_N_per_m, position_m, gap_m;
};

/// A module along x whose link goes by `way` and turns by `turn` into springs that push along -y.
class PressedModule {
 public:
  explicit PressedModule(double friction = 0.0)
      : smoother_(config(), friction), centre_(config(), friction) {
    state_ = smoother_.initialState();
  }

  static TactileModuleConfig config() {
    TactileModuleConfig module;
    module.length_m = 0.4;
    return module;
  }

  /// noise: of F and, in half a length, of M; slide: of the link along its axis.
  void press(const std::vector<Spring>& springs, double way_m, double turn_rad, double slide_m,
             double noise_N, test::Random& random) {
    double F_N = noise_N * normal(random);
    double M_Nm = 0.2 * F_N + 0.2 * noise_N * normal(random);
    for (const Spring& spring : springs) {
      const double x_m = spring.position_m - slide_m;
      const double force_N =
          spring.stiffness_N_per_m * std::max(0.0, way_m + turn_rad * x_m - spring.gap_m);
      F_N += force_N;
      M_Nm += x_m * force_N;
    }
    ContactPointState sensor = state_.contact;
    const double F_z_N = noise_N * normal(random);
    sensor.force_N = std::hypot(F_N, F_z_N);
    if (F_N != 0.0) sensor.position_m = std::clamp(M_Nm / F_N, 0.0, config().length_m);
    if (sensor.force_N > 0.0) sensor.direction = Vector3(0.0, -F_N, F_z_N) / sensor.force_N;
    sensor.interval_s = kCentreSample_s;
    Pose X;
    X.R_AB.setIdentity();
    X.p_AB = Vector3(slide_m, 0.0, 0.0);
    smoother_.update({}, sensor, X, state_);
    centre_.update({}, sensor, state_, centre_state_);
  }

  /// Until the smoother knows the noise.
  void waitUntouched(double noise_N, test::Random& random) {
    for (int i = 0; i < 500; ++i) press({}, 0.0, 0.0, 0.0, noise_N, random);
  }

  double contact_m() const { return state_.contact.position_m; }
  const StiffnessCentreState& centre() const { return centre_state_; }

 private:
  ContactSmoother smoother_;
  StiffnessCentre centre_;
  ContactSmootherState state_;
  StiffnessCentreState centre_state_;
};

/// The second is met before the first presses with 3 N.
std::vector<Spring> drawPair(test::Random& random) {
  const double first = random.logUniform(300.0, 3e4);
  return {{first, random.uniform(0.02, 0.15), 0.0},
          {random.logUniform(300.0, 3e4), random.uniform(0.25, 0.38),
           random.uniform(0.0, 3.0) / first}};
}

double stiffnessCentre(const std::vector<Spring>& springs) {
  double sum = 0.0, moment = 0.0;
  for (const Spring& spring : springs) {
    sum += spring.stiffness_N_per_m;
    moment += spring.stiffness_N_per_m * spring.position_m;
  }
  return moment / sum;
}

/// Goes in until all press with `force_N` together, to and fro by `share` of that.
void pressToAndFro(const std::vector<Spring>& springs, double noise_N, test::Random& random,
                   PressedModule& module) {
  double stiffness = 0.0, offset_N = 0.0;
  for (const Spring& spring : springs) {
    stiffness += spring.stiffness_N_per_m;
    offset_N += spring.stiffness_N_per_m * spring.gap_m;
  }
  for (int i = 0; i < 1500; ++i) {
    const double force_N = i < 300 ? 0.03 * i : 9.0 + 2.5 * std::sin(0.03 * (i - 300));
    module.press(springs, (force_N + offset_N) / stiffness, 0.0, 0.0, noise_N, random);
  }
}

TEST(StiffnessCentre, IsWhereTwoSpringsAreIt) {
  test::Random random(81);
  int apart = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const std::vector<Spring> springs = drawPair(random);
    PressedModule module;
    pressToAndFro(springs, 0.0, random, module);
    const double x_c = stiffnessCentre(springs);
    ASSERT_GT(module.centre().weight, 0.0);
    EXPECT_NEAR(module.centre().p_Base.x(), x_c, 0.012) << draw;
    const double way_m = x_c - module.contact_m();
    const double shift_m = module.centre().shift_m;
    EXPECT_LE(std::abs(shift_m), std::abs(way_m) + 0.005) << "no further than to the centre";
    if (std::abs(way_m) < 0.06) continue;
    ++apart;
    EXPECT_GT(shift_m * way_m, 0.0) << "towards it";
  }
  EXPECT_GT(apart, 10);
}

TEST(StiffnessCentre, IsFoundUnderNoise) {
  test::Random random(82);
  double worst_m = 0.0;
  for (int draw = 0; draw < 200; ++draw) {
    const std::vector<Spring> springs = drawPair(random);
    PressedModule module;
    module.waitUntouched(0.05, random);
    pressToAndFro(springs, 0.05, random, module);
    worst_m = std::max(worst_m, std::abs(module.centre().p_Base.x() - stiffnessCentre(springs)));
  }
  EXPECT_LT(worst_m, 0.05);
}

TEST(StiffnessCentre, OfOneContactIsTheContact) {
  test::Random random(83);
  for (const double noise_N : {0.0, 0.02, 0.05, 0.1}) {
    for (int draw = 0; draw < 100; ++draw) {
      std::vector<Spring> springs = drawPair(random);
      springs.resize(1);
      PressedModule module;
      module.waitUntouched(noise_N, random);
      for (int i = 0; i < 2000; ++i) {
        const double way_m = (4.0 + 3.9 * std::sin(0.01 * i)) / springs[0].stiffness_N_per_m;
        const double slide_m = 0.02 * std::sin(0.004 * i);
        module.press(springs, way_m, 0.0, slide_m, noise_N, random);
        ASSERT_LE(std::abs(module.centre().shift_m), noise_N > 0.02 ? 0.02 : 0.0)
            << draw << " " << i << " " << noise_N;
      }
      EXPECT_GT(module.centre().weight, 0.0) << "it has been looked for";
    }
  }
}

/// A link that also turns, and loses none of them: the place that is found approaches at least as
/// fast as the centre.
TEST(StiffnessCentre, OfATurningLinkApproachesNoSlower) {
  test::Random random(84);
  int told = 0;
  for (int draw = 0; draw < 200; ++draw) {
    const std::vector<Spring> springs = drawPair(random);
    const double x_c = stiffnessCentre(springs);
    const double v = 0.005, turn = random.uniform(-0.05, 0.05);  // m/s at the centre, rad/s
    PressedModule module;
    for (int i = 0; i < 500; ++i) {
      const double t_s = kCentreSample_s * i;
      module.press(springs, 0.04 + (v - turn * x_c) * t_s, turn * t_s, 0.0, 0.0, random);
    }
    if (module.centre().weight == 0.0) continue;
    ++told;
    EXPECT_GT(v + turn * (module.centre().p_Base.x() - x_c), 0.9 * v) << draw;
  }
  EXPECT_GT(told, 150);
}

TEST(StiffnessCentre, LearnsNothingBelowTheThreshold) {
  test::Random random(85);
  PressedModule module;
  for (int i = 0; i < 1000; ++i)
    module.press({{1000.0, 0.05, 0.0}, {1000.0, 0.35, 0.0}}, 0.25e-3 * (1.0 + std::sin(0.05 * i)),
                 0.0, 0.0, 0.0, random);
  EXPECT_EQ(module.centre().weight, 0.0);
  EXPECT_EQ(module.centre().shift_m, 0.0);
}

}  // namespace
}  // namespace tactus
