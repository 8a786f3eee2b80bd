"""Data that ships with the program: messages, themes, fonts, manual, templates, the demonstration survey."""
