"""Reads a QR code by ISO/IEC 18004, written apart from the library that makes it: versions 1 to 3, one block, bytes."""

_DATA_OF_M = {1: 16, 2: 28, 3: 44}  # data codewords at error correction M
_ALIGNMENT = {1: (), 2: (18,), 3: (22,)}
_MASKS = (
    lambda y, x: (y + x) % 2 == 0,
    lambda y, x: y % 2 == 0,
    lambda y, x: x % 3 == 0,
    lambda y, x: (y + x) % 3 == 0,
    lambda y, x: (y // 2 + x // 3) % 2 == 0,
    lambda y, x: (y * x) % 2 + (y * x) % 3 == 0,
    lambda y, x: ((y * x) % 2 + (y * x) % 3) % 2 == 0,
    lambda y, x: ((y + x) % 2 + (y * x) % 3) % 2 == 0,
)


def read(rows):
    """Return the text of a code without its margin: rows of booleans, dark ones True."""
    size = len(rows)
    version = (size - 17) // 4
    level, mask = _format_of(rows)
    assert level == 0, "error correction M is 00"
    words = _codewords(rows, version, _MASKS[mask])
    assert not any(_syndromes(words, len(words) - _DATA_OF_M[version])), "the error correction does not fit"
    bits = "".join(f"{word:08b}" for word in words[: _DATA_OF_M[version]])
    assert bits[:4] == "0100", "byte mode"
    length = int(bits[4:12], 2)
    return bytes(int(bits[12 + 8 * i : 20 + 8 * i], 2) for i in range(length)).decode("ascii")


def _format_of(rows):
    """Return error correction level and mask, read beside the finder at the top left."""
    places = [(8, x) for x in (0, 1, 2, 3, 4, 5, 7, 8)] + [(y, 8) for y in (7, 5, 4, 3, 2, 1, 0)]
    value = 0
    for y, x in places:
        value = value << 1 | rows[y][x]
    value ^= 0b101010000010010
    return value >> 13, value >> 10 & 0b111


def _is_function(y, x, size, version):
    """Return whether a module belongs to finders, timing, alignment or format rather than to the data."""
    if (y < 9 and x < 9) or (y < 9 and x >= size - 8) or (y >= size - 8 and x < 9):
        return True
    centres = _ALIGNMENT[version]
    return y == 6 or x == 6 or any(abs(y - c) <= 2 and abs(x - c) <= 2 for c in centres)


def _codewords(rows, version, mask):
    """Return the codewords in the order of the zigzag, unmasked."""
    size, bits, upward = len(rows), [], True
    columns = [x for x in range(size - 1, 0, -2) if x > 6] + [5, 3, 1]
    for right in columns:
        for y in range(size - 1, -1, -1) if upward else range(size):
            bits += [rows[y][x] ^ mask(y, x) for x in (right, right - 1) if not _is_function(y, x, size, version)]
        upward = not upward
    whole = len(bits) // 8
    return [int("".join("01"[bit] for bit in bits[8 * i : 8 * i + 8]), 2) for i in range(whole)]


def _syndromes(words, checks):
    """Return the Reed-Solomon syndromes over GF(256), 0x11d: all zero for an unharmed code."""
    out = []
    for power in range(checks):
        root, total = _power(power), 0
        for word in words:
            total = _times(total, root) ^ word
        out.append(total)
    return out


def _times(a, b):
    out = 0
    while b:
        if b & 1:
            out ^= a
        a = a << 1 ^ (0x11D if a & 0x80 else 0)
        b >>= 1
    return out


def _power(exponent):
    out = 1
    for _ in range(exponent):
        out = _times(out, 2)
    return out
