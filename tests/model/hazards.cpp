#include <fmt/format.h>

#include <array>

#include "model/mode_model.h"

/// What may go wrong, a row each. Of a fault the daemon's own table says how it is seen, answered
/// and what remains; of all else the row does.
namespace tactus::model {
namespace {

struct Hazard {
  const char* hazard;
  const char* cause;
  Fault fault;
  const char* tests;
  const char* detection = "";
  const char* reaction = "";
  const char* within = "";
  const char* remains = "";
  const char* event = "";
};

constexpr const char* kInContact = "`FaultInContact.BringsTheArmToRestAndEnds`";
constexpr const char* kInContactAndHil = "`FaultInContact.BringsTheArmToRestAndEnds`, `hil.faults`";
constexpr const char* kPresses = "the arm presses on";
constexpr const char* kStrays = "a joint moves otherwise than commanded";
constexpr const char* kUnasked = "the arm moves unasked";
constexpr const char* kGoesOn = "the arm does not stop";
constexpr const char* kSinks = "a joint sinks";
constexpr const char* kHits = "the arm hits itself or what stands there";
constexpr const char* kUnknown = "nobody knows what happened";

constexpr auto kHazards = std::to_array<Hazard>({
    {kPresses, "a blow, or a sensor that says too much", Fault::kTactileInvalid,
     "`FaultInContact.BringsTheArmToRestAndEnds`, "
     "`RetreatForce.AfterTooMuchForceLeavesLessThanTheLawsForce`"},
    {kPresses, "module, its power or its wire fails", Fault::kTactileStale,
     "`RetreatForce.WithoutReadingsLeavesNothingOfContactsAsAssumed`, `hil.faults`"},
    {kPresses, "a push beyond what a channel can tell", Fault::kTactileSaturated,
     "`FaultInContact.BringsTheArmToRestAndEnds`, "
     "`RetreatForce.WithoutReadingsLeavesNothingOfContactsAsAssumed`"},
    {kPresses, "a cable within the module breaks", Fault::kTactileCableBreak, kInContact},
    {kPresses, "something leans on the cover at the start, and would be tared away",
     Fault::kTareRefused, "`ControlCycleBoot.RefusesToTareInContact`"},
    {kPresses, "a module fails, and the arm may go on slowly", Fault::kNone,
     "`LostModule.LetsNoJointBeFasterThanItsShare`, `LostModuleByChance.LeavesTheArmSlowOrAtRest`",
     "no new sample, broken cable, nonsense", "slower: `module_lost_speed_share`", "0.2 s",
     "all that the lost module does not feel", "`modules_lost`, `module_losses`"},
    {kPresses, "contact where no module is", Fault::kNone,
     "`UnsensedContact.IsWarnedOfWithItsTimeAndForce`, `UnsensedOnBuses.IsThatOfTheSimulation`",
     "nothing; in simulation `tactus check`", "none", "", "all that the drives can push",
     "`unsensed_contact`, in simulation"},
    {kPresses, "an obstacle is stiffer or met faster than the law bears", Fault::kNone,
     "`TouchCheck.NamesASpeedThatKeepsTheForceOfTheLaw`, "
     "`LargestStiffnessRatio.SeparatesStableFromUnstable`",
     "`tactus check`, before; then the module", "the law gives way", "T",
     "a peak above F_act + F_th: [claims](claims.md)", "`contacts`"},
    {kPresses, "gains that swing are sent to the running arm", Fault::kNone,
     "`GainsInContact.UnstableOnesAreTakenBackInTime`",
     "phase margin, before; then the force's swing", "refused; gains go back", "three swings",
     "the peak of these swings", "`trouble`"},
    {kPresses, "an obstacle follows an arm that holds", Fault::kNone,
     "`RetreatForce.FromObstaclesThatComeTowardsTheArm`", "nothing", "none", "",
     "all that the obstacle can push", "the log's force"},

    {kStrays, "a drive loses its power or its wire", Fault::kDriveSilent, kInContactAndHil},
    {kStrays, "a drive is too hot, overloaded, or broken", Fault::kDriveFault, kInContactAndHil},
    {kStrays, "a drive is switched off or restarts", Fault::kDriveStateLost, kInContactAndHil},
    {kStrays, "a joint is blocked or pushed, or its encoder slips", Fault::kFollowingError,
     kInContact},
    {kStrays, "adapter or driver hangs", Fault::kBusStalled, kInContactAndHil},
    {kStrays, "all nodes of a bus lose their power, or its cable", Fault::kBusUnacknowledged,
     kInContactAndHil},
    {kStrays, "a short, or a wrong bit rate", Fault::kBusOff, kInContactAndHil},
    {kStrays, "an adapter is removed", Fault::kBusDown, kInContact},
    {kStrays, "a node babbles", Fault::kBusFlooded, kInContact},
    {kStrays, "frames get lost, come twice, or are of somebody else", Fault::kNone,
     "`ControlCycleHostile.RandomFramesNeverLeadBeyondTheLimits`, `hil.fuzz`",
     "size, order and kind of each frame", "the frame is left out", "1 cycle",
     "forged status and samples are believed: [threats](threats.md)", "`malformed_drive_frames`"},
    {kStrays, "setpoints alone get lost", Fault::kNone,
     "`ControlCycleLostSetpoints.TheDriveStopsByItselfWithinTheHeartbeatTimeout`",
     "the drive, by object 1400:05", "the drive stops by itself", "`heartbeat_timeout_s`",
     "a drive without that object keeps its last velocity", "the drive's emergency"},
    {kStrays, "a setpoint becomes another on its way", Fault::kNone,
     "`ControlCycleChangedSetpoints.TheDriveHeedsTheJointsLimit`, "
     "`ControlCycleChangedSetpoints.WhereItLastsTheArmStopsWithinTheFollowingError`",
     "the drive, by object 607F; `following_error` where it lasts",
     "none for a single one, else quick stop", "max_following_error / speed",
     "the joint at a tenth above its speed limit, for as long; where the drive does not heed 607F, "
     "at any speed",
     "`following_error` (15)"},
    {kStrays, "sign or counts of a joint are wrong in robot.yaml", Fault::kNone,
     "`CommissionTrouble.SignIsJudgedBeforeAnyJog`, `ArmCheck.WarnsOfSizesThatNoRobotHas`",
     "`tactus commission`, before", "short, slow motions of one joint", "",
     "all, for a file that nobody commissioned", "`robot.yaml.commission.json`"},
    {kStrays, "two CAN interfaces change places, and their joints with them", Fault::kNone,
     "`ControlCycleBoot.NamesTheDriveThatDoesNotAnswer`, "
     "`ControlCycleBoot.RefusesAnArmThatIsNotAtTheStart`",
     "no answer, where a node id is on one bus alone; else joints that are not at the start",
     "nothing is switched on", "before motion",
     "ids that repeat, of joints that are alike at the start or of a scene that begins wherever "
     "the arm is",
     "`drive_setup_refused` (16), `not_at_start` (17)"},
    {kStrays, "the law computes nonsense", Fault::kCommandNotFinite,
     "`ApproachLimit.StaysFiniteWhateverTheSensorSays`, `Mode.AnswersEveryFaultByItsRow`"},
    {kStrays, "the computer is too slow, or something else takes it", Fault::kOverrun,
     kInContactAndHil},
    {kStrays, "the loop does what may block", Fault::kForbiddenSystemCall, kInContactAndHil},

    {kUnasked, "a drive does not take its set-up", Fault::kDriveSetupRefused,
     "`ControlCycleBoot.NamesTheObjectThatADriveRefuses`"},
    {kUnasked, "the arm was moved, or is not where its path begins", Fault::kNotAtStart,
     "`ControlCycleBoot.RefusesAnArmThatIsNotAtTheStart`, "
     "`ControlCycleSafety.AnArmThatWasPushedAwayDoesNotStartAgain`"},
    {kUnasked, "the daemon is started, and nobody stands by", Fault::kNone,
     "`Mode.WaitsForTheEnableLine`, `python.mode_model`", "enable line", "waits for it", "",
     "**without such a line the arm moves at once**", "mode `ready`"},
    {kUnasked, "a restart after a crash or a hang, also one with a fault latched", Fault::kNone,
     "`EnableWait.CountsTheLineOnceItWasOff`, `hil.told`", "an enable line that was on before",
     "waits until it was off and is on", "before motion", "who switches has to look",
     "mode `ready`"},
    {kUnasked, "a contact of the enable line chatters while a stopped arm waits for it",
     Fault::kNone, "`EnableWait.TakesALineThatFlickersForOff`", "how long the line is off",
     "counts as off until it was off for 0.05 s, or `debounce_s` if that is longer", "1 cycle",
     "one that is off for longer, and on again", "mode `holding`, `fault` or `ready`"},
    {kUnasked, "links move to `redundancy.posture` while the tool holds", Fault::kNone,
     "`SoftPosture.BeginsSoftlyAlsoWhereTheSceneBegins`, `SoftPosture.GoesOnSoftlyAfterAHold`, "
     "`Posture.IsBoundedInItsSpeedAndNotTurned`",
     "the law, where they touch something", "gives way", "T",
     "up to `max_speed_share` of the joints' speeds while the arm runs", "mode `running`"},
    {kUnasked, "an encoder has lost its counts, where the scene begins wherever the arm is",
     Fault::kNone, "`MeasuredStart.PutsAJointBesideItsLimitOnIt`",
     "a start beyond limits or `clearance`, else nothing", "refused, else none", "before motion",
     "**the arm is believed to be elsewhere**: home its drives first", "the journal's `start`"},
    {kUnasked, "the cause of a fault goes by itself", Fault::kNone,
     "`FaultInContact.RestartsByTheEnableLineOnly`, `python.mode_model`", "the latched fault",
     "none, until the line is off and on", "", "who switches has to look", "mode `fault`"},
    {kUnasked, "a bus gets its power back, and old setpoints wait in queues", Fault::kNone,
     "`ControlCyclePowerCut.BringsNoStaleSetpointToADrive`, "
     "`MoteusCycle.FollowsASetpointThatWaitedForPowerNoLongerThanItsWatchdog`, `hil.faults`",
     "unconfirmed frames", "none are sent", "1 cycle",
     "nothing; a moteus moves as before for `heartbeat_timeout_s` at most, and slows down",
     "`bus_unacknowledged`"},
    {kUnasked, "a second daemon takes the same buses", Fault::kNone,
     "`InterfaceLock.IsHeldByOneAtATime`, `hil.faults`", "a lock of each interface",
     "the second one does not start", "before motion", "programs that are not ours", "exit code 3"},

    {kGoesOn, "somebody presses the e-stop", Fault::kEmergencyStop, kInContactAndHil},
    {kGoesOn, "the GPIO chip goes, or somebody takes a line", Fault::kGpioLost, kInContact},
    {kGoesOn, "somebody takes the enable line away", Fault::kNone,
     "`Retreat.EndsAtOnceByHarsherFaultsAndTheEnableLine`, `hil.faults`, `python.mode_model`",
     "the line, polled each cycle", "ramp, then hold", "1 cycle", "that where the arm stops",
     "mode `holding`"},
    {kGoesOn, "somebody asks for the end", Fault::kNone,
     "`ControlCycleStop.EndsAtRestWithDrivesOffFromEveryMoment`, "
     "`DaemonSignals.NoneOfATerminalEndsOrSuspendsIt`, `python.mode_model`",
     "SIGTERM, SIGHUP, Ctrl-C, Ctrl-Z", "ramp, then drives off", "1 cycle",
     "that where the arm stops", "mode `stopping`"},
    {kGoesOn, "a drive moves on though it was told to stop", Fault::kNone,
     "`LyingDrive.ThatMovesOnIsBrakedAndStoppedInTime`, `hil.faults`", "its measured position",
     "brakes close, NMT stop, its bus falls silent", "0.1 s", "what the brakes do not hold",
     "none of its own: `q_measured`"},
    {kGoesOn, "a drive is not seen off", Fault::kNone,
     "`LyingDrive.ThatNeverSwitchesOffIsCutOffInTimeThoughCyclesAreMissed`, `hil.faults`",
     "its status word", "the same", "`can.stop_deadline_s`", "what the brakes do not hold",
     "none of its own: `q_measured`"},
    {kGoesOn, "the daemon crashes or is killed", Fault::kNone, "`hil.faults`",
     "the drives, by its heartbeat", "drives stop by themselves", "`heartbeat_timeout_s`",
     "a drive that does not watch it; what the brake line does without a program",
     "systemd's journal"},
    {kGoesOn, "the loop hangs, or is late for good", Fault::kNone,
     "`ServiceWatchdog.starvesWhereTheLoopMissesCycles`", "systemd, by its watchdog",
     "the same, and a restart", "2 s; drives before", "the same", "systemd's journal"},

    {kSinks, "a drive lets go before its brake has closed", Fault::kNone,
     "`ControlCycleBrake.OpensBeforeMotionAndClosesBeforeDrivesLetGo`, `python.mode_model`",
     "status words, and time", "drives hold while brakes close", "the brake's `switching_s`",
     "a brake that is slower than set", "mode `stopping`"},
    {kSinks,
     "after a fault a drive has let go while others still stop, and one line closes all brakes",
     Fault::kNone, "`Brake.IsOpenWhereAModeNeedsItAndNowhereElse`, `python.mode_model`",
     "status words", "brakes close once no drive holds any more", "`can.stop_deadline_s`",
     "what that joint sinks until then, unless its brake is the drive's own", "mode `fault`"},
    {kSinks, "a fault or a stop opens a brake", Fault::kNone,
     "`ControlCycleSafety.AFaultNeverOpensABrake`, `python.mode_model`", "the table of brakes",
     "it stays closed", "", "nothing", "mode `fault`"},

    {kHits, "the null space or a push leads a link there", Fault::kNone,
     "`Clearance.IsKeptWhateverIsCommanded`, `ClearScenes.TouchOnlyWithoutTheirClearance`",
     "distances of the bodies in the scene's `clearance`", "the motion is limited", "each cycle",
     "bodies that the scene does not name", "none"},

    {kUnknown, "the disk is full or slow", Fault::kNone,
     "`RunLogInMemory.StopsWhenItHasEatenUpToTheReserve`, "
     "`RunLogFiles.AFolderThatVanishesStopsTheLog`",
     "each write", "the log stops, the arm goes on", "", "what comes after", "`log` of the status"},
});

std::string line(const Hazard& row, bool is_first) {
  const FaultRow& known = faultRow(row.fault);
  const bool is_fault = row.fault != Fault::kNone;
  const std::string event =
      is_fault ? fmt::format("`{}` ({})", known.name, static_cast<int>(row.fault)) : row.event;
  return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", is_first ? row.hazard : "",
                     row.cause, is_fault ? known.detection : row.detection,
                     is_fault ? reactionName(known.reaction) : row.reaction,
                     is_fault ? known.within : row.within, is_fault ? known.remains : row.remains,
                     event, row.tests);
}

}  // namespace

std::string hazardTable() {
  std::string text =
      "| Hazard | Cause | Seen by | Reaction | Within | What remains | Log event | Test |\n"
      "|---|---|---|---|---|---|---|---|\n";
  const char* before = "";
  for (const Hazard& row : kHazards) {
    text += line(row, row.hazard != before);
    before = row.hazard;
  }
  return text;
}

}  // namespace tactus::model
