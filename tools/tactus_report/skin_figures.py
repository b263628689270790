"""Runs of arms with several tactile modules: the force of each, a table of the contacts, and the arm drawn
as it was when they pushed most."""

import html

import matplotlib
import numpy as np

from .figures import (BLUE, COLOURS, GREEN, INK, RED, STYLE, WIDTH_IN, Curve, Figure, as_figure, as_svg,
                      line_figure)

MOST_MOMENTS = 4  # drawn of a run
ONE_MOMENT_S = 0.25  # pushes that near in time are in one picture
ARROW_M_PER_N = 0.02
LONGEST_ARROW_M = 0.3
VIEWS = (("from the side", 0, 2), ("from above", 0, 1))  # the axes that are seen
AXES = "xyz"
HEIGHT_IN = 3.2


def of_skins(runs):
    """The runs with more than one module, sorted by name."""
    return sorted((run for run in runs if len(run.modules) > 1), key=lambda run: run.name)


def section(runs):
    """Elements of the page; none without such a run."""
    body = []
    for number, run in enumerate(of_skins(runs)):
        name = f"skin-{number}"
        body += [f"<h3>{html.escape(run.name)}</h3>", force_figure(f"{name}-force", run),
                 *pictures(name, run)]
    return ["<h2>Arms with several tactile modules</h2>", *body] if body else []


def force_figure(name, run):
    curves = [Curve(link, COLOURS[i % len(COLOURS)], "solid", run.time_s, force_N)
              for i, (link, force_N) in enumerate(zip(run.modules, run.forces_N))]
    drawing = line_figure(name, curves, "sensor force in N", "N", label_peak=True)
    return as_figure(name, drawing, "Force on each module.", f"Outcome: {run.summary['outcome']}.")


def pictures(name, run):
    """One figure for each moment; none where the log does not say what the arm is like."""
    if run.arm is None:
        return []
    chain, covers, obstacles = run.arm
    figures = []
    for number, (cycle, link) in enumerate(moments(run)):
        time_s = run.time_s[cycle]
        drawing = draw(f"{name}-arm-{number}", chain, covers, obstacles, run, cycle)
        forces = ", ".join(f"{module} {force_N[cycle]:.1f} N"
                           for module, force_N in zip(run.modules, run.forces_N))
        figures.append(as_figure(f"{name}-arm-{number}", drawing, f"At {time_s:.2f} s.",
                                 f"Where {link} was pushed most. {forces}. Arrows: what pushes on "
                                 f"the arm, {ARROW_M_PER_N:g} m for 1 N. Thick: covers of modules."))
    return figures


def moments(run):
    """(cycle, link) of the largest force of each contact, the earliest ones, in the order of time."""
    found = []
    for contact in run.summary.get("contacts", []):
        if contact["tactile_module"] not in run.modules:
            continue
        force_N = run.forces_N[run.modules.index(contact["tactile_module"])]
        inside = np.flatnonzero((run.time_s >= contact["start_s"]) & (run.time_s <= contact["end_s"]))
        if inside.size:
            found.append((int(inside[force_N[inside].argmax()]), contact["tactile_module"]))
    apart = []
    for cycle, link in sorted(found):
        if not apart or run.time_s[cycle] - run.time_s[apart[-1][0]] > ONE_MOMENT_S:
            apart.append((cycle, link))
    return apart[:MOST_MOMENTS]


def arrows(chain, covers, run, cycle):
    """(point, force) of each module that is pushed, base frame, m and N."""
    poses = chain.poses(run.q[cycle])
    found = []
    for cover, force_N, position_m, direction in zip(covers, run.forces_N, run.positions_m,
                                                     run.directions):
        pose = poses[cover.link]
        if force_N[cycle] > 0.0:
            on_axis = pose[:3, 3] + position_m[cycle] * pose[:3, 0]
            F = pose[:3, :3] @ direction[cycle]
            found.append((on_axis - cover.radius_m * F, force_N[cycle] * F))
    return found


def draw(name, chain, covers, obstacles, run, cycle):
    poses = chain.poses(run.q[cycle])
    way = np.vstack([np.zeros((1, 3)), chain.way(run.q[cycle])])
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(STYLE)
        figure = Figure(figsize=(WIDTH_IN, HEIGHT_IN))
        for number, (title, across, up) in enumerate(VIEWS):
            axes = figure.add_axes((0.08 + 0.49 * number, 0.15, 0.4, 0.75))
            axes.set_aspect("equal", adjustable="datalim")
            axes.set_title(title, fontsize=10)
            axes.set_xlabel(f"{AXES[across]} in m")
            axes.set_ylabel(f"{AXES[up]} in m")
            draw_obstacles(axes, obstacles, across, up)
            axes.plot(way[:, across], way[:, up], "o-", color=INK, linewidth=1.6, markersize=3.0)
            for cover in covers:
                start = poses[cover.link][:3, 3]
                end = start + cover.length_m * poses[cover.link][:3, 0]
                draw_capsule(axes, start, end, cover.radius_m, BLUE, across, up)
            for point, force in arrows(chain, covers, run, cycle):
                draw_arrow(axes, point, force, across, up)
        return as_svg(figure, name)


def draw_obstacles(axes, obstacles, across, up):
    for obstacle in obstacles:
        draw_capsule(axes, obstacle.start, obstacle.end, max(obstacle.radius_m, 0.004), GREEN, across, up)


def draw_capsule(axes, start, end, radius_m, colour, across, up):
    """The outline of all within radius_m of a segment, as it is seen."""
    a, b = (np.array([p[across], p[up]]) for p in (start, end))
    along = b - a
    heading = np.arctan2(along[1], along[0])
    turn = np.linspace(0.5 * np.pi, 1.5 * np.pi, 19)
    angles = np.concatenate([heading + turn, heading + turn + np.pi])
    centres = np.vstack([np.tile(a, (19, 1)), np.tile(b, (19, 1))])
    outline = centres + radius_m * np.column_stack([np.cos(angles), np.sin(angles)])
    axes.fill(outline[:, 0], outline[:, 1], facecolor=colour, edgecolor=colour, alpha=0.35)


def draw_arrow(axes, point, force, across, up):
    """It ends where the force acts."""
    way = ARROW_M_PER_N * force
    way *= min(1.0, LONGEST_ARROW_M / max(np.linalg.norm(way), 1e-9))
    start = point - way
    axes.annotate("", (point[across], point[up]), (start[across], start[up]),
                  arrowprops={"arrowstyle": "-|>", "color": RED, "linewidth": 1.4, "shrinkA": 0, "shrinkB": 0})
