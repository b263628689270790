#pragma once

#include <vector>

#include "tactus/bench/judged_run.h"
#include "tactus/bench/random.h"
#include "tactus/sim/obstacle.h"

/// Posts, vertical and endless, where links come along.
namespace tactus {

/// A start near the base's, and a straight path. base: one waypoint.
void drawPath(BenchRandom& draw, RunSetup& setup);

/// Poses of each module's frame without obstacles, every 20 ms.
using ModulePaths = std::vector<std::vector<Pose>>;
ModulePaths freePaths(RunSetup setup);

struct PostPlace {
  double path_share = 0.5;       ///< of the module's path, where it stands
  double length_share = 0.5;     ///< of the cover
  double gap_m = 0.0;            ///< between cover and post there
  bool is_behind = false;        ///< on the side that the cover moves away from
  double min_speed_share = 0.2;  ///< of the tool's, of the cover against the post
};

/// Beside the cover at a moment of its path; false where it does not move sidewards.
bool placePost(const RunSetup& setup, const std::vector<Pose>& path, std::size_t module,
               const PostPlace& place, ObstacleConfig& post);

/// Whether a post comes over an end of a cover, onto it or off it, or touches it at the start: no
/// module feels that force.
class EndWatch {
 public:
  explicit EndWatch(const RunSetup& setup);

  /// In each cycle. t_s = 0 is the start.
  bool isOut(const JointVector& q, double t_s);

 private:
  /// A post as one cover meets it, and as a longer one does.
  struct Post {
    std::size_t module;
    Obstacle at_cover, at_longer;
    bool touched = false, touched_longer = false;
  };

  SerialChain chain_;
  std::vector<TactileModuleConfig> modules_;
  std::vector<double> radii_m_;
  std::vector<Post> posts_;
  ChainPose pose_{};
};

}  // namespace tactus
