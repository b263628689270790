#include "tactus/scene/key_builders.h"

namespace tactus {
namespace {

using namespace keys;
using Draft = ConfigDraft;

Waypoint& waypoint(Draft& d) { return d.task.trajectory.waypoints.back(); }
void addWaypoint(Draft& d) { d.task.trajectory.waypoints.emplace_back(); }

std::vector<KeySpec> lineKeys() {
  return {
      defaulted("[0, 0, 0]",
                vector3("displacement_m", "m", within(-100, 100),
                        "target position relative to the start, base frame",
                        [](Draft& d) -> Vector3& { return waypoint(d).displacement_m; })),
      defaulted("[0, 0, 0]",
                vector3("rotation_vector_rad", "rad", within(-4, 4),
                        "target orientation relative to the start: axis times angle, base frame",
                        [](Draft& d) -> Vector3& { return waypoint(d).rotation_vector_rad; })),
      defaulted("0.1", number("speed_m_per_s", "m/s", above(0, 10), "cruise speed of the position",
                              [](Draft& d) -> double& { return waypoint(d).speed_m_per_s; })),
      defaulted("0.5",
                number("angular_speed_rad_per_s", "rad/s", above(0, 10),
                       "largest speed of the orientation",
                       [](Draft& d) -> double& { return waypoint(d).angular_speed_rad_per_s; })),
      defaulted("0.5", number("ramp_s", "s", above(0, 1000),
                              "length of the sin^2 speed ramps at both ends",
                              [](Draft& d) -> double& { return waypoint(d).ramp_s; })),
  };
}

std::vector<KeySpec> waypointKeys() {
  std::vector<KeySpec> rows = lineKeys();
  rows.push_back(defaulted("0", number("pause_s", "s", within(0, kMaxTime_s), "rest after arrival",
                                       [](Draft& d) -> double& { return waypoint(d).pause_s; })));
  return rows;
}

KeySpec taskSection() {
  KeySpec components = value(ValueType::kChoiceList, "components", "",
                             "what the task controls of the tool, base frame",
                             [](Draft& d) -> std::vector<std::string>& { return d.components; });
  components.choices = componentNames();
  components.count = {1, kMaxTaskSize};
  return section(
      "task", "what the tool shall do",
      {
          defaulted("[x, y, z]", components),
          defaulted("5", number("drift_gain_per_s", "1/s", within(0, 1e4),
                                "beta of (2): pulls the tool back to its reference",
                                [](Draft& d) -> double& { return d.gains.task.drift_gain_per_s; })),
          optional(
              number("max_return_speed_m_per_s", "m/s", above(0, 10),
                     "largest speed at which beta pulls the position back, as after a contact; "
                     "absent: beta times its error",
                     [](Draft& d) -> double& { return d.gains.task.max_return_speed_m_per_s; })),
          optional(
              number("max_return_speed_rad_per_s", "rad/s", above(0, 10),
                     "largest speed at which beta pulls the orientation back; absent: beta "
                     "times its error",
                     [](Draft& d) -> double& { return d.gains.task.max_return_speed_rad_per_s; })),
          optional(number(
              "wait_beyond_m", "m", above(0, 10),
              "lag of the tool's position beyond which the reference goes on slower; beyond twice "
              "that it stands still until the tool has caught up; absent: it never waits",
              [](Draft& d) -> double& { return d.gains.task.wait_beyond_m; })),
          section("trajectory", "the reference w_d; exactly one of line, waypoints, hold",
                  {
                      defaulted("0", number("start_s", "s", within(0, kMaxTime_s),
                                            "rest before the first motion",
                                            [](Draft& d) -> double& {
                                              return d.task.trajectory.start_s;
                                            })),
                      optional(section("line", "one straight motion", lineKeys(), addWaypoint)),
                      optional(sectionList("waypoints", {1, 1000},
                                           "straight motions with a stop at every corner",
                                           waypointKeys(), addWaypoint)),
                      optional(section("hold", "stay at the start pose", {})),
                  }),
      });
}

KeySpec redundancySection() {
  return section(
      "redundancy", "how the joints share a motion",
      {
          optional(oneAJoint("weights", "", within(1e-6, 1e6),
                             "diagonal of W in (1): a heavy joint moves less; absent: all 1",
                             [](Draft& d) -> std::vector<double>& { return d.weights; })),
          optional(section(
              "joint_limit_avoidance", "dH/dq of (1): keeps the joints off their limits",
              {
                  defaulted("1", number("gain", "", within(0, 1000), "alpha of (1)",
                                        [](Draft& d) -> double& {
                                          return d.gains.joint_limit_avoidance.gain;
                                        })),
                  defaulted("3.52", number("gradient_at_limit", "m/s or rad/s", above(0, 1000),
                                           "dH/dq of a joint on its limit",
                                           [](Draft& d) -> double& {
                                             return d.gains.joint_limit_avoidance.gradient_at_limit;
                                           })),
                  defaulted("0.507",
                            number("active_fraction", "", above(0, 1),
                                   "outer part of the half range in which the gradient rises",
                                   [](Draft& d) -> double& {
                                     return d.gains.joint_limit_avoidance.active_fraction;
                                   })),
              },
              [](Draft& d) { d.has_joint_limit_avoidance = true; })),
      });
}

KeySpec transitionSection() {
  return section(
      "transition", "how feedforward and integral fade when contact is lost",
      {
          defaulted("1", number("max_time_constant_s", "s", above(0, 100),
                                "T_t,max: time constant of the fade right after the loss",
                                [](Draft& d) -> double& {
                                  return d.gains.force.transition.max_time_constant_s;
                                })),
          defaulted("0.05", number("distance_m", "m", above(0, 10),
                                   "d_t: distance from the lost contact at which all is faded",
                                   [](Draft& d) -> double& {
                                     return d.gains.force.transition.distance_m;
                                   })),
          defaulted("0", number("engage_force_N", "N", within(0, 1000),
                                "force range over which the feedforward engages; 0: at once",
                                [](Draft& d) -> double& {
                                  return d.gains.force.transition.engage_force_N;
                                })),
          defaulted(
              "0.3",
              number("release_force_N", "N", above(0, 1000),
                     "F_rel: reading below which joint_space has lost contact, and above "
                     "which an arm that goes on after a stop is in contact",
                     [](Draft& d) -> double& { return d.gains.force.transition.release_force_N; })),
          defaulted("0.01", number("search_speed_m_per_s", "m/s", within(0, 10),
                                   "v_search, joint_space only: speed of the return to a lost "
                                   "contact",
                                   [](Draft& d) -> double& {
                                     return d.gains.force.transition.search_speed_m_per_s;
                                   })),
      });
}

KeySpec controllerSection() {
  KeySpec variant =
      value(ValueType::kChoice, "variant", "",
            "what gives way to contact: null_space the null space, the tool keeps its task; "
            "joint_space all joints; task_space the tool alone; null_task, "
            "null_joint the null space, and above activation_force_N the tool or "
            "all joints; null_limit the null space, and the tool as far as the force "
            "would else pass activation_force_N; none nothing, it is only measured",
            [](Draft& d) -> std::string& { return d.variant; });
  variant.choices = variantNames();
  return section(
      "controller", "force control; absent: the tactile module is not even read",
      {
          variant,
          defaulted("2", integer("order", within(1, 2), "order of the target dynamics (4)",
                                 [](Draft& d) -> int& { return d.force.order; })),
          defaulted("0.1",
                    number("time_constant_s", "s", within(0.001, 100),
                           "T of the target dynamics (4): smaller is faster, less stable",
                           [](Draft& d) -> double& { return d.gains.force.time_constant_s; })),
          defaulted("0.5", number("damping", "", above(0, 10), "d of (4), second order only",
                                  [](Draft& d) -> double& { return d.gains.force.damping; })),
          defaulted("1.2",
                    number("contact_threshold_N", "N", within(0, 1000),
                           "F_th: a smaller reading is no contact",
                           [](Draft& d) -> double& { return d.gains.force.contact_threshold_N; })),
          optional(number("activation_force_N", "N", above(0, 1000),
                          "F_act: contact force from which null_task, null_joint and null_limit "
                          "leave the null space",
                          [](Draft& d) -> double& { return d.gains.force.activation_force_N; })),
          defaulted("5", number("max_null_speed_m_per_s", "m/s", above(0, 1000),
                                "limit of the null-space reaction of a prismatic joint",
                                [](Draft& d) -> double& {
                                  return d.gains.force.max_null_speed_m_per_s;
                                })),
          defaulted("5", number("max_null_speed_rad_per_s", "rad/s", above(0, 1000),
                                "limit of the null-space reaction of a revolute joint",
                                [](Draft& d) -> double& {
                                  return d.gains.force.max_null_speed_rad_per_s;
                                })),
          defaulted("500",
                    number("pull_gain_per_s", "1/s", within(0, 1e4),
                           "beta of joint_space in contact; drift_gain_per_s holds "
                           "elsewhere",
                           [](Draft& d) -> double& { return d.gains.force.pull_gain_per_s; })),
          defaulted("300",
                    number("min_approach_stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                           "c_floor, null_limit only: softer contact is approached no faster "
                           "than this, for what may be behind it",
                           [](Draft& d) -> double& {
                             return d.gains.force.min_approach_stiffness_N_per_m;
                           })),
          defaulted("", transitionSection()),
      });
}

KeySpec stiffnessSection() {
  return section(
      "stiffness", "what the law believes about the obstacle's stiffness",
      {
          number("assumed_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                 "c_0: where the estimate starts, or stays without one",
                 [](Draft& d) -> double& { return d.gains.force.assumed_stiffness_N_per_m; }),
          optional(number("stiffest_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                          "stiffest contact, obstacle and arm in series, for which the gains must "
                          "be stable; absent: as stiff as assumed",
                          [](Draft& d) -> double& { return d.stiffest_N_per_m; })),
          optional(section(
              "estimate", "Algorithm 1, or with null_limit an estimator of its own; absent: none",
              {
                  defaulted("0.2", number("min_force_change_N", "N", above(0, 1000),
                                          "F_est,min: change of force that makes an estimate",
                                          [](Draft& d) -> double& {
                                            return d.gains.force.estimator.min_force_change_N;
                                          })),
                  defaulted("0.03", number("filter_time_constant_s", "s", above(0, 100),
                                           "T_est: smoothing of the estimate",
                                           [](Draft& d) -> double& {
                                             return d.gains.force.estimator.filter_time_constant_s;
                                           })),
                  defaulted("10", number("min_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                                         "smallest raw estimate",
                                         [](Draft& d) -> double& {
                                           return d.gains.force.estimator.min_N_per_m;
                                         })),
                  defaulted("1e6", number("max_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                                          "largest raw estimate",
                                          [](Draft& d) -> double& {
                                            return d.gains.force.estimator.max_N_per_m;
                                          })),
              },
              [](Draft& d) { d.force.has_estimator = true; })),
      });
}

KeySpec requirementSection() {
  return section(
      "real_time", "what this scene asks of the machine that runs it on hardware",
      {defaulted("true", boolean("required", "false: run even where real time is not granted",
                                 [](Draft& d) -> bool& { return d.real_time.required; }))});
}

KeySpec logSection() {
  return section(
      "log", "how much of a disk the log of tactusd may take; the arm never stops for it",
      {
          optional(number("max_bytes", "bytes", within(1e6, 1e15),
                          "a run.ulg that would grow larger becomes run.1.ulg, what was that "
                          "run.2.ulg and so on, and a new one is begun; absent: no limit",
                          [](Draft& d) -> double& { return d.log.max_bytes; })),
          defaulted("4", integer("keep", within(0, kMaxKeptLogs),
                                 "how many older files stay besides run.ulg",
                                 [](Draft& d) -> int& { return d.log.keep; })),
          defaulted("1e8", number("min_free_bytes", "bytes", within(0, 1e15),
                                  "the log stops when less of its disk is free; 0: when all of it "
                                  "is full",
                                  [](Draft& d) -> double& { return d.log.min_free_bytes; })),
      });
}

}  // namespace

const std::vector<std::string>& variantNames() {
  static const std::vector<std::string> names = {
      "none", "null_space", "joint_space", "task_space", "null_task", "null_joint", "null_limit"};
  return names;
}

const std::vector<std::string>& componentNames() {
  static const std::vector<std::string> names = {"x", "y", "z", "rx", "ry", "rz"};
  return names;
}

const std::vector<KeySpec>& sceneKeys() {
  static const std::vector<KeySpec> table = {
      optional(text("extends", "scene that this one changes, relative to this file",
                    [](Draft& d) -> std::string& { return d.extends; })),
      text("robot", "robot description, relative to the file that names it",
           [](Draft& d) -> std::string& { return d.robot; }),
      defaulted("0.001", number("period_s", "s", within(1e-5, 0.02), "of the control cycle",
                                [](Draft& d) -> double& { return d.period_s; })),
      optional(oneAJoint("start", "m or rad", within(-1e6, 1e6),
                         "joint positions at the start; absent: the robot's home",
                         [](Draft& d) -> std::vector<double>& { return d.start; })),
      taskSection(),
      optional(redundancySection()),
      optional(controllerSection()),
      optional(stiffnessSection()),
      simulationSection(),
      defaulted("", requirementSection()),
      defaulted("", logSection()),
  };
  return table;
}

}  // namespace tactus
