"""The files that others work with: map programs, drawings, asset systems, spreadsheets, sound programs.

Every map format writes the same :mod:`layers <processing.reporting.handover.layers>` in the same target system.
"""
