"""Worker processes of this machine."""

import contextlib
import json
import os
import pathlib
import queue
import selectors
import subprocess
import sys
import threading
import time

import tactus

BATCH_S = 0.25  # of one worker: short enough to show progress, long enough to cost nothing
MAX_BATCH = 500
BATCHES_AHEAD = 2
GATHER_S = 0.02  # for rows that come one by one are a tenth of what short runs take
START_S = 300  # of a worker: machines that are busy, or far from their disk, take a minute
LOOK_S = 5  # whether one is over
DEATHS = 2  # a run that ends its worker that often has failed


class PoolError(Exception):
    """No worker can go on; one line."""

    def __init__(self, text, exit_code):
        super().__init__(text)
        self.exit_code = exit_code


class Worker:
    def __init__(self, plan_line, environment):
        self.process = subprocess.Popen([sys.executable, "-P", "-m", "tactus._sweep"], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, env=environment)
        os.set_blocking(self.process.stdout.fileno(), False)
        self.batches = []  # lists of runs that it has not answered yet
        self.rest = b""
        self.identity = None  # until it has started
        self.begun_s = time.monotonic()
        self.lines = queue.SimpleQueue()
        self.writer = threading.Thread(target=self.write_lines, daemon=True)
        self.writer.start()
        self.send(plan_line)

    def send(self, line):
        self.lines.put(line)

    def write_lines(self):
        """A pipe does not take a plan with all its scenes where nobody reads."""
        with contextlib.suppress(BrokenPipeError):  # its end is seen where its answers are read
            while line := self.lines.get():
                self.process.stdin.write(line)
                self.process.stdin.flush()

    def is_silent(self):
        return self.identity is None and time.monotonic() - self.begun_s > START_S

    def give(self, numbers):
        self.batches.append(list(numbers))
        self.send(json.dumps(numbers).encode() + b"\n")

    def read(self):
        """Rows that have arrived, and whether it is there still."""
        content = self.process.stdout.read()
        if content is None:
            return [], True
        lines = (self.rest + content).split(b"\n")
        self.rest = lines.pop()
        if lines and self.identity is None:
            self.identity = json.loads(lines.pop(0))
        rows = [json.loads(line) for line in lines]
        for row in rows:
            self.batches[0].remove(row["run"])
            if not self.batches[0]:
                self.batches.pop(0)
        return rows, content != b""

    def end(self):
        """Ends the run that it is at, too."""
        self.process.kill()
        self.process.wait()
        self.send(b"")
        self.writer.join()
        with contextlib.suppress(BrokenPipeError):  # what it has not read any more
            self.process.stdin.close()
        self.process.stdout.close()


class Pool:
    """Computes runs; rows(pending) yields lists of rows as they come."""

    def __init__(self, plan, count, identity):
        self.identity = identity
        self.plan_line = json.dumps(plan.as_json()).encode() + b"\n"
        self.environment = environment()
        self.count = count
        self.selector = selectors.DefaultSelector()
        self.deaths = {}
        self.stillborn = 0
        self.workers = []
        self.rate = 0.0  # runs a second of one worker

    def rows(self, pending):
        """`pending`: numbers of runs, each once. Ends when all have been answered."""
        waiting = list(reversed(pending))
        for _ in range(min(self.count, len(waiting))):
            self.start()
        begin, done, total = time.monotonic(), 0, len(waiting)
        while done < total:
            for worker in self.workers:
                self.feed(worker, waiting)
            rows = []
            self.selector.select(LOOK_S)
            time.sleep(GATHER_S)
            for key, _ in self.selector.select(0):
                rows += self.serve(key.data, waiting)
            for worker in [worker for worker in self.workers if worker.is_silent()]:
                if not any(other.identity for other in self.workers):
                    raise PoolError(f"a worker process has not begun within {START_S} s, as if it hung", 3)
                rows += self.replace(worker, waiting)
            done += len(rows)
            self.rate = done / max(time.monotonic() - begin, 1e-3) / len(self.workers)
            yield rows

    def feed(self, worker, waiting):
        """The last runs are shared out one by one, so that no worker has them alone."""
        while waiting and len(worker.batches) < BATCHES_AHEAD:
            size = min(max(1, int(self.rate * BATCH_S)), MAX_BATCH,
                       max(1, len(waiting) // (2 * len(self.workers))))
            numbers = [waiting.pop() for _ in range(min(size, len(waiting)))]
            worker.give(numbers)

    def serve(self, worker, waiting):
        rows, is_there = worker.read()
        if worker.identity not in (None, self.identity):
            raise PoolError(f"a worker process has tactus {worker.identity['version']}, build "
                            f"{worker.identity['build']}, expected {self.identity['version']}, build "
                            f"{self.identity['build']}", 1)
        return rows if is_there else rows + self.replace(worker, waiting)

    def replace(self, worker, waiting):
        """Of one that has ended: what it was at may be the reason. Rows of runs that have failed."""
        self.forget(worker)
        worker.end()
        if worker.identity is None and not any(other.identity for other in self.workers):
            raise PoolError("a worker process ends before its first run; its own lines above say why", 3)
        left = [run for batch in worker.batches for run in batch]
        failed = []
        if left and worker.identity is not None:  # else it had not begun one
            self.deaths[left[0]] = self.deaths.get(left[0], 0) + 1
            if self.deaths[left[0]] >= DEATHS:
                reason = f"its worker ended with {worker.process.returncode}, {DEATHS} times"
                failed.append({"run": left.pop(0), "outcome": "failed", "reason": reason})
        waiting.extend(reversed(left))
        self.stillborn += worker.identity is None
        if worker.identity is not None or self.stillborn < DEATHS:  # else the others go on alone
            self.start()
        return failed

    def start(self):
        worker = Worker(self.plan_line, self.environment)
        self.workers.append(worker)
        self.selector.register(worker.process.stdout, selectors.EVENT_READ, worker)

    def forget(self, worker):
        self.workers.remove(worker)
        self.selector.unregister(worker.process.stdout)

    def close(self):
        for worker in list(self.workers):
            self.forget(worker)
            worker.end()


def environment():
    """With this tactus, and one thread each."""
    module = str(pathlib.Path(tactus.__file__).parent.parent)
    paths = [module, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
    return os.environ | threads | {"PYTHONPATH": os.pathsep.join(paths), "PYTHONDONTWRITEBYTECODE": "1"}
