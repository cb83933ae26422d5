"""`health`: results of many logs of the same joints, and whether something has changed."""
