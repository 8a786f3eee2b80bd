"""The detectors' names, apart from their code, so that a form can offer them without loading the signal processing."""

# a row each in processing.sound.candidates.DETECTORS
DETECTOR_NAMES = (
    "envelope",
    "metres",
    "metres_or_loud",
    "layers",
    "agreed",
    "kurtosis_band",
    "wavelet_band",
    "spectrum",
)
