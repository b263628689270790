#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "support/crops9.h"
#include "support/rows_run.h"
#include "support/task_kinematics.h"
#include "tactus/control/sensed_position.h"
#include "tactus/control/several_contacts.h"

/// Where rows of several contacts stand, what they count for, and what is forgotten with them.
namespace tactus {
namespace {

using test::kOneAct_N;
using test::kOneC_N_per_m;
using test::kOneT_s;
using test::kOneThreshold_N;
using test::kPeriod_s;
using test::kRowsOf;
using test::RowsOf;
using test::rowsRail;
using test::RowsRun;

struct CropsContact {
  explicit CropsContact(const RowsOf& rows_of, int modules = 1)
      : config([&] {
          ControllerConfig crops = test::crops9Controller(Variant::kNullLimit, true);
          crops.force_control->limit_at = rows_of.limit_at;
          crops.force_control->friction_coefficient = rows_of.friction_coefficient;
          for (int i = 1; i < modules; ++i)
            crops.tactile_modules.push_back(crops.tactile_modules.front());
          return crops;
        }()),
        contacts(config, ScaledVector::Ones()),
        state(contacts.initialState()) {
    test::computeTaskKinematics(config, config.q_start, ScaledVector::Ones(), kinematics);
    for (int i = 0; i < modules; ++i) {
      ModuleContactState& module = state.modules[i];
      module.approach.memory_N_per_m = 1000.0;
      module.approach.estimator.stiffness_N_per_m = 1000.0;
      module.approach.smoother.contact.position_m = 0.1;
      module.approach.smoother.contact.direction = Vector3(0.0, 0.6, -0.8);
    }
  }

  SpeedRows rows() const {
    SpeedRows rows;
    contacts.addRows(config.gains.force, kinematics, -1, state, rows);
    return rows;
  }
  void expectRowAt(double position_m, const SpeedRow& row) const {
    ContactPointState contact = state.modules[0].approach.smoother.contact;
    contact.position_m = position_m;
    const AttachedFrame& link = config.tactile_modules.front().link;
    const PlacedContact at = placed(kinematics.pose, link, contact);
    ScaledVector a;
    applyPointJacobianTranspose(config.chain, kinematics.pose, link.joint, at.p_Base, at.F_Base, a);
    EXPECT_LT((row.a_scaled - a).norm(), 1e-12) << position_m;
  }

