"""Figures and pages of runs and studies."""

import logging

logging.getLogger("matplotlib").setLevel(logging.ERROR)  # no remarks about caches and HOME, as it is imported
