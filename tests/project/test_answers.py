"""Questions of a new user: the start page leads to each answer by at most two links."""

from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from lxml import html

QUESTIONS = {
    "How do I install it?": ["start.html#the-python-package"],
    "How do I get from my recording to a stiffness?": ["how-to/log.html#configure"],
    "What do I have to record?": ["how-to/motion.html#which-motion-to-record"],
    "How many joints may a log have?": ["how-to/log.html#several-joints"],
    "Does it run on an STM32, for how many joints?": [
        "controller.html",
        "controller-cost.html#seven-joints-at-1-khz",
    ],
    "When may my controller use the stiffness?": [
        "filtered-regression/index.html#when-the-estimate-can-be-trusted"
    ],
    "Why is it negative?": ["how-to/symptoms.html#negative"],
    "What do I do without a torque constant?": ["how-to/symptoms.html#no-torque-constant"],
    "Which number has the method in FMPy?": [
        "fmu.html",
        "how-to/fmpy.html#plant-then-estimator",
    ],
    "How do I cite it?": ["start.html#how-to-cite"],
}
"""Pages from the start page to the answer, which is under the heading of the last anchor."""


@pytest.mark.parametrize("question", QUESTIONS)
def test_the_answer_is_within_two_links_of_the_start_page(question: str, site: Path) -> None:
    way = QUESTIONS[question]
    assert len(way) <= 2
    page = site / "index.html"
    for step in way:
        target, _, anchor = step.partition("#")
        # Links of the text, and not of the navigation, which has every page.
        (article,) = html.parse(str(page)).getroot().xpath("//article")
        links = [urlsplit(str(link)).path for link in article.xpath(".//a/@href")]
        reached = {(page.parent / unquote(link)).resolve() for link in links if link}
        page = (site / target).resolve()
        assert page in reached, step
        assert not anchor or html.parse(str(page)).getroot().xpath("//*[@id=$id]", id=anchor)
