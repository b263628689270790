#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan.h"
#include "campaign/play.h"
#include "campaign/stage.h"
#include "soak/client.h"
#include "soak/daemon.h"
#include "soak/operator.h"
#include "soak/replay_sample.h"
#include "tactus/record/run_folder.h"

namespace tactus::soak {

using test::VirtualRobotCell;

/// What was seen so far, of all lives.
struct Tally {
  double t_s = 0.0;  ///< virtual
  long long cycles = 0, missed_cycles = 0;
  long long episodes = 0, troubles = 0;
  long long stops = 0;      ///< faults
  long long holds = 0;      ///< without a fault
  long long goings_on = 0;  ///< to running, from a stop or a hold
  int lives = 0, power_cuts = 0, found = 0;
  std::map<std::string, int> faults;
  std::map<std::string, int> left;  ///< arms that had to be brought home: by the fault
  RequestCounts requests;
  ReplayCounts replays;
  std::array<DrawnTimes, 4> drawn;
  std::array<Histogram, 4> histograms;  ///< of the same
  double peak = 0.0;  ///< of joints in the 3 s after going on, while nothing pushed, m/s or rad/s
  std::vector<std::string> violations;
};

/// With lines, which no bus has.
Scene loadSoakScene(const std::string& path, const std::vector<Override>& settings);

/// One life of a daemon, from its start with an arm at home to its end or the loss of power. All
/// follows from seed and number.
class Life {
 public:
  /// minutely: each minute of virtual time; false: run() is to end.
  Life(std::uint64_t seed, int number, const std::string& folder, Tally& tally,
       std::function<bool()> minutely);

  /// The daemon, where the arm stands.
  void start();
  /// Troubles, requests and going on, for so much virtual time, or until the arm does not go on.
  void run(double duration_s);
  /// A stop request, or the loss of power. Then drives have to rest, the log has to be readable,
  /// and a daemon that starts where the arm is runs only if that is near enough to its home.
  void end();

 private:
  campaign::Plan drawEpisode();
  void leave(const campaign::Observation& last, const campaign::Plan& plan);
  /// Returns how it ended.
  campaign::Observation play(const campaign::Plan& plan, Operator user);
  void endAlone(campaign::Play& play, campaign::Judges& judges,
                std::vector<campaign::Violation>& found);
  void ask();
  void count(const campaign::Observation& before, const campaign::Observation& now);
  void account();
  bool passTime(const VirtualRobotCell& cell);
  void note(const campaign::Plan& plan, const std::vector<campaign::Violation>& found);
  void complain(const std::string& what);
  void judgeSubnormals(const VirtualRobotCell& cell);
  void cutPower();
  double fastestJoint() const;  ///< m/s or rad/s
  void startAgain();
  bool findArm();
  void stop();
  void finish();
  void takeReplay(long long expected_cycles);

  std::string folder_, log_folder_;
  std::uint64_t seed_;
  int number_;
  Tally& tally_;
  std::function<bool()> minutely_;
  test::Random random_;
  SoakScene scene_;
  campaign::Stage stage_;
  std::optional<VirtualRobotCell> cell_;
  std::optional<RunFolder> run_folder_;
  std::optional<Daemon> daemon_;
  std::optional<Client> client_;
  double began_s_, next_ask_s_ = 0.0, next_replay_s_ = 0.0, next_minute_s_ = 0.0;
  bool goes_on_ = true;
};

}  // namespace tactus::soak
