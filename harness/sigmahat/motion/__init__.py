"""Proposes a motion that will show the stiffness of a joint, before a log exists."""
