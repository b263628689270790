#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "support/crops9.h"
#include "support/period.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

/// The runs of an independent implementation, followed cycle by cycle. Its files hold every 10th
/// cycle, with 8 significant digits.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kForceTolerance_N = 1e-6;
constexpr double kJointTolerance = 1e-7;
constexpr int kRowsInFile = 1300;

struct ReferenceRow {
  double t_s, F_sen_N, stiffness_N_per_m, gamma, u_n, u_t;
  JointVector q;
};

std::vector<ReferenceRow> readReference(const std::string& name) {
  std::ifstream file(std::string(TACTUS_SOURCE_DIR) + "/tests/data/reference_" + name + ".csv");
  std::vector<ReferenceRow> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    std::string field;
    std::vector<double> values;
    while (std::getline(fields, field, ',')) values.push_back(std::stod(field));
    rows.push_back({values[0], values[1], values[2], values[3], values[4], values[5],
                    test::jointVector({values.begin() + 6, values.end()})});
  }
  return rows;
}

struct ReferenceCase {
  std::string file;
  Variant variant;
  bool estimated;
  std::vector<ObstacleConfig> obstacles;
};

class FollowsReference : public testing::TestWithParam<ReferenceCase> {};

TEST_P(FollowsReference, CycleByCycle) {
  const std::vector<ReferenceRow> reference = readReference(GetParam().file);
  ASSERT_EQ(reference.size(), kRowsInFile);
  const ControllerConfig config = test::crops9Controller(GetParam().variant, GetParam().estimated);
  const Controller controller(config);
  SimulatedRobot robot(config, test::crops9Plant(GetParam().obstacles), kPeriod_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  double force_difference_N = 0.0;
  double joint_difference = 0.0;
  for (int cycle = 0; cycle < 10 * kRowsInFile; ++cycle) {
    robot.read(input);
    controller.update(input, controller.initialGains(), cycle * kPeriod_s, kPeriod_s, state,
                      output);
    robot.write(output.velocity);
    if (cycle % 10 != 0) continue;
    const ReferenceRow& row = reference[cycle / 10];
    ASSERT_NEAR(row.t_s, cycle * kPeriod_s, 1e-9);
    force_difference_N =
        std::max(force_difference_N, std::abs(output.sensed[0].force_N - row.F_sen_N));
    joint_difference =
        std::max(joint_difference, (output.q_desired - row.q).lpNorm<Eigen::Infinity>());
    EXPECT_NEAR(output.contact.stiffness_N_per_m, row.stiffness_N_per_m, 1e-3) << row.t_s;
    EXPECT_NEAR(output.contact.gamma, row.gamma, 1e-7) << row.t_s;
    EXPECT_NEAR(output.contact.u_t, row.u_t, 1e-6) << row.t_s;
  }
  RecordProperty("largest_force_difference_N", std::to_string(force_difference_N));
  std::printf("largest difference: force %.2g N, q %.2g\n", force_difference_N, joint_difference);
  EXPECT_LT(force_difference_N, kForceTolerance_N);
  EXPECT_LT(joint_difference, kJointTolerance);
  EXPECT_EQ(output.fault, Fault::kNone);
}

INSTANTIATE_TEST_SUITE_P(
    Paper, FollowsReference,
    testing::Values(ReferenceCase{"s1_null", Variant::kNullSpace, false, test::scenario1()},
                    ReferenceCase{"s1_multi", Variant::kNullTask, false, test::scenario1()},
                    ReferenceCase{"s2_multi_est", Variant::kNullTask, true, test::scenario2()}),
    [](const auto& test) { return test.param.file; });

}  // namespace
}  // namespace tactus
