#include "tactus/scene/key_builders.h"

namespace tactus {
namespace {

using namespace keys;
using Draft = ConfigDraft;

ObstacleConfig& obstacle(Draft& d) { return d.plant.obstacles.back(); }
FoamLayer& foamLayer(Draft& d) { return obstacle(d).foam.back(); }
TroubleDraft& trouble(Draft& d) { return d.troubles.back(); }

std::vector<KeySpec> obstacleKeys() {
  return {
      number("x_m", "m", within(-100, 100), "place of the vertical line, base frame",
             [](Draft& d) -> double& { return obstacle(d).x_m; }),
      number("y_m", "m", within(-100, 100), "place of the vertical line, base frame",
             [](Draft& d) -> double& { return obstacle(d).y_m; }),
      number("stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m), "of the solid part",
             [](Draft& d) -> double& { return obstacle(d).stiffness_N_per_m; }),
      optional(sectionList(
          "foam", {0, 16}, "layers before the solid part, outermost first",
          {
              number("stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m), "of the layer",
                     [](Draft& d) -> double& { return foamLayer(d).stiffness_N_per_m; }),
              number("until_force_N", "N", above(0, 1e5), "force at which the layer is compressed",
                     [](Draft& d) -> double& { return foamLayer(d).until_force_N; }),
          },
          [](Draft& d) { obstacle(d).foam.emplace_back(); })),
      defaulted("0", number("appears_s", "s", within(0, kMaxTime_s), "absent before",
                            [](Draft& d) -> double& { return obstacle(d).appears_s; })),
      optional(number("vanishes_s", "s", above(0, kMaxTime_s), "absent from then on",
                      [](Draft& d) -> double& { return obstacle(d).vanishes_s; })),
      optional(section(
          "swing", "motion to and fro around the place, along a sine",
          {
              defaulted("0", number("x_m", "m", within(-100, 100), "amplitude",
                                    [](Draft& d) -> double& { return obstacle(d).swing.x_m; })),
              defaulted("0", number("y_m", "m", within(-100, 100), "amplitude",
                                    [](Draft& d) -> double& { return obstacle(d).swing.y_m; })),
              number("frequency_hz", "Hz", above(0, 1000), "of the sine",
                     [](Draft& d) -> double& { return obstacle(d).swing.frequency_hz; }),
          })),
  };
}

std::vector<KeySpec> troubleKeys() {
  KeySpec kind = value(
      ValueType::kChoice, "kind", "",
      "what happens. To frames: drop, delay, reorder, corrupt, duplicate. To a bus: bus_off, "
      "power_cut. To a drive: drive_fault; ignore_commands, it obeys neither control words nor "
      "setpoints and keeps its last velocity; freeze_feedback, it sends the status and "
      "position of the beginning; nonsense_status, its status word is not in CiA 402; boot_up, "
      "it sends one boot-up message and runs on; heartbeat_only, neither missing SYNC nor "
      "missing setpoints stop it. To the line: emergency_stop",
      [](Draft& d) -> std::string& { return trouble(d).kind; });
  kind.choices = troubleNames();
  return {
      kind,
      number("from_s", "s", within(0, kMaxTime_s), "since the first drive was enabled",
             [](Draft& d) -> double& { return trouble(d).trouble.from_s; }),
      number("until_s", "s", within(0, kMaxTime_s), "end of the trouble",
             [](Draft& d) -> double& { return trouble(d).trouble.until_s; }),
      optional(text("interface", "bus of the robot that it happens to; none with emergency_stop",
                    [](Draft& d) -> std::string& { return trouble(d).interface; })),
      optional(integer("id", within(0, 0x7FF),
                       "of the frames, or node id of the drive; absent or 0: all of the bus",
                       [](Draft& d) -> int& { return trouble(d).id; })),
      optional(number("delay_s", "s", above(0, 10), "how late frames come, with delay only",
                      [](Draft& d) -> double& { return trouble(d).trouble.delay_s; })),
  };
}

}  // namespace

const std::vector<std::string>& troubleNames() {
  static const std::vector<std::string> names = {"drop",
                                                 "delay",
                                                 "reorder",
                                                 "corrupt",
                                                 "duplicate",
                                                 "bus_off",
                                                 "power_cut",
                                                 "drive_fault",
                                                 "ignore_commands",
                                                 "freeze_feedback",
                                                 "nonsense_status",
                                                 "boot_up",
                                                 "heartbeat_only",
                                                 "emergency_stop"};
  return names;
}

KeySpec simulationSection() {
  return section(
      "simulation", "the world that the robot meets",
      {
          number("duration_s", "s", above(0, kMaxTime_s),
                 "length of a simulated run; tactusd goes on until it is stopped",
                 [](Draft& d) -> double& { return d.duration_s; }),
          optional(number("drive_lag_s", "s", within(0, 1),
                          "lag of the simulated drives; absent: as robot.yaml says",
                          [](Draft& d) -> double& { return d.simulated_drive_lag_s; })),
          defaulted(
              "", section("tactile_module", "imperfections of the simulated tactile module",
                          {
                              optional(number("filter_cutoff_hz", "Hz", within(0.1, 1e5),
                                              "of its filter; absent: as robot.yaml says",
                                              [](Draft& d) -> double& {
                                                return d.simulated_filter_cutoff_hz;
                                              })),
                              defaulted("true", boolean("quantised", "24-bit channels",
                                                        [](Draft& d) -> bool& {
                                                          return d.plant.module.quantised;
                                                        })),
                              defaulted("0", number("noise_N", "N", within(0, 100),
                                                    "standard deviation of one channel",
                                                    [](Draft& d) -> double& {
                                                      return d.plant.module.noise_N;
                                                    })),
                              defaulted("0", number("lost_share", "", within(0, 1),
                                                    "share of the samples that get lost",
                                                    [](Draft& d) -> double& {
                                                      return d.plant.module.lost_share;
                                                    })),
                              defaulted("1", integer("seed", within(0, 1e15), "of noise and losses",
                                                     [](Draft& d) -> std::uint64_t& {
                                                       return d.plant.module.seed;
                                                     })),
                          })),
          optional(sectionList("obstacles", {0, 64}, "vertical lines that push on the cover",
                               obstacleKeys(), [](Draft& d) { d.plant.obstacles.emplace_back(); })),
          optional(sectionList("troubles", {0, 64},
                               "what goes wrong on the buses of tactus plant; simulate has none",
                               troubleKeys(), [](Draft& d) { d.troubles.emplace_back(); })),
      });
}

}  // namespace tactus
