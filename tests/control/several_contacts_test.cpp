#include "tactus/control/several_contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/controller_run.h"
#include "support/crops9.h"
#include "support/period.h"
#include "support/rows_run.h"
#include "support/task_kinematics.h"

/// Contacts with rows of their own, on a rail.
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

/// Of a module that feels two contacts, or one that rubs: corners around both places.
TEST(SeveralContacts, HaveTheConesAroundTheResultantAndTheStiffnessCentre) {
  ControllerConfig config = test::crops9Controller(Variant::kNullLimit, true);
  config.force_control->friction_coefficient = 0.5;
  const ScaledVector inv_sqrt = ScaledVector::Ones();
  TaskKinematics kinematics;
  test::computeTaskKinematics(config, config.q_start, inv_sqrt, kinematics);
  const SeveralContacts contacts(config, inv_sqrt);
  const FrictionCone cone(config.tactile_modules.front(), 0.5);
  for (const double shift_m : {-0.05, 0.0, 0.05}) {
    SeveralContactsState state = contacts.initialState();
    ModuleContactState& module = state.modules[0];
    module.approach.memory_N_per_m = 1000.0;
    module.centre.shift_m = shift_m;
    ContactPointState& contact = module.approach.smoother.contact;
    contact.position_m = 0.1;
    contact.direction = Vector3(0.0, 0.6, -0.8);
    SpeedRows rows, expected;
    contacts.addRows(config.gains.force, kinematics, -1, state, rows);
    cone.add(config.chain, kinematics, contact.direction,
             cone.around({0.1 + std::min(0.0, shift_m), 0.1 + std::max(0.0, shift_m)}), inv_sqrt,
             expected);
    ASSERT_EQ(rows.size, 4);
    for (int i = 0; i < rows.size; ++i)
      EXPECT_EQ(rows.row[i].a_scaled, expected.row[i].a_scaled) << i << " " << shift_m;
  }
}

/// Until something is felt, of whatever length each module is.
TEST(SeveralContacts, AreInTheMiddleOfTheirModulesAtFirst) {
  ControllerConfig config = rowsRail(kRowsOf[0], 0.1);
  for (const double length_m : {0.2, 0.7}) {
    config.tactile_modules.push_back(config.tactile_modules.front());
    config.tactile_modules.back().length_m = length_m;
  }
  const ControllerState state = Controller(config).initialState();
  for (int i = 0; i < 3; ++i) {
    const double middle_m = 0.5 * config.tactile_modules[i].length_m;
    EXPECT_EQ(state.several.modules[i].approach.smoother.contact.position_m, middle_m);
    EXPECT_EQ(state.modules[i].contact.position_m, middle_m);
  }
}

/// The null space holds a contact at F_th, and the tool does not notice.
TEST(SeveralContacts, HoldTheThresholdInTheNullSpace) {
  for (const RowsOf& rows : kRowsOf) {
    RowsRun run(rowsRail(rows, 0.1), -0.01);
    run.run(20);  // until it is felt
    run.expectDecay(kOneThreshold_N, 800);
    EXPECT_NEAR(run.force_N(), kOneThreshold_N, 0.01);
    EXPECT_LT(std::abs(run.output.error[0]), 1e-9);
    EXPECT_NEAR(run.output.contact.force_contact_N, std::max(0.0, run.force_N() - kOneThreshold_N),
                0.01);
    EXPECT_EQ(run.output.contact.stiffness_N_per_m, kOneC_N_per_m);
    EXPECT_LT(run.output.contact.u_n, 0.0);
    if (rows.friction_coefficient == 0.0) {
      EXPECT_NEAR(run.output.contact.u_n, 2.0 * run.output.velocity[0] - 0.1, 1e-9);
    }
    EXPECT_EQ(run.output.contact.u_t, 0.0);
    EXPECT_FALSE(run.state.several.modules[0].approach.is_limiting);
  }
}

/// From below, too: what is near its threshold is approached no faster than it can be held.
TEST(SeveralContacts, AreMetNoFasterThanTheyAreHeld) {
  for (const RowsOf& rows : kRowsOf) {
    RowsRun run(rowsRail(rows, 0.5), 0.0);
    double largest_N = 0.0;
    for (int i = 0; i < 600; ++i) {
      run.step();
      largest_N = std::max(largest_N, run.force_N());
    }
    EXPECT_LT(largest_N, 2.5) << "what a cycle or two of the approach add";
    EXPECT_NEAR(run.force_N(), kOneThreshold_N, 0.01);
  }
}

