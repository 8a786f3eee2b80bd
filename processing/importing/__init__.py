"""From a logger's files to clean samples, and what is wrong with them."""
