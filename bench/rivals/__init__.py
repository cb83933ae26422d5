"""FilteredRegression beside other methods, on the logs of joints in MuJoCo."""
