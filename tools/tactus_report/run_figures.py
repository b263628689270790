"""Figures of any runs, one or several of one scene: force where there was any, and what it cost the task."""

from .figures import COLOURS, Curve, as_figure, line_figure

LINES = ("solid", (0, (5, 2)), (0, (1.2, 1.6)))  # from one round of colours to the next


def render_runs(name, runs):
    """<figure> elements; `name` is unique in the page."""
    figures = []
    if any(run.force_N.any() for run in runs):
        figures.append(figure(f"{name}-force", runs, lambda run: run.force_N, "N", "sensor force",
                              "Contact force"))
    figures.append(figure(f"{name}-error", runs, lambda run: 1e3 * run.tool_error_m, "mm",
                          "TCP error", "Deviation of the tool from its path"))
    return figures


def figure(name, runs, values_of, unit, label, title):
    curves = [Curve(run.name if len(runs) > 1 else label, COLOURS[number % len(COLOURS)],
                    LINES[number // len(COLOURS) % len(LINES)], run.time_s, values_of(run))
              for number, run in enumerate(runs)]
    drawing = line_figure(name, curves, f"{label} in {unit}", unit, label_peak=True)
    outcomes = ", ".join(f"{run.name}: {run.summary['outcome']}" for run in runs)
    changed = "".join(f" {run.name} with --set {run.set_text}." for run in runs if run.overrides)
    return as_figure(name, drawing, f"{title}.", f"Outcome of {outcomes}.{changed}")
