#include "tactus/supervisor/cycle_record.h"

#include <algorithm>
#include <cstring>

namespace tactus {
namespace {

template <typename Vector>
void copy(const Vector& from, double* to) noexcept {
  std::memcpy(to, from.data(), static_cast<std::size_t>(from.size()) * sizeof(double));
}

void fillContact(const ContactReport& contact, CycleRecord& record) noexcept {
  record.force_contact_N = contact.force_contact_N;
  record.stiffness_N_per_m = contact.stiffness_N_per_m;
  record.stiffness_raw_N_per_m = contact.stiffness_raw_N_per_m;
  record.gamma = contact.gamma;
  record.k_n = contact.k_n;
  record.k_j = contact.k_j;
  record.k_t = contact.k_t;
  record.x_dot_eff_m_per_s = contact.x_dot_eff_m_per_s;
  record.u_n = contact.u_n;
  record.u_j = contact.u_j;
  record.u_t = contact.u_t;
}

void fillModule(int i, const TactileSample& sample, const ContactPointState& sensed,
                CycleRecord& record) noexcept {
  record.force_sensor_N[i] = sensed.force_N;
  record.contact_position_m[i] = sensed.position_m;
  record.contact_dir_x[i] = sensed.direction.x();
  record.contact_dir_y[i] = sensed.direction.y();
  record.contact_dir_z[i] = sensed.direction.z();
  record.tactile_force_y_N[i] = sample.force_y_N;
  record.tactile_force_z_N[i] = sample.force_z_N;
  record.tactile_moment_y_Nm[i] = sample.moment_y_Nm;
  record.tactile_moment_z_Nm[i] = sample.moment_z_Nm;
  record.tactile_sequence[i] = sample.sequence;
  record.tactile_moment_x_Nm[i] = sample.moment_x_Nm;
}

}  // namespace

void fillRecord(double t_s, const RobotInput& input, const Gains& gains,
                const ControllerOutput& output, const Vector3& tool_error_m,
                CycleRecord& record) noexcept {
  record.t_s = t_s;
  record.task_time_s = t_s;
  copy(input.q_measured, record.q_measured);
  for (int i = 0; i < output.modules; ++i)
    fillModule(i, input.tactile[i], output.sensed[i], record);
  fillContact(output.contact, record);
  copy(output.q_desired, record.q);
  copy(output.velocity, record.dq);
  copy(output.w, record.w);
  copy(output.w_d, record.wd);
  copy(output.w_d_dot, record.wd_dot);
  record.fault = static_cast<std::uint64_t>(output.fault);
  copy(tool_error_m, record.tool_error_m);
  record.path_time_s = output.path_time_s;
  record.modules_lost = output.modules_lost;
  record.speed_share = output.speed_share;
  record.gains = gains;
}

double largestForce_N(const CycleRecord& record, int modules) noexcept {
  return *std::max_element(record.force_sensor_N, record.force_sensor_N + std::max(1, modules));
}

RobotInput recordedInput(const CycleRecord& record, int joints) noexcept {
  RobotInput input;
  input.q_measured = Eigen::Map<const Eigen::VectorXd>(record.q_measured, joints);
  for (int i = 0; i < kMaxTactileModules; ++i) {
    input.tactile[i] = {record.tactile_force_y_N[i],
                        record.tactile_force_z_N[i],
                        record.tactile_moment_y_Nm[i],
                        record.tactile_moment_z_Nm[i],
                        static_cast<std::uint32_t>(record.tactile_sequence[i]),
                        record.tactile_moment_x_Nm[i]};
  }
  return input;
}

}  // namespace tactus
