#!/usr/bin/env python3
"""The panel's server against those who should not be heard: other pages, no token, too much, nonsense.

usage: panel_http_test.py TACTUS_PANEL VIRTUAL_DAEMON
"""
import contextlib
import json
import pathlib
import random
import signal
import socket
import sys
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))

from panel_rig import POST, Rig, wait_for  # noqa: E402

DAEMON = pathlib.Path(sys.argv.pop(2)).resolve()
PANEL = pathlib.Path(sys.argv.pop(1)).resolve()
UNREAD = {400, 405, 411, 413, 415}  # refused before the body is read: the answer may be lost with it
SET = {"do": "set", "values": {"controller.damping": "0.55"}}


class Served(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rig = Rig(PANEL, DAEMON)
        cls.addClassCleanup(cls.rig.close)
        cls.rig.start_daemon(POST)
        cls.rig.start_panel()

    def refused(self, status, method, path, body=None, **headers):
        before = self.rig.show()
        got, sent, text = self.rig.ask(method, path, body, **headers)
        if got or status not in UNREAD:
            self.assertEqual(got, status, (path, headers, text))
            self.assertIs(json.loads(text)["done"], False)
            self.assertEqual(sent["Connection"], "close")
        self.assertEqual(self.rig.show(), before)


class Strangers(Served):
    def write(self, status, body=SET, **headers):
        self.refused(status, "POST", "/api/do", body, **headers)

    def test_other_names_of_this_machine(self):
        for host in ("evil.example", "evil.example:80", "127.0.0.1.evil.example", "localhost.evil.example",
                     "localhost@evil.example", "[::1", "127.0.0.1:80:80", "127.0.0.1:", "127.0.0.2", "",
                     "169.254.169.254", "localhost:999999"):
            with self.subTest(host=host):
                self.refused(403, "GET", "/", Host=host)
                self.write(403, Host=host, X_Tactus_Token=self.rig.token)

    def test_its_own_names(self):
        for host in ("127.0.0.1", "localhost", "LocalHost:1", "[::1]:9000", f"127.0.0.1:{self.rig.port}"):
            self.assertEqual(self.rig.ask("GET", "/", Host=host)[0], 200, host)

    def test_no_host_and_two(self):
        for hosts in (b"", b"Host: localhost\r\nHost: evil.example\r\n"):
            answer = self.rig.raw(b"GET / HTTP/1.1\r\n" + hosts + b"\r\n")
            self.assertTrue(answer.startswith(b"HTTP/1.1 403 "), answer)

    def test_other_pages(self):
        for origin in ("http://evil.example", "null", "https://127.0.0.1", "http://127.0.0.1:1", "file://",
                       f"https://127.0.0.1:{self.rig.port}", f"http://localhost:{self.rig.port}",
                       f"http://127.0.0.1:{self.rig.port}.evil.example"):
            with self.subTest(origin=origin):
                self.write(403, Origin=origin, X_Tactus_Token=self.rig.token)
                self.refused(403, "GET", "/api/events", Origin=origin)
        for site in ("cross-site", "same-site", "other"):
            self.refused(403, "GET", "/api/keys", Sec_Fetch_Site=site)
            self.write(403, Sec_Fetch_Site=site, X_Tactus_Token=self.rig.token)

    def test_its_own_page(self):
        origin = f"http://127.0.0.1:{self.rig.port}"
        for path in ("/", "/panel.js", "/api/keys"):
            self.assertEqual(self.rig.ask("GET", path, Origin=origin, Sec_Fetch_Site="same-origin")[0], 200)

    def test_a_page_that_may_not_say_what_it_sends(self):
        for type_name in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data; boundary=a",
                          "application/jsonp", None):
            self.write(415, Content_Type=type_name, X_Tactus_Token=self.rig.token)

    def test_without_the_token(self):
        token = self.rig.token
        for given in (None, "", "0" * 32, token[:-1], token + "0", token.upper() + " ", token * 2):
            if given is not None and given.strip() == token:
                continue
            self.write(401, X_Tactus_Token=given)
        for request in ({"do": "undo"}, {"do": "save"}, {"do": "hold"}, {"do": "move", "to_m": [1, 1, 1]}):
            self.write(401, request)
        self.refused(401, "POST", f"/api/do?token={token}", SET)
        self.refused(401, "POST", "/api/do", SET, Cookie=f"token={token}")

    def test_no_preflight_is_granted(self):
        status, headers, _ = self.rig.ask("OPTIONS", "/api/do", Origin="http://evil.example",
                                          Access_Control_Request_Method="POST")  # fmt: skip
        self.assertEqual(status, 405)
        self.assertFalse([name for name in headers if name.startswith("Access-Control")])

    def test_two_tokens(self):
        head = (f"POST /api/do HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                f"X-Tactus-Token: {self.rig.token}\r\nX-Tactus-Token: 0\r\nContent-Length: 2\r\n\r\n{{}}")
        self.assertTrue(self.rig.raw(head.encode()).startswith(b"HTTP/1.1 401 "))


class Nonsense(Served):
    def test_bodies_that_are_too_long(self):
        for size in (16385, 1 << 20, 1 << 40):
            head = (f"POST /api/do HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                    f"X-Tactus-Token: {self.rig.token}\r\nContent-Length: {size}\r\n\r\n")  # fmt: skip
            answer = self.rig.raw(head.encode() + b" " * min(size, 1 << 20))
            self.assertTrue(answer.startswith(b"HTTP/1.1 413 ") or not answer, answer[:80])
        self.assertEqual(self.rig.ask("GET", "/")[0], 200)

    def test_lengths_that_are_none(self):
        for lengths in (b"", b"Content-Length: -1\r\n", b"Content-Length: 2x\r\n",
                        b"Content-Length: 2\r\nContent-Length: 3\r\n",
                        b"Content-Length: 99999999999999999999999\r\n",
                        b"Transfer-Encoding: chunked\r\n", b"Content-Length: 2\r\nContent-Encoding: gzip\r\n"):
            head = (b"POST /api/check HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n" +
                    lengths + b"\r\n{}")  # fmt: skip
            self.assertRegex(self.rig.raw(head), rb"^(HTTP/1\.1 4\d\d |$)", lengths)

    def test_nothing_is_smuggled_behind_a_refused_request(self):
        inner = (f"POST /api/do HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                 f"X-Tactus-Token: {self.rig.token}\r\nContent-Length: {len(json.dumps(SET))}\r\n\r\n"
                 f"{json.dumps(SET)}")  # fmt: skip
        before = self.rig.show()
        for method in ("GET", "POST"):
            outer = f"{method} / HTTP/1.1\r\nHost: evil.example\r\nContent-Length: {len(inner)}\r\n\r\n"
            self.assertLessEqual(self.rig.raw((outer + inner).encode()).count(b"HTTP/1.1 "), 1)
        self.assertEqual(self.rig.show(), before)

    def test_bodies_that_are_no_request(self):
        def status(body):
            body = body | {"asked_s": time.monotonic()} if isinstance(body, dict) else body
            return self.rig.ask("POST", "/api/do", body, X_Tactus_Token=self.rig.token)[0]
        for body in ("", "{", "[]", "1", "null", "\x00", "[" * 8000, '{"a":' * 3000, "\u00ff{}"):
            self.assertEqual(status(body.encode("latin-1")), 400, body[:20])
        for body in ({}, {"do": 1}, {"do": "stream"}, {"do": "show"}, {"do": "reload"}, {"do": ["set"]},
                     {"do": "set"}, {"do": "set", "values": {"controller.damping": [1]}},
                     {"do": "set", "values": {"a\nb": "1"}}, {"do": "set", "values": {"controller.damping": "x"}},
                     {"do": "set", "values": {"robot": "/etc/passwd"}}, {"do": "move", "to_m": [1]}):  # fmt: skip
            self.assertEqual(status(body), 422, body)

    def test_checks_that_cannot_be(self):
        for values in ([], 1, {"controller.damping": 1}, {"controller.damping": None}):
            self.assertEqual(self.rig.ask("POST", "/api/check", {"values": values})[0], 422, values)
        for values in ({"no.such": "1"}, {"controller.damping": "nan"}, {"controller.damping": ""},
                       {"controller.variant": "none"}, {"controller.damping": "1e999"}, {"\x1b[31m": "1"}):  # fmt: skip
            status, _, text = self.rig.ask("POST", "/api/check", {"values": values})
            self.assertEqual(status, 200, values)
            self.assertTrue(json.loads(text)["refused"], values)
            self.assertNotIn("\x1b", text)

    def test_paths_that_lead_elsewhere(self):
        for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "//etc/passwd", "/panel.js/..",
                     "/panel.js%00", "/panelxjs", "/dygraph.js", "/index.html", "/api", "/api/", "/api/do/x",
                     "/..%5c..%5cetc%5cpasswd", "/" + "a" * 9000):  # fmt: skip
            status, _, text = self.rig.ask("GET", path)
            self.assertIn(status, (404, 414), path)
            self.assertNotIn("root:", text)

    def test_parts_of_a_file(self):
        for ranges in ("bytes=0-1", "bytes=" + ",".join(["0-"] * 2000)):
            got, _, text = self.rig.ask("GET", "/dygraph.min.js", Range=ranges)
            self.assertEqual(got, 416)
            self.assertLess(len(text), 1_000_000, "the file is 100 kB")  # the library cuts the refusal, too

    def test_other_methods(self):
        for method in ("PUT", "DELETE", "PATCH", "TRACE"):
            self.assertIn(self.rig.ask(method, "/")[0], (400, 405), method)
        self.assertEqual(self.rig.ask("GET", "/api/do")[0], 401)
        self.assertEqual(self.rig.ask("GET", "/api/do", X_Tactus_Token=self.rig.token)[0], 200)
        self.assertEqual(self.rig.ask("GET", "/api/check")[0], 404)

    def test_bytes_by_chance(self):
        chance = random.Random(1)
        words = [b"GET ", b"POST ", b"/", b"/api/do", b" HTTP/1.1", b"\r\n", b"Host: localhost", b":", b"{}",
                 b"\r\n\r\n", b"Content-Length: 5", b"\x00", b"\xff\xfe", b"Range: bytes=0-1,5-", b"A" * 9000]
        for _ in range(200):
            self.rig.raw(b"".join(chance.choices(words, k=chance.randint(1, 20))), is_half=True)
        self.assertIsNone(self.rig.panel.poll())
        self.assertEqual(self.rig.ask("GET", "/")[0], 200)

    def test_a_line_without_an_end(self):
        def resident_kB():
            status = pathlib.Path(f"/proc/{self.rig.panel.pid}/status").read_text()
            return int(status.partition("VmRSS:")[2].split()[0]) if "VmRSS:" in status else 0
        most_kB = 0
        with socket.create_connection(("127.0.0.1", self.rig.port)) as connection, contextlib.suppress(OSError):
            for _ in range(1500):
                connection.sendall(b"a" * (1 << 20))
                most_kB = max(most_kB, resident_kB())
        self.assertLess(most_kB, 1 << 20)
        self.rig.stop_panel()  # it has ended, and nothing else
        self.rig.show()
        self.rig.start_panel()


class Late(Served):
    """Requests of whom nobody waits for any more."""

    MOVE = {"do": "move", "relative": True, "to_m": [0, 0.01, 0]}

    def order(self):
        return self.rig.task()["number"]

    def bytes_of(self, request):
        body = json.dumps(request)
        return (f"POST /api/do HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                f"X-Tactus-Token: {self.rig.token}\r\nContent-Length: {len(body)}\r\n\r\n{body}").encode()

    def send_and_leave(self, request):
        with socket.create_connection(("127.0.0.1", self.rig.port)) as connection:
            connection.sendall(self.bytes_of(request))

    def test_events_tell_the_clock(self):
        events = self.rig.events()
        for event in (next(events), next(events)):
            self.assertLess(abs(time.monotonic() - event["now_s"]), 5)
        events.close()

    def test_a_move_that_a_stopped_panel_has_kept_is_not_taken_and_a_hold_is(self):
        before = self.order()
        self.rig.panel.send_signal(signal.SIGSTOP)
        try:
            asked_s = time.monotonic()
            for request in (self.MOVE, self.MOVE, {"do": "hold"}):
                self.send_and_leave(request | {"asked_s": asked_s})
            time.sleep(6)
        finally:
            self.rig.panel.send_signal(signal.SIGCONT)
        wait_for("a hold", lambda: self.order() > before)
        time.sleep(1)
        self.assertEqual((self.order(), self.rig.task()["state"]), (before + 1, "holding"))

    def test_only_what_was_asked_just_now_is_taken_but_a_hold_always(self):
        for do in (self.MOVE, SET, {"do": "undo"}, {"do": "save"}):
            for asked_s, reason in ((time.monotonic() - 6, "came late"), (0, "came late"),
                                    (time.monotonic() + 6, "asked_s"), ("1", "asked_s"), (None, "asked_s")):
                before = self.rig.show(), self.order()
                status, _, text = self.rig.ask("POST", "/api/do", do | {"asked_s": asked_s},
                                               X_Tactus_Token=self.rig.token)  # fmt: skip
                self.assertEqual(status, 422, (do, asked_s))
                self.assertIn(reason, json.loads(text)["error"])
                self.assertEqual((self.rig.show(), self.order()), before)
        for asked in ({}, {"asked_s": 0}, {"asked_s": None}, {"asked_s": 1e300}, {"asked_s": "x"}):
            status = self.rig.ask("POST", "/api/do", {"do": "hold"} | asked, X_Tactus_Token=self.rig.token)[0]
            self.assertEqual(status, 200, asked)


if __name__ == "__main__":
    unittest.main()
