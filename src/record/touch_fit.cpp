#include "tactus/record/touch_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "tactus/control/contact_point.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kApproach_s = 0.05;
constexpr double kLeastBefore_s = 0.05;  ///< what is touched from the first sample on tells nothing
constexpr std::size_t kLeastSamples = 10;
constexpr double kLeastForce_N = 0.5;
constexpr double kMostDeviation = 0.5;  ///< of c_e
/// Of c_e: simulated first touches show errors of the way of about 3 %, where F^ has
/// noise, the contact point moves or the arm rings.
constexpr double kWayDeviation = 0.03;
constexpr double kEnd_m = 0.002;     ///< of a cover: there F^ need not be the normal
constexpr double kPlacing = 0.25;    ///< of the force that was felt first: less has no place
constexpr double kLargestGap = 2.5;  ///< periods
constexpr int kPlaces = 40;          ///< of touch that are tried first
constexpr int kHalvings = 20;        ///< around the best of them
/// Where it touched before the samples begin, so many times the way that they have farther.
constexpr double kFarther = 3.0;

/// Force and way of each cycle.
struct Touch {
  std::vector<double> t_s, way_m, force_N;
  std::vector<bool> counts;  ///< a new sample
  double period_s = 0.0;
};

Vector3 pointOf(const Pose& X_BaseModule, double position_m) {
  return X_BaseModule.p_AB + position_m * X_BaseModule.R_AB.col(0);
}

bool isAtEnd(const ControllerConfig& config, int module, const TouchSample& sample) {
  const double length_m = config.tactile_modules[static_cast<std::size_t>(module)].length_m;
  return sample.position_m < kEnd_m || sample.position_m > length_m - kEnd_m;
}

Touch wayOf(const ControllerConfig& config, int module, const std::deque<TouchSample>& samples,
            double felt_s) {
  Touch touch;
  const AttachedFrame& link = config.tactile_modules[static_cast<std::size_t>(module)].link;
  const auto felt = std::ranges::find_if(
      samples, [felt_s](const TouchSample& sample) { return sample.t_s >= felt_s; });
  if (felt == samples.end() || isAtEnd(config, module, *felt)) return touch;
  if (felt_s - samples.front().t_s < kLeastBefore_s) return touch;
  const double least_N = std::max(kMinForceForDirection_N, kPlacing * felt->force_N);
  const TouchSample* placed = &*felt;
  double way_m = 0.0;
  std::optional<Pose> before;
  std::uint64_t sequence = 0;
  ChainPose pose;
  for (const TouchSample& sample : samples) {
    if (sample.t_s < felt_s - kBeforeTouch_s || sample.t_s > felt_s + kBehindTouch_s) continue;
    const bool points_away = sample.way.dot(placed->direction) < 0.0;
    if (sample.t_s >= felt_s && !points_away && sample.force_N > least_N) placed = &sample;
    config.chain.computePose(JointVector::Map(sample.q, config.chain.size()), pose);
    const Pose X_BaseModule = framePose(pose, link);
    const Vector3 F_Base = X_BaseModule.R_AB * placed->direction;
    if (before) {
      way_m -= F_Base.dot(pointOf(X_BaseModule, placed->position_m) -
                          pointOf(*before, placed->position_m));
    }
    touch.t_s.push_back(sample.t_s);
    touch.way_m.push_back(way_m);
    touch.force_N.push_back(points_away ? -sample.force_N : sample.force_N);
    touch.counts.push_back(before && sample.sequence != sequence);
    sequence = sample.sequence;
    before = X_BaseModule;
  }
  return touch;
}

/// Whether all cycles are there; sets the period.
bool isWhole(Touch& touch) {
  const std::size_t n = touch.t_s.size();
  if (n < kLeastSamples) return false;
  touch.period_s = (touch.t_s.back() - touch.t_s.front()) / static_cast<double>(n - 1);
  if (!(touch.period_s > 0.0)) return false;
  for (std::size_t i = 1; i < n; ++i)
    if (touch.t_s[i] - touch.t_s[i - 1] > kLargestGap * touch.period_s) return false;
  return std::ranges::all_of(touch.way_m, [](double x) { return std::isfinite(x); }) &&
         std::ranges::all_of(touch.force_N, [](double x) { return std::isfinite(x); });
}

