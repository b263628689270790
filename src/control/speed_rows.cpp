#include "tactus/control/speed_rows.h"

#include <algorithm>
#include <cmath>

#include "tactus/math/few_complementarity.h"
#include "tactus/math/pair.h"

namespace tactus {
namespace {

constexpr double kYielding_N_s_m = 1.5;  ///< delta_0
constexpr int kRepetitions = 4;
/// Of the largest speed that lacks: what a repetition changes less than this is found.
constexpr double kFound = 1e-11;

/// The motion as a whole, until it keeps the rows that standing still keeps.
void slowDown(const SpeedRows& rows, int task_size, Motion& motion) {
  double share = 1.0;
  for (int i = 0; i < rows.size; ++i) {
    const double approach = -speedAlong(rows.row[i], task_size, motion);
    const double v_max = rows.row[i].v_max_m_per_s;
    if (v_max >= 0.0 && share * approach > v_max) share = v_max / approach;
  }
  motion.v_scaled *= share;
  motion.y *= share;
}

/// d = lacking + delta l; false if it is what it was before, but for so much. What is beyond the
/// rows is zero, or was in the first place.
bool passOn(const RowVector& lacking, const RowVector& delta, const RowVector& l, double negligible,
            const RowVector& before, RowVector& d) {
  Pair change{0.0, 0.0};
  for (int i = 0; i < d.size(); i += 4) {
    for (int k = i; k < i + 4; k += 2) {
      const Pair d_k = pairAt(lacking.data() + k) + pairAt(delta.data() + k) * pairAt(l.data() + k);
      change = larger(change, magnitude(d_k - pairAt(before.data() + k)));
      storePair(d_k, d.data() + k);
    }
  }
  return std::max(change[0], change[1]) > negligible;
}

}  // namespace

void RowProblem::multiply() noexcept {
  if (is_multiplied_) return;
  is_multiplied_ = true;
  in_all_.resize(rows_.size, rows_.size);
  in_task_.resize(rows_.size, rows_.size);
  for (int i = 0; i < rows_.size; ++i) {
    const SpeedRow& a = rows_.row[i];
    for (int j = 0; j <= i; ++j) {
      const SpeedRow& b = rows_.row[j];
      in_all_(j, i) = dot(a.a_scaled, b.a_scaled);
      in_task_(j, i) = dot(a.a_task, b.a_task, task_size_);
    }
  }
}

/// K + diag(delta), and delta.
void RowProblem::respond(const RowSpace& space, RowMatrix& K, RowVector& delta) const noexcept {
  const double difference = space.task - space.null_space;
  const Pair null_spaces{space.null_space, space.null_space};
  const Pair differences{difference, difference};
  K.resize(rows_.size, rows_.size);
  RowVector own(rows_.size);  // K_ii
  RowVector presence(rows_.size);
  RowVector opposition(rows_.size);
  for (int i = 0; i < rows_.size; ++i) {
    const double* const all = &in_all_(0, i);
    const double* const task = &in_task_(0, i);
    double* const K_i = &K(0, i);
    const double length_squared = all[i];
    own[i] = std::max(space.null_space * length_squared + difference * task[i],
                      std::max(1e-3 * length_squared, 1e-4));
    const Pair own_i{own[i], own[i]};
    const double p = rows_.row[i].presence;
    Pair sum{0.0, 0.0};
    presence[i] = opposition[i] = 0.0;  // i itself may be of the last pair
    for (int j = 0; j < i; j += 2) {
      const Pair K_ij = null_spaces * pairAt(all + j) + differences * pairAt(task + j);
      storePair(K_ij, K_i + j);
      K(i, j) = K_ij[0];
      K(i, j + 1) = K_ij[1];
      if (!isAny(K_ij < 0.0)) continue;
      const Pair against = K_ij < 0.0 ? K_ij : Pair{0.0, 0.0};
      const Pair o_ij =
          Pair{p, p} * pairAt(&presence[j]) * (against * against / (own_i * pairAt(&own[j])));
      storePair(pairAt(&opposition[j]) + o_ij, &opposition[j]);
      sum += o_ij;
    }
    opposition[i] = sum[0] + sum[1];
    presence[i] = p;
  }
  delta.resize(rows_.size);
  double most = 0.0;  // of delta, as a share of K_ii
  for (int i = 0; i < rows_.size; ++i) {
    delta[i] = space.proximal * own[i];
    const double yielding =
        kYielding_N_s_m / rows_.row[i].damping_N_s_per_m * std::min(1.0, opposition[i]);
    most = std::max(most, yielding / own[i]);
    delta[i] += yielding;
    K(i, i) = own[i] + delta[i];
  }
  if (most > space.max_yielding) {  // all rows less alike: they yield in proportion to their forces
    const double share = space.max_yielding / most;
    for (int i = 0; i < rows_.size; ++i) {
      delta[i] = share * delta[i] + (1.0 - share) * space.proximal * own[i];
      K(i, i) = own[i] + delta[i];
    }
  }
  zeroRest(delta);
}

/// K: with delta. negligible: change of what lacks.
template <typename Problem>
RowMultipliers RowProblem::repeat(const RowMatrix& K, const RowVector& delta,
                                  const RowVector& lacking, double negligible) noexcept {
  Problem problem(K);
  RowVector d(rows_.size);
  bool is_whole = problem.solve(lacking, products_left_);
  for (int i = 1; i < kRepetitions && is_whole; ++i) {
    const bool is_new = passOn(lacking, delta, problem.l(), negligible, i == 1 ? lacking : d, d);
    if (rows_.is_of_one_contact)
      problem.forget();
    else if (!is_new)
      break;
    is_whole = problem.solve(d, products_left_);
  }
  return {problem.l(), is_whole};
}

RowMultipliers RowProblem::solve(const RowVector& v_max_m_per_s, const RowSpace& space,
                                 const Motion& motion, double share) noexcept {
  RowVector lacking(rows_.size);
  double most = 0.0;
  bool is_kept = true;  // not of NaN, which has to reach the gate before the drives
  for (int i = 0; i < rows_.size; ++i) {
    const SpeedRow& row = rows_.row[i];
    lacking[i] = -v_max_m_per_s[i] - dot(row.a_scaled, motion.v_scaled) -
                 dot(row.a_task, motion.y, task_size_);
    most = std::max(most, lacking[i]);
    is_kept = is_kept && lacking[i] <= 0.0;
  }
  if (is_kept) return {RowVector::Zero(rows_.size)};
  zeroRest(lacking);
  multiply();
  RowMatrix K;
  RowVector delta;
  respond(space, K, delta);
  const int for_others = products_left_ - static_cast<int>(share * products_left_);
  products_left_ -= for_others;
  const bool are_few = rows_.size <= FewComplementarity::kMost && !rows_.is_of_one_contact;
  const RowMultipliers found = are_few
                                   ? repeat<FewComplementarity>(K, delta, lacking, kFound * most)
                                   : repeat<Complementarity>(K, delta, lacking, kFound * most);
  products_left_ += for_others;
  return found;
}

RowVector RowProblem::keep(Motion& motion) noexcept {
  const RowMultipliers found = solve(ownSpeeds(rows_), kBothSpaces, motion);
  addRows(rows_, found.l, kBothSpaces, motion);
  if (!found.is_whole) slowDown(rows_, task_size_, motion);
  return found.l;
}

RowVector ownSpeeds(const SpeedRows& rows) noexcept {
  RowVector v_max(rows.size);
  for (int i = 0; i < rows.size; ++i) v_max[i] = rows.row[i].v_max_m_per_s;
  return v_max;
}

void addRows(const SpeedRows& rows, const RowVector& l, const RowSpace& space,
             Motion& motion) noexcept {
  for (int i = 0; i < rows.size; ++i) {
    if (l[i] == 0.0) continue;
    motion.v_scaled += space.null_space * l[i] * rows.row[i].a_scaled;
    motion.y += (space.task - space.null_space) * l[i] * rows.row[i].a_task;
  }
}

}  // namespace tactus
