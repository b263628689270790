#include "tactus/analysis/calibration_fit.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>

namespace tactus {
namespace {

using Rows = Eigen::Matrix<double, 5, 8>;
using Loads = Eigen::Matrix<double, 5, Eigen::Dynamic>;
using Readings = Eigen::Matrix<double, 8, Eigen::Dynamic>;

/// What makes moments forces: 1 m over the lengths.
Wrench5 loadScale(const CalibratedModule& module) {
  const double l = 0.5 * module.length_m;
  return Wrench5{{1.0, 1.0, 1.0 / l, 1.0 / l, 1.0 / module.cover_radius_m}};
}

double sizeOf(const KnownPush& push, const CalibratedModule& module) {
  return std::hypot(push.force_y_N, push.force_z_N, push.moment_x_Nm / module.cover_radius_m);
}

int rowsOf(const std::vector<KnownPush>& pushes) {
  const bool has_moment_x =
      std::any_of(pushes.begin(), pushes.end(), [](const auto& p) { return p.moment_x_Nm != 0.0; });
  return has_moment_x ? 5 : 4;
}

/// Loads and readings, each by the size of its push; readings in N.
struct Equations {
  Loads W;
  Readings S;
};

Equations equationsOf(const std::vector<KnownPush>& pushes, const CalibratedModule& module) {
  const auto n = static_cast<Eigen::Index>(pushes.size());
  Equations equations{Loads(5, n), Readings(8, n)};
  for (Eigen::Index i = 0; i < n; ++i) {
    const KnownPush& push = pushes[static_cast<std::size_t>(i)];
    const double size_N = sizeOf(push, module);
    equations.W.col(i) = wrenchOf(push) / size_N;
    equations.S.col(i) = push.counts / (module.counts_per_N * size_N);
  }
  return equations;
}

double conditionOf(const Eigen::VectorXd& singular_values, int rank) {
  if (singular_values.size() < rank || !(singular_values[rank - 1] > 0.0)) return kNoLimit;
  return singular_values[0] / singular_values[rank - 1];
}

/// u: the direction that the loads tell least, of those of F_y, F_z, M_y, M_z, M_x. Pushes at one
/// place mix a force with its moment in it: the force is told then, how it turns is not.
int weakestRow(const Eigen::MatrixXd& loads, const Eigen::VectorXd& u, double largest) {
  constexpr double kMixed = 0.3;  // at one place it is 0.5 at least, at the cover's far end
  Eigen::Index row = 0;
  u.cwiseAbs().maxCoeff(&row);
  if (row == 4) return 4;
  const int force = row == 0 || row == 3 ? 0 : 1, moment = 3 - force;
  const bool is_force_told = 0.5 * kMaxPushesCondition * loads.row(force).norm() > largest;
  const bool is_mixed = std::abs(u[moment]) > kMixed * std::abs(u[force]);
  return is_force_told && is_mixed ? moment : force;
}

double loadsCondition(const Loads& W, int rows, const CalibratedModule& module, int* weakest_row) {
  const Eigen::MatrixXd scaled = (loadScale(module).asDiagonal() * W).topRows(rows);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(scaled, Eigen::ComputeFullU);
  const double condition = conditionOf(svd.singularValues(), rows);
  if (weakest_row)
    *weakest_row = weakestRow(scaled, svd.matrixU().col(rows - 1), svd.singularValues()[0]);
  return condition;
}

/// What one set of pushes comes to.
struct Solution {
  CalibrationProblem problem = CalibrationProblem::kNone;
  double pushes_condition = kNoLimit, channels_condition = kNoLimit;
  int weakest_row = 0;
  Rows calibration = Rows::Zero();
};

Solution solveCalibration(const std::vector<KnownPush>& pushes, int rows,
                          const CalibratedModule& module) {
  Solution solution;
  if (pushes.empty()) {
    solution.problem = CalibrationProblem::kTooFew;
    return solution;
  }
  const Equations equations = equationsOf(pushes, module);
  solution.pushes_condition = loadsCondition(equations.W, rows, module, &solution.weakest_row);
  if (static_cast<int>(pushes.size()) < rows) solution.problem = CalibrationProblem::kTooFew;
  if (solution.problem == CalibrationProblem::kNone &&
      !(solution.pushes_condition <= kMaxPushesCondition))
    solution.problem = CalibrationProblem::kPushesAlike;
  if (solution.problem != CalibrationProblem::kNone) return solution;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations.S,
                                              Eigen::ComputeThinU | Eigen::ComputeThinV);
  solution.channels_condition = conditionOf(svd.singularValues(), rows);
  if (!(solution.channels_condition <= kMaxChannelsCondition)) {
    solution.problem = CalibrationProblem::kChannelsAlike;
    return solution;
  }
  const Eigen::VectorXd inverse = svd.singularValues().head(rows).cwiseInverse();
  solution.calibration.topRows(rows) = equations.W.topRows(rows) * svd.matrixV().leftCols(rows) *
                                       inverse.asDiagonal() *
                                       svd.matrixU().leftCols(rows).transpose();
  return solution;
}

PushResidual residualOf(const KnownPush& push, const Rows& calibration, int rows,
                        const CalibratedModule& module) {
  const Wrench5 found = calibration * push.counts / module.counts_per_N;
  Wrench5 error = found - wrenchOf(push);
  if (rows < 5) error[4] = 0.0;
  const double square = found.head<2>().squaredNorm();
  const double size_N = sizeOf(push, module);
  PushResidual residual;
  residual.force_N = error.head<2>().norm();
  residual.position_m = std::numeric_limits<double>::quiet_NaN();
  if (square > 1e-6 * size_N * size_N)
    residual.position_m = (found[3] * found[0] - found[2] * found[1]) / square - push.position_m;
  residual.share = loadScale(module).cwiseProduct(error).norm() / size_N;
  return residual;
}

std::vector<KnownPush> without(const std::vector<KnownPush>& pushes, std::size_t index) {
  std::vector<KnownPush> rest = pushes;
  rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(index));
  return rest;
}

