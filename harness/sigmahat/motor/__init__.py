"""Motor data, polynomial orders and noise, identified off line from a log."""
