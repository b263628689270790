"""The report of a study: one HTML page that needs nothing else."""

import collections
import html
import math
import shlex

import matplotlib
from tactus_report.document import html_page, table
from tactus_report.figures import BLUE, GRID, RED, as_figure, as_svg, new_figure

from .judge import (ERROR, FORCE, SHOWN, candidate_of, candidate_text, candidates, completed, front, notes,
                    sensitivities)
from .table import scene_name

NAME = "report.html"
MAX_DOTS = 2000
MAX_FRONT_ROWS = 30
SCENES_OPEN = 3
FIGURE_HEADS = ["Peak force, N", "TCP error, mm", "Unsensed, N", "Path left, s", "Objective"]


def build_page(study, plan, rows, checks):
    """`rows` as judged, by their number; `checks` of the best."""
    found = candidates(plan, rows)
    best = front(found)
    body = [f"<h1>Study {html.escape(study.path.stem)}</h1>", summary(study, plan, rows, found),
            "<h2>Peak force against TCP error</h2>", front_figure(found, best), front_table(study, plan, best),
            *sensitivity_section(study, plan, rows),
            f"<h2>The best {min(SHOWN, len(found))}</h2>", best_table(study, plan, found, checks),
            *worst_section(study, plan, rows), *reasons_section(rows)]
    return html_page(f"Tactus study {study.path.stem}", body)


def summary(study, plan, rows, found):
    outcomes = collections.Counter(row["outcome"] for row in rows)
    text = f"{len(rows)} runs: " + ", ".join(f"{count} {name}" for name, count in sorted(outcomes.items()))
    sizes = [(len(plan.scenes), "scenes"), *zip(map(len, plan.parts), ("places of the grid", "points",
                                                                       "disturbances"))]
    text += ". " + " times ".join(f"{size} {name}" for size, name in sizes if size > 1) + "."
    if study.limits:
        limits = ", ".join(f"{name} at most {limit:g}" for name, limit in study.limits.items())
        text += (f" Limits: {limits}. {sum(row['is_within'] for row in rows)} runs and "
                 f"{sum(one.is_fit for one in found)} of {len(found)} candidates keep them.")
    terms = " + ".join(name if weight == 1.0 else f"{weight:g} {name}" for name, weight in study.objective.items())
    text += f" Objective, as small as can be: {terms}. A candidate's figures are the worst of its runs."
    return "\n".join(f"<p>{html.escape(text)}</p>" for text in [text, *(f"{note}." for note in notes(study, rows))])


def front_figure(found, best):
    """At most MAX_DOTS candidates beside the front: evenly chosen."""
    known = [one for one in found if math.isfinite(one.force_N) and math.isfinite(one.error_m)]
    shown = known[::max(1, math.ceil(len(known) / MAX_DOTS))]
    with matplotlib.rc_context():
        figure, axes = new_figure(3.6)
        axes.set_position((0.085, 0.13, 0.9, 0.83))
        axes.plot([one.force_N for one in shown], [1e3 * one.error_m for one in shown], ".", color=BLUE,
                  markersize=5, alpha=0.5, markeredgewidth=0)
        axes.plot([one.force_N for one in best], [1e3 * one.error_m for one in best], "o-", color=RED,
                  markersize=4, linewidth=1.2, drawstyle="steps-post")
        axes.grid(color=GRID)
        axes.set_xlabel("peak force in N")
        axes.set_ylabel("largest TCP error in mm")
        drawing = as_svg(figure, "front")
    note = f"{len(best)} of {len(known)} candidates, joined: no other has both less force and less error."
    if len(shown) < len(known):
        note += f" Of the others {len(shown)} are drawn."
    return as_figure("front", drawing, "Pareto front.", note)


def figures_of(one):
    return [number(one.force_N), number(1e3 * one.error_m), number(one.unsensed_N), number(one.path_left_s),
            number(one.objective)]


