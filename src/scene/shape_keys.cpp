#include "tactus/scene/shape_keys.h"

namespace tactus {

using namespace keys;

namespace {

template <class S>
Row<S> place(const std::string& key, const std::string& doc, Vector3 S::*member) {
  return required(vector3(key, "m", within(-100, 100), doc + ", base frame", member));
}

template <class S>
Row<S> direction(const std::string& key, const std::string& doc, Vector3 S::*member) {
  return vector3(key, "", within(-1e3, 1e3), doc + ", base frame, of any length but 0", member);
}

}  // namespace

Table<SphereConfig> sphereKeys() {
  return {place("center_m", "its centre", &SphereConfig::center_m),
          required(number("radius_m", "m", above(0, 100), "of it", &SphereConfig::radius_m))};
}

Table<PlaneConfig> planeKeys() {
  return {place("point_m", "a point of its surface", &PlaneConfig::point_m),
          required(direction("normal", "out of the obstacle", &PlaneConfig::normal))};
}

Table<LineConfig> obstacleLineKeys() {
  return {place("point_m", "a point on it", &LineConfig::point_m),
          required(direction("direction", "along it", &LineConfig::direction))};
}

Table<PostConfig> postKeys() {
  using Config = PostConfig;
  return {
      place("foot_m", "one end of its axis", &Config::foot_m),
      direction("axis", "from foot to head", &Config::axis),
      required(number("height_m", "m", above(0, 100), "length of its axis", &Config::height_m)),
      number("radius_m", "m", within(0, 100), "around its axis, also at its round ends",
             &Config::radius_m),
  };
}

}  // namespace tactus
