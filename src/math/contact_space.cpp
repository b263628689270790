#include "tactus/math/contact_space.h"

#include <algorithm>

namespace tactus {

void computeContactSpace(const WeightedPseudoinverse& pseudoinverse, const JointVector& a,
                         const ScaledVector& inv_sqrt_weights, const PaddedTaskVector& y_eff,
                         ContactSpace& contact) noexcept {
  contact.a_scaled = scaled(a, inv_sqrt_weights);
  contact.a_task = pseudoinverse.project(contact.a_scaled);
  contact.k_j = contact.a_scaled.squaredNorm();
  contact.k_t = dot(contact.a_task, contact.a_task, pseudoinverse.taskSize());
  contact.k_n = (contact.a_scaled - pseudoinverse.expand(contact.a_task)).squaredNorm();
  contact.x_dot_eff_m_per_s = dot(contact.a_task, y_eff, pseudoinverse.taskSize());
}

double invertRegularised(double k, double k_j) noexcept {
  return 1.0 / std::max({k, 1e-3 * k_j, 1e-4});
}

}  // namespace tactus
