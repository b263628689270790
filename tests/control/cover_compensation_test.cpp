#include "tactus/control/cover_compensation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "support/period.h"
#include "support/random_robot.h"
#include "tactus/control/controller.h"
#include "tactus/math/filter.h"

/// Against forces and moments by hand, through the simulated module's own filter.
namespace tactus {
namespace {

using test::kPeriod_s;

ControllerConfig coveredRobot(test::Random& random) {
  const int joints = random.integer(2, 9);
  ControllerConfig config = test::randomController(random, joints, 1);
  config.gravity_Base = random.uniform(1.0, 12.0) * random.unitVector();
  config.tactile_modules.front().feels_moment_x = true;
  config.tactile_modules.front().cover =
      CoverConfig{random.uniform(0.05, 1.5), random.vector<Vector3>(3, -0.2, 0.4)};
  return config;
}

Joint carriageJoint() {
  Joint rail;
  rail.type = JointType::kPrismatic;
  return rail;
}

/// A cover on the first of two carriages.
ControllerConfig coveredCarriage(test::Random& random) {
  ControllerConfig config = coveredRobot(random);
  config.chain = SerialChain({carriageJoint(), carriageJoint()}, {1, {}});
  config.q_start = JointVector::Zero(2);
  config.tactile_modules.front().link.joint = 0;
  return config;
}

Pose modulePose(const ControllerConfig& config, const JointVector& q) {
  ChainPose pose;
  config.chain.computePose(q, pose);
  return framePose(pose, config.tactile_modules.front().link);
}

/// What cells feel of the cover: force and moment about the module's origin.
Wrench5 feltAt(const ControllerConfig& config, const JointVector& q, const Vector3& a_Base) {
  const CoverConfig& cover = *config.tactile_modules.front().cover;
  const Matrix3 R = modulePose(config, q).R_AB;
  const Vector3 F = cover.mass_kg * (R.transpose() * config.gravity_Base) -
                    cover.mass_kg * (R.transpose() * a_Base);
  const Vector3 M = cover.p_ModuleCenter.cross(F);
  return Wrench5{{F.y(), F.z(), M.y(), M.z(), M.x()}};
}

TactileSample sampleOf(const Wrench5& w, std::uint32_t sequence) {
  return {w[0], w[1], w[2], w[3], sequence, w[4]};
}

Wrench5 wrenchOf(const TactileSample& s) {
  return Wrench5{{s.force_y_N, s.force_z_N, s.moment_y_Nm, s.moment_z_Nm, s.moment_x_Nm}};
}

TEST(CoverCompensation, LeavesTheContactOfAnArmAtRestAnywhere) {
  test::Random random(901);
  for (int i = 0; i < 50; ++i) {
    const ControllerConfig config = coveredRobot(random);
    const CoverCompensation compensation(config, config.tactile_modules.front());
    const auto n = static_cast<int>(config.q_start.size());
    const JointVector q = random.vector(n, -2.0, 2.0);
    const Vector3 none = Vector3::Zero();
    const Wrench5 contact = random.vector<Wrench5>(5, -5.0, 5.0);
    const Wrench5 weight = feltAt(config, q, none) - feltAt(config, config.q_start, none);
    CoverCompensationState state;
    TactileSample relieved;
    for (std::uint32_t cycle = 1; cycle < 300; ++cycle)
      relieved = compensation.relieve(sampleOf(contact + weight, cycle), q, kPeriod_s, state);
    EXPECT_LT((wrenchOf(relieved) - contact).norm(), 1e-9);
    EXPECT_EQ(relieved.sequence, 299u);
  }
}

/// It would turn the push.
TEST(CoverCompensation, TellsNoMomentAboutTheLinkOfAModuleThatFeelsNone) {
  test::Random random(907);
  for (int i = 0; i < 10; ++i) {
    ControllerConfig config = coveredRobot(random);
    config.tactile_modules.front().feels_moment_x = false;
    const CoverCompensation compensation(config, config.tactile_modules.front());
    const auto n = static_cast<int>(config.q_start.size());
    const JointVector q = random.vector(n, -2.0, 2.0);
    TactileSample sample = sampleOf(random.vector<Wrench5>(5, -5.0, 5.0), 1);
    sample.moment_x_Nm = 0.0;
    CoverCompensationState state;
    EXPECT_EQ(compensation.relieve(sample, q, kPeriod_s, state).moment_x_Nm, 0.0);
  }
}

/// Joints swing, each with its own frequency.
struct Swinging {
  JointVector q_middle, amplitude, frequency_hz;

