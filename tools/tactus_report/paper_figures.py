"""The paper's figures 2 to 8, and ours beyond it: which runs, what of them, and what to see."""

import dataclasses
import html

from .figures import BLUE, GREEN, ORANGE, RED, Curve, as_figure, line_figure

DASHED, DOTTED, SOLID, DASH_DOT = (0, (5, 2)), (0, (1.2, 1.6)), "solid", (0, (6, 2, 1.2, 2))


@dataclasses.dataclass
class PaperFigure:
    number: int
    title: str
    what_to_see: str
    quantity: str  # attribute of Run
    y_label: str
    unit: str
    curves: list  # (scene, label, colour, line); broken lines last, to show what lies below
    log_axis: bool = False
    label_peak: bool = False  # name the largest value beside a curve, not the last one

    def shows_any_of(self, runs):
        return any(scene in runs for scene, *_ in self.curves)


NONE = ("scenario1_none", "no controller", RED, DASH_DOT)
NULL = ("scenario1_null_space", "null space", GREEN, DASHED)
JOINT = ("scenario1_joint_space", "joint space", BLUE, SOLID)
MULTI = ("scenario1_multi_space", "multi-space", ORANGE, SOLID)
ASSUMED_2 = ("scenario2_assumed", "assumed", BLUE, DASHED)
ESTIMATED_2 = ("scenario2_estimated", "estimated", ORANGE, SOLID)
ASSUMED_3 = ("scenario3_assumed", "assumed", BLUE, DASHED)
ESTIMATED_3 = ("scenario3_estimated", "estimated", ORANGE, SOLID)
FAST_3 = ("scenario3_estimated_fast", "estimated, fast", GREEN, DASH_DOT)
LIMIT_1 = ("scenario1_tactus", "approach limit", BLUE, DASHED)
LIMIT_2 = ("scenario2_tactus", "approach limit", BLUE, DASHED)
LIMIT_3 = ("scenario3_tactus", "approach limit", BLUE, DASHED)
LIMIT_FAST_3 = ("scenario3_tactus_fast", "limit, fast", RED, DOTTED)

LEVEL_1 = ("scenario1_acceleration", "acceleration", BLUE, DASHED)
LEVEL_2 = ("scenario2_acceleration", "acceleration", BLUE, DASHED)
LEVEL_3 = ("scenario3_acceleration", "acceleration", BLUE, DASHED)

FORCE = ("force_N", "sensor force in N", "N")
JERK = ("joint_jerk", "norm of the joints' jerk", "")
STIFFNESS = ("stiffness_N_per_m", "stiffness in N/m", "N/m")

FIGURES = [
    PaperFigure(
        2, "Scenario 1, soft band: contact force",
        "Without control the force follows the band. The null space takes off a third and the tool "
        "stays on its path; multi-space gives way slowly above 5 N; joint space lets go of the "
        "task for the smallest force.",
        *FORCE, [NONE, MULTI, NULL, JOINT]),
    PaperFigure(
        3, "Scenario 1: squared joint velocities",
        "The price of a small force is joint motion, highest in joint space. Null space and "
        "multi-space are the same until the force threshold. The sum mixes m/s and rad/s, as in "
        "the paper.",
        "joint_speed_squared", "squared norm of the command", "", [NONE, MULTI, NULL, JOINT],
        label_peak=True),
    PaperFigure(
        4, "Scenario 1: deviation of the tool from its path",
        "Joint space leaves the path at once and far; multi-space only after the force has passed "
        "its threshold, and gradually.",
        "tool_error_m", "TCP error in m", "m", [JOINT, MULTI]),
    PaperFigure(
        5, "Scenario 2, soft band then profile: contact force",
        "The profile is reached at 8 s. With the assumed stiffness of 7000 N/m the reaction is too "
        "slow; the estimate halves the peak. Both come to rest at 5 N.",
        *FORCE, [ESTIMATED_2, ASSUMED_2], label_peak=True),
    PaperFigure(
        6, "Scenario 2: stiffness",
        "The estimate finds the band's 30 N/m, then rises within tenths of a second at the "
        "profile.",
        *STIFFNESS, [ESTIMATED_2, ASSUMED_2], log_axis=True),
    PaperFigure(
        7, "Scenario 3, profile alone: contact force",
        "Estimation cuts the peak by more than half; even at 2.4 times the speed it stays below "
        "the peak without estimation.",
        *FORCE, [ESTIMATED_3, ASSUMED_3, FAST_3], label_peak=True),
    PaperFigure(
        8, "Scenario 3: stiffness",
        "Foam and profile are averaged. At its peak force the fast run has gone deeper, and its "
        "estimate holds more of the profile than the slow one's.",
        *STIFFNESS, [ESTIMATED_3, ASSUMED_3, FAST_3], log_axis=True),
]

BEYOND_FIGURES = [
    PaperFigure(
        9, "Scenario 1, soft band: contact force with the approach-speed limit",
        "The force goes to 5 N and stays there, where the paper's law overshoots and comes back "
        "slowly.",
        *FORCE, [MULTI, LIMIT_1], label_peak=True),
    PaperFigure(
        10, "Scenario 2, soft band then profile: contact force with the approach-speed limit",
        "At the profile the tool stops approaching before the force has passed its threshold.",
        *FORCE, [ESTIMATED_2, LIMIT_2], label_peak=True),
    PaperFigure(
        11, "Scenario 3, profile alone: contact force with the approach-speed limit",
        "Neither the stiff profile nor 2.4 times the speed leads beyond 5 N.",
        *FORCE, [ESTIMATED_3, FAST_3, LIMIT_3, LIMIT_FAST_3], label_peak=True),
]

LEVEL_FIGURES = [
    PaperFigure(
        12, "Scenario 1, soft band: contact force at both levels",
        "The band is far softer than assumed: at the acceleration level the force peaks lower, and "
        "creeps to 5 N.",
        *FORCE, [MULTI, LEVEL_1], label_peak=True),
    PaperFigure(
        13, "Scenario 3, profile alone: contact force at both levels",
        "With the estimate peak and rest are those of the velocity level.",
        *FORCE, [ESTIMATED_3, LEVEL_3], label_peak=True),
    PaperFigure(
        14, "Scenario 3: jerk at both levels",
        "A sample of the sensor is a step of velocity at the velocity level and of acceleration at "
        "the other.",
        *JERK, [ESTIMATED_3, LEVEL_3], label_peak=True),
]


def render(spec, runs):
    """One <figure> element of at least one run. It says which others it lacks."""
    curves = [Curve(label, colour, line, runs[scene].time_s, getattr(runs[scene], spec.quantity))
              for scene, label, colour, line in spec.curves if scene in runs]
    missing = [scene for scene, *_ in spec.curves if scene not in runs]
    name = f"figure-{spec.number}"
    drawing = line_figure(name, curves, spec.y_label, spec.unit, spec.log_axis, spec.label_peak)
    changed = [f"{scene}: {runs[scene].set_text}" for scene, *_ in spec.curves
               if scene in runs and runs[scene].overrides]
    notes = "".join(f'<p class="missing">{word}: {html.escape(", ".join(found))}</p>'
                    for word, found in (("Missing", missing), ("With --set", changed)) if found)
    return as_figure(name, drawing + notes, f"Figure {spec.number}. {spec.title}.",
                     spec.what_to_see)
