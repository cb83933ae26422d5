"""The commands of `sigmahat`, one file each. Other modules are imported when a command runs."""