  JointVector at(double t_s) const {
    return q_middle + amplitude.cwiseProduct((6.28 * t_s * frequency_hz).array().sin().matrix());
  }
};

/// The worst that is left of readings of a moving cover, and the most that there was, N.
struct Left {
  double worst_N = 0.0, felt_N = 0.0;
};

Left relieveSwinging(const ControllerConfig& config, const Swinging& swinging) {
  const Vector3 c = config.tactile_modules.front().cover->p_ModuleCenter;
  const CoverCompensation compensation(config, config.tactile_modules.front());
  const Wrench5 tare = feltAt(config, config.q_start, Vector3::Zero());
  std::vector<ButterworthLowPass> filters(5, ButterworthLowPass(15.0, 1.0 / kPeriod_s));
  const auto center = [&](double t_s) {
    const Pose X = modulePose(config, swinging.at(t_s));
    return Vector3(X.p_AB + X.R_AB * c);
  };
  CoverCompensationState state;
  Left left;
  for (int cycle = 0; cycle < 1500; ++cycle) {
    const double t_s = cycle * kPeriod_s;
    constexpr double h = 1e-4;
    const Vector3 a = (center(t_s + h) - 2.0 * center(t_s) + center(t_s - h)) / (h * h);
    Wrench5 reading = feltAt(config, swinging.at(t_s), a);
    for (int i = 0; i < 5; ++i) reading[i] = filters[i].update(reading[i]);
    reading -= tare;
    const TactileSample relieved =
        compensation.relieve(sampleOf(reading, 1), swinging.at(t_s), kPeriod_s, state);
    if (t_s < 0.5) continue;  // until the filters know the motion
    left.felt_N = std::max(left.felt_N, reading.head<2>().norm());
    left.worst_N = std::max(left.worst_N, wrenchOf(relieved).head<2>().norm());
  }
  return left;
}

TEST(CoverCompensation, LeavesNextToNothingOfAMovingCover) {
  test::Random random(902);
  for (int i = 0; i < 20; ++i) {
    const ControllerConfig config = coveredRobot(random);
    const auto n = static_cast<int>(config.q_start.size());
    const Swinging swinging{config.q_start, random.vector(n, 0.0, 0.1), random.vector(n, 0.5, 4.0)};
    const Left left = relieveSwinging(config, swinging);
    EXPECT_LT(left.worst_N, 0.06 * left.felt_N + 1e-3);
    EXPECT_GT(left.felt_N, 0.01);
  }
}

TEST(CoverCompensation, MissedCyclesAreNoAcceleration) {
  test::Random random(903);
  const ControllerConfig config = coveredCarriage(random);
  const CoverCompensation compensation(config, config.tactile_modules.front());
  CoverCompensationState state;
  double q = 0.0, most_N = 0.0;
  for (int cycle = 0; cycle < 600; ++cycle) {
    const TactileSample relieved =
        compensation.relieve({}, JointVector{{q, 0.0}}, kPeriod_s, state);
    if (cycle > 300) most_N = std::max(most_N, wrenchOf(relieved).norm());
    const int missed = cycle % 50 == 49 ? 4 : 0;
    state.missed_s += missed * kPeriod_s;
    q += 0.3 * (1 + missed) * kPeriod_s;
  }
  EXPECT_LT(most_N, 1e-3) << "what is left of the start; a false acceleration is 240 m/s^2";
}

/// A carriage that is at its speed from one cycle to the next: one cycle of acceleration, through
/// the filter with the cut-off that the module has.
TEST(CoverCompensation, FiltersAsTheModuleDoes) {
  test::Random random(907);
  ControllerConfig config = coveredCarriage(random);
  TactileModuleConfig& module = config.tactile_modules.front();
  for (const double cutoff_hz : {15.0, 40.0}) {
    module.filter_cutoff_hz = cutoff_hz;
    const CoverCompensation compensation(config, module);
    std::vector<ButterworthLowPass> filters(5, ButterworthLowPass(cutoff_hz, 1.0 / kPeriod_s));
    CoverCompensationState state;
    const Wrench5 rest = feltAt(config, config.q_start, Vector3::Zero());
    double largest_N = 0.0, off_N = 0.0;
    for (int cycle = 0; cycle < 200; ++cycle) {
      const JointVector q{{0.3 * kPeriod_s * std::max(0, cycle - 20), 0.0}};
      const double a = cycle == 21 ? 0.3 / kPeriod_s : 0.0;
      Wrench5 left = wrenchOf(compensation.relieve({}, q, kPeriod_s, state));
      const Wrench5 felt = feltAt(config, q, a * carriageJoint().axis) - rest;
      for (int i = 0; i < 5; ++i) {
        const double filtered = filters[i].update(felt[i]);
        largest_N = std::max(largest_N, std::abs(filtered));
        off_N = std::max(off_N, std::abs(left[i] + filtered));
      }
    }
    EXPECT_GT(largest_N, 0.1);
    EXPECT_LT(off_N, 1e-4 * largest_N) << cutoff_hz;
  }
}

TEST(CoverCompensation, AModuleWithoutACoverIsReadAsItIs) {
  test::Random random(904);
  ControllerConfig config = coveredRobot(random);
  config.tactile_modules.front().cover.reset();
  const Controller controller(config);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  RobotInput input;  // measured joints are not asked for
  input.tactile[0] = {3.0, 4.0, 0.0, 0.0, 1};
  controller.update(input, controller.initialGains(), 0.0, kPeriod_s, state, output);
  EXPECT_EQ(output.sensed[0].force_N, 5.0);
}

TEST(CoverCompensation, BeginsAnewAfterARestart) {
  test::Random random(905);
  const ControllerConfig config = coveredRobot(random);
  const Controller controller(config);
  ControllerState state = controller.initialState(), fresh = controller.initialState();
  ControllerOutput output;
  RobotInput input;
  const auto n = static_cast<int>(config.q_start.size());
  for (int cycle = 0; cycle < 50; ++cycle) {
    input.q_measured = random.vector(n, -1.0, 1.0);
    controller.watchSensors(input, kPeriod_s, state);
  }
  controller.restart(controller.initialGains(), state);
  input.q_measured = random.vector(n, -1.0, 1.0);
  input.tactile[0].sequence = 7;
  for (ControllerState* s : {&state, &fresh}) controller.watchSensors(input, kPeriod_s, *s);
  EXPECT_EQ(state.modules[0].contact.force_N, fresh.modules[0].contact.force_N)
      << "a log from here on has all that counts";
}

/// The cover is where the link is: of stiff gears where the motor is, of soft ones elsewhere.
TEST(CoverCompensation, FollowsLinksBehindTheirGears) {
  test::Random random(906);
  double elsewhere_N = 0.0;
  for (int i = 0; i < 10; ++i) {
    const ControllerConfig rigid = coveredRobot(random);
    const auto n = static_cast<int>(rigid.q_start.size());
    ControllerConfig stiff = rigid;
    stiff.geared_links = GearedLinks{std::vector<BodyInertia>(n, BodyInertia{2.0}),
                                     JointVector::Constant(n, 1e12), JointVector::Zero(n)};
    ControllerConfig soft = stiff;
    soft.geared_links->gear_stiffness.setConstant(500.0);
    soft.geared_links->gear_damping.setConstant(5.0);
    const std::vector<const ControllerConfig*> configs{&rigid, &stiff, &soft};
    std::vector<TactileSample> relieved(3);
    std::vector<CoverCompensationState> states(3);
    const Swinging swinging{rigid.q_start, random.vector(n, 0.01, 0.1), random.vector(n, 0.2, 1.0)};
    for (std::uint32_t cycle = 1; cycle < 400; ++cycle) {
      int k = 0;
      for (const ControllerConfig* config : configs) {
        const CoverCompensation compensation(*config, config->tactile_modules.front());
        relieved[k] = compensation.relieve(sampleOf(Wrench5(Wrench5::Zero()), cycle),
                                           swinging.at(cycle * kPeriod_s), kPeriod_s, states[k]);
        ++k;
      }
      ASSERT_LT((wrenchOf(relieved[1]) - wrenchOf(relieved[0])).norm(), 1e-3) << i << " " << cycle;
      elsewhere_N =
          std::max(elsewhere_N, (wrenchOf(relieved[2]) - wrenchOf(relieved[0])).head<2>().norm());
    }
  }
  EXPECT_GT(elsewhere_N, 0.01);
}

/// The weight that a cover has shed since it was tared is no contact, on whichever module it is.
TEST(CoverCompensation, IsOfTheModulesThatHaveACover) {
  for (const int covered : {0, 1}) {
    test::Random random(908);
    const ControllerConfig with = coveredRobot(random);
    ControllerConfig config = with;
    config.tactile_modules.push_back(config.tactile_modules.front());
    config.tactile_modules[1 - covered].cover.reset();
    const Controller controller(config);
    const JointVector q = config.q_start.array() + 0.5;
    ControllerState state = controller.initialState(q);
    ControllerOutput output;
    const Wrench5 shed =
        feltAt(with, q, Vector3::Zero()) - feltAt(with, with.q_start, Vector3::Zero());
    ASSERT_GT(shed.head(2).matrix().norm(), 0.05);
    for (std::uint32_t i = 1; i < 3; ++i) {
      const TactileSample sample = sampleOf(shed, i);
      controller.update({q, {sample, sample}}, config.gains, 0.0, kPeriod_s, state, output);
    }
    EXPECT_NEAR(output.sensed[covered].force_N, 0.0, 1e-9) << covered;
    EXPECT_GT(output.sensed[1 - covered].force_N, 0.05);
  }
}

}  // namespace
}  // namespace tactus
