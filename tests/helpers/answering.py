"""Stand-ins for what a test has not: a sound card, and an operator who answers message boxes."""

import time


class CountingSink:
    """A sound card that takes blocks at its own pace."""

    latency_s = 0.0

    def __init__(self):
        self.frames, self.closed = 0, False

    def write(self, block):
        time.sleep(0.002)
        self.frames += block.size

    def drain(self):
        pass

    def close(self):
        self.closed = True


class AnsweringBoxes:
    """Message boxes that note what they were asked, and answer with ``answer`` or else as Escape would."""

    language = "en"

    def __init__(self, answer=None):
        self.told, self.answer = [], answer

    def error(self, error):
        self.told.append(error.code)

    def tell(self, text):
        self.told.append(text)

    def ask(self, text, choices):
        self.told.append(text)
        keys = [choice.key for choice in choices]
        return self.answer if self.answer in keys else keys[-1]
