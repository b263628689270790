#include "tactus/control/link_observer.h"

#include <Eigen/Cholesky>

namespace tactus {

void observeLinks(const SerialChain& chain, const GearedLinks& links, const JointVector& q_motor,
                  double step_s, LinkObserverState& state) noexcept {
  const double h = step_s;
  if (state.q.size() == 0) state = {q_motor, JointVector::Zero(q_motor.size()), q_motor};
  ChainPose pose;
  chain.computePose(state.q, pose);
  MassMatrix A;
  computeMassMatrix(chain, pose, links.bodies, A);
  JointVector b = A * state.velocity;
  for (Eigen::Index i = 0; i < q_motor.size(); ++i) {
    const double K = links.gear_stiffness[i], D = links.gear_damping[i];
    b[i] += h * K * (q_motor[i] - state.q[i]) + D * (q_motor[i] - state.q_motor[i]);
    A(i, i) += h * D + h * h * K;
  }
  state.velocity = A.llt().solve(b);
  state.q += h * state.velocity;
  assign(q_motor, state.q_motor);
}

}  // namespace tactus
