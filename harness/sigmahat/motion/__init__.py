"""A motion to record: which one will show the stiffness of a joint, before there is a log."""
