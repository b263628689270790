"""What tools/mutate does; see there. How a mutant is judged is in trials.py."""

import collections
import concurrent.futures
import dataclasses
import hashlib
import json
import math
import random
import shutil
import threading

import yaml

import places
from trials import Trials


def code_at(target, file, line):
    return (target.root / file).read_text().splitlines()[line - 1].strip() if line > 0 else ""


def reason_for(target, mutant, listed):
    """Of the list: same file, text of the line and change. `column` where the line has several such places,
    `after`, the line before, where the file has several such lines."""
    for entry in listed:
        if entry["file"] == mutant.file and entry["code"] == code_at(target, mutant.file, mutant.line) and \
                mutant.what in entry["what"] and entry.get("column", mutant.column) == mutant.column and \
                entry.get("after") in (None, code_at(target, mutant.file, mutant.line - 1)):
            return entry
    return None


def version(target, file):
    """Of the source: a result of another is none. Tests may change: to forget what they killed, begin anew."""
    return hashlib.sha256((target.root / file).read_bytes()).hexdigest()[:12]


def version_judged(target, file):
    """A result by other judges is none, either."""
    judges = " ".join(stage.name for stage in target.stages(file))
    return f"{version(target, file)}-{hashlib.sha256(judges.encode()).hexdigest()[:6]}"


class Results:
    """A line of text a mutant, tab between: version, state, by whom, name. Appended, so a run can go on."""

    def __init__(self, path):
        self.path, self.lock, self.known = path, threading.Lock(), {}
        if path.exists():
            for line in path.read_text().splitlines():
                if line.count("\t") == 3:  # not half a line of a run that was ended
                    of, state, by, name = line.split("\t")
                    self.known[of, name] = state, by

    def add(self, of, mutant, state, by):
        with self.lock:
            self.known[of, mutant.name] = state, by
            with self.path.open("a") as file:
                file.write(f"{of}\t{state}\t{by}\t{mutant.name}\n")


def interval_95(killed, all_of):
    """Wilson's, of a share that a sample has."""
    if not all_of:
        return 0.0, 1.0
    z, share = 1.96, killed / all_of
    middle = share + z * z / (2 * all_of)
    half = z * math.sqrt(share * (1 - share) / all_of + z * z / (4 * all_of * all_of))
    return (middle - half) / (1 + z * z / all_of), (middle + half) / (1 + z * z / all_of)


def chosen(mutants, sample, seed):
    """A larger sample of the same seed holds the smaller one."""
    order = sorted(mutants)
    random.Random(seed).shuffle(order)
    return order[:sample] if sample else order


def places_of(target, file, folder):
    """Remembered for this version of the source, as clang reads headers for seconds."""
    known = folder / "places" / f"{file.replace('/', '_')}.{version(target, file)}.json"
    if known.exists():
        return [places.Mutant(*fields) for fields in json.loads(known.read_text())]
    found = places.mutants(target.root / file, target.clang_flags[file], file)
    known.parent.mkdir(exist_ok=True)
    part = known.with_suffix(".part")
    part.write_text(json.dumps([dataclasses.astuple(mutant) for mutant in found]))
    part.rename(known)
    return found


def run(target, folder, options, listed, unnoticed=()):
    """listed: equivalents. unnoticed: what may survive, with what it would do."""
    folder.mkdir(parents=True, exist_ok=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        found = pool.map(lambda file: places_of(target, file, folder), target.files)
        every = [mutant for of_file in found for mutant in of_file]
    stale = [entry for entry in [*listed, *unnoticed]
             if not any(reason_for(target, mutant, [entry]) for mutant in every if mutant.file == entry["file"])
             and entry["file"] in target.files]
    for entry in stale:
        print(f"reason that fits no mutant any more: {entry['file']}: {entry['code']}: {entry['what']}")
    mutants = chosen(every, options.sample, options.seed)
    results = Results(folder / "results.txt")
    versions = {file: version_judged(target, file) for file in target.files}

    def known(mutant):
        return results.known.get((versions[mutant.file], mutant.name))

    open_ones = [mutant for mutant in mutants
                 if (known(mutant) is None or (options.again and known(mutant)[0] == "survived"))
                 and not reason_for(target, mutant, listed)]
    made = folder / "trials"
    shutil.rmtree(made, ignore_errors=True)
    made.mkdir()
    trials = Trials(target, open_ones, made, options.jobs)
    print(f"{len(open_ones)} to try, of which {len(open_ones) - len(trials.with_copy) - len(trials.refused)} are "
          "compiled alone", flush=True)

    def judge(mutant):
        state, by = trials.trial(mutant)
        results.add(versions[mutant.file], mutant, state, by)
        print(f"{mutant.name}: {state}{' by ' if by else ''}{by}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in [pool.submit(judge, mutant) for mutant in open_ones]:
            done.result()
    return stale, table(target, mutants, known, listed, unnoticed, len(every))


def table(target, mutants, known, listed, unnoticed, every):
    counts = collections.Counter()
    print("\n== what is not killed")
    for mutant in sorted(mutants):
        entry = reason_for(target, mutant, listed)
        state = "equivalent" if entry else known(mutant)[0]
        counts[state] += 1
        if state == "survived":
            entry = reason_for(target, mutant, unnoticed)
            counts["without a reason"] += not entry
        if state == "survived" or entry:
            reason = entry["reason"] if entry else "WITHOUT A REASON"
            print(f"{mutant.name}: {state}: {reason}\n    {code_at(target, mutant.file, mutant.line)}")
    judged = counts["killed"] + counts["survived"]
    low, high = interval_95(counts["killed"], judged)
    print(f"\n{every} mutants, {len(mutants)} of them drawn: {counts['killed']} killed, {counts['survived']} survived "
          f"({counts['without a reason']} without a reason), {counts['equivalent']} equivalent, "
          f"{counts['does not compile']} do not compile")
    print(f"score: {counts['killed']} of {judged}, {100 * counts['killed'] / max(1, judged):.1f} %"
          + (f", 95 % interval {100 * low:.1f} to {100 * high:.1f} %" if len(mutants) < every else ""))
    return counts


def read_list(path):
    return yaml.safe_load(path.read_text()) or [] if path.exists() else []
