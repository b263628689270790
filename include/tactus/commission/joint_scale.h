#pragma once

#include <optional>
#include <span>

namespace tactus {

/// A place of a joint: what its encoder counted there, and what the engineer measured.
struct Mark {
  double counts = 0.0;
  double q = 0.0;  ///< m or rad, by the URDF's zero and positive sense
};

/// counts = sign * counts_per_unit * (q - offset)
struct JointScale {
  int sign = 1;
  double counts_per_unit = 0.0;  ///< per m or rad
  double offset = 0.0;           ///< m or rad
  /// Of counts_per_unit: how far it may be wrong, as a share of it, if no measured q is further
  /// off than was said.
  double uncertainty = 0.0;

  double position(double counts) const noexcept { return sign * counts / counts_per_unit + offset; }
  double counts(double q) const noexcept { return sign * counts_per_unit * (q - offset); }
};

/// The straight line through marks, by least squares. q_error: of a measured q, at most. Nothing
/// where marks lie too close together to tell the sign.
std::optional<JointScale> fitScale(std::span<const Mark> marks, double q_error);

/// The same marks with counts per unit that are known otherwise: offset alone is fitted.
JointScale fitOffset(std::span<const Mark> marks, int sign, double counts_per_unit);

/// The fewest counts a unit that marks allow, each q wrong by q_error at most; 0: they tell
/// nothing.
double fewestCountsPerUnit(std::span<const Mark> marks, double q_error) noexcept;

/// The most, likewise; infinity: they tell nothing.
double mostCountsPerUnit(std::span<const Mark> marks, double q_error) noexcept;

/// The largest distance of a mark from a line, m or rad: from this one, or from that through all of
/// them by least squares, wherever they lie.
double largestMisfit(std::span<const Mark> marks, const JointScale& scale) noexcept;
double largestMisfit(std::span<const Mark> marks) noexcept;

}  // namespace tactus
