"""When something was written down, by this computer's clock."""

from datetime import UTC, datetime


def now_utc() -> str:
    """Return this moment as ISO 8601 in UTC, to the millisecond."""
    return datetime.now(UTC).isoformat(timespec="milliseconds")
