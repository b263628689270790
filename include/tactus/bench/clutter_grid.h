#pragma once

#include <cstdint>
#include <vector>

#include "tactus/bench/judged_run.h"

/// Reaching in clutter as in Jain, Killpack, Edsinger and Kemp (IJRR 2013) and Killpack, Kapusta
/// and Kemp (Autonomous Robots 2016): their planar arm, posts and limit; sizes are the defaults of
/// their published hrl-haptic-manip.
namespace tactus {

enum class ClutterKind {
  kSoft,     ///< 100 N/m, fixed
  kSliding,  ///< 1000 N/m, slides away at 2 N
  kHard,     ///< 1000 N/m, fixed
};
inline constexpr int kClutterKinds = 3;
const char* clutterKindName(ClutterKind kind);

/// Posts of 10 mm radius, upright, nowhere in one another, nor in the fingertip at its goal, within
/// 0.2 <= x <= 0.6 m and |y| <= 0.3 m; a goal 0.5 to 0.7 m from the base within 30 degrees of x,
/// and a straight path to it. base: one waypoint, the last module upright around the fingertip,
/// others along their links, a start outside.
std::vector<RunSetup> drawClutter(const RunSetup& base, ClutterKind kind, int posts,
                                  std::uint64_t seed, int count);

enum class ClutterLaw {
  kNone,       ///< goes on whatever it feels
  kNullTask,   ///< the paper's, with one module along the last link alone
  kNullLimit,  ///< with all modules
};
inline constexpr int kClutterLaws = 3;
const char* clutterLawName(ClutterLaw law);

/// Links whose modules the law does not have are touched all the same.
void useLaw(ClutterLaw law, RunSetup& setup);

/// How a reach went. Forces are those of single posts on single links, true ones.
struct ClutterRun {
  static constexpr double kReached_m = 0.02;
  static constexpr double kHigh = 1.05;  ///< of F_act + F_th, above which a force is high

  double tcp_error_final_m = 0.0;
  double contact_s = 0.0;  ///< time with a contact
  double high_s = 0.0;     ///< of it, with a high force
  double largest_N = 0.0;
  double largest_at_rest_N = 0.0;       ///< over the last JudgedRun::kRest_s
  double largest_felt_at_rest_N = 0.0;  ///< what a module says, at most, over them
  double restlessness_N = 0.0;  ///< largest standard deviation of a module's force over them
  Fault fault = Fault::kNone;

  bool isReached() const { return tcp_error_final_m <= kReached_m; }
};

ClutterRun runClutter(const RunSetup& setup);

}  // namespace tactus
