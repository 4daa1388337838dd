"""Reads cases: meshes, fields, tables, grains. Needs numpy only."""
