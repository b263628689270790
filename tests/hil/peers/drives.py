#!/usr/bin/env python3
"""Plays nine CiA 402 drives, node ids 1 to 3 on can0, can1 and can2, until it is told to stop.

usage: drives.py FOLDER [BUS:NODE=COUNTS]...    where the axes stand at power-on, else 0

Writes to FOLDER: `ready` when all have booted; on SIGTERM drives.csv, what each got and answered at
each SYNC, and drives.json, how each was set up and what became of it.
"""
import csv
import gc
import json
import pathlib
import select
import signal
import sys
import time

import can
import canopen

from drive import Drive

BUSES = ("can0", "can1", "can2")
NODE_IDS = (1, 2, 3)
COLUMNS = (
    "t_s", "bus", "node_id", "control_word", "target_velocity", "status_word",
    "position", "velocity", "periods",
)  # fmt: skip
REPORTED = {
    "mode": (0x6060, 0), "interpolation_value": (0x60C2, 1), "interpolation_index": (0x60C2, 2),
    "rpdo1_cob_id": (0x1400, 1), "rpdo1_type": (0x1400, 2),
    "rpdo1_entry1": (0x1600, 1), "rpdo1_entry2": (0x1600, 2),
    "tpdo1_cob_id": (0x1800, 1), "tpdo1_type": (0x1800, 2),
    "tpdo1_entry1": (0x1A00, 1), "tpdo1_entry2": (0x1A00, 2),
    "tpdo2_cob_id": (0x1801, 1), "tpdo3_cob_id": (0x1802, 1), "tpdo4_cob_id": (0x1803, 1),
    "producer_heartbeat": (0x1017, 0), "consumer_heartbeat": (0x1016, 1),
}  # fmt: skip


def receive(network):
    """All frames that wait on a bus, in the library's hands. In this thread, so that frames are
    answered in the order of the bus."""
    while (message := network.bus.recv(timeout=0)) is not None:
        if not message.is_error_frame and not message.is_remote_frame:
            network.notify(message.arbitration_id, message.data, message.timestamp)


def serve(networks, drives):
    by_socket = {network.bus.fileno(): network for network in networks}
    while True:
        ready, _, _ = select.select(list(by_socket), [], [], 0.05)
        for socket in ready:
            receive(by_socket[socket])
        if not ready:
            for drive in drives:
                drive.idle(time.time())


def report(drive):
    return {
        "bus": drive.bus,
        "node_id": drive.node.id,
        "nmt": drive.node.nmt.state,
        "states": drive.power.history,
        "position": drive.position,
        "velocity": drive.velocity,
        "emergencies": drive.emergencies,
        "pdos_of_wrong_length": drive.pdos_of_wrong_length,
        "stops_without_ramp": drive.stops_without_ramp,
        **{name: drive.value(*entry) for name, entry in REPORTED.items()},
    }


def write_results(folder, drives, reports_at_reset):
    with open(folder / "drives.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        writer.writerows(sorted(row for drive in drives for row in drive.rows))
    reports = [
        {**at_reset[0], "resets": len(at_reset)} if at_reset else {**report(drive), "resets": 0}
        for drive, at_reset in zip(drives, reports_at_reset)
    ]
    (folder / "drives.json").write_text(json.dumps(reports, indent=1))


def main():
    folder = pathlib.Path(sys.argv[1])
    positions = dict(argument.split("=") for argument in sys.argv[2:])
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    networks = []
    drives = []
    for bus in BUSES:
        network = canopen.Network(can.Bus(bus, interface="socketcan"))
        networks.append(network)
        for node_id in NODE_IDS:
            position = int(positions.pop(f"{bus}:{node_id}", 0))
            drives.append(Drive(network, bus, node_id, position))
    if positions:
        sys.exit(f"drives.py: no such drive: {', '.join(positions)}")
    reports_at_reset = [[] for _ in drives]
    for drive, reports in zip(drives, reports_at_reset):
        drive.on_reset = lambda drive, reports=reports: reports.append(report(drive))
    gc.disable()  # its pauses would be the drives'
    (folder / "ready").touch()
    try:
        serve(networks, drives)
    finally:
        write_results(folder, drives, reports_at_reset)
        for drive in drives:
            drive.power_off()
        for network in networks:
            network.disconnect()


if __name__ == "__main__":
    main()
