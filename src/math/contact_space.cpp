#include "tactus/math/contact_space.h"

#include <algorithm>

namespace tactus {

void computeContactSpace(const WeightedPseudoinverse& pseudoinverse, const ScaledVector& a,
                         const ScaledVector& inv_sqrt_weights, const PaddedTaskVector& y_eff,
                         ContactSpace& contact) noexcept {
  contact.a_scaled = inv_sqrt_weights.cwiseProduct(a);
  contact.a_task = pseudoinverse.project(contact.a_scaled);
  contact.k_j = dot(contact.a_scaled, contact.a_scaled);
  contact.k_t = dot(contact.a_task, contact.a_task, pseudoinverse.taskSize());
  const ScaledVector a_null = contact.a_scaled - pseudoinverse.expand(contact.a_task);
  contact.k_n = dot(a_null, a_null);
  contact.x_dot_eff_m_per_s = dot(contact.a_task, y_eff, pseudoinverse.taskSize());
}

double invertRegularised(double k, double k_j) noexcept {
  return 1.0 / std::max({k, 1e-3 * k_j, 1e-4});
}

}  // namespace tactus
