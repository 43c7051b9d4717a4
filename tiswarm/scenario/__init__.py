"""Scenario: what a trial is made of, from TOML to a frozen, checked object. No Taichi."""
