"""Options of the functions, as keywords. Written by `python/tests/typed_options.py`; a test compares both."""

from collections.abc import Iterable, Mapping
from os import PathLike
from typing import Literal, TypedDict


class CheckOptions(TypedDict, total=False):
    """Options of `check`.

    input
        Check all channels without a model; this channel is the input.
    ratio_tolerance
        Tolerance of the mean ratio of two speeds against that of the gears, percent [default: 1%].
    """

    input: str | None
    ratio_tolerance: float


class IdentifyOptions(TypedDict, total=False):
    """Options of `identify`.

    fixed
        Fix a parameter at its value in the model or at the given value (SI); may be repeated.
    start_values
        Start value of a parameter (SI); may be repeated.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    method
        Estimation method [default: output-error].
    band
        Frequency band, Hz: report the fit of validation recordings within it; for frequency-domain methods, use only this
        band.
    start
        Start state of each recording [default: free].
    noise
        Known standard deviation of a channel's noise (SI); may be repeated. With a level for every output, inputs without
        one are exact; otherwise the other levels are estimated.
    starts
        Number of start points of the search [default: 6].
    seed
        Seed of the random start points [default: 1].
    budget_s
        Time within which the fit shall end, as in 60s or 10min (0: no end). The best point by then is the result, marked as
        unfinished; methods over frequency are short and have no such end [default: 300.0].
    calibration
        Calibration file with the sensors' uncertainty, which widens the intervals [default: that in the recordings].
    """

    fixed: str | Iterable[str] | Mapping[str, float | str] | None
    start_values: str | Iterable[str] | Mapping[str, float | str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    method: Literal["output-error", "inverse-dynamics", "frf", "etf", "coefficient-match"]
    band: str | tuple[float, float] | None
    start: Literal["free", "equilibrium"]
    noise: str | Iterable[str] | Mapping[str, float | str] | None
    starts: int
    seed: int
    budget_s: float
    calibration: str | PathLike[str] | None


class ResponseOptions(TypedDict, total=False):
    """Options of `response`.

    fixed
        Fix a parameter at its value in the model or at the given value (SI); may be repeated.
    start_values
        Start value of a parameter (SI); may be repeated.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    band
        Frequency band, Hz.
    outputs
        Output channel of the response; may be repeated [default: all, or the output speed for a transfer function].
    reference
        Column of the reference signal, which is free of noise [default: command_V, if the recordings have it].
    period_s
        Period of the excitation, s [default: estimated].
    outliers
        Replace samples by the median of their neighbours if they differ by more than this number of standard deviations.
    low_pass
        Low-pass filter (Butterworth) on all signals: corner in Hz, and order [default order: 4].
    quietest
        Of recordings with the same mean input (within 5 %), use only the one with least noise.
    """

    fixed: str | Iterable[str] | Mapping[str, float | str] | None
    start_values: str | Iterable[str] | Mapping[str, float | str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    band: str | tuple[float, float] | None
    outputs: str | Iterable[str] | None
    reference: str | None
    period_s: float | None
    outliers: float | None
    low_pass: str | tuple[float, float] | None
    quietest: bool


class DiagnoseOptions(TypedDict, total=False):
    """Options of `diagnose`.

    fixed
        Fix a parameter at its value in the model or at the given value (SI); may be repeated.
    start_values
        Start value of a parameter (SI); may be repeated.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    false_alarm_rate
        False alarm rate, 0 to 1: share of complete models for which something may be found [default: 0.01].
    start
        Start state of each recording [default: free].
    tolerance
        Materiality, a fraction of a channel's standard deviation: findings that change every prediction by less are listed
        but do not count as missing physics [default: 0.001].
    most
        Greatest number of effects to add [default: 3].
    why
        Tell of this effect why it is no finding: how far it came in the search, and what the corrected model gains or loses
        with it, fitted to its end; may be repeated.
    seed
        Seed of the random start values [default: 1].
    budget_s
        Time within which the diagnosis shall end, as in 60s or 10min (0: no end). The search gets three quarters of it, and
        what was found by then is the answer, marked as unfinished [default: 600.0].
    """

    fixed: str | Iterable[str] | Mapping[str, float | str] | None
    start_values: str | Iterable[str] | Mapping[str, float | str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    false_alarm_rate: float
    start: Literal["free", "equilibrium"]
    tolerance: float
    most: int
    why: str | Iterable[str] | None
    seed: int
    budget_s: float


class CompareOptions(TypedDict, total=False):
    """Options of `compare`.

    names
        Compare a simulated channel with a measured one of another name; may be repeated.
    offset_s
        Seconds to add to the simulation's times [default: 0.0].
    false_alarm_rate
        False alarm rate, 0 to 1: share of right simulations of which a difference is reported [default: 0.01].
    model
        Model file (`template model` prints one to start from), or an embedded model: speed-o-cam, two-mass, emps, emps-
        loop, gearmotor.
    """

    names: str | Iterable[str] | Mapping[str, float | str] | None
    offset_s: float
    false_alarm_rate: float
    model: str | None


class WatchOptions(TypedDict, total=False):
    """Options of `watch`.

    fixed
        Fix a parameter at its value in the model or at the given value (SI); may be repeated.
    start_values
        Start value of a parameter (SI); may be repeated.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    false_alarms_per_hour
        Mean number of alarms per hour of a healthy bench, over all channels [default: 0.5].
    window_s
        Longest stretch after a change from which its cause is named, as in 10s [default: 10s].
    block_s
        Length of the blocks that are compared with the model, as in 500ms [default: 500ms].
    learn_s
        Length of the beginning that is the baseline where none is given, as in 30s [default: 30s].
    """

    fixed: str | Iterable[str] | Mapping[str, float | str] | None
    start_values: str | Iterable[str] | Mapping[str, float | str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    false_alarms_per_hour: float
    window_s: float | None
    block_s: float | None
    learn_s: float | None


class SimulateOptions(TypedDict, total=False):
    """Options of `simulate`.

    duration_s
        Time until the command is back at 0, as in 10s, 1.5min or 500ms [default: the profile's duration].
    rate_hz
        Sampling rate, Hz [default: 1000.0].
    disturb
        A column of that recording that acts in addition to the model's inputs: a torque (N m) or force (N) on a node, or V
        on a servo's drive.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    from_rest
        Start at rest [default: start states that fit the whole recording best].
    values
        Let a parameter of the virtual bench differ from the model's: NAME=VALUE in SI, as in k1=71; may be repeated.
    hide
        Conceal physics in the virtual bench that the model does not name, in SI, as in
        coulomb_friction@load_bearing:torque=0.4 or sensor_gain@torque_out:gain=0.98; may be repeated.
    begin_at_s
        Let --set and --hide begin in mid-run, so long after the drive was enabled, as in 20s [default: from the start].
    seed
        Another number, other noise of the sensors [default: 1].
    noise
        Take all noise from the sensors.
    """

    duration_s: float | None
    rate_hz: float
    disturb: str | Iterable[str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    from_rest: bool
    values: str | Iterable[str] | Mapping[str, float | str] | None
    hide: str | Iterable[str] | None
    begin_at_s: float | None
    seed: int
    noise: bool


class DesignOptions(TypedDict, total=False):
    """Options of `design`.

    fixed
        Fix a parameter at its value in the model or at the given value (SI); may be repeated.
    start_values
        Start value of a parameter (SI); may be repeated.
    between
        How inputs move between their samples: auto, hold, linear or band-limited, for all of them or as INPUT=KIND for one;
        may be repeated [default: what the model file says, else auto: what fits the recordings best, and where they do not
        tell, band-limited for a motion, linear for a torque, a force, a voltage or a reference].
    diagnosis
        The diagnosis.json of `diagnose --report`: compare its strongest finding with its first rival, each added to
        --model.
    duration_s
        Length of the recording, as in 10s or 1.5min [default: 10.0].
    voltage
        Largest command, V [default: 1.8, or the clamp of the calibration if that is less].
    slew_v_s
        Fastest change of the command, V/s [default: 500.0].
    limits
        Limit of a channel, SI, in place of the calibration's; may be repeated.
    one_way
        Only profiles that do not change direction.
    calibration
        Calibration file with motor, sensors and limits [default: one that suits the model].
    """

    fixed: str | Iterable[str] | Mapping[str, float | str] | None
    start_values: str | Iterable[str] | Mapping[str, float | str] | None
    between: str | Iterable[str] | Mapping[str, float | str] | None
    diagnosis: str | PathLike[str] | None
    duration_s: float
    voltage: float | None
    slew_v_s: float
    limits: str | Iterable[str] | Mapping[str, float | str] | None
    one_way: bool
    calibration: str | PathLike[str] | None