/// Where the null space can do nothing, the tool stops at F_act + F_th.
TEST(SeveralContacts, LimitTheToolWhereTheNullSpaceIsUsedUp) {
  for (const RowsOf& rows : kRowsOf) {
    ControllerConfig config = rowsRail(rows, 10.0);
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    RowsRun run(config, -0.01);
    run.run(20);
    run.expectDecay(kOneAct_N + kOneThreshold_N, 800);
    EXPECT_NEAR(run.force_N(), kOneAct_N + kOneThreshold_N, 0.01);
    EXPECT_LT(run.output.contact.u_t, 0.0);
    EXPECT_TRUE(run.state.several.modules[0].approach.is_limiting);
  }
}

/// What was lost is forgotten with 5 T; what comes back where it was, half as fast each time.
TEST(SeveralContacts, ForgetSlowlyAndSlowerWhatComesBack) {
  RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
  run.run(10);
  double rate = 0.2 / kOneT_s;
  for (int times = 0; times < 8; ++times) {
    ASSERT_EQ(run.memory(), kOneC_N_per_m) << times;
    run.world.surface_m = 1.0;  // it is taken away
    run.step();
    const double first = run.memory();
    run.run(200);
    EXPECT_NEAR(std::log(first / run.memory()) / (200 * kPeriod_s), rate, 0.01 * rate) << times;
    run.world.surface_m = run.state.q_desired[0] - 0.002;
    run.run(2);
    rate = std::max(0.5 * rate, 0.2 / kOneT_s / 64.0);
  }
}

/// However often it came back: once the link has gone elsewhere it is not waited for.
TEST(SeveralContacts, ForgetAtOnceWhatTheyHaveGoneAwayFrom) {
  for (const double haste : {1.0, 0.25, 1.0 / 64.0}) {
    for (const double away_m : {0.0, 0.1}) {
      RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
      run.run(10);
      run.state.several.modules[0].haste = haste;
      run.world.surface_m = 1.0;
      run.run(2);
      run.state.q_desired.array() -= away_m;
      run.run(2);
      const double first = run.memory();
      run.run(100);
      const double rate = 0.2 / kOneT_s * (away_m > 0.0 ? 1.0 : haste);
      EXPECT_NEAR(std::log(first / run.memory()) / (100 * kPeriod_s), rate, 0.01 * rate)
          << haste << " " << away_m;
    }
  }
}

/// As long as something is felt what was learnt is of use, wherever the link is by then.
TEST(SeveralContacts, KnowHowStiffItIsWhileItIsFelt) {
  for (const double away_m : {0.0, 0.1}) {
    for (const double force_N : {0.8, 0.0}) {
      ControllerConfig config = rowsRail(kRowsOf[0], 1e-9);
      config.force_control->has_estimator = true;
      RowsRun run(config, -0.002);
      run.run(10);
      const double& c = run.state.several.modules[0].approach.estimator.stiffness_N_per_m;
      run.state.several.modules[0].approach.estimator.stiffness_N_per_m = 50.0 * kOneC_N_per_m;
      run.state.q_desired.array() -= away_m;
      for (int i = 0; i < 1000; ++i) {
        run.world.surface_m = run.state.q_desired[0] - force_N / kOneC_N_per_m;
        run.step();
      }
      const bool is_known = force_N > 0.0 || away_m == 0.0;
      if (is_known)
        EXPECT_NEAR(c, 50.0 * kOneC_N_per_m, (force_N > 0.0 ? 1e-9 : 5.0) * kOneC_N_per_m)
            << away_m << " " << force_N;
      else
        EXPECT_LT(c, 25.0 * kOneC_N_per_m) << away_m << " " << force_N;
    }
  }
}

/// Between F_rel and F_th it is felt, and nothing is forgotten.
TEST(SeveralContacts, RememberWhatIsStillFelt) {
  RowsRun run(rowsRail(kRowsOf[0], 1e-9), -0.002);
  run.run(10);
  for (const double force_N : {1.1, 0.31, 0.3, 0.29}) {
    for (int i = 0; i < 100; ++i) run.press({force_N});
    EXPECT_EQ(run.memory() == kOneC_N_per_m, force_N > 0.3) << force_N;
  }
}

/// A soft obstacle that comes is known for one, as long as the arm moves.
TEST(SeveralContacts, AreGivenWayAsFastAsTheyCome) {
  for (const RowsOf& rows : kRowsOf) {
    ControllerConfig config = rowsRail(rows, 0.1);
    config.gains.force.max_null_speed_m_per_s = 1e-12;
    RowsRun run(config, 0.0);
    run.run(2000);
    EXPECT_NEAR(run.force_N(), kOneAct_N + kOneThreshold_N, 0.01);
    const double& high_s = run.state.several.modules[0].approach.obstacle.high_s;
    const auto come = [&](int cycles) {
      double longest_s = 0.0;
      for (int i = 0; i < cycles; ++i) {
        run.world.surface_m -= 0.02 * kPeriod_s;
        run.step();
        longest_s = std::max(longest_s, high_s);
      }
      return longest_s;
    };
    EXPECT_GT(come(250), 0.1);
    RowsRun stopped = run;
    stopped.state.is_stopping = true;
    stopped.step();
    EXPECT_EQ(stopped.state.several.modules[0].approach.obstacle.high_s, 0.0);
    come(4000);
    EXPECT_LT(run.force_N(), 1.15 * (kOneAct_N + kOneThreshold_N)) << "T c v_o alone were 2 N more";
  }
}