  ControllerConfig config;
  SeveralContacts contacts;
  SeveralContactsState state;
  TaskKinematics kinematics;
};

TEST(SeveralContactsRows, StandAtTheResultantAndTowardsTheStiffnessCentre) {
  CropsContact crops({LimitAt::kStiffnessCentre, 0.0});
  for (const double shift_m : {-0.05, 0.0, 0.05}) {
    crops.state.modules[0].centre.shift_m = shift_m;
    const SpeedRows rows = crops.rows();
    ASSERT_EQ(rows.size, shift_m == 0.0 ? 1 : 2);
    crops.expectRowAt(0.1, rows.row[0]);
    if (rows.size == 2) crops.expectRowAt(0.1 + shift_m, rows.row[1]);
  }
}

TEST(SeveralContactsRows, StandAtBothEndsIfAskedTo) {
  CropsContact crops({LimitAt::kModuleEnds, 0.0});
  const double length_m = crops.config.tactile_modules.front().length_m;
  const SpeedRows rows = crops.rows();
  ASSERT_EQ(rows.size, 2);
  crops.expectRowAt(0.0, rows.row[0]);
  crops.expectRowAt(length_m, rows.row[1]);

  CropsContact rubbing({LimitAt::kModuleEnds, 0.5});
  const FrictionCone cone(rubbing.config.tactile_modules.front(), 0.5);
  SpeedRows expected;
  cone.add(rubbing.config.chain, rubbing.kinematics, Vector3(0.0, 0.6, -0.8), {0.0, length_m},
           ScaledVector::Ones(), expected);
  const SpeedRows corners = rubbing.rows();
  ASSERT_EQ(corners.size, 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(corners.row[i].a_scaled, expected.row[i].a_scaled) << i;
}

/// Two modules of one link that feel the same.
TEST(SeveralContactsRows, AreTheCornersOfTheConeOfEachModule) {
  const SpeedRows rows = CropsContact({LimitAt::kStiffnessCentre, 0.5}, 2).rows();
  ASSERT_EQ(rows.size, 8);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(rows.row[4 + i].a_scaled, rows.row[i].a_scaled) << i;
}

/// The stiffness may be forgotten sooner than the contact.
TEST(SeveralContactsRows, ArePresentAsTheContactIsRememberedButNeverMoreThanWhole) {
  CropsContact crops({LimitAt::kStiffnessCentre, 0.0});
  for (const double memory_N_per_m : {250.0, 500.0, 1000.0, 2000.0}) {
    crops.state.modules[0].approach.memory_N_per_m = memory_N_per_m;
    EXPECT_EQ(crops.rows().row[0].presence, std::min(1.0, memory_N_per_m / 1000.0));
  }
}

/// What is on its way already counts as if it were felt: else the drives' lag would carry the link
/// far into the contact.
TEST(SeveralContactsRows, CountTheWayThatNoSampleHasToldOf) {
  ControllerConfig config = rowsRail(kRowsOf[0], 0.5);
  config.drive_lag_s = 0.05;
  const SensedPosition drives(config.drive_lag_s, config.tactile_modules.front().filter_cutoff_hz);
  SensedPositionState seen;
  RowsRun run(config, 0.01);
  double largest_N = 0.0;
  for (int i = 0; i < 2000; ++i) {
    drives.update(run.state.q_desired, true, kPeriod_s, seen);
    const double force_N = kOneC_N_per_m * (seen.sensed[0] - run.world.surface_m);
    largest_N = std::max(largest_N, force_N);
    run.press({std::max(0.0, force_N)});
    if (i < 200) continue;
    ASSERT_NEAR(run.output.velocity[0],
                (kOneThreshold_N - run.force_N()) / (kOneT_s * kOneC_N_per_m), 2e-3)
        << i;
  }
  EXPECT_NEAR(run.force_N(), kOneThreshold_N, 0.02);
}

/// A joint that is near its limit keeps off it before anything is felt.
TEST(SeveralContactsRows, AreBesideThoseOfJoints) {
  constexpr double kLeft_m = 0.1;
  ControllerConfig config = rowsRail(kRowsOf[0], 10.0);
  config.limits.upper[1] = kLeft_m;
  config.gains.force.max_null_speed_m_per_s = 100.0;
  RowsRun run(config, 1.0);
  run.step();
  EXPECT_NEAR(run.output.velocity[1], 5.0 * kLeft_m / (1.0 - kLeft_m / 0.25), 1e-4);
  EXPECT_NEAR(run.output.velocity.sum(), 10.0, 1e-3) << "the null space is enough";
}

/// Four modules that are pressed, one of them hard.
TEST(SeveralContactsRows, LimitWhereTheyAreBrokenAlone) {
  for (int hard = 0; hard < 4; ++hard) {
    ControllerConfig config = rowsRail({LimitAt::kResultant, 0.0}, 1e-9);
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    for (int i = 1; i < 4; ++i) config.tactile_modules.push_back(config.tactile_modules.front());
    RowsRun run(config, 1.0);
    std::vector<double> forces_N(4, 2.0);
    forces_N[hard] = 8.0;
    for (int i = 0; i < 3; ++i) run.press(forces_N);
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(run.state.several.modules[i].approach.is_limiting, i == hard) << i << " " << hard;
    EXPECT_NEAR(run.output.contact.u_t, run.output.velocity.sum(), 1e-8);
  }
}

/// 4 N halfway, and 4 N more beyond: of whichever module that feels it.
TEST(SeveralContactsRows, KnowTheStiffnessCentreOfEachModule) {
  const auto shifts_m = [](LimitAt limit_at, int felt) {
    ControllerConfig config = rowsRail({limit_at, 0.0}, 1e-9);
    config.tactile_modules.push_back(config.tactile_modules.front());
    RowsRun run(config, 1.0);
    for (std::uint32_t i = 1; i < 12; ++i) {
      RobotInput input{run.state.q_desired, {}};
      input.tactile[0] = input.tactile[1] = test::touchAt(0.5, 0.0, 0.0, i);
      input.tactile[felt] =
          i % 2 == 0 ? test::touchAt(0.6, -8.0, 0.0, i) : test::touchAt(0.4, -4.0, 0.0, i);
      run.controller.update(input, config.gains, 0.0, kPeriod_s, run.state, run.output);
    }
    const auto& modules = run.state.several.modules;
    return std::array<double, 2>{modules[0].centre.shift_m, modules[1].centre.shift_m};
  };
  for (const int felt : {0, 1}) {
    const std::array<double, 2> shift_m = shifts_m(LimitAt::kAuto, felt);
    EXPECT_GT(shift_m[felt], 0.05);
    EXPECT_LT(shift_m[felt], 0.4);
    EXPECT_EQ(shift_m[1 - felt], 0.0);
    EXPECT_EQ(shifts_m(LimitAt::kResultant, felt)[felt], 0.0) << "nobody asks for it";
  }
}

/// A swing that does not press is no return.
TEST(SeveralContactsMemory, FadesNoSlowerForWhatIsFeltBelowTheThreshold) {
  RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
  run.run(10);
  run.world.surface_m = 1.0;
  run.run(10);
  run.press({0.8});
  run.run(1);
  EXPECT_NEAR(run.forgetting_per_s(), 0.2 / kOneT_s, 0.01 * 0.2 / kOneT_s);
}

/// However slowly the last one was forgotten.
TEST(SeveralContactsMemory, FadesAsAtFirstOfWhatIsMetElsewhere) {
  RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
  run.run(10);
  run.state.several.modules[0].haste = 1.0 / 64.0;
  run.world.surface_m = 1.0;
  run.run(2);
  run.state.q_desired.array() -= 0.1;
  run.world.surface_m = run.state.q_desired[0] - 0.002;
  run.run(10);
  run.world.surface_m = 1.0;
  run.run(1);
  EXPECT_NEAR(run.forgetting_per_s(), 0.2 / kOneT_s, 0.01 * 0.2 / kOneT_s);
}

/// Half of the distance where a contact is another is elsewhere already.
TEST(SeveralContactsMemory, TellsElsewhereFromHalfTheDistanceOn) {
  for (const double away_m : {0.12, 0.125, 0.13}) {
    ControllerConfig config = rowsRail(kRowsOf[0], 0.0);
    config.gains.force.transition.distance_m = 0.25;
    RowsRun run(config, 1.0);
    run.state.q_desired[0] = 0.5;
    run.press({3.0});
    for (int i = 0; i < 3; ++i) run.press({0.0});
    run.state.several.modules[0].haste = 0.25;
    run.state.q_desired[0] = 0.5 + away_m;
    run.press({3.0});
    EXPECT_EQ(run.state.several.modules[0].haste, away_m < 0.125 ? 0.125 : 1.0) << away_m;
  }
}

/// Of a module that the arm goes on without nothing is known, nor that it was here before.
TEST(SeveralContactsMemory, IsOfNoUseOfALostModule) {
  RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
  run.run(10);
  run.state.several.modules[0].haste = 1.0 / 64.0;
  run.state.modules[0].is_lost = true;
  run.step();
  EXPECT_NEAR(run.forgetting_per_s(), 0.2 / kOneT_s, 0.01 * 0.2 / kOneT_s) << "whatever it says";
  run.state.modules[0].is_lost = false;
  run.world.surface_m = run.state.q_desired[0] - 0.002;
  run.run(2);
  run.world.surface_m = 1.0;
  run.run(1);
  EXPECT_NEAR(run.forgetting_per_s(), 0.2 / kOneT_s, 0.01 * 0.2 / kOneT_s) << "a new one";
}

/// The way of a module's absence says nothing of how soft a contact is.
TEST(SeveralContactsMemory, CountsNoWayOfALostModule) {
  ControllerConfig config = rowsRail(kRowsOf[0], 1e-9);
  config.force_control->has_estimator = true;
  RowsRun run(config, 1.0);
  run.run(10);
  run.state.modules[0].is_lost = true;
  const std::uint32_t sequence = run.state.modules[0].sequence;
  run.state.q_desired.array() += 0.1;
  run.controller.update({run.state.q_desired, {test::touchAt(0.5, 0.0, 0.0, sequence)}},
                        config.gains, 0.0, kPeriod_s, run.state, run.output);
  run.state.modules[0].is_lost = false;
  run.press({kOneThreshold_N + 0.4 * kOneAct_N});
  EXPECT_GE(run.output.contact.stiffness_N_per_m, kOneC_N_per_m);
}

}  // namespace
}  // namespace tactus
