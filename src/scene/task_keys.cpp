#include "tactus/scene/task_keys.h"

namespace tactus {
namespace {

using namespace keys;

Row<TaskConfig> componentsRow() {
  Row<TaskConfig> row;
  row.spec.key = "components";
  row.spec.type = ValueType::kChoiceList;
  row.spec.presence = Presence::kDefaulted;
  row.spec.doc =
      "what the task controls of the tool, base frame; with a part of rx, ry and rz the tool is "
      "free "
      "to turn about the rest";
  row.spec.count = {1, kMaxTaskSize};
  for (const Word<int>& word : kComponentWords) row.spec.choices.push_back(word.text);
  row.spec.target = [](void* owner) -> Target {
    TaskConfig& task = *static_cast<TaskConfig*>(owner);
    return WordsTarget{[&task](const std::vector<std::string>& words) {
                         task.size = static_cast<int>(words.size());
                         for (int i = 0; i < task.size; ++i) {
                           task.components[i] = valueOf(kComponentWords, words[i]);
                         }
                       },
                       [&task] {
                         std::vector<std::string> words;
                         for (int i = 0; i < task.size; ++i) {
                           words.push_back(wordOf(kComponentWords, task.components[i]));
                         }
                         return words;
                       }};
  };
  return row;
}

Table<TaskGains> correctionKeys() {
  using Config = TaskGains;
  return {
      withSymbol("beta", number("drift_gain_per_s", "1/s", within(0, 1e4),
                                "how fast the tool is pulled back to its reference: its error "
                                "times this is a speed, as in (2)",
                                &Config::drift_gain_per_s)),
      optional(number(
          "max_return_speed_m_per_s", "m/s", above(0, 10),
          "largest speed at which drift_gain_per_s pulls the position back, as after a contact; "
          "absent: as much as the gain makes of the error",
          &Config::max_return_speed_m_per_s)),
      optional(number(
          "max_return_speed_rad_per_s", "rad/s", above(0, 10),
          "largest speed at which drift_gain_per_s pulls the orientation back; absent: as much "
          "as the gain makes of the error",
          &Config::max_return_speed_rad_per_s)),
      optional(number(
          "wait_beyond_m", "m", above(0, 10),
          "lag of the tool's position beyond which the reference goes on slower; beyond twice "
          "that it stands still until the tool has caught up; absent: it never waits",
          &Config::wait_beyond_m)),
      optional(number(
          "wait_beyond_rad", "rad", above(0, 1),
          "the same for the lag of the tool's orientation; the reference waits for the one that "
          "lags more of its own",
          &Config::wait_beyond_rad)),
  };
}

Table<Waypoint> lineKeys() {
  return {
      vector3("displacement_m", "m", within(-100, 100),
              "target position relative to the start, base frame", &Waypoint::displacement_m),
      vector3("rotation_vector_rad", "rad", within(-4, 4),
              "target orientation relative to the start: axis times angle, base frame",
              &Waypoint::rotation_vector_rad),
      number("speed_m_per_s", "m/s", above(0, 10), "cruise speed of the position",
             &Waypoint::speed_m_per_s),
      number("angular_speed_rad_per_s", "rad/s", above(0, 10), "largest speed of the orientation",
             &Waypoint::angular_speed_rad_per_s),
      number("ramp_s", "s", above(0, 1000), "length of the sin^2 speed ramps at both ends",
             &Waypoint::ramp_s),
  };
}

Table<Waypoint> waypointKeys() {
  return join(lineKeys(), Table<Waypoint>{number("pause_s", "s", within(0, kMaxTime_s),
                                                 "rest after arrival", &Waypoint::pause_s)});
}

Table<TrajectorySection> trajectoryKeys() {
  using Config = TrajectorySection;
  return {
      number("start_s", "s", within(0, kMaxTime_s), "rest before the first motion",
             &Config::start_s),
      section("line", "one straight motion", &Config::line, lineKeys()),
      sectionList("waypoints", {1, 1000}, "straight motions with a stop at every corner",
                  &Config::waypoints, waypointKeys()),
      section("hold", "stay at the start pose", &Config::hold, {}),
  };
}

Table<MotionLimits> motionLimitKeys(const std::string& unit, const std::string& of) {
  using Config = MotionLimits;
  return {
      number("max_speed_" + unit + "_per_s", unit + "/s", above(0, 10), "largest speed " + of,
             &Config::max_speed),
      number("max_acceleration_" + unit + "_per_s2", unit + "/s^2", above(0, 1000),
             "largest acceleration " + of, &Config::max_acceleration),
      number("max_jerk_" + unit + "_per_s3", unit + "/s^3", above(0, 1e5), "largest jerk " + of,
             &Config::max_jerk),
  };
}

Table<TaskCommandsConfig> commandKeys() {
  using Config = TaskCommandsConfig;
  return join(inside(&Config::limits,
                     join(inside(&ToolMotionLimits::position,
                                 motionLimitKeys("m", "of the reference's position")),
                          inside(&ToolMotionLimits::rotation,
                                 motionLimitKeys("rad", "of the reference's orientation")))),
              Table<Config>{
                  number("arrival_m", "m", above(0, 1), "so close to its target a tool has arrived",
                         &Config::arrival_m),
                  number("arrival_rad", "rad", above(0, 1), "and so close in orientation",
                         &Config::arrival_rad),
                  number("give_up_after_s", "s", above(0, kMaxTime_s),
                         "a tool that is held off its way for this long rests where it is",
                         &Config::give_up_after_s),
                  number("stream_timeout_s", "s", above(0, 60),
                         "a stream's tool stops unless the next target comes within this",
                         &Config::stream_timeout_s),
                  boolean("start_measured",
                          "tactusd begins where it finds the arm, in place of start, and checks "
                          "the scene there; encoders have to know where they are, and gpio.enable "
                          "has to be switched off and on",
                          &Config::start_measured),
              });
}

}  // namespace

Row<SceneConfig> taskSection() {
  const Table<SceneConfig> source = {
      choice("source",
             "where the reference comes from: trajectory this file; commands the tool holds until "
             "it is told, as by tactus move",
             &SceneConfig::source, kTaskSourceWords)};
  const Table<SceneConfig> trajectory = {withSymbol(
      "w_d", optional(section("trajectory",
                              "where the tool shall be when; exactly one of line, waypoints, hold",
                              &SceneConfig::trajectory, trajectoryKeys())))};
  const Table<TaskConfig> commands = {
      optional(section("commands", "in place of trajectory, of source: commands",
                       &TaskConfig::commands, commandKeys()))};
  return required(
      group("task", "what the tool shall do",
            join(inside(&SceneConfig::task, {componentsRow()}),
                 inside(&SceneConfig::gains, inside(&Gains::task, live(correctionKeys()))), source,
                 trajectory, inside(&SceneConfig::task, commands))));
}

}  // namespace tactus
