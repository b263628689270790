#include <gtest/gtest.h>

#include <cmath>

#include "support/scene_files.h"

/// An arm that is simulated with mass: bodies from the URDF, the rest from robot.yaml.
namespace tactus {
namespace {

std::string linkWith(const char* name, const char* mass, const char* moments) {
  return std::string("<link name=\"") + name +
         "\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"" + mass + "\"/><inertia " + moments +
         "/></inertial></link>";
}

constexpr const char* kMoments =
    "ixx=\"0.02\" ixy=\"0\" ixz=\"0\" iyy=\"0.03\" iyz=\"0\" izz=\"0.04\"";

struct MassiveFiles : test::SceneFiles {
  MassiveFiles() {
    for (const char* link : {"link1", "link2", "link3", "gripper"}) {
      urdf = test::replaced(urdf, std::string("<link name=\"") + link + "\"/>",
                            linkWith(link, "2", kMoments));
    }
    robot +=
        "dynamics:\n  rotor_inertia: [3, 0.5, 0.1]\n  gear_stiffness: [1e5, 1e3, 1e3]\n"
        "  gear_damping: [10, 1, 1]\n  servo_bandwidth_hz: 30\n"
        "  contact_stiffness_N_per_m: 9000\n";
    scene += "  arm: flexible_gears\n";
  }
};

TEST(DynamicsLoad, TakesBodiesFromTheUrdfAndTheRestFromTheRobot) {
  const Scene scene = MassiveFiles().load();
  ASSERT_TRUE(scene.plant.dynamics);
  const ArmDynamicsConfig& arm = *scene.plant.dynamics;
  ASSERT_EQ(arm.bodies.size(), 3u);
  EXPECT_EQ(arm.bodies[0].mass_kg, 2.0);
  EXPECT_LT((arm.bodies[0].p_JointCom - Vector3(0.1, 0, 0)).norm(), 1e-15);
  EXPECT_NEAR(arm.bodies[1].I_Com(2, 2), 0.04, 1e-15);
  // link3 and the gripper, which hangs on it by a fixed joint and one beside the chain.
  EXPECT_EQ(arm.bodies[2].mass_kg, 4.0);
  EXPECT_LT((arm.bodies[2].p_JointCom - Vector3(0.25, 0.05, 0)).norm(), 1e-15);
  EXPECT_EQ(arm.rotor_inertia[1], 0.5);
  EXPECT_EQ(arm.gear_stiffness[0], 1e5);
  EXPECT_EQ(arm.servo_bandwidth_hz, 30.0);
  EXPECT_EQ(scene.plant.robot_stiffness_N_per_m, 9000.0);
}

/// Slanted, so that its least moment is zero but for what the computation rounds.
TEST(DynamicsLoad, TakesAThinRod) {
  MassiveFiles files;
  constexpr const char* kRod =
      "ixx=\"0.001580772\" ixy=\"-0.000243196\" ixz=\"-0.000364794\" iyy=\"0.001215979\" "
      "iyz=\"-0.000729587\" izz=\"0.000607989\"";
  std::size_t at = 0;
  while ((at = files.urdf.find(kMoments)) != std::string::npos)
    files.urdf.replace(at, std::string(kMoments).size(), kRod);
  const Scene scene = files.load();
  ASSERT_TRUE(scene.plant.dynamics);
  EXPECT_EQ(scene.plant.dynamics->bodies[0].mass_kg, 2.0);
}

TEST(DynamicsLoad, IsAbsentUnlessTheSceneNamesIt) {
  MassiveFiles files;
  files.scene = test::kSceneText;
  EXPECT_FALSE(files.load().plant.dynamics);
  EXPECT_EQ(files.load().plant.robot_stiffness_N_per_m, 5000.0);
}

TEST(DynamicsLoad, RigidGearsHaveNoSpring) {
  const Scene scene = MassiveFiles().load({{"simulation.arm", "rigid_gears"}});
  EXPECT_TRUE(std::isinf(scene.plant.dynamics->gear_stiffness[2]));
  EXPECT_EQ(scene.plant.robot_stiffness_N_per_m, 5000.0);
}

struct Broken {
  const char *from, *to;
  std::vector<std::string> parts;
};

TEST(DynamicsLoad, EndsAsOneLine) {
  const auto expectParts = [](const std::string& error, const std::vector<std::string>& parts) {
    for (const std::string& part : parts)
      EXPECT_NE(error.find(part), std::string::npos) << part << " in " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  };
  for (const Broken& broken : std::vector<Broken>{
           {"dynamics:", "drives2:", {"robot.yaml:", "unknown key"}},
           {"  gear_stiffness: [1e5, 1e3, 1e3]\n",
            "",
            {"scene.yaml:", "simulation.arm: the robot has no gear_stiffness", "rigid_gears"}},
           {"[1e5, 1e3, 1e3]",
            "[1e5, 1e3]",
            {"robot.yaml:", "dynamics.gear_stiffness", "3 numbers"}},
           {"[1e5, 1e3, 1e3]",
            "[1e5, 1e3, 1e9]",
            {"dynamics.gear_stiffness: a gear rings with", "at most 500 Hz"}},
           {"[3, 0.5, 0.1]", "[3, -0.5, 0.1]", {"dynamics.rotor_inertia[1]: '-0.5'"}}}) {
    MassiveFiles files;
    files.robot = test::replaced(files.robot, broken.from, broken.to);
    expectParts(test::loadError(files.sources()), broken.parts);
  }
  for (const Broken& broken : std::vector<Broken>{
           {"value=\"2\"", "value=\"-2\"", {"robot.urdf:", "link.link1.inertial.mass.value"}},
           {"ixx=\"0.02\"", "ixx=\"1.02\"", {"robot.urdf:", "no body has these moments"}},
           {"ixx=\"0.02\" ", "", {"robot.urdf:", "inertia.ixx: is missing"}},
           {"iyy=\"0.03\" ", "", {"robot.urdf:", "inertia.iyy: is missing"}},
           {"ixx=\"0.02\"", "ixx=\"nan\"", {"robot.urdf:", "'nan' is no number"}}}) {
    MassiveFiles files;
    const std::size_t at = files.urdf.find(broken.from);
    files.urdf.replace(at, std::string(broken.from).size(), broken.to);
    expectParts(test::loadError(files.sources()), broken.parts);
  }
  MassiveFiles without;
  without.urdf = test::kUrdfText;
  expectParts(test::loadError(without.sources()),
              {"robot.yaml:", "dynamics: joint", "moves no mass", "<inertial>"});
  MassiveFiles nothing;
  nothing.robot = test::kRobotText;
  expectParts(test::loadError(nothing.sources()),
              {"scene.yaml:", "simulation.arm: the robot has no section dynamics"});
}

TEST(DriveEffectsLoad, AreAbsentUnlessTheSceneNamesThem) {
  const PlantConfig plant = MassiveFiles().load().plant;
  EXPECT_EQ(plant.drives.dead_time_s, 0.0);
  EXPECT_EQ(plant.drives.max_acceleration.size(), 0);
  EXPECT_FALSE(plant.drives.loop);
  EXPECT_FALSE(plant.drives.reports_links);
  EXPECT_EQ(plant.dynamics->max_torque.size(), 0);
  EXPECT_EQ(plant.dynamics->coulomb_friction.size(), 0);
  EXPECT_EQ(plant.dynamics->viscous_friction.size(), 0);
  EXPECT_EQ(plant.dynamics->backlash.size(), 0);
}

TEST(DriveEffectsLoad, GoWhereTheyActInThePlant) {
  const PlantConfig heavy =
      MassiveFiles()
          .load({{"simulation.drives",
                  "{dead_time_s: 0.004, max_acceleration: [1, 2, 3], max_torque: [10, 20, 30], "
                  "coulomb_friction: [4, 5, 6], viscous_friction: [7, 8, 9], "
                  "backlash: [0, 0.001, 0.002], feedback: link}"}})
          .plant;
  EXPECT_EQ(heavy.drives.dead_time_s, 0.004);
  EXPECT_EQ(heavy.drives.max_acceleration[1], 2.0);
  EXPECT_TRUE(heavy.drives.reports_links);
  EXPECT_EQ(heavy.dynamics->max_torque[0], 10.0);
  EXPECT_EQ(heavy.dynamics->coulomb_friction[2], 6.0);
  EXPECT_EQ(heavy.dynamics->viscous_friction[0], 7.0);
  EXPECT_EQ(heavy.dynamics->backlash[2], 0.002);
  EXPECT_FALSE(heavy.drives.loop);
  const auto loaded = [](const char* drives) {
    return test::SceneFiles{}.load({{"simulation.drives", drives}}).plant;
  };
  const PlantConfig line = loaded("{bandwidth_hz: 8}");
  ASSERT_TRUE(line.drives.loop);
  EXPECT_EQ(line.drives.loop->bandwidth_hz, 8.0);
  EXPECT_EQ(line.drives.loop->damping_ratio, 0.7);
  EXPECT_EQ(loaded("{bandwidth_hz: 8, damping_ratio: 0.4}").drives.loop->damping_ratio, 0.4);
}

TEST(DriveEffectsLoad, EndAsOneLineWhereTheArmCannotHaveThem) {
  struct Wrong {
    const char *arm, *drives, *at, *problem;
  };
  for (const Wrong& wrong : {
           Wrong{"quasi_static", "{bandwidth_hz: 501}", "bandwidth_hz: ", "501 Hz is too high"},
           Wrong{"quasi_static", "{bandwidth_hz: -1}", "bandwidth_hz: ", "out of range"},
           Wrong{"quasi_static", "{dead_time_s: 0.2}", "dead_time_s: ", "out of range"},
           Wrong{"quasi_static", "{damping_ratio: 0.5}", "damping_ratio: ", "damps nothing"},
           Wrong{"rigid_gears", "{bandwidth_hz: 8}", "bandwidth_hz: ", "servos of its own"},
           Wrong{"quasi_static", "{max_torque: [1, 1, 1]}", "max_torque: ", "no torques"},
           Wrong{"quasi_static", "{coulomb_friction: [1, 1, 1]}",
                 "coulomb_friction: ", "no torques"},
           Wrong{"quasi_static", "{viscous_friction: [1, 1, 1]}",
                 "viscous_friction: ", "no torques"},
           Wrong{"rigid_gears", "{backlash: [0, 0, 0]}", "backlash: ", "do not give way"},
           Wrong{"quasi_static", "{feedback: link}", "feedback: ", "do not give way"},
           Wrong{"rigid_gears", "{max_torque: [1, 1]}", "max_torque: ", "2"},
       }) {
    const std::string error =
        test::loadError(MassiveFiles().sources(),
                        {{"simulation.arm", wrong.arm}, {"simulation.drives", wrong.drives}});
    EXPECT_NE(error.find(std::string("simulation.drives.") + wrong.at), std::string::npos) << error;
    EXPECT_NE(error.find(wrong.problem), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST(DriveEffectsLoad, PlayNeedsAMotorWithMass) {
  MassiveFiles files;
  files.robot = test::replaced(files.robot, "[3, 0.5, 0.1]", "[3, 0, 0.1]");
  EXPECT_NO_THROW(files.load({{"simulation.drives", "{backlash: [0.001, 0, 0.001]}"}}));
  const std::string error =
      test::loadError(files.sources(), {{"simulation.drives", "{backlash: [0, 0.001, 0]}"}});
  EXPECT_NE(error.find("simulation.drives.backlash[1]: its motor has no mass"), std::string::npos)
      << error;
}

}  // namespace
}  // namespace tactus
