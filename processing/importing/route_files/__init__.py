"""From the file of a pipe on the utility's map to the mapped route of a survey; one module a format."""
