#include "tactus/control/contact_controller.h"
#include "tactus/math/velocity_product.h"

/// What the acceleration level makes of a contact.
namespace tactus {

ControlLawOutput ContactController::accelerate(
    const ForceGains& gains, const TaskKinematics& kinematics, const Vector3& p_BaseContact,
    const Vector3& F_Base, const ContactSpace& space, const CommandedMotion& commanded,
    const ControlLawInput& input, double period_s, ControlLawState& state,
    Motion& motion) const noexcept {
  ControlLawOutput u;
  if (!commanded.is_followed) {
    state.It_m_per_s = 0.0;
    return u;
  }
  const VelocityProduct curvature =
      velocityProduct(chain_, kinematics.pose, link_.joint, p_BaseContact, commanded.velocity);
  acceleration_law_->update(gains, input, F_Base.dot(curvature.linear), *commanded.free, kinematics,
                            space, period_s, state, motion, u);
  u.u_n *= law_.nullSpeedLimit().share(gains, u.u_n * space.a_scaled, state.null_speed);
  return u;
}

double ContactController::eased(const ForceGains& gains, const ContactSpace& space,
                                const CommandedMotion& commanded, double period_s,
                                double v_least) const noexcept {
  const double v_before = dot(space.a_scaled, commanded.free->v_before);
  return v_before + velocityShare(gains, period_s) * (v_least - v_before);
}

}  // namespace tactus