/// LP of a function of the way, at each cycle. It has been as at first for long.
template <typename Function>
std::vector<double> filtered(const Touch& touch, double cutoff_hz, Function function) {
  std::vector<double> result;
  result.reserve(touch.way_m.size());
  std::optional<ButterworthLowPass> filter;
  if (2.0 * cutoff_hz * touch.period_s < 0.99) filter.emplace(cutoff_hz, 1.0 / touch.period_s);
  const double first = function(touch.way_m.front());
  bool has_changed = false;  // before, a filter answers nothing with nothing
  for (const double x_m : touch.way_m) {
    const double input = function(x_m) - first;
    has_changed = has_changed || input != 0.0;
    result.push_back(first + (filter && has_changed ? filter->update(input) : input));
  }
  return result;
}

/// The best c_e of one place of touch.
struct PlacedFit {
  double c_N_per_m = 0.0;
  double residual_N2 = 0.0;  ///< sum of squares
  double count = 0.0;
};

PlacedFit fitAt(const Touch& touch, double cutoff_hz, double x0_m) {
  const std::vector<double> depth =
      filtered(touch, cutoff_hz, [x0_m](double x_m) { return std::max(0.0, x_m - x0_m); });
  double dd = 0.0, df = 0.0, ff = 0.0;
  PlacedFit fit;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (!touch.counts[i]) continue;
    dd += depth[i] * depth[i];
    df += depth[i] * touch.force_N[i];
    ff += touch.force_N[i] * touch.force_N[i];
    fit.count += 1.0;
  }
  if (dd > 0.0) fit.c_N_per_m = std::max(0.0, df / dd);
  fit.residual_N2 =
      std::max(0.0, ff - 2.0 * fit.c_N_per_m * df + fit.c_N_per_m * fit.c_N_per_m * dd);
  return fit;
}

/// Of what was touched before the samples begin the force is a line over the filtered way, and this
/// where that line is zero.
double placeOnLine(const Touch& touch, double cutoff_hz) {
  const std::vector<double> way = filtered(touch, cutoff_hz, [](double x_m) { return x_m; });
  double count = 0.0, x = 0.0, f = 0.0, xx = 0.0, xf = 0.0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    if (!touch.counts[i]) continue;
    count += 1.0;
    x += way[i];
    f += touch.force_N[i];
    xx += way[i] * way[i];
    xf += way[i] * touch.force_N[i];
  }
  const double c_N_per_m = (count * xf - x * f) / (count * xx - x * x);
  return x / count - f / count / c_N_per_m;
}

double placeOfTouch(const Touch& touch, double cutoff_hz) {
  const auto [least, most] = std::ranges::minmax_element(touch.way_m);
  const double low = *least - kFarther * (*most - *least);
  double width = (*most - low) / kPlaces;
  double best = low, best_N2 = fitAt(touch, cutoff_hz, low).residual_N2;
  const auto look = [&](double x_m) {
    const double residual_N2 = fitAt(touch, cutoff_hz, x_m).residual_N2;
    if (!(residual_N2 < best_N2)) return false;
    best_N2 = residual_N2;
    best = x_m;
    return true;
  };
  for (int i = 1; i < kPlaces; ++i) look(low + i * width);
  for (int i = 0; i < kHalvings; ++i) {
    width *= 0.5;
    const double middle = best;
    if (!look(middle - width)) look(middle + width);
  }
  const double before = placeOnLine(touch, cutoff_hz);  // may be farther than any that was tried
  if (before < *least) look(before);
  return best;
}

