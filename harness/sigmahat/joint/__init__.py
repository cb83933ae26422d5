"""What logs told about a joint: its data sheet, and the files made of it for other tools."""
