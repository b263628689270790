#include <valgrind/callgrind.h>

#include <cstdio>
#include <cstring>

#include "support/crops9.h"
#include "support/random.h"
#include "support/task_kinematics.h"
#include "tactus/control/friction_cone.h"
#include "tactus/control/joint_limit_rows.h"
#include "tactus/control/speed_rows.h"

/// The most that the gate has to keep: a contact on each of kMaxTactileModules modules of the
/// nine-joint arm, four pairs of bodies, and all joints near their limits, in drawn poses; both
/// levels of rows, as SeveralContacts solves them. With the argument `cones` contacts rub. Dumps
/// the instructions of each draw, and prints how many there were.
namespace {

using namespace tactus;

struct Draw {
  explicit Draw(test::Random& random) : config(test::crops9Controller()) {
    const int n = config.chain.size();
    q = random.vector(n, -0.8, 0.8);
    config.limits.lower = q - random.vector(n, 0.01, 0.2);
    config.limits.upper = q + random.vector(n, 0.01, 0.2);
    test::computeTaskKinematics(config, q, ScaledVector::Ones(), kinematics);
    motion.v_scaled = scaled(random.vector(n, -1.0, 1.0), ScaledVector::Ones());
    motion.y.setZero();
    for (int i = 0; i < config.task.size; ++i) motion.y[i] = random.uniform(-0.5, 0.5);
  }

  void addContact(test::Random& random, int module, bool rubs) {
    TactileModuleConfig tactile;
    tactile.link.joint = 1 + module % 8;
    const double angle = random.uniform(-3.1, 3.1);
    const ContactPointState point{.position_m = random.uniform(0.0, 0.15),
                                  .direction = Vector3(0.0, std::cos(angle), std::sin(angle))};
    const int first = rows.size;
    const FrictionCone cone(tactile, rubs ? 0.5 : 0.0);
    cone.add(config.chain, kinematics, point.direction,
             cone.around({point.position_m, point.position_m}), ScaledVector::Ones(), rows);
    if (!rubs) rows.size = first + 1;
    setSpeeds(random, first, -0.1, 0.1, random.logUniform(10.0, 1e5));
  }

  void addPair(test::Random& random) {
    const int first = rows.size;
    SpeedRow& row = rows.row[rows.size++];
    applyPointJacobianTranspose(config.chain, kinematics.pose, random.integer(4, 8),
                                framePosition(kinematics.pose, config.chain.tip()),
                                random.unitVector(), row.a_scaled);
    row.a_task = kinematics.pseudoinverse.project(row.a_scaled);
    setSpeeds(random, first, 0.0, 0.1, 2e6);
  }

  void setSpeeds(test::Random& random, int first, double least, double most, double damping) {
    const double v_max = random.uniform(least, most);
    for (int i = first; i < rows.size; ++i) {
      rows.row[i].v_max_m_per_s = v_max;
      rows.row[i].damping_N_s_per_m = damping;
      rows.row[i].presence = 1.0;
    }
  }

  void addWithoutSensor(test::Random& random) {
    for (int i = 0; i < 4; ++i) addPair(random);
    JointLimitRows(config.limits, true).add(q, kinematics, ScaledVector::Ones(), 1.0, rows);
  }

  void keep() {
    RowProblem problem(rows, config.task.size);
    const RowMultipliers found = problem.solve(ownSpeeds(rows), kNullSpaceAlone, motion, 0.5);
    addRows(rows, found.l, kNullSpaceAlone, motion);
    problem.keep(motion);
  }

  ControllerConfig config;
  JointVector q;
  TaskKinematics kinematics;
  Motion motion;
  SpeedRows rows;
};

}  // namespace

int main(int argc, char** argv) {
  const bool rubs = argc > 1 && std::strcmp(argv[1], "cones") == 0;
  constexpr int kDraws = 1500;
  test::Random random(351);
  for (int i = 0; i < kDraws; ++i) {
    Draw draw(random);
    for (int k = 0; k < kMaxTactileModules; ++k) draw.addContact(random, k, rubs);
    draw.addWithoutSensor(random);
    CALLGRIND_ZERO_STATS;
    CALLGRIND_TOGGLE_COLLECT;
    draw.keep();
    CALLGRIND_TOGGLE_COLLECT;
    CALLGRIND_DUMP_STATS;
  }
  std::printf("%d\n", kDraws);
  return 0;
}
