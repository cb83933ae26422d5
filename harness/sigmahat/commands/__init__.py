"""The commands of `sigmahat`, one file each. They import what they need when they run."""
