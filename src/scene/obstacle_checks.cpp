#include "tactus/scene/obstacle_checks.h"

#include <fmt/format.h>

#include <string>

namespace tactus {
namespace {

/// An obstacle as its file says it.
struct WrittenObstacle {
  const YamlNode& root;
  const ObstacleConfig& config;
  std::string path;

  bool has(const std::string& key) const { return findGiven(root, path + "." + key) != nullptr; }

  [[noreturn]] void fail(const std::string& key, const std::string& problem,
                         const std::string& expectation) const {
    const std::string full = key.empty() ? path : path + "." + key;
    failAt(locate(root, full), full, problem, "expected " + expectation);
  }
};

constexpr const char* kOneShape = "one of x_m and y_m, sphere, plane, line, post";

void checkShape(const WrittenObstacle& obstacle) {
  std::string first;
  for (const char* shape : {"sphere", "plane", "line", "post"}) {
    if (!obstacle.has(shape)) continue;
    if (!first.empty()) obstacle.fail(shape, "a second shape besides " + first, kOneShape);
    first = shape;
  }
  for (const char* key : {"x_m", "y_m"}) {
    if (!first.empty() && obstacle.has(key))
      obstacle.fail(key, "a second shape besides " + first, kOneShape);
    if (first.empty() && !obstacle.has(key)) obstacle.fail(key, "is missing", kOneShape);
  }
}

void checkDirection(const WrittenObstacle& obstacle, const std::string& key,
                    const Vector3& direction) {
  constexpr double kMinLength = 1e-6;
  if (direction.norm() < kMinLength)
    obstacle.fail(key, "has no length", "a vector other than zero");
}

void checkDirections(const WrittenObstacle& obstacle) {
  const ObstacleConfig& config = obstacle.config;
  if (config.plane) checkDirection(obstacle, "plane.normal", config.plane->normal);
  if (config.line) checkDirection(obstacle, "line.direction", config.line->direction);
  if (config.post) checkDirection(obstacle, "post.axis", config.post->axis);
}

void checkTimes(const WrittenObstacle& obstacle) {
  const ObstacleConfig& config = obstacle.config;
  if (config.vanishes_s > config.appears_s) return;
  obstacle.fail("vanishes_s", fmt::format("{} s is too early", config.vanishes_s),
                fmt::format("more than appears_s = {}", config.appears_s));
}

void checkFoam(const WrittenObstacle& obstacle) {
  const std::vector<FoamLayer>& foam = obstacle.config.foam;
  for (std::size_t k = 1; k < foam.size(); ++k) {
    if (foam[k].until_force_N > foam[k - 1].until_force_N) continue;
    obstacle.fail(fmt::format("foam[{}].until_force_N", k),
                  fmt::format("{} N is not above the layer before", foam[k].until_force_N),
                  fmt::format("more than {} N", foam[k - 1].until_force_N));
  }
}

/// In fewer cycles a turn it would be another swing, or none.
void checkSwing(const WrittenObstacle& obstacle, double period_s) {
  if (obstacle.has("x_m") && obstacle.config.swing.z_m != 0.0)
    obstacle.fail("swing.z_m", "moves a vertical line along itself", "0, or another shape");
  const double most_hz = 0.1 / period_s;
  if (obstacle.config.swing.frequency_hz > most_hz)
    obstacle.fail("swing.frequency_hz", "has less than ten cycles a turn",
                  fmt::format("at most {:g} Hz", most_hz));
}

}  // namespace

void checkObstacles(const YamlNode& root, const std::vector<ObstacleConfig>& obstacles,
                    double period_s) {
  for (std::size_t i = 0; i < obstacles.size(); ++i) {
    const WrittenObstacle obstacle{root, obstacles[i], fmt::format("simulation.obstacles[{}]", i)};
    checkShape(obstacle);
    checkDirections(obstacle);
    checkTimes(obstacle);
    checkFoam(obstacle);
    checkSwing(obstacle, period_s);
  }
}

}  // namespace tactus
