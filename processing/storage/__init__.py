"""The survey folder on disk: originals untouched, human decisions safe, derived results in a cache."""
