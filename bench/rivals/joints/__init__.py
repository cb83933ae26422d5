"""Joints in physics engines that we did not write: MuJoCo and Drake."""
