"""What logs show about a joint: its data sheet, and the files made of it for other tools."""
