"""The study of `sigmahat health`: how often it is wrong, and how soon it finds what wears."""
