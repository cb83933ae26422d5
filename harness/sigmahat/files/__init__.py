"""Writing of results: the folder of the results, tables, and titles of columns."""
