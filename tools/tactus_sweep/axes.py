"""What one key of a study takes: values of a list, or of a range."""

import dataclasses
import math

MAX_VALUES = 100_000
WIDEST = 40  # standard deviations beyond which a double has no normal distribution
MOST_CUT = 1e6  # deviations to what from and to leave: above it quantiles lose their digits
DIGITS = 6  # of what is drawn: enough, and a line that reruns it stays short


@dataclasses.dataclass
class Axis:
    """Its settings by the quantile u in [0, 1)."""

    entry: object  # Node of the study
    texts: list  # of a list
    law: str = ""  # "uniform", "log", "normal" of a range
    lower: float = -math.inf
    upper: float = math.inf
    mean: float = 0.0
    deviation: float = 0.0
    is_whole: bool = False

    @property
    def key(self):
        return self.entry.key_set

    def at(self, u):
        """KEY=VALUE"""
        if self.texts:
            return f"{self.key}={self.texts[min(int(u * len(self.texts)), len(self.texts) - 1)]}"
        return f"{self.key}={as_setting(self.value(u), self)}"

    def value(self, u):
        if self.is_whole:
            return min(self.lower + math.floor(u * (self.upper - self.lower + 1)), self.upper)
        if self.law == "log":
            return self.lower * (self.upper / self.lower) ** u
        if self.law == "normal":
            return self.mean + self.deviation * normal_quantile(self, u)
        return self.lower + u * (self.upper - self.lower)

    def ends(self):
        """Settings that have to be possible: all of a list, the ends of a range."""
        if self.texts:
            return [f"{self.key}={text}" for text in self.texts]
        ends = [end for end in (self.lower, self.upper) if math.isfinite(end)] or [self.mean]
        return [f"{self.key}={as_setting(end, self)}" for end in ends]


def as_setting(value, axis):
    if axis.is_whole:
        return str(int(value))
    rounded = float(f"{value:.{DIGITS}g}")
    return repr(min(max(rounded, axis.lower), axis.upper))


def normal_quantile(axis, u):
    """In standard deviations, of what lies between the bounds."""
    from scipy.special import ndtr, ndtri

    low, high = (ndtr((end - axis.mean) / axis.deviation) for end in (axis.lower, axis.upper))
    tiny = 1e-12
    return float(ndtri(min(max(low + u * (high - low), tiny), 1.0 - tiny)))


def read_list(entry):
    items = entry.items("a list of values, or a range")
    if not items:
        raise entry.error("an empty list", "at least one value")
    if len(items) > MAX_VALUES:
        raise entry.error(f"{len(items)} values", f"at most {MAX_VALUES}")
    texts = [item.setting() for item in items]
    found = set()
    for item, text in zip(items, texts):
        value = value_of(text)
        if value in found:
            raise item.error(f"'{text}' is there twice", "each value once")
        found.add(value)
    return Axis(entry, texts)


def value_of(text):
    """0.5 and 0.50 are one."""
    try:
        return float(text)
    except ValueError:
        return text


def read_random(entry):
    """Of a point or a disturbance."""
    if entry.is_list:
        return read_list(entry)
    if entry.is_section and "mean" in entry.entries():
        return read_normal(entry)
    known = entry.section(("from", "to", "scale", "whole"))
    return read_range(entry, known)


def read_range(entry, known):
    for name in ("from", "to"):
        if name not in known:
            raise entry.error(f"without {name}", "{from: NUMBER, to: NUMBER} or a list of values")
    axis = Axis(entry, [], "uniform", known["from"].number(), known["to"].number())
    if axis.lower >= axis.upper:
        raise known["to"].error(f"{axis.upper:g} is not above from, {axis.lower:g}", "a range")
    if "scale" in known:
        axis.law = known["scale"].word("linear or log")
        if axis.law not in ("linear", "log"):
            raise known["scale"].wrong("linear or log")
    if axis.law == "log" and axis.lower <= 0.0:
        raise known["from"].wrong("a number > 0, for the scale is log")
    if not math.isfinite(axis.upper / axis.lower if axis.law == "log" else axis.upper - axis.lower):
        raise known["to"].error("too far from from", "a range that numbers can measure")
    if "whole" in known and known["whole"].flag():
        axis.is_whole = True
        if axis.law == "log":
            raise known["whole"].error("with scale log", "one of them")
        for end in ("from", "to"):
            if known[end].number() % 1.0 or abs(known[end].number()) > 2**53:
                raise known[end].wrong("a whole number")
    return axis


def read_normal(entry):
    known = entry.section(("mean", "standard_deviation", "from", "to"))
    if "standard_deviation" not in known:
        raise entry.error("without standard_deviation", "{mean: NUMBER, standard_deviation: NUMBER}")
    axis = Axis(entry, [], "normal", mean=known["mean"].number(),
                deviation=known["standard_deviation"].number())
    if axis.deviation <= 0.0:
        raise known["standard_deviation"].wrong("a number > 0")
    if "from" in known:
        axis.lower = known["from"].number()
    if "to" in known:
        axis.upper = known["to"].number()
    if not math.isfinite(axis.mean + WIDEST * axis.deviation):
        raise known["standard_deviation"].wrong("a smaller number")
    if axis.upper - axis.lower < axis.deviation / MOST_CUT:
        raise known["standard_deviation"].error("so wide that from and to leave no shape of it", "a range")
    if not axis.lower < axis.mean < axis.upper:
        raise known["mean"].wrong("a number between from and to")
    return axis


def read_grid(entry):
    """All settings of a key of the grid."""
    if entry.is_list:
        return read_list(entry)
    known = entry.section(("from", "to", "count", "scale", "whole"))
    axis = read_range(entry, known)
    if "count" not in known:
        raise entry.error("without count", "how many values there are from from to to")
    count = known["count"].whole(2, MAX_VALUES)
    if axis.is_whole:
        return Axis(entry, whole_steps(axis, known["count"], count))
    texts = [as_setting(axis.value(number / (count - 1)), axis) for number in range(count)]
    if len(set(texts)) < count:
        raise known["count"].error(f"{count} values that {DIGITS} digits do not tell apart", "fewer, or farther apart")
    return Axis(entry, texts)


def whole_steps(axis, entry, count):
    step, rest = divmod(int(axis.upper) - int(axis.lower), count - 1)
    if rest:
        raise entry.error(f"{count} values from {axis.lower:.0f} to {axis.upper:.0f} are not whole",
                          "a count that parts the range evenly")
    return [str(int(axis.lower) + number * step) for number in range(count)]
