"""Studies: many tasks that differ in a few settings, the table of what they come to, what follows.

A plan (configs/studies/<name>.toml) has a kind, and each kind a module here. `study` says what a
kind must offer, `plan` reads plans, `rows` keeps tables, `runner` carries out what a table lacks.
"""