/// An arm that its drives had stopped by themselves may stand elsewhere: what held it is gone.
TEST(SeveralContacts, AreForgottenByARestart) {
  for (const RowsOf& rows : kRowsOf) {
    RowsRun run(rowsRail(rows, 0.1), 0.0);
    run.run(2000);
    ASSERT_LT(run.output.velocity[0], 0.01);
    run.controller.restart(run.config.gains, run.state);
    run.controller.place(run.state.q_desired.array() - 0.1, run.config.gains, run.state);
    run.world.surface_m = 1.0;
    run.step();
    EXPECT_EQ(run.memory(), 0.0);
    EXPECT_NEAR(run.output.velocity[0], 0.05, 1e-9) << "half of the tool's speed, as if alone";
  }
}

/// Else the next one, of one post alone, would have rows elsewhere.
TEST(SeveralContacts, ForgetWhereStiffnessWasWithTheContact) {
  RowsRun run(rowsRail(kRowsOf[0], 0.1), 0.0);
  run.run(500);
  StiffnessCentreState& centre = run.state.several.modules[0].centre;
  centre.weight = 1.0;
  run.world.surface_m = 1.0;
  run.step();
  ASSERT_GT(run.memory(), 0.0);
  EXPECT_EQ(centre.weight, 1.0) << "the contact may come back";
  for (int i = 0; i < 20000 && run.memory() > 0.0; ++i) run.step();
  EXPECT_EQ(run.memory(), 0.0);
  EXPECT_EQ(centre.weight, 0.0);
}

TEST(SeveralContacts, TellNothingWhereThereIsNone) {
  RowsRun run(rowsRail(kRowsOf[0], 0.1), 1.0);
  run.step();
  EXPECT_EQ(run.output.contact.u_n, 0.0);
  EXPECT_EQ(run.output.contact.u_t, 0.0);
}

TEST(SeveralContacts, TellNothingOfCyclesBefore) {
  for (const RowsOf& rows : kRowsOf) {
    ControllerConfig config = rowsRail(rows, 0.1);
    config.gains.force.max_null_speed_m_per_s = 1e-12;  // so that the tool has to wait
    RowsRun run(config, 0.0);
    run.run(2000);
    RowsRun other = run;
    other.output = {};
    run.step();
    other.step();
    EXPECT_LT(run.output.contact.u_t, -1e-3) << "this test is blind";
    test::expectSameContact(run.output.contact, other.output.contact);
  }
}

/// It tells of the module that is pressed most, and each has its own.
TEST(SeveralContacts, TellOfTheModuleThatIsPressedMost) {
  for (const int most : {0, 1}) {
    ControllerConfig config = rowsRail({LimitAt::kAuto, 0.0}, 1e-9);
    config.tactile_modules.push_back(config.tactile_modules.front());
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    for (std::uint32_t i = 1; i < 5; ++i) {
      RobotInput input{state.q_desired, {}};
      for (int module = 0; module < 2; ++module)
        input.tactile[module] = test::touchAt(0.5, module == most ? -4.0 : -2.0, 0.0, i);
      controller.update(input, config.gains, 0.0, kPeriod_s, state, output);
    }
    EXPECT_NEAR(output.contact.force_contact_N, 4.0 - kOneThreshold_N, 1e-9);
    EXPECT_EQ(output.contact.stiffness_raw_N_per_m, kOneC_N_per_m);
    EXPECT_EQ(output.contact.gamma, 1.0);
    for (int module = 0; module < 2; ++module)
      EXPECT_NEAR(state.several.modules[module].approach.smoother.contact.force_N,
                  module == most ? 4.0 : 2.0, 1e-9);
    RobotInput less{state.q_desired, {}};
    for (int module = 0; module < 2; ++module)
      less.tactile[module] = test::touchAt(0.5, module == most ? -0.8 : 0.0, 0.0, 5);
    state.several.modules[1 - most].transition.gamma = 0.0;
    controller.update(less, config.gains, 0.0, kPeriod_s, state, output);
    EXPECT_NEAR(output.contact.gamma, 1.0, 0.01) << "below the threshold, too";
    less.tactile[0] = less.tactile[1] = test::touchAt(0.5, 0.0, 0.0, 6);
    controller.update(less, config.gains, 0.0, kPeriod_s, state, output);
    EXPECT_NEAR(output.contact.gamma, most == 0 ? 1.0 : 0.0, 0.01) << "else of the first";
  }
}

}  // namespace
}  // namespace tactus
