#!/usr/bin/python3
"""Reads a log and draws its contacts: the force of each tactile module over time, each contact laid over
the others at its touch, and a row of figures for each.

usage: plot_contacts.py RUN.ulg [-o FILE.png]

Needs matplotlib: apt-get install python3-matplotlib"""

import argparse
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

import tactus  # noqa: E402

BEFORE_S, BEHIND_S = 0.3, 2.0


def forces(log):
    """(cycles, modules), N"""
    return log["force_sensor_N"].reshape(log.cycles, -1)


def draw(log, contacts, path):
    t_s, force_N = log["t_s"], forces(log)
    figure, (over_time, at_touch) = plt.subplots(2, figsize=(9, 7), layout="constrained")
    for module, link in enumerate(log.modules):
        over_time.plot(t_s, force_N[:, module], label=link)
    for contact in contacts:
        over_time.axvspan(contact["start_s"], contact["end_s"], alpha=0.1)
        window = (t_s >= contact["start_s"] - BEFORE_S) & (t_s <= contact["start_s"] + BEHIND_S)
        module = log.modules.index(contact["tactile_module"])
        at_touch.plot(t_s[window] - contact["start_s"], force_N[window, module],
                      label=f"{contact['start_s']:.2f} s, {contact['tactile_module']}")
    over_time.set(xlabel="t, s", ylabel="force, N")
    at_touch.set(xlabel="since the touch, s", ylabel="force, N")
    for axes in (over_time, at_touch):
        axes.grid(alpha=0.3)
        if axes.get_legend_handles_labels()[0]:
            axes.legend()
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("log")
    parser.add_argument("-o", "--output", default="contacts.png")
    arguments = parser.parse_args()
    try:
        log = tactus.read_log(arguments.log)
        contacts = log.contacts
        draw(log, contacts, arguments.output)
    except (tactus.ConfigError, OSError, ValueError) as error:  # also of matplotlib: an ending that it cannot
        print(error, file=sys.stderr)
        return 1
    for contact in contacts:
        print(f"{contact['start_s']:8.3f} s to {contact['end_s']:8.3f} s on {contact['tactile_module']}: "
              f"at most {contact['peak_force_N']:.2f} N, settled after {contact['settling_s']:.2f} s")
    print(f"{len(contacts)} contacts, at most {np.max(forces(log), initial=0.0):.2f} N: {arguments.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
