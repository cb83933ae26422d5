"""The data sheet of a joint, as logs show the joint, and files for other tools."""
