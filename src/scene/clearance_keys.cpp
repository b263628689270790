#include "tactus/scene/clearance_keys.h"

#include "tactus/scene/key_words.h"
#include "tactus/scene/shape_keys.h"

namespace tactus {
namespace {

using namespace keys;

Table<KeepOutSection> keepOutKeys() {
  using Config = KeepOutSection;
  return {
      optional(section("plane", "a wall: all that is behind a plane", &Config::plane, planeKeys())),
      optional(section("sphere", "in place of plane: a ball", &Config::sphere, sphereKeys())),
      optional(section("post", "in place of plane: a round bar of finite length", &Config::post,
                       postKeys())),
      choice("for", "all: every link keeps clear of it; tool: what moves with the last joint",
             &Config::links, kKeptLinksWords),
  };
}

Table<ExcludedPair> excludedKeys() {
  return {text("link", "a link with collision_capsules", &ExcludedPair::link),
          text("other", "the one that it may touch", &ExcludedPair::other)};
}

Table<ClearanceAvoidance> avoidKeys() {
  using Config = ClearanceAvoidance;
  return {
      withSymbol("d_a", number("distance_m", "m", above(0, 100),
                               "distance from which on the null space does it, and the more the "
                               "less is left",
                               &Config::distance_m)),
      number("gain_per_s", "1/s", within(0, 1000),
             "how fast what is lacking to distance_m is made good, with levers of 0.3 m",
             &Config::gain_per_s),
  };
}

Table<ClearanceSection> clearanceKeys() {
  using Config = ClearanceSection;
  return {
      withSymbol("d_s", number("safe_distance_m", "m", within(0, 10),
                               "between surfaces of collision_capsules and what they keep clear "
                               "of: never less, also where the arm stops",
                               &Config::safe_distance_m)),
      withSymbol("d_i", number("influence_distance_m", "m", above(0, 100),
                               "from which on links are slowed down towards each other, to nothing "
                               "at safe_distance_m",
                               &Config::influence_distance_m)),
      optional(section("avoid",
                       "keeps links apart early, in the null space; absent: they are only slowed "
                       "down",
                       &Config::avoid, avoidKeys())),
      boolean("self_collision",
              "all links keep clear of each other, but neighbours and those that always touch",
              &Config::self_collision),
      sectionList("exclude", {0, 256}, "links that may touch each other, besides", &Config::exclude,
                  excludedKeys()),
      sectionList("keep_out", {0, 64}, "walls and bodies to keep clear of, which do not move",
                  &Config::keep_out, keepOutKeys()),
  };
}

}  // namespace

Row<SceneConfig> clearanceSection() {
  return optional(section("clearance",
                          "what the arm must not touch, itself among it; absent: nothing looks",
                          &SceneConfig::clearance, clearanceKeys()));
}

}  // namespace tactus
