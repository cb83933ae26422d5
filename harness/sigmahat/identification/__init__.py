"""Motor data, orders and noise from a log."""
