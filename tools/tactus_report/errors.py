"""What is wrong with what the user gave."""


class InputError(Exception):
    """The message is one line."""


def first_line(text):
    return next(iter(str(text).strip().splitlines()), "")
