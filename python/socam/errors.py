"""Exceptions of the package: each message is one sentence that says what, where and what to do.

Arguments of a wrong type raise `TypeError`, values that cannot be meant raise `ValueError`.
"""

__all__ = ["FitError", "ModelError", "RecordingError", "SimulationError", "SocamError"]


class SocamError(Exception):
    """Something that this package cannot work with."""


class RecordingError(SocamError):
    """A recording that cannot be read, is damaged, or lacks a channel."""


class ModelError(SocamError):
    """A model file with a mistake, or a model without equations of motion."""


class FitError(SocamError):
    """Recordings and a model that do not go together, or a fit that cannot be started."""


class SimulationError(SocamError):
    """A simulation that the bench's limits or the solver ended."""
