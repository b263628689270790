#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "support/random.h"
#include "tactus/bench/mujoco_model.h"
#include "tactus/sim/obstacle_shape.h"

/// Where a cover meets spheres, planes and posts, how deep and which way, as MuJoCo's own collision
/// functions have it.
namespace tactus::physics {
namespace {

std::string text(const Vector3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}

std::string capsuleText(const Vector3& from, const Vector3& to, double radius_m) {
  return fmt::format(R"(<geom type="capsule" fromto="{} {}" size="{:.17g}"/>)", text(from),
                     text(to), radius_m);
}

std::string geomText(const ObstacleConfig& obstacle) {
  if (const auto& sphere = obstacle.sphere)
    return fmt::format(R"(<geom type="sphere" pos="{}" size="{:.17g}"/>)", text(sphere->center_m),
                       sphere->radius_m);
  if (const auto& plane = obstacle.plane)
    return fmt::format(R"(<geom type="plane" pos="{}" zaxis="{}" size="1 1 1"/>)",
                       text(plane->point_m), text(plane->normal));
  const PostConfig& post = *obstacle.post;
  return capsuleText(post.foot_m, post.foot_m + post.height_m * post.axis, post.radius_m);
}

/// MuJoCo's deepest contact of the cover, as ours.
struct DeepestContact {
  double depth_m = 0.0;
  Vector3 normal = Vector3::Zero();  ///< into the cover
  Vector3 p = Vector3::Zero();       ///< in the middle of what overlaps
};

DeepestContact deepestContact(const ObstacleConfig& obstacle, const CoverAxis& axis) {
  const Vector3 end = axis.p_BaseStart + axis.length_m * axis.direction;
  const MujocoModel model = loadMujoco(
      fmt::format("<mujoco><compiler boundmass=\"1e-6\" boundinertia=\"1e-9\"/><worldbody>{}<body>"
                  "<freejoint/>{}</body></worldbody></mujoco>",
                  geomText(obstacle), capsuleText(axis.p_BaseStart, end, axis.radius_m)));
  const MujocoData data(mj_makeData(model.get()));
  mj_forward(model.get(), data.get());
  DeepestContact deepest;
  for (int i = 0; i < data->ncon; ++i) {
    const mjContact& contact = data->contact[i];
    if (-contact.dist <= deepest.depth_m) continue;
    const double sign = contact.geom2 == 1 ? 1.0 : -1.0;  // the normal leads from geom1 to geom2
    deepest = {-contact.dist, sign * Eigen::Map<const Vector3>(contact.frame),
               Eigen::Map<const Vector3>(contact.pos)};
  }
  return deepest;
}

ObstacleConfig randomObstacle(test::Random& random, int kind, const Vector3& near) {
  ObstacleConfig obstacle;
  if (kind == 0) obstacle.sphere = SphereConfig{near, random.uniform(0.02, 0.2)};
  if (kind == 1) obstacle.plane = PlaneConfig{near, random.unitVector()};
  if (kind == 2)
    obstacle.post = PostConfig{near, random.unitVector(), random.uniform(0.1, 0.5), 0.03};
  return obstacle;
}

TEST(ObstacleShape, MeetsCoversWhereMujocoHasIt) {
  test::Random random(941);
  int met[3] = {0, 0, 0};
  for (int i = 0; i < 1800; ++i) {
    const CoverAxis axis{random.vector<Vector3>(3, -0.3, 0.3), random.unitVector(),
                         random.uniform(0.1, 0.6), 0.06};
    const ObstacleConfig obstacle =
        randomObstacle(random, i % 3, axis.p_BaseStart + random.vector<Vector3>(3, -0.2, 0.3));
    const DeepestContact expected = deepestContact(obstacle, axis);
    const Meeting meeting = ObstacleShape(obstacle).meet(axis, Vector3::Zero());
    if (expected.depth_m == 0.0) {
      ASSERT_LT(meeting.depth_m, 1e-9) << i;
      continue;
    }
    const Vector3 p = axis.p_BaseStart + meeting.position_m * axis.direction;
    ASSERT_NEAR(meeting.depth_m, expected.depth_m, 1e-9) << i;
    ASSERT_LT((meeting.normal_Base - expected.normal).norm(), 1e-7) << i;
    const double to_middle_m = axis.radius_m - 0.5 * meeting.depth_m;
    ASSERT_LT((p - to_middle_m * meeting.normal_Base - expected.p).norm(), 1e-7) << i;
    ++met[i % 3];
  }
  EXPECT_GT(*std::min_element(met, met + 3), 50);
}

}  // namespace
}  // namespace tactus::physics
