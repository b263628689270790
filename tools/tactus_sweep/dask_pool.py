"""Workers of a Dask cluster, which have tactus and read no file: each batch brings its scenes along."""

import logging
import time
from concurrent.futures import CancelledError

import distributed
from tactus._sweep import OtherVersion, run_batch
from tactus._sweep import identity as identity_there

from .pool import PoolError
from .study_text import one_line

BATCH_S = 1.0  # of one thread
MAX_BATCH = 200
BATCHES_AHEAD = 2  # for each thread
CONNECT_S, WORKERS_S = 10, 60


class DaskPool:
    """As Pool."""

    def __init__(self, plan, scheduler, identity):
        # What it says, and what its connections say behind its back once they are gone, this says in one line.
        for name in ("distributed", "distributed.client", "asyncio", "tornado", "tornado.application"):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
        self.plan, self.identity = plan, identity
        self.batches = {}  # future: runs
        try:
            self.client = distributed.Client(scheduler, timeout=CONNECT_S)
            self.client.wait_for_workers(1, timeout=WORKERS_S)
        except (OSError, ValueError, TimeoutError, ImportError, distributed.TimeoutError) as error:
            raise PoolError(one_line(f"{scheduler}: no Dask scheduler with a worker ({error}), expected its "
                                     "address, such as tcp://host:8786"), 3) from error
        self.refuse_others()

    def refuse_others(self):
        answers = self.client.run(identity_there, on_error="return")
        for worker, answer in answers.items():
            if answer != self.identity:
                self.client.close()
                raise other_version(f"worker {worker}", is_identity(answer) or first_line(answer), self.identity)

    def rows(self, pending):
        try:
            yield from self.batches_of(pending)
        except (OSError, CancelledError, distributed.TimeoutError) as error:
            raise lost() from error

    def batches_of(self, pending):
        waiting = list(reversed(pending))
        begin, done, total = time.monotonic(), 0, len(waiting)
        size = 1
        finished = distributed.as_completed([])
        while done < total:
            threads = max(1, sum(self.client.nthreads().values()))
            while waiting and len(self.batches) < BATCHES_AHEAD * threads:
                self.submit(finished, waiting, min(size, max(1, len(waiting) // (2 * threads))))
            future = next(finished)
            rows = self.take(finished, future)
            done += len(rows)
            rate = done / max(time.monotonic() - begin, 1e-3) / threads
            size = max(1, min(int(rate * BATCH_S), MAX_BATCH))
            yield rows

    def submit(self, finished, waiting, size):
        numbers = [waiting.pop() for _ in range(min(size, len(waiting)))]
        jobs = [(number, self.plan.files(number), self.plan.settings(number)) for number in numbers]
        future = self.client.submit(run_batch, self.identity, jobs, pure=False)
        self.batches[future] = numbers
        finished.add(future)

    def take(self, finished, future):
        """Its rows. Where its workers have died, one run of it may be the reason: each is tried alone."""
        numbers = self.batches.pop(future)
        if future.status == "finished":
            return future.result()
        if future.status != "error":
            raise lost()
        error = future.exception()
        if not isinstance(error, distributed.KilledWorker):  # the runs' own errors are rows already
            raise unfit(error, self.identity)
        if len(numbers) > 1:
            for number in numbers:
                self.submit(finished, [number], 1)
            return []
        reason = one_line(f"{type(error).__name__}: {first_line(error)}")
        return [{"run": numbers[0], "outcome": "failed", "reason": reason}]

    def close(self):
        try:
            self.client.cancel(list(self.batches))
            self.client.close()
        except (OSError, CancelledError, distributed.TimeoutError):
            pass  # without a scheduler there is nothing to cancel


def lost():
    return PoolError("the Dask scheduler is lost; the runs before are kept, and the same command goes on", 3)


def unfit(error, identity):
    """Of a worker that has joined late, or whose machine has a trouble of its own."""
    if isinstance(error, (OtherVersion, ImportError)):
        return other_version("a worker", first_line(error), identity)
    return PoolError(one_line(f"a worker cannot compute, {type(error).__name__}: {first_line(error)}; the runs "
                              "before are kept, and the same command goes on"), 3)


def is_identity(answer):
    return f"tactus {answer['version']}, build {answer['build']}" if isinstance(answer, dict) else ""


def first_line(error):
    return (str(error).splitlines() or [type(error).__name__])[0]


def other_version(who, has, wanted):
    return PoolError(one_line(f"{who} is refused: {has}, expected tactus {wanted['version']}, build "
                              f"{wanted['build']}"), 1)