/// Standard deviation of c_e, by the normal matrix in c_e and x_0, and of the way.
double deviationOf(const Touch& touch, double cutoff_hz, double x0_m, const PlacedFit& fit) {
  const std::vector<double> by_c =
      filtered(touch, cutoff_hz, [x0_m](double x_m) { return std::max(0.0, x_m - x0_m); });
  const std::vector<double> by_x0 =
      filtered(touch, cutoff_hz, [&](double x_m) { return x_m > x0_m ? -fit.c_N_per_m : 0.0; });
  double cc = 0.0, cx = 0.0, xx = 0.0, from_s = kNoLimit, to_s = -kNoLimit;
  for (std::size_t i = 0; i < by_c.size(); ++i) {
    if (!touch.counts[i]) continue;
    cc += by_c[i] * by_c[i];
    cx += by_c[i] * by_x0[i];
    xx += by_x0[i] * by_x0[i];
    from_s = std::min(from_s, touch.t_s[i]);
    to_s = std::max(to_s, touch.t_s[i]);
  }
  const double information = cc - (xx > 0.0 ? cx * cx / xx : 0.0);
  if (!(information > 0.0)) return kNoLimit;
  const double independent = std::min(fit.count, 2.0 * cutoff_hz * (to_s - from_s));
  const double variance_N2 = fit.residual_N2 / std::max(1.0, independent - 2.0);
  const double of_way = kWayDeviation * fit.c_N_per_m;
  return std::sqrt(variance_N2 / information + of_way * of_way);
}

void addTouch(const Touch& touch, double x0_m, double felt_s, TouchFit& result) {
  std::size_t i = 0;
  while (i + 1 < touch.t_s.size() && touch.t_s[i] < felt_s) ++i;
  while (i > 0 && touch.way_m[i] > x0_m) --i;
  result.touch_s = touch.t_s[i];
  std::size_t k = i;
  while (k > 0 && touch.t_s[i] - touch.t_s[k] < kApproach_s) --k;
  if (k == i)  // it touched before the samples begin
    while (i + 1 < touch.t_s.size() && touch.t_s[i] - touch.t_s[k] < kApproach_s) ++i;
  const double time_s = touch.t_s[i] - touch.t_s[k];
  if (time_s > 0.0) result.speed_m_per_s = (touch.way_m[i] - touch.way_m[k]) / time_s;
}

/// F^ of so small a force is that of an earlier sample. This one tells where it points itself,
/// unless a cover was taken out of it.
Vector3 wayOfForce(const CycleRecord& record, int module, const TouchSample& sample) noexcept {
  if (sample.force_N > kMinForceForDirection_N) return sample.direction;
  const Vector3 F(0.0, record.tactile_force_y_N[module], record.tactile_force_z_N[module]);
  const bool is_whole = std::abs(F.norm() - sample.force_N) <= 1e-9 * sample.force_N;
  return is_whole ? F : Vector3(Vector3::Zero());
}

}  // namespace

TouchSample touchSample(const CycleRecord& record, int module) noexcept {
  TouchSample sample{
      .t_s = record.t_s,
      .force_N = record.force_sensor_N[module],
      .position_m = record.contact_position_m[module],
      .direction = Vector3(record.contact_dir_x[module], record.contact_dir_y[module],
                           record.contact_dir_z[module]),
      .sequence = record.tactile_sequence[module]};
  sample.way = wayOfForce(record, module, sample);
  std::copy_n(record.q_measured, kMaxJoints, sample.q);
  return sample;
}

TouchFit fitTouch(const ControllerConfig& config, int module,
                  const std::deque<TouchSample>& samples, double felt_s) {
  Touch touch = wayOf(config, module, samples, felt_s);
  if (!isWhole(touch)) return {};
  const double cutoff_hz =
      config.tactile_modules[static_cast<std::size_t>(module)].filter_cutoff_hz;
  const double x0_m = placeOfTouch(touch, cutoff_hz);
  const PlacedFit fit = fitAt(touch, cutoff_hz, x0_m);
  double largest_N = 0.0;
  for (std::size_t i = 0; i < touch.force_N.size(); ++i)
    if (touch.counts[i]) largest_N = std::max(largest_N, touch.force_N[i]);
  if (fit.count < static_cast<double>(kLeastSamples) || largest_N < kLeastForce_N ||
      fit.c_N_per_m <= 0.0)
    return {};
  const double deviation = deviationOf(touch, cutoff_hz, x0_m, fit);
  if (!(deviation <= kMostDeviation * fit.c_N_per_m)) return {};
  TouchFit result{.is_known = true,
                  .stiffness_N_per_m = fit.c_N_per_m,
                  .low_N_per_m = std::max(0.0, fit.c_N_per_m - 1.96 * deviation),
                  .high_N_per_m = fit.c_N_per_m + 1.96 * deviation};
  addTouch(touch, x0_m, felt_s, result);
  return result;
}

}  // namespace tactus
