#include "tactus/commission/joint_scale.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

/// Twice what two errors can make up.
constexpr double kLeastBaseline_errors = 4.0;

/// So many digits of counts per unit are kept: a file shows no more, and the offset has to fit
/// what it shows.
double rounded(double value) {
  if (!(value > 0.0)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 8.0);
  return std::round(value / unit) * unit;
}

Mark meanOf(std::span<const Mark> marks) noexcept {
  Mark mean;
  for (const Mark& mark : marks) {
    mean.counts += mark.counts / static_cast<double>(marks.size());
    mean.q += mark.q / static_cast<double>(marks.size());
  }
  return mean;
}

/// By least squares, m or rad a count; 0 of marks at one place.
double slopeOf(std::span<const Mark> marks, const Mark& mean) noexcept {
  double counts_counts = 0.0, counts_q = 0.0;
  for (const Mark& mark : marks) {
    const double d = mark.counts - mean.counts;
    counts_counts += d * d;
    counts_q += d * (mark.q - mean.q);
  }
  return counts_counts > 0.0 ? counts_q / counts_counts : 0.0;
}

}  // namespace

std::optional<JointScale> fitScale(std::span<const Mark> marks, double q_error) {
  const auto [first, last] = std::ranges::minmax_element(marks, {}, &Mark::counts);
  if (marks.size() < 2 || !(last->counts > first->counts)) return std::nullopt;
  const Mark mean = meanOf(marks);
  const double slope = slopeOf(marks, mean);
  const double baseline = std::abs(slope) * (last->counts - first->counts);
  if (!(baseline > kLeastBaseline_errors * q_error)) return std::nullopt;
  JointScale scale = fitOffset(marks, slope > 0.0 ? 1 : -1, rounded(1.0 / std::abs(slope)));
  double spread = 0.0, counts_counts = 0.0;  // what errors that all pull one way make of the slope
  for (const Mark& mark : marks) {
    spread += std::abs(mark.counts - mean.counts);
    counts_counts += (mark.counts - mean.counts) * (mark.counts - mean.counts);
  }
  scale.uncertainty = q_error * spread / counts_counts / std::abs(slope);
  return scale;
}

JointScale fitOffset(std::span<const Mark> marks, int sign, double counts_per_unit) {
  const Mark mean = meanOf(marks);
  return {sign, counts_per_unit, mean.q - sign * mean.counts / counts_per_unit, 0.0};
}

double fewestCountsPerUnit(std::span<const Mark> marks, double q_error) noexcept {
  double fewest = 0.0;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double way = std::abs(marks[i].q - marks[k].q) + 2.0 * q_error;
      fewest = std::max(fewest, std::abs(marks[i].counts - marks[k].counts) / way);
    }
  }
  return fewest;
}

double mostCountsPerUnit(std::span<const Mark> marks, double q_error) noexcept {
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < marks.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const double way = std::abs(marks[i].q - marks[k].q) - 2.0 * q_error;
      if (way > 0.0) most = std::min(most, std::abs(marks[i].counts - marks[k].counts) / way);
    }
  }
  return most;
}

double largestMisfit(std::span<const Mark> marks, const JointScale& scale) noexcept {
  double largest = 0.0;
  for (const Mark& mark : marks)
    largest = std::max(largest, std::abs(scale.position(mark.counts) - mark.q));
  return largest;
}

double largestMisfit(std::span<const Mark> marks) noexcept {
  const Mark mean = meanOf(marks);
  const double slope = slopeOf(marks, mean);
  double largest = 0.0;
  for (const Mark& mark : marks)
    largest = std::max(largest, std::abs(mark.q - mean.q - slope * (mark.counts - mean.counts)));
  return largest;
}

}  // namespace tactus
