"""A recorder on a bench: its devices do as told."""

import pytest
from recorder_bench import Bench


@pytest.fixture
def bench(tmp_path):
    benches = []

    def make(target=None, **words):
        benches.append(Bench(target or tmp_path, **words))
        benches[-1].recorder.open()
        return benches[-1]

    yield make
    for one in benches:
        one.recorder.close()
