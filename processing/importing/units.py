"""Units that loggers write, under one name each, and what turns them into SI."""

import re
from collections.abc import Mapping
from types import MappingProxyType

AUTO = "auto"
STANDARD_GRAVITY_MPS2 = 9.80665
_DEG = 0.017453292519943295

# what one of the unit is in the unit of the code: s, m/s², rad/s, µT, kPa; temperature is affine, see below
FACTORS: Mapping[str, Mapping[str, float]] = MappingProxyType(
    {
        "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "100us": 1e-4, "min": 60.0, "clock": 1.0},
        "counter": {"1": 1.0},
        "acc": {"mps2": 1.0, "g": STANDARD_GRAVITY_MPS2, "mg": STANDARD_GRAVITY_MPS2 * 1e-3, "cmps2": 0.01},
        "gyr": {"radps": 1.0, "dps": _DEG, "mdps": _DEG * 1e-3, "mradps": 1e-3},
        "mag": {"ut": 1.0, "nt": 1e-3, "mt": 1e3, "t": 1e6, "gauss": 100.0, "mgauss": 0.1, "au": 50.0},
        "quat": {"1": 1.0},
        "pressure": {"kpa": 1.0, "pa": 1e-3, "hpa": 0.1, "bar": 100.0, "psi": 6.894757},
        "temperature": {"c": 1.0, "k": 1.0, "f": 5.0 / 9.0},
    }
)
_OFFSETS = MappingProxyType({"k": -273.15, "f": -160.0 / 9.0})

_SPELLINGS: Mapping[str, Mapping[str, str]] = {
    "time": {
        "s": "s sec secs second seconds sn saniye",
        "ms": "ms msec millis millisecond milliseconds",
        "us": "us usec µs μs micros microsecond microseconds",
        "ns": "ns nsec nanos nanosecond nanoseconds",
        "100us": "100us 0.1ms",
        "min": "min minute minutes",
        "clock": "clock hh:mm:ss hh:mm:ss.fff txt iso",
    },
    "counter": {"1": "1 count counts samples"},
    "acc": {
        "mps2": "m/s^2 m/s2 m/s² m/s/s mps2 m.s-2 m*s^-2 ms-2 m/s**2 mps^2",
        "g": "g g's gs gn",
        "mg": "mg",
        "cmps2": "cm/s^2 cm/s2 cm/s² gal",
    },
    "gyr": {
        "radps": "rad/s rads radps rad.s-1 rad*s^-1 rad/sec r/s",
        "dps": "deg/s °/s dps d/s degps deg/sec degrees/s º/s deg.s-1 dg/s",
        "mdps": "mdps mdeg/s m°/s",
        "mradps": "mrad/s",
    },
    "mag": {
        "ut": "ut µt μt microtesla",
        "nt": "nt",
        "mt": "mt millitesla",
        "t": "t tesla",
        "gauss": "gauss gs ga g",
        "mgauss": "mgauss mg mga",
        "au": "au a.u. a.u arb normalised normalized",
    },
    "quat": {"1": "1 -"},
    "pressure": {"kpa": "kpa", "pa": "pa pascal", "hpa": "hpa mbar mb", "bar": "bar", "psi": "psi"},
    "temperature": {"c": "c °c degc celsius ºc", "k": "k kelvin", "f": "f °f degf"},
}


def unit_named(kind: str, text: str) -> str:
    """Return our name of a unit as a header writes it (``m/s^2`` → ``mps2``), ``auto`` where it is not known."""
    bare = re.sub(r"\s", "", text).strip("[]()").casefold()
    for name, spellings in _SPELLINGS.get(kind, {}).items():
        if bare and (bare == name or bare in spellings.split()):
            return name
    return AUTO


def factor(kind: str, unit: str) -> float:
    """Return what one ``unit`` is in the unit of the code; 1 for ``auto``."""
    return FACTORS[kind].get(unit, 1.0)


def offset(kind: str, unit: str) -> float:
    """Return what is added after the factor: only temperatures have one."""
    return _OFFSETS.get(unit, 0.0) if kind == "temperature" else 0.0
