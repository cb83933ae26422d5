"""Creates one HTML file from the results of a reproduction, a log or a sweep."""
