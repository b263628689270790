"""`tactus sweep`."""


def stopped_text(signal_name):
    """What a sweep that a signal ends says, whenever it comes."""
    return f"{signal_name}: stopped; the runs so far are kept, and the same command goes on"
