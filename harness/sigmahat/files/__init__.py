"""How results are written: the folder that they appear in, tables, and titles of columns."""