def front_table(study, plan, best):
    rows = [[candidate_text(study, plan, one.runs[0]), *figures_of(one), "yes" if one.is_fit else "no"]
            for one in best[::max(1, math.ceil(len(best) / MAX_FRONT_ROWS))]]
    return table(["On the front", *FIGURE_HEADS, "Within limits"], rows, "front")


def best_table(study, plan, found, checks):
    rows = [[candidate_text(study, plan, one.runs[0]), *figures_of(one), "yes" if one.is_fit else "no", check.text,
             rerun_line(study, plan, one.worst)] for one, check in zip(found, checks)]
    return table(["Candidate", *FIGURE_HEADS, "Within limits", "Check", "Its worst run again"], rows, "best")


def worst_section(study, plan, rows):
    """Runs that were completed; the others have a section of their own."""
    done = list(filter(completed, rows))
    unknown = sum(math.isinf(row["objective"]) for row in done)
    worst = sorted(done, key=lambda row: (math.isinf(row["objective"]), -row["objective"], row["run"]))[:SHOWN]
    if not worst:
        return []
    cells = [[str(row["run"]), scene_name(study, plan, row), *figures_of(candidate_of(None, [row])),
              rerun_line(study, plan, row)] for row in worst]
    return [f"<h2>The worst {len(worst)} runs</h2>",
            *([f"<p>Objective unknown for {unknown} runs: they lack a figure of it.</p>"] if unknown else []),
            table(["Run", "Scene", *FIGURE_HEADS, "Again"], cells, "worst")]


def reasons_section(rows):
    """Of what was not completed: each reason, how often, and one run that has it."""
    groups = {}
    for row in rows:
        if not completed(row):
            groups.setdefault((row["outcome"], row["reason"]), []).append(row["run"])
    if not groups:
        return []
    common = sorted(groups.items(), key=lambda item: (-len(item[1]), item[1]))
    cells = [[outcome, reason, str(len(runs)), str(runs[0])] for (outcome, reason), runs in common[:SHOWN]]
    text = f"<p>{len(common) - SHOWN} further reasons are in the table of all runs.</p>"
    return ["<h2>Not completed</h2>", table(["Outcome", "Reason", "Runs", "First of them"], cells, "reasons"),
            *([text] if len(common) > SHOWN else [])]


def sensitivity_section(study, plan, rows):
    body = []
    for place, (_, name, _) in enumerate(study.scenes):
        found = sensitivities(study, plan, [row for row in rows if plan.place(row["run"])[0] == place])
        if not found:
            continue
        cells = [[one.key, *(number(one.correlation[figure], "{:+.2f}") for figure in (FORCE, ERROR)),
                  *(number(one.share[figure], "{:.2f}") for figure in (FORCE, ERROR))] for one in found]
        listed = table(["Key", "Rank correlation, force", "TCP error", "Share of variance, force", "TCP error"],
                       cells, "sensitivity")
        summary_ = html.escape(name)
        body.append(f"<details{' open' if place < SCENES_OPEN else ''}><summary>{summary_}</summary>\n{listed}"
                    "</details>")
    if not body:
        return []
    return ["<h2>What matters</h2>",
            "<p>Rank correlation (Spearman): +1, the figure rises with the key; 0, it does not, or rises and "
            "falls. Share of variance: what the key alone explains, 0 to 1; what is missing to 1 are keys "
            "together, and what is not linear within a slice of the key.</p>", *body]


def rerun_line(study, plan, row):
    """The command that runs it with a log."""
    scene = study.scenes[plan.place(row["run"])[0]][2].absolute()
    words = ["tactus", "simulate", str(scene), "-o", f"runs/{study.path.stem}", "--name", f"run_{row['run']}"]
    for setting in plan.settings(row["run"]):
        words += ["--set", setting]
    return shlex.join(words)


def number(value, form="{:.4g}"):
    return "" if value is None or not math.isfinite(value) else form.format(value)
