#include "tactus/bench/mujoco_model.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <mutex>
#include <stdexcept>

namespace tactus::physics {
namespace {

constexpr double kPostHeight_m = 4.0;  ///< above and below the base
constexpr double kWallHalf_m = 0.2;    ///< of its thickness

// Soft enough to stay shut while it slides: MuJoCo's friction opens a contact by mu times the way
// that is slid in its time constant. A shorter one sticks sooner; a longer one damps less, as
// obstacles do.
constexpr double kContactSteps = 5.0;  ///< of its time constant
constexpr double kContactDamping = 0.4;
constexpr double kContactImpedance = 0.75;

std::string numbers(const Vector3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string place(const Matrix3& R, const Vector3& p) {
  const Eigen::Quaterniond q(R);
  return fmt::format(R"(pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}")", numbers(p), q.w(), q.x(),
                     q.y(), q.z());
}

std::string inertial(const BodyInertia& body) {
  const Matrix3& I = body.I_Com;
  return fmt::format(
      R"(<inertial pos="{}" mass="{:.17g}" fullinertia="{} {:.17g} {:.17g} {:.17g}"/>)",
      numbers(body.p_JointCom), body.mass_kg, numbers(I.diagonal()), I(0, 1), I(0, 2), I(1, 2));
}

/// The joint or, behind a flexible gear, both.
std::string joints(JointType type, const Vector3& axis, const ArmDynamicsConfig& arm, int i) {
  const std::string kind = fmt::format(
      R"(type="{}" axis="{}")", type == JointType::kPrismatic ? "slide" : "hinge", numbers(axis));
  std::string text = fmt::format(R"(<joint name="motor{}" {} armature="{:.17g}"/>)", i, kind,
                                 arm.rotor_inertia[i]);
  if (std::isinf(arm.gear_stiffness[i])) return text;
  return text + fmt::format(R"(<joint name="gear{}" {} stiffness="{:.17g}" damping="{:.17g}"/>)", i,
                            kind, arm.gear_stiffness[i], arm.gear_damping[i]);
}

/// Covers collide with posts, and with nothing else.
std::string cover(const MujocoCover& cover) {
  const Pose& X = cover.link.X_JointFrame;
  return fmt::format(
      R"(<geom type="capsule" size="{:.17g}" fromto="{} {}" mass="0" contype="1" conaffinity="0" friction="0"/>)",
      cover.radius_m - kPostRadius_m, numbers(X.p_AB),
      numbers(X.p_AB + cover.length_m * X.R_AB.col(0)));
}

std::string post(const MujocoPost& post) {
  std::string text = fmt::format(R"(<body pos="{}">)", numbers(post.p_Base));
  for (int i = 0; i < 3; ++i)
    text += fmt::format(R"(<joint type="slide" axis="{}"/>)", numbers(Vector3::Unit(i)));
  return text +
         fmt::format(
             R"(<geom {} mass="{:.17g}" contype="0" conaffinity="1" friction="{:.17g}"/></body>)",
             post.geom, post.mass_kg, post.friction_coefficient);
}

/// A box whose face is at the plane, as wide as no arm.
std::string wallGeom(const Vector3& normal) {
  const Matrix3 R = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitX(), normal).toRotationMatrix();
  return fmt::format(R"(type="box" size="{:.17g} 4 4" {})", kWallHalf_m + kPostRadius_m,
                     place(R, -kWallHalf_m * normal.normalized()));
}

/// A body a joint, each in the one before.
std::string bodies(const SerialChain& chain, const ArmDynamicsConfig& arm,
                   const MujocoWorld& world) {
  ChainPose pose;  // with all joints at 0
  chain.computePose(JointVector::Zero(chain.size()), pose);
  Matrix3 R_BaseParent = Matrix3::Identity();
  Vector3 p_BaseParent = Vector3::Zero();
  std::string text;
  for (int i = 0; i < chain.size(); ++i) {
    const Matrix3& R = pose.R_BaseJoint[i];
    const Vector3 p = pose.p_BaseJoint[i];
    text += fmt::format("<body {}>", place(R_BaseParent.transpose() * R,
                                           R_BaseParent.transpose() * (p - p_BaseParent)));
    text += inertial(arm.bodies[i]);
    text += joints(chain.type(i), R.transpose() * pose.axis_Base[i], arm, i);
    for (const MujocoCover& one : world.covers)
      if (one.link.joint == i) text += cover(one);
    R_BaseParent = R;
    p_BaseParent = p;
  }
  for (int i = 0; i < chain.size(); ++i) text += "</body>\n";
  return text;
}

}  // namespace

MujocoPost mujocoPost(const ObstacleConfig& obstacle, double mass_kg) {
  const double mu = obstacle.friction_coefficient;
  if (obstacle.line || obstacle.post) throw std::invalid_argument("no such obstacles here");
  if (const auto& sphere = obstacle.sphere) {
    const double radius_m = sphere->radius_m + kPostRadius_m;
    return {sphere->center_m, fmt::format(R"(type="sphere" size="{:.17g}")", radius_m), mass_kg,
            mu};
  }
  if (const auto& plane = obstacle.plane)
    return {plane->point_m, wallGeom(plane->normal), mass_kg, mu};
  return {Vector3(obstacle.x_m, obstacle.y_m, 0.0),
          fmt::format(R"(type="capsule" size="{}" fromto="0 0 {} 0 0 {}")", kPostRadius_m,
                      -kPostHeight_m, kPostHeight_m),
          mass_kg, mu};
}

double contactStiffness(const mjModel& model, int body, int other_body) {
  const double inverse_mass =
      model.body_invweight0[2 * body] + model.body_invweight0[2 * other_body];
  const double time_s = kContactSteps * kContactDamping * model.opt.timestep;
  return 1.0 / ((1.0 - kContactImpedance) * time_s * time_s * inverse_mass);
}

/// What sticks creeps: by this impratio friction that holds relaxes in minutes, with 1e4 in
/// seconds. With 1e7 MuJoCo's solver gives wrong forces.
std::string mujocoText(const SerialChain& chain, const ArmDynamicsConfig& arm,
                       const MujocoWorld& world) {
  for (const MujocoCover& one : world.covers)
    if (one.link.joint < 0) throw std::invalid_argument("a cover has to move with a joint");
  std::string text = fmt::format(
      R"(<mujoco><compiler angle="radian"/>
<option timestep="{:.17g}" gravity="0 0 0" integrator="implicit" cone="elliptic" impratio="300000"/>
<default><geom solref="{:.17g} {:.17g}" solimp="{:.17g} {:.17g} 0.001" condim="3"/></default>
<worldbody>)",
      world.step_s, kContactSteps * world.step_s, kContactDamping, kContactImpedance,
      kContactImpedance);
  text += bodies(chain, arm, world);
  for (const MujocoPost& one : world.posts) text += post(one) + "\n";
  text += "</worldbody><actuator>\n";
  for (int i = 0; i < chain.size(); ++i)
    text += fmt::format(
        R"(<general joint="motor{}" gainprm="1" biastype="affine" biasprm="0 0 0"/>)", i);
  return text + "</actuator></mujoco>\n";
}

MujocoModel loadMujoco(const std::string& text) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  // It would write them to a file of its own; MujocoRobot::isSound() tells.
  mju_user_warning = [](const char*) {};
  constexpr char kName[] = "arm.xml";
  const auto files = std::make_unique<mjVFS>();  // hundreds of kilobytes
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(text.size()));
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), kName)], text.data(), text.size());
  char error[1000] = "";
  MujocoModel model(mj_loadXML(kName, files.get(), error, sizeof error));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

}  // namespace tactus::physics
