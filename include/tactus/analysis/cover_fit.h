#pragma once

#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"

namespace tactus {

/// A number and its standard deviation.
struct Fitted {
  double value = 0.0, deviation = 0.0;
};

/// What a log without contact says of a cover.
struct CoverEstimate {
  /// Seconds that were used, of a last part half of one or more; all else is zero with fewer than
  /// kMinBlocks.
  int blocks = 0;
  Fitted mass_kg;
  Fitted center_m[3];     ///< in the module's frame
  double residual_N = 0;  ///< root mean square, of one component of the force
  /// The fastest of the readings beside the cover's, moments by half the length. A contact that
  /// begins or ends shows in it.
  double drift_N_per_s = 0.0;
  /// Standard deviation of g - a in the module's frame, m/s^2: along x, which tells the centre, and
  /// across, which tells the mass.
  double change_along = 0.0, change_across = 0.0;
};

/// Mass and centre of a tactile module's cover by least squares, from readings in a slow motion:
///   F_y = m G_y + b_1 + d_1 t,   M_y = m c_z G_x - m c_x G_z + b_3 + d_3 t
///   F_z = m G_z + b_2 + d_2 t,   M_z = m c_x G_y - m c_y G_x + b_4 + d_4 t
///   G = H [ R^T (g - a) ]
/// with the module's filter H, constants b of the tare, d of channels that drift, a of the middle
/// of the cover; moments count by half its length. Deviations by leaving out each second in turn
/// (Tukey's jackknife of 1958), which also sees errors that last, as of a contact,
/// but for what goes evenly with time.
class CoverFit {
 public:
  static constexpr int kMinBlocks = 5;

  CoverFit(const ControllerConfig& config, const TactileModuleConfig& module);

  /// The next cycle, step_s after the one before. q: measured.
  void add(const JointVector& q, const TactileSample& sample, double step_s);
  /// So much time is missing before the next cycle.
  void skip(double missing_s) noexcept {
    poses_ = 0;
    time_s_ += missing_s;
  }

  CoverEstimate estimate() const;

 private:
  /// Of m, m c, b and d.
  using Unknowns = Eigen::Matrix<double, 12, 1>;
  struct Normal {
    Eigen::Matrix<double, 12, 12> A = Eigen::Matrix<double, 12, 12>::Zero();
    Unknowns b = Unknowns::Zero();
    double squares = 0.0, samples = 0.0;
    Vector3 sum = Vector3::Zero(), sum_of_squares = Vector3::Zero();  ///< of G

    void add(const Normal& other, double sign);
  };

  void follow(const JointVector& q, double step_s);
  static void addRow(const Unknowns& row, double reading, Normal& normal);
  static Unknowns solve(const Normal& normal, double& squares);

  SerialChain chain_;
  AttachedFrame link_;
  Vector3 gravity_Base_;
  double middle_m_, filter_cutoff_hz_;
  int poses_ = 0;  ///< in a row, up to two
  std::uint32_t sequence_ = 0;
  double block_s_ = 0.0;  ///< of the newest block
  double time_s_ = 0.0;   ///< since the first cycle
  Vector3 p_Base_, v_Base_;
  Vector3 G_, origin_, s0_, s1_, s2_;
  std::vector<Normal> blocks_;
};

}  // namespace tactus
