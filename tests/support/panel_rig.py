"""A panel, and a daemon in virtual time for it, for the tests of the panel."""
import contextlib
import http.client
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
POST = ("simulation.obstacles=[{post: {foot_m: [0.70771, -0.08, 0], axis: [0, 0, 1], "
        "height_m: 0.62, radius_m: 0.01}, stiffness_N_per_m: 7000}]")  # fmt: skip
PATIENCE_S = 60


@contextlib.contextmanager
def cut_off_allowed():
    """Who is refused may be; to hang is no refusal."""
    try:
        yield
    except TimeoutError:
        raise
    except OSError:
        pass


def nobody():
    """For subprocess: without the rights of root."""
    return {"user": 65534, "extra_groups": []} if os.geteuid() == 0 else {}


class Rig:
    """Folders of a run, with a copy of the scenes, which are written to."""

    def __init__(self, panel, daemon):
        self.programs = {"panel": panel, "daemon": daemon}
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        shutil.copytree(ROOT / "config", self.folder / "config")
        self.scene = self.folder / "config/scenes/commands.yaml"
        self.runtime = self.folder / "runtime"
        self.runtime.mkdir()
        self.daemon = self.panel = None
        self.runs = 0

    def environment(self):
        return os.environ | {"RUNTIME_DIRECTORY": str(self.runtime)}

    def start_daemon(self, *settings, pace=5, scene=None):
        self.runs += 1
        log = self.folder / f"run{self.runs}"
        log.mkdir()
        command = [self.programs["daemon"], "--log", log, str(pace), scene or self.scene, *settings]
        self.daemon = subprocess.Popen(command, env=self.environment(), text=True,
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        assert self.daemon.stdout.readline() == "running\n"

    def stop_daemon(self, is_killed=False):
        if self.daemon:
            self.daemon.kill() if is_killed else self.daemon.terminate()
            self.daemon.communicate()
        self.daemon = None

    def start_panel(self, *options, **more):
        self.panel = subprocess.Popen([self.programs["panel"], *(options or ["--port", "0"])],
                                      env=self.environment(), text=True, stdout=subprocess.PIPE, **more)
        self.address = self.panel.stdout.readline().strip()
        match = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/#token=([0-9a-f]{32})", self.address)
        if match:
            self.port, self.token = int(match[1]), match[2]

    def stop_panel(self):
        if self.panel:
            self.panel.terminate()
            self.panel.communicate()
        self.panel = None

    def close(self):
        self.stop_panel()
        self.stop_daemon()
        self.scratch.cleanup()

    def raw(self, request, is_half=False):
        """All that comes back for these bytes, before the end or a reset. is_half: no more will come."""
        answer = b""
        with socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_S) as connection:
            with cut_off_allowed():  # while it still sends
                connection.sendall(request)
                if is_half:
                    connection.shutdown(socket.SHUT_WR)
            with cut_off_allowed():
                while piece := connection.recv(65536):
                    answer += piece
        return answer

    def ask(self, method, path, body=None, **headers):
        """(status, headers, text); headers with _ for -; None: it is left out. Status 0: cut off."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        sent = {"Content-Type": "application/json"} if method == "POST" else {}
        sent |= {name.replace("_", "-"): value for name, value in headers.items()}
        body = json.dumps(body) if isinstance(body, (dict, list)) else body
        try:
            connection.request(method, path, body, {k: v for k, v in sent.items() if v is not None})
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read().decode()
        except TimeoutError:  # to hang is no refusal
            raise
        except OSError:
            return 0, {}, ""
        finally:
            connection.close()

    def ask_daemon(self):
        """Its answer to show, past the panel."""
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as connection:
            connection.settimeout(PATIENCE_S)
            connection.connect(str(self.runtime / "control"))
            connection.send(b'{"do": "show"}')
            return json.loads(connection.recv(1 << 18))

    def task(self):
        return self.ask_daemon()["task"]

    def show(self):
        answer = self.ask_daemon()
        return {name: answer[name] for name in ("number", "state", "kept", "ordered")}

    def do(self, request):
        request = request | {"asked_s": time.monotonic()}
        status, _, text = self.ask("POST", "/api/do", request, X_Tactus_Token=self.token)
        return status, json.loads(text)

    def events(self):
        """Objects as they come."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        connection.request("GET", "/api/events")
        answer = connection.getresponse()
        assert answer.status == 200, answer.status
        try:
            while line := answer.readline():
                if line.startswith(b"data: "):
                    yield json.loads(line[6:])
        finally:
            connection.close()

    def open_events(self):
        """Events, with the first one read; None: no place is free."""
        try:
            events = self.events()
            next(events)
            return events
        except AssertionError:
            return None


def wait_for(what, condition, patience_s=PATIENCE_S):
    """The first value that is true."""
    end = time.monotonic() + patience_s
    while not (value := condition()):
        assert time.monotonic() < end, f"never: {what}"
        time.sleep(0.05)
    return value
