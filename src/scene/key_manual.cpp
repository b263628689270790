#include <fmt/format.h>

#include <cctype>

#include "tactus/scene/key_docs.h"

namespace tactus {
namespace {

/// What a page says besides the keys, as roff.
struct PageText {
  const char* name;  ///< the line under NAME
  const char* description;
  const char* rest;  ///< from EXAMPLES on
};

constexpr PageText kSceneText = {
    R"(what a run of Tactus consists of: robot, task, controller, world)",
    R"(A scene is a YAML file for
.BR tactus (1)
and
.BR tactusd (8).
What it does not name does not exist in the run: without
.B controller
no tactile module is even read.
.PP
A scene that
.B extends
another consists of the differences: sections merge key by key, lists and values replace what was
there, and
.I key\fB: null
drops it.
Keys that are required may then be in either file.
Paths are relative to the file that they stand in.
.PP
.B \-\-set
.IR key = value
of the commands lays one more value over the scene, as in
.BR \-\-set\~simulation.obstacles[0].x_m=0.7 ;
keys of the robot begin with
.BR robot. ,
as in
.BR \-\-set\~robot.drives.joints[0].node_id=3 .
.PP
Keys that are called live or free can be changed while
.BR tactusd (8)
runs, by
.BR tactus\~set :
a live one at once, a free one once nothing was touched for half a second, both on a ramp.
With null_task and null_joint, and as a limit of speed that is raised, a live one waits as a free one does.
All others need a restart.
)",
    R"(.SH EXAMPLES
A band in the way of the arm that gives way in its null space:
.PP
.EX
# yaml\-language\-server: $schema=/usr/share/tactus/schema/scene.schema.json
robot: ../robots/crops9/robot.yaml
task:
  trajectory:
    line: {displacement_m: [0, 0.56, 0], speed_m_per_s: 0.05}
controller:
  variant: null_space
stiffness:
  assumed_N_per_m: 7000
simulation:
  duration_s: 13
  obstacles:
    \- {x_m: 0.70771, y_m: 0.00265, stiffness_N_per_m: 60}
.EE
.PP
The same with another threshold:
.PP
.EX
extends: my_scene.yaml
controller:
  contact_threshold_N: 2
.EE
.SH SEE ALSO
.BR tactus (1),
.BR tactusd (8),
.BR tactus\-robot (5)
)"};

constexpr PageText kRobotText = {
    R"(an arm for Tactus: kinematics, limits, drives, tactile module, lines)",
    R"(A robot is a YAML file, by custom
.IR robot.yaml ,
beside the URDF that it names.
Scenes take it by their key
.BR robot ;
see
.BR tactus\-scene (5).
.PP
Any serial chain of 2 to 16 prismatic, revolute or continuous joints will do.
Dimensions, position limits and velocity limits are those of the URDF; joints count from its base to
.BR tip .
.PP
Without
.B can
the arm only simulates.
With it, the keys of drives, tactile module and lines say what is where, and
.B tactus check
prints what each bus has to carry at worst.
)",
    R"(.SH EXAMPLES
A planar arm that only simulates:
.PP
.EX
# yaml\-language\-server: $schema=/usr/share/tactus/schema/robot.schema.json
urdf: planar2.urdf
tip: tool
home: [0.5, 1.2]
limits:
  acceleration: [20, 20]
.EE
.SH SEE ALSO
.BR tactus (1),
.BR tactusd (8),
.BR tactus\-scene (5)
)"};

constexpr const char* kRules = R"(.PP
Keys carry their units; all values are SI.
A mistake ends every command with one line,
.IR file : line : column ": " key ": what is wrong, what is expected" ;
unknown and duplicate keys are mistakes.
Anchors, aliases, tags and second documents are not accepted.
.PP
.B tactus keys
.I key
prints a part of what follows.
Editors that know JSON schemas check and explain the keys while you type, with the first line of
the example.
Symbols and numbers in parentheses, of equations, are those of the paper: F. Sygulla, C. Schuetz, D. Rixen,
.IR "Adaptive Motion Control in Uncertain Environments using Tactile Feedback" .
)";

/// Text as roff prints it.
std::string roff(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char next = i + 1 < text.size() ? text[i + 1] : ' ';
    const bool is_minus = text[i] == '-' && std::isdigit(static_cast<unsigned char>(next));
    switch (text[i]) {
      case '\\':
        result += "\\e";
        break;
      case '^':
        result += "\\(ha";
        break;
      case '~':
        result += "\\(ti";
        break;
      case '\'':
        result += "\\(aq";
        break;
      default:
        result += is_minus ? "\\-" : std::string(1, text[i]);
    }
  }
  return result.starts_with('.') ? "\\&" + result : result;
}

void addRow(const KeyRow& row, std::string& page) {
  page += fmt::format(".TP\n.B {}\n{}.\n.br\n{}.\n", roff(row.path), roff(keyFacts(*row.spec)),
                      roff(row.spec->doc));
}

/// The keys of the top level, then one part for each of its sections.
std::string describeKeys(const std::vector<KeySpec>& keys) {
  std::string page;
  for (const KeySpec& spec : keys) {
    if (spec.keys.empty()) addRow({spec.key, &spec}, page);
  }
  for (const KeySpec& spec : keys) {
    if (spec.keys.empty()) continue;
    page += fmt::format(".SS {}\n{}: {}.\n", spec.key, roff(keyFacts(spec)), roff(spec.doc));
    if (!spec.same_as.empty()) continue;
    const char* const mark = spec.type == ValueType::kSectionList ? "[]." : ".";
    for (const KeyRow& row : keyRows(spec.keys))
      addRow({spec.key + mark + row.path, row.spec}, page);
  }
  return page;
}

}  // namespace

std::string manualPage(const FileFormat& format) {
  const PageText& text = format.name == "scene" ? kSceneText : kRobotText;
  std::string upper;
  for (const char c : format.name) upper += static_cast<char>(std::toupper(c));
  return fmt::format(
      ".TH TACTUS\\-{} 5 \"\" Tactus \"File formats\"\n.ad l\n"
      ".SH NAME\ntactus\\-{} \\- {}\n.SH DESCRIPTION\n{}{}.SH KEYS\n{}{}",
      upper, format.name, text.name, text.description, kRules, describeKeys(format.keys),
      text.rest);
}

}  // namespace tactus
