#include "tactus/bench/study.h"

namespace tactus {

const std::vector<Study>& studies() {
  static const std::vector<Study> list = {
      {"pseudoinverse", "error and time of pseudoinverses down to singular", false, true,
       studyPseudoinverse},
      {"step", "one whole control step beside Orocos KDL and a plain SVD", false, true, studyStep},
      {"closed_loop", "force, tool error and stability of scenes against the cycle's period", true,
       true, studyClosedLoop},
      {"stability", "stiff and extreme cases, each with its outcome", false, false, studyStability},
      {"law", "the approach-speed limit beside the paper's law, on bands and profiles", false,
       false, studyLaw},
      {"contact", "null_limit on contacts that rub", false, false, studyContact},
      {"several", "null_limit on contacts of several modules", false, false, studySeveral},
      {"clutter", "reaching among many posts, with modules on all links", false, false,
       studyClutter},
      {"body", "null_limit on the body model of ISO/TS 15066", false, false, studyBody},
      {"physics", "the simulated arm beside MuJoCo", false, false, studyPhysics},
  };
  return list;
}

Table goalTable(const std::vector<StudyResult>& results) {
  Table table{"goals", {"goal", "limit", "measured", "met"}, {}};
  for (const StudyResult& result : results) {
    for (const Goal& goal : result.goals) {
      const bool is_met = goal.measured <= goal.limit;
      table.rows.push_back({goal.text, goal.limit, goal.measured,
                            std::string(goal.measured != goal.measured ? "not measured"
                                        : is_met                       ? "yes"
                                                                       : "no")});
    }
  }
  return table;
}

}  // namespace tactus
