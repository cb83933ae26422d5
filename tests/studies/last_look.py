"""The last look at a method: joints drawn at random, with all misfits at once.

    python tests/studies/last_look.py JOBS

prints the rows of these joints for the seeds LAST_LOOK, 100 joints of each kind. Whoever chooses
settings of the method by this table has to draw other seeds for the next look.
"""

from __future__ import annotations

import sys

from sigmahat.compare.misfits.conditions import CONDITIONS, LAST_LOOK, Group
from sigmahat.compare.misfits.job import compare
from sigmahat.compare.misfits.joints import JOINTS
from sigmahat.compare.misfits.table import table

if __name__ == "__main__":
    conditions = [each for each in CONDITIONS if each.group is Group.RANDOM]
    print(table(compare(conditions, JOINTS, LAST_LOOK, int(sys.argv[1]))))
