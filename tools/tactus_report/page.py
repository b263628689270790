"""The report of runs."""

import html

from . import comparison, contacts, levels, paper_figures, run_figures, runs, skin_figures
from .document import html_page, number, table, with_unit
from .figures import as_figure, scatter_figure

PAPER_SCENES = {scene for figure in paper_figures.FIGURES for scene, *_ in figure.curves}
OWN_SCENES = {scene for figure in paper_figures.BEYOND_FIGURES + paper_figures.LEVEL_FIGURES
              for scene, *_ in figure.curves}


def build_page(loaded):
    by_scene = runs.by_scene(loaded)
    of_paper = {scene: run for scene, run in by_scene.items() if scene in PAPER_SCENES}
    further = {scene: run for scene, run in by_scene.items() if scene not in PAPER_SCENES}
    groups = runs.of_one_scene(loaded)
    title = "Tactile feedback control"
    if of_paper:
        title += ": the paper&#8217;s experiments, simulated"
    body = [f"<h1>{title}</h1>",
            f"<p>{len(loaded)} {'run' if len(loaded) == 1 else 'runs'} of the controller.</p>",
            *(f'<p class="missing">{html.escape(run.end_text)}.</p>' for run in loaded if run.end_text),
            *comparison_with_paper(by_scene),
            *paper_section(of_paper),
            *beyond_the_paper(by_scene),
            *levels_section(by_scene),
            *overlays(groups),
            "<h2>Error against run time</h2>",
            error_figure(loaded)]
    if of_paper:
        body.append(runs_table([run for run in loaded if run.scene in PAPER_SCENES]))
    body += faults_section(loaded)
    body += unsensed_section(loaded)
    body += skin_figures.section(loaded)
    body += contacts_section(loaded)
    if further:
        body += ["<h2>Further runs, not of the paper</h2>" if of_paper else "<h2>Runs</h2>",
                 runs_table([run for run in loaded if run.scene not in PAPER_SCENES]),
                 *further_figures(further, {group[0].scene for group in groups})]
    return html_page("Tactus report", body)


def comparison_with_paper(by_scene):
    """Nothing where none of the scenes that it compares was run."""
    rows = comparison.compare(by_scene)
    if not rows:
        return []
    sources = comparison.read_data()["sources"]
    return ["<h2>Paper, reference, ours</h2>",
            "<p>The number in front is the paper&#8217;s scenario: 1 a soft band, 2 a softer band and a "
            "stiff profile behind it, 3 the profile alone.</p>",
            comparison_table(rows),
            f'<p class="source">Paper: {html.escape(sources["paper"])}. Reference: '
            f'{html.escape(sources["reference"])}.</p>']


def paper_section(of_paper):
    if not of_paper:
        return []
    return ["<h2>Figures</h2>",
            "<p>Figures 2 to 8 carry the paper&#8217;s numbers.</p>",
            *(paper_figures.render(figure, of_paper) for figure in paper_figures.FIGURES
              if figure.shows_any_of(of_paper))]


def beyond_the_paper(by_scene):
    """The figures that have a subject."""
    limits = {scene for figure in paper_figures.BEYOND_FIGURES for scene, *_ in figure.curves}
    own = {scene: run for scene, run in by_scene.items() if scene in limits - PAPER_SCENES}
    figures = [figure for figure in paper_figures.BEYOND_FIGURES if figure.shows_any_of(own)]
    if not figures:
        return []
    return ["<h2>Beyond the paper</h2>",
            "<p>The approach-speed limit (variant null_limit) beside the paper&#8217;s multi-space "
            "law.</p>",
            *(paper_figures.render(figure, by_scene) for figure in figures)]


def levels_section(by_scene):
    """The acceleration level beside the velocity level; nothing without a run of it."""
    if not levels.shown(by_scene):
        return []
    own = {scene: by_scene[scene] for scene in levels.shown(by_scene)}
    return ["<h2>Acceleration level</h2>",
            "<p>The same law as resolved acceleration (level acceleration). Jerk is the second "
            "difference of the command, of all joints; margins are those of the least stable "
            "loop.</p>",
            table(levels.HEADS, levels.rows(by_scene), "runs"),
            *(paper_figures.render(figure, own) for figure in paper_figures.LEVEL_FIGURES
              if figure.shows_any_of(own))]


