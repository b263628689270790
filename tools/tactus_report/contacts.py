"""The contacts of runs, as their summaries tell them."""

HEADS = ["Run", "Link of the module", "From, s", "To, s", "Largest force, N", "Settles in, s",
         "Rests at, N", "Swings by, N", "c, N/m", "c_e, N/m (95 %)", "TCP error max, mm",
         "Null space alone, %", "Task space, %", "T, s", "d"]


def rows(runs):
    """Cells of each contact; empty where a summary of an older version does not tell."""
    return [[run.name, *cells(contact)] for run in runs for contact in run.summary.get("contacts", [])]


def cells(contact):
    def number(key, digits, scale=1.0):
        value = contact.get(key)
        return "" if value is None else f"{scale * value:.{digits}f}"

    def gain(key):
        return "" if contact.get(key) is None else f"{contact[key]:g}"

    return [contact["tactile_module"], number("start_s", 3), number("end_s", 3),
            number("peak_force_N", 2), number("settling_s", 3), number("rest_force_N", 2),
            number("swing_N", 2), number("stiffness_N_per_m", 0), stiffness(contact),
            number("tcp_error_max_m", 1, 1e3), number("null_space_share", 0, 100.0),
            number("task_space_share", 0, 100.0), gain("time_constant_s"), gain("damping")]


def stiffness(contact):
    """c_e with its interval."""
    fit = contact.get("contact_stiffness_N_per_m")
    return "" if fit is None else f"{fit['value']:.0f} ({fit['low']:.0f} to {fit['high']:.0f})"
