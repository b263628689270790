#!/usr/bin/env python3
"""Reaches for a target that may be behind something. Where the arm is held off, it learns from the
contact where that is, goes back, and tries a way round it.

usage: pick_around.py X Y Z     where the tool shall go: m, base frame

Needs nothing but Python, and a running tactusd whose scene has `task: {source: commands}`."""

import json
import math
import os
import socket
import sys
import time

CONTROL = os.path.join(os.environ.get("RUNTIME_DIRECTORY", "/run/tactus"), "control")
CLEARANCE_M = 0.15  # by which a way round leads past a contact
UNDER_WAY = ("moving", "blocked")
HELD_OFF = ("blocked", "given_up")  # it may be given up between two looks that see it moving


class Arm:
    """A running daemon, by docs/control.md: one JSON object a packet."""

    def __init__(self, path=CONTROL):
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.connect(path)

    def ask(self, **request):
        self.socket.send(json.dumps(request).encode())
        answer = json.loads(self.socket.recv(1 << 18))
        if not answer["done"]:
            raise RuntimeError(answer["error"])
        return answer

    def tool(self):
        return self.ask(do="show")["task"]

    def follow(self, *points):
        """Stops at each; returns how that ended: the task, with the contact that held it off."""
        task = self.ask(do="follow", waypoints=[{"to_m": list(point)} for point in points])["task"]
        number, contact = task["number"], None
        while task["state"] in UNDER_WAY or task["waiting"] > 0:
            time.sleep(0.05)
            task = self.tool()
            if task["number"] != number:
                raise RuntimeError("somebody else has told the tool where to go")
            if task["state"] in HELD_OFF:
                contact = task["contact"] or contact
        return task["state"], contact


def ways_round(start, target):
    """Past what was touched: over it, on either side, or below; each a name and three points."""
    for name, axis, by_m in (("over it", 2, CLEARANCE_M), ("nearer", 0, -CLEARANCE_M),
                             ("further out", 0, CLEARANCE_M), ("below it", 2, -CLEARANCE_M)):
        aside, ahead = list(start), list(target)
        aside[axis] += by_m
        ahead[axis] += by_m
        yield name, (aside, ahead, target)


def target_of(words):
    try:
        target = [float(word) for word in words]
    except ValueError:
        target = []
    if len(target) != 3 or not all(map(math.isfinite, target)):
        sys.exit(__doc__)
    return target


def pick(arm, target):
    """Exit code."""
    tool = arm.tool()
    if tool is None:
        raise RuntimeError("the scene's task is a trajectory, expected task.source: commands")
    start = tool["p_BaseTool_m"]
    state, contact = arm.follow(target)
    print(f"straight on: {state}")
    if state == "given_up" and contact:
        print(f"held off by {contact['force_N']:.1f} N on {contact['module']} at "
              f"{[round(x, 3) for x in contact['p_BaseContact_m']]} m")
        for name, points in ways_round(start, target):
            arm.follow(start)
            try:
                state, _ = arm.follow(*points)
            except RuntimeError as refused:
                state = str(refused)
            print(f"{name}: {state}")
            if state == "arrived":
                break
    arm.ask(do="hold")
    return 0 if state == "arrived" else 1


def main():
    target = target_of(sys.argv[1:])
    try:
        return pick(Arm(), target)
    except KeyboardInterrupt:  # a connection of its own: an answer may be on its way in the other
        Arm().ask(do="hold")
        print("held")
        return 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (OSError, RuntimeError) as error:
        sys.exit(f"pick_around: {error}")
