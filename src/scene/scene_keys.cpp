#include "tactus/scene/clearance_keys.h"
#include "tactus/scene/key_builders.h"
#include "tactus/scene/key_defaults.h"
#include "tactus/scene/scene_config.h"
#include "tactus/scene/simulation_keys.h"
#include "tactus/scene/task_keys.h"

namespace tactus {
namespace {

using namespace keys;

Table<JointLimitAvoidanceGains> avoidanceKeys() {
  using Config = JointLimitAvoidanceGains;
  return {
      withSymbol("alpha", number("gain", "", within(0, 1000),
                                 "how strongly the null space keeps joints off their limits: "
                                 "factor of dH/dq in (1)",
                                 &Config::gain)),
      number("gradient_at_limit", "m/s or rad/s", above(0, 1000),
             "how fast a joint on its limit is driven back: its dH/dq", &Config::gradient_at_limit),
      number("active_fraction", "", above(0, 1),
             "outer part of the half range in which the gradient rises", &Config::active_fraction),
  };
}

Row<SceneConfig> postureSection() {
  using Gain = PostureGains;
  return optional(group<SceneConfig>(
      "posture", "leads the joints to a posture through the null space; absent: nothing does",
      join(inside(&SceneConfig::posture, Table<PostureSection>{optional(oneAJoint(
                                             "positions", "m or rad", within(-1e6, 1e6),
                                             "of the joints there; absent: the robot's home",
                                             &PostureSection::positions))}),
           inside(&SceneConfig::gains,
                  inside(&Gains::posture,
                         live(Table<Gain>{
                             withSymbol("k", number("gain_per_s", "1/s", within(0, 10),
                                                    "how fast joints go there, for what they are "
                                                    "away; 0: not at all",
                                                    &Gain::gain_per_s)),
                             number("max_speed_share", "", within(0.001, 1),
                                    "of the largest velocity of each joint, no faster",
                                    &Gain::max_speed_share),
                         })))),
      [](SceneConfig& scene) { scene.posture.emplace(); }));
}

Row<SceneConfig> redundancySection() {
  return optional(group<SceneConfig>(
      "redundancy", "how the joints share a motion",
      {
          withSymbol("W", oneAJoint("weights", "", within(1e-6, 1e6),
                                    "a joint with a larger one moves less: diagonal of W in (1), "
                                    "divided by their median, as a common factor says nothing; "
                                    "absent: all 1",
                                    &SceneConfig::weights)),
          optional(group<SceneConfig>(
              "joint_limit_avoidance",
              "keeps the joints off their limits, by dH/dq of (1); absent: nothing does",
              inside(&SceneConfig::gains,
                     inside(&Gains::joint_limit_avoidance, live(avoidanceKeys()))),
              [](SceneConfig& scene) { scene.has_joint_limit_avoidance = true; })),
          postureSection(),
      }));
}

Table<ContactTransitionGains> transitionKeys() {
  using Config = ContactTransitionGains;
  Table<Config> rows = {
      withSymbol("T_t,max", number("max_time_constant_s", "s", above(0, 100),
                                   "time constant of the fade right after the loss",
                                   &Config::max_time_constant_s)),
      withSymbol("d_t", number("distance_m", "m", above(0, 10),
                               "distance from the lost contact at which all is faded",
                               &Config::distance_m)),
      withSymbol("F_eng", number("engage_force_N", "N", within(0, 1000),
                                 "force range over which the feedforward engages; 0: at once",
                                 &Config::engage_force_N)),
      withSymbol("F_rel", number("release_force_N", "N", above(0, 1000),
                                 "reading below which joint_space and null_limit have lost "
                                 "contact, and above which an arm that goes on after a stop is "
                                 "in contact",
                                 &Config::release_force_N)),
      withSymbol("v_search", number("search_speed_m_per_s", "m/s", within(0, 10),
                                    "speed of the return to a lost contact, joint_space only",
                                    &Config::search_speed_m_per_s)),
  };
  for (Row<Config>& row : rows) row = whenFree(row);
  return rows;
}

Row<ForceControlConfig> variantRow() {
  return required(
      choice("variant",
             "what gives way to contact: null_space the null space, the tool keeps its task; "
             "joint_space all joints; task_space the tool alone; null_task, "
             "null_joint the null space, and above activation_force_N the tool or "
             "all joints; null_limit the null space, and the tool as far as the force "
             "would else pass activation_force_N; none nothing, it is only measured",
             &ForceControlConfig::variant, kVariantWords));
}

Row<ForceControlConfig> levelRow() {
  return choice("level",
                "what the answer to contact is computed as: velocity, as in the paper; or "
                "acceleration, smoother, for null_space, null_task and null_limit of second order",
                &ForceControlConfig::level, kLevelWords);
}

Row<ForceControlConfig> orderRow() {
  return integer("order", within(1, 2),
                 "of the motion that a force is answered with, the target dynamics (4)",
                 &ForceControlConfig::order);
}

Row<ForceControlConfig> frictionRow() {
  return withSymbol("mu_max",
                    number("friction_coefficient", "", within(0, 1),
                           "what null_limit shall bear, at the price of more give: more than there "
                           "is, 0.5 for contacts of 0.3, 0.7 with flexible gears; 0 stands for no "
                           "friction",
                           &ForceControlConfig::friction_coefficient));
}

Row<ForceControlConfig> limitAtRow() {
  return choice(
      "limit_at",
      "where on a tactile module null_limit limits the approach, as two contacts may press "
      "on one: resultant where their sum acts; stiffness_centre there, and where changes "
      "of it act; module_ends at both ends, which bounds all contacts on one side, at the "
      "price of more give; auto stiffness_centre on robots with several modules, and "
      "else resultant",
      &ForceControlConfig::limit_at, kLimitAtWords);
}

Table<ForceGains> responseKeys() {
  using Config = ForceGains;
  return {
      withSymbol("T", number("time_constant_s", "s", within(0.001, 100),
                             "how fast the force is brought to zero: smaller is faster, less "
                             "stable; time constant of the target dynamics (4)",
                             &Config::time_constant_s)),
      withSymbol("d", number("damping", "", above(0, 10),
                             "how little the force overshoots: damping of the target dynamics (4), "
                             "second order only",
                             &Config::damping)),
      whenFree(withSymbol("F_th",
                          number("contact_threshold_N", "N", within(0, 1000),
                                 "a smaller reading is no contact", &Config::contact_threshold_N))),
      optional(withSymbol("F_act",
                          number("activation_force_N", "N", above(0, 1000),
                                 "contact force from which null_task, null_joint and null_limit "
                                 "leave the null space",
                                 &Config::activation_force_N))),
  };
}

Table<ForceGains> responseLimitKeys() {
  using Config = ForceGains;
  return {
      number("max_null_speed_m_per_s", "m/s", above(0, 1000),
             "limit of the null-space reaction of a prismatic joint",
             &Config::max_null_speed_m_per_s),
      number("max_null_speed_rad_per_s", "rad/s", above(0, 1000),
             "limit of the null-space reaction of a revolute joint",
             &Config::max_null_speed_rad_per_s),
      whenFree(
          withSymbol("beta", number("pull_gain_per_s", "1/s", within(0, 1e4),
                                    "how fast joint_space pulls the tool back while in contact; "
                                    "drift_gain_per_s holds elsewhere",
                                    &Config::pull_gain_per_s))),
      withSymbol("c_floor",
                 number("min_approach_stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                        "null_limit only: softer contact is approached no faster "
                        "than this, for what may be behind it",
                        &Config::min_approach_stiffness_N_per_m)),
      withSymbol("k_v", number("velocity_gain_per_s", "1/s", above(0, 1e4),
                               "acceleration level only: how fast velocities go to those of the "
                               "velocity level where no target dynamics decides; smaller is "
                               "smoother, and peaks higher",
                               &Config::velocity_gain_per_s)),
      section("transition", "how feedforward and integral fade when contact is lost",
              &Config::transition, transitionKeys()),
  };
}

Row<SceneConfig> controllerSection() {
  const Table<ForceGains> gains = live(join(responseKeys(), responseLimitKeys()));
  return optional(group<SceneConfig>(
      "controller", "force control; absent: no tactile module is even read",
      join(inside(&SceneConfig::controller,
                  {variantRow(), levelRow(), orderRow(), frictionRow(), limitAtRow()}),
           inside(&SceneConfig::gains, inside(&Gains::force, gains))),
      [](SceneConfig& scene) { scene.controller.emplace(); }));
}

Table<StiffnessEstimatorGains> estimateKeys() {
  using Config = StiffnessEstimatorGains;
  return {
      whenFree(withSymbol("F_est,min", number("min_force_change_N", "N", above(0, 1000),
                                              "change of force that makes an estimate",
                                              &Config::min_force_change_N))),
      withSymbol("T_est", number("filter_time_constant_s", "s", above(0, 100),
                                 "smoothing of the estimate", &Config::filter_time_constant_s)),
      number("min_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m), "smallest raw estimate",
             &Config::min_N_per_m),
      number("max_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m), "largest raw estimate",
             &Config::max_N_per_m),
  };
}

Row<ForceGains> assumedRow() {
  return withSymbol("c_0",
                    required(number("assumed_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                                    "stiffness of the contact that the law reckons with: "
                                    "where the estimate starts, or stays without one",
                                    &ForceGains::assumed_stiffness_N_per_m)));
}

Row<StiffnessSection> stiffestRow() {
  return withSymbol("c_e", number("stiffest_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                                  "stiffest contact, obstacle and arm in series, for which the "
                                  "gains must be stable; absent: as stiff as assumed",
                                  &StiffnessSection::stiffest_N_per_m));
}

Row<SceneConfig> stiffnessSection() {
  const auto force = [](Table<ForceGains> rows) {
    return inside(&SceneConfig::gains, inside(&Gains::force, std::move(rows)));
  };
  const Table<SceneConfig> estimate = {optional(group<SceneConfig>(
      "estimate",
      "estimates the stiffness while in contact, by Algorithm 1 or with null_limit by an "
      "estimator of its own; absent: it stays as assumed",
      force(inside(&ForceGains::estimator, live(estimateKeys()))),
      [](SceneConfig& scene) { scene.stiffness->has_estimate = true; }))};
  return optional(
      group<SceneConfig>("stiffness", "what the law believes about the obstacle's stiffness",
                         join(force(live(Table<ForceGains>{assumedRow()})),
                              inside(&SceneConfig::stiffness, {stiffestRow()}), estimate),
                         [](SceneConfig& scene) { scene.stiffness.emplace(); }));
}

Table<LogConfig> logKeys() {
  return {
      optional(number("max_bytes", "bytes", within(1e6, 1e15),
                      "a run.ulg that would grow larger becomes run.1.ulg, what was that "
                      "run.2.ulg and so on, and a new one is begun; absent: no limit",
                      &LogConfig::max_bytes)),
      integer("keep", within(0, kMaxKeptLogs), "how many older files stay besides run.ulg",
              &LogConfig::keep),
      number("min_free_bytes", "bytes", within(0, 1e15),
             "the log stops when less of its disk is free; 0: when all of it is full",
             &LogConfig::min_free_bytes),
  };
}

Table<SceneConfig> sceneTable() {
  using Config = SceneConfig;
  return {
      text("extends", "scene that this one changes, relative to this file", &Config::extends),
      text("robot", "robot description, relative to the file that names it", &Config::robot),
      number("period_s", "s", within(1e-5, 0.02), "of the control cycle", &Config::period_s),
      oneAJoint("start", "m or rad", within(-1e6, 1e6),
                "joint positions at the start; absent: the robot's home", &Config::start),
      taskSection(),
      redundancySection(),
      controllerSection(),
      stiffnessSection(),
      clearanceSection(),
      simulationSection(),
      group<Config>("real_time", "what this scene asks of the machine that runs it on hardware",
                    {boolean("required", "false: run even where real time is not granted",
                             &Config::requires_real_time)}),
      section("log", "how much of a disk the log of tactusd may take; the arm never stops for it",
              &Config::log, logKeys()),
  };
}

}  // namespace

const std::vector<KeySpec>& sceneKeys() {
  static const std::vector<KeySpec> keys = [] {
    std::vector<KeySpec> rows = specsOf(sceneTable());
    SceneConfig config;
    addDefaults(rows, &config);
    return rows;
  }();
  return keys;
}

}  // namespace tactus
