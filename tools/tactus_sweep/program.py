"""`tactus sweep`."""

import contextlib
import json
import os
import pathlib
import signal
import sys

from tactus._sweep import identity
from tactus_report.whole_file import write_whole

from . import judge, results, scenes, stopped_text, table
from .check import check_candidates
from .pool import Pool, PoolError
from .progress import Progress
from .study import make_plan, read_study
from .study_text import StudyError

DONE, BAD_INPUT, FAULT = 0, 1, 3


class Stopped(BaseException):
    """By SIGTERM or Ctrl-C."""


def stop(number, _):
    raise Stopped(signal.Signals(number).name)


def run_program(arguments):
    """Exit code."""
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, stop)
    if not arguments.output:  # which pathlib takes for the current folder
        return refuse("-:1:1: -o: no folder, expected a path", BAD_INPUT, arguments)
    arguments.output = pathlib.Path(arguments.output)
    try:
        study = read_study(arguments.study)
        plan = make_plan(study, scenes.load_files(study))
        scenes.check_keys(study, plan)
        answer = sweep(study, plan, arguments)
    except StudyError as error:
        return refuse(error, BAD_INPUT, arguments)
    except (results.ResultsError, PoolError) as error:
        return refuse(error, error.exit_code, arguments)
    except OSError as error:
        return refuse(f"{error.filename or arguments.output}: {error.strerror or error}", FAULT, arguments)
    except Stopped as stopped:
        return refuse(stopped_text(stopped), FAULT, arguments)
    code = DONE if answer["completed"] else FAULT
    return code if say(json.dumps(answer) if arguments.json else text_of(answer)) else FAULT


def refuse(error, exit_code, arguments):
    with contextlib.suppress(OSError):  # there is nobody left to tell
        print(error, file=sys.stderr)
    if arguments.json:
        say(json.dumps({"done": False, "error": str(error)}))
    return exit_code


def say(text):
    """False: it cannot be written. Who has gone ends this, as of the other commands."""
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    try:
        print(text, flush=True)
    except OSError:
        print("standard output: cannot be written", file=sys.stderr)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or it is tried once more
        return False
    return True


def sweep(study, plan, arguments):
    me = identity()
    kept = results.Results(arguments.output, results.header_of(plan, me))
    before = len(kept.rows)
    try:
        if kept.damaged and before < plan.runs:  # the lines stay when their runs have been done again
            print(f"{kept.path}: {kept.damaged} damaged lines, their runs are done again", file=sys.stderr)
        compute(plan, kept, arguments, me)
    finally:
        kept.close()
    rows = [kept.rows[run] for run in range(plan.runs)]
    judge.judge(study, rows)
    write_whole(arguments.output / table.NAME, table.table_text(study, plan, rows))
    shown = judge.candidates(plan, rows)[:judge.SHOWN]
    checks = check_candidates(study, plan, shown)
    from . import study_page  # takes a second

    write_whole(arguments.output / study_page.NAME, study_page.build_page(study, plan, rows, checks))
    return {**answer_of(study, plan, rows, plan.runs - before, arguments.output),
            "best": best_of(study, plan, shown[0], checks[0])}


def compute(plan, kept, arguments, me):
    pending = [run for run in range(plan.runs) if run not in kept.rows]
    if not pending:
        return
    progress = Progress(len(kept.rows), plan.runs)
    pool = make_pool(plan, arguments, me)
    try:
        for rows in pool.rows(pending):
            kept.add(rows)
            progress.show(len(kept.rows))
    finally:
        progress.end()
        pool.close()


def make_pool(plan, arguments, me):
    if arguments.scheduler is None:
        return Pool(plan, arguments.jobs or len(os.sched_getaffinity(0)), me)
    try:
        from .dask_pool import DaskPool
    except ModuleNotFoundError as error:
        raise PoolError(f"{error}; install it: apt-get install python3-distributed", FAULT) from error
    return DaskPool(plan, arguments.scheduler, me)


def answer_of(study, plan, rows, run_now, folder):
    outcomes = [row["outcome"] for row in rows]
    return {"done": True, "runs": plan.runs, "run_now": run_now, "completed": outcomes.count("completed"),
            "refused": outcomes.count("refused"), "failed": outcomes.count("failed"),
            "faults": sum(outcome not in ("completed", "refused", "failed") for outcome in outcomes),
            "within_limits": sum(row["is_within"] for row in rows),
            "notes": judge.notes(study, rows), "table": str(folder / table.NAME),
            "report": str((folder / "report.html").resolve())}


def best_of(study, plan, best, check):
    return {"is_fit": best.is_fit, "candidate": judge.candidate_text(study, plan, best.worst),
            "run": best.worst["run"], "set": plan.settings(best.worst["run"]),
            judge.FORCE: known(best.force_N), judge.ERROR: known(best.error_m),
            "objective": known(best.objective), "phase_margin_deg": check.margin_deg, "refusal": check.refusal or None}


def known(value):
    return value if value < float("inf") else None


def text_of(answer):
    best = answer["best"]
    lines = [f"{answer['runs']} runs, {answer['run_now']} of them now: {answer['completed']} completed, "
             f"{answer['within_limits']} within the limits, {answer['faults']} with a fault, "
             f"{answer['refused']} refused, {answer['failed']} failed"]
    if best["objective"] is not None:
        lines.append(f"best: {best['candidate']}" + ("" if best["is_fit"] else " (not within the limits)")
                     + (f" (refused by tactus check: {best['refusal']})" if best["refusal"] else ""))
    return "\n".join([*lines, *answer["notes"], f"table: {answer['table']}", f"report: {answer['report']}"])


