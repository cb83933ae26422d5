"""Equations of the plants, in CasADi."""
