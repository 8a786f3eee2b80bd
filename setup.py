"""Builds the compiled recursions; everything else stands in pyproject.toml.

The kernels are Cython in pure-Python mode: where no compiler is at hand they stay Python, slower but the same.
"""

import os
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

KERNELS = sorted(Path("processing").glob("**/kernels*.py"))

setup(
    ext_modules=cythonize(
        [Extension(".".join(k.with_suffix("").parts), [str(k)], optional=True) for k in KERNELS],
        language_level=3,
        compiler_directives={"boundscheck": False, "wraparound": False, "cdivision": True, "embedsignature": True},
        force=False,
    ),
    options={"build_ext": {"parallel": os.cpu_count()}},  # the first set-up waits for these
)