def overlays(groups):
    """Runs of one scene, each list in the same figures."""
    if not groups:
        return []
    body = ["<h2>Runs of one scene</h2>",
            "<p>Each curve has the name of its run&#8217;s folder.</p>"]
    for number, group in enumerate(groups):
        body += [f"<h3>{html.escape(group[0].scene)}</h3>",
                 *run_figures.render_runs(f"overlay-{number}", group)]
    return body


def further_figures(further, shown):
    """Of scenes that no figure above shows."""
    own = [run for scene, run in sorted(further.items()) if scene not in OWN_SCENES | shown]
    body = []
    for number, run in enumerate(own):
        body += [f"<h3>{html.escape(run.scene)}</h3>",
                 *run_figures.render_runs(f"run-{number}", [run])]
    return body


def comparison_table(rows):
    cells = [[row.quantity, row.paper, row.reference, row.ours, row.difference] for row in rows]
    return table(["Quantity", "Paper", "Reference", "Ours", "Ours to reference"], cells, "compare")


def error_figure(loaded):
    points = []
    for run in sorted(loaded, key=lambda run: run.name):
        time_ns, error_m = run.summary["step_time_ns"]["median"], run.summary["tcp_error_rms_m"]
        if time_ns is not None and error_m:
            points.append((time_ns / 1e3, 1e3 * error_m, run.name))
    drawing = scatter_figure("figure-error", points, "median time of one control step in µs",
                             "TCP error, rms, in mm")
    return as_figure(
        "figure-error", drawing, "Error against run time.",
        "Each point is a run. The error is the price of a small force, not of a fast step: "
        "it depends on the control variant, the run time on the stages that the scene names. Runs "
        "below half a millimetre keep to their path; what is left is the lag of the drives.")


def runs_table(loaded):
    heads = ["Run", "Outcome", "Peak force, N", "Final force, N", "TCP error rms, mm",
             "TCP error max, mm", "Step median, ns", "Step p99, ns", "Times real time"]
    rows = []
    for run in sorted(loaded, key=lambda run: run.name):
        summary, times = run.summary, run.summary["step_time_ns"]
        rows.append([run.name, summary["outcome"], number(summary["peak_force_N"], 2),
                     number(summary["final_force_N"], 2),
                     number(summary["tcp_error_rms_m"], 3, 1e3),
                     number(summary["tcp_error_max_m"], 3, 1e3), number(times["median"], 0),
                     number(times["p99"], 0), number(summary["real_time_factor"], 0)])
    return table(heads, rows, "runs")


def faults_section(runs):
    """Of the runs that a fault has ended."""
    rows = []
    for run in runs:
        if fault := run.summary.get("fault"):
            unit = fault["unit"] or ""
            rows.append([run.name, fault["name"], number(fault["time_s"], 3),
                         fault["joint"] or fault["bus"] or "", with_unit(fault["value"], unit),
                         with_unit(fault["limit"], unit), fault["description"]])
    heads = ["Run", "Fault", "At, s", "Joint or bus", "Value", "Limit", "In words"]
    return ["<h2>Faults</h2>", table(heads, rows, "faults")] if rows else []


def contacts_section(runs):
    rows = contacts.rows(runs)
    if not rows:
        return []
    return ["<h2>Contacts</h2>",
            "<p>c is what the law took the contact for, at its end; c_e what force and way say, with "
            "the interval of 95 %. Null space alone: of the time that the law answered. Task space: of "
            "the way that the law gave the contact point.</p>",
            table(contacts.HEADS, rows, "contacts")]


def unsensed_section(runs):
    """Of the runs in which obstacles pushed where no module feels it."""
    rows = []
    for run in runs:
        contact = run.summary.get("unsensed_contact")
        if contact and contact["force_N"]:
            rows.append([run.name, contact["link"], str(contact["obstacle"]),
                         number(contact["force_N"], 2), number(contact["t_s"], 3)])
    heads = ["Run", "Link", "Obstacle", "Largest force, N", "At, s"]
    return ["<h2>Contact that no module feels</h2>", table(heads, rows, "unsensed")] if rows else []