/// Root mean square of what the pushes are off by.
double disagreement(const std::vector<KnownPush>& pushes, const Rows& calibration, int rows,
                    const CalibratedModule& module) {
  double squares = 0.0;
  for (const KnownPush& push : pushes) {
    const double share = residualOf(push, calibration, rows, module).share;
    squares += share * share;
  }
  return std::sqrt(squares / static_cast<double>(pushes.size()));
}

/// Leaves out each push in turn.
void leaveOut(const std::vector<KnownPush>& pushes, const CalibratedModule& module,
              CalibrationFit& fit) {
  /// Of pushes that agree to rounding none is worse than another.
  constexpr double kNothing = 1e-9, kHardlyLess = 1.5;
  std::vector<double> rest_disagrees(pushes.size(), kNoLimit);
  fit.left_out.resize(pushes.size());
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const std::vector<KnownPush> rest = without(pushes, i);
    const Solution solution = solveCalibration(rest, fit.rows, module);
    if (solution.problem != CalibrationProblem::kNone) continue;
    fit.left_out[i] = residualOf(pushes[i], solution.calibration, fit.rows, module);
    rest_disagrees[i] = kNothing + disagreement(rest, solution.calibration, fit.rows, module);
    if (fit.worst < 0 || rest_disagrees[i] < rest_disagrees[static_cast<std::size_t>(fit.worst)])
      fit.worst = static_cast<int>(i);
  }
  if (fit.worst < 0) return;
  const auto worst = static_cast<std::size_t>(fit.worst);
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    if (i == worst || !(rest_disagrees[i] < kHardlyLess * rest_disagrees[worst])) continue;
    const bool is_next = fit.or_worst < 0 ||
                         rest_disagrees[i] < rest_disagrees[static_cast<std::size_t>(fit.or_worst)];
    if (is_next) fit.or_worst = static_cast<int>(i);
  }
}

/// Of a push that nothing checks it is -1.
double shareOff(const CalibrationFit& fit, int push) noexcept {
  const auto& left_out = fit.left_out[static_cast<std::size_t>(push)];
  return left_out ? left_out->share : -1.0;
}

}  // namespace

Wrench5 wrenchOf(const KnownPush& push) noexcept {
  return Wrench5{{push.force_y_N, push.force_z_N, -push.position_m * push.force_z_N,
                  push.position_m * push.force_y_N, push.moment_x_Nm}};
}

int farthestPush(const CalibrationFit& fit) noexcept {
  int farthest = -1;
  for (int i = 0; i < std::ssize(fit.left_out); ++i)
    if (shareOff(fit, i) > (farthest < 0 ? -1.0 : shareOff(fit, farthest))) farthest = i;
  return farthest;
}

int wrongPush(const CalibrationFit& fit) noexcept {
  const int farthest = farthestPush(fit);
  if (farthest < 0 || !(shareOff(fit, farthest) > kMaxLeftOutShare)) return -1;
  return fit.worst >= 0 && shareOff(fit, fit.worst) > kMaxLeftOutShare ? fit.worst : farthest;
}

double pushesCondition(const std::vector<KnownPush>& pushes, const CalibratedModule& module,
                       int* weakest_row) {
  if (pushes.empty()) return kNoLimit;
  return loadsCondition(equationsOf(pushes, module).W, rowsOf(pushes), module, weakest_row);
}

int uncheckedPushes(const std::vector<KnownPush>& pushes, const CalibratedModule& module) {
  const int rows = rowsOf(pushes);
  int unchecked = 0;
  for (std::size_t i = 0; i < pushes.size(); ++i) {
    const std::vector<KnownPush> rest = without(pushes, i);
    const bool is_told =
        std::ssize(rest) >= rows &&
        loadsCondition(equationsOf(rest, module).W, rows, module, nullptr) <= kMaxPushesCondition;
    unchecked += is_told ? 0 : 1;
  }
  return unchecked;
}

CalibrationFit fitCalibration(const std::vector<KnownPush>& pushes, const CalibratedModule& module,
                              const ChannelVector& sigma) {
  CalibrationFit fit;
  fit.rows = rowsOf(pushes);
  const Solution solution = solveCalibration(pushes, fit.rows, module);
  fit.problem = solution.problem;
  fit.pushes_condition = solution.pushes_condition;
  fit.channels_condition = solution.channels_condition;
  fit.weakest_row = solution.weakest_row;
  if (fit.problem != CalibrationProblem::kNone) return fit;
  fit.calibration = solution.calibration;
  for (const KnownPush& push : pushes)
    fit.residuals.push_back(residualOf(push, fit.calibration, fit.rows, module));
  fit.noise = ((fit.calibration / module.counts_per_N).cwiseAbs2() * sigma.cwiseAbs2()).cwiseSqrt();
  leaveOut(pushes, module, fit);
  return fit;
}

}  // namespace tactus
