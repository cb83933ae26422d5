"""The workflows run pinned actions, and only the job that publishes may write."""

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

WORKFLOWS = sorted((Path(__file__).parents[2] / ".github" / "workflows").glob("*.yml"))
each_workflow = pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)


def contents(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = yaml.safe_load(path.read_text(encoding="utf-8"))
    return found


def steps(path: Path) -> list[dict[str, Any]]:
    return [step for job in contents(path)["jobs"].values() for step in job["steps"]]


def test_there_are_workflows() -> None:
    assert {path.stem for path in WORKFLOWS} >= {"gate", "complete", "release"}


@each_workflow
def test_every_action_has_the_digest_of_its_commit_and_the_version(path: Path) -> None:
    used = re.findall(r"\buses: *(.*)", path.read_text(encoding="utf-8"))
    assert used
    for action in used:
        assert re.fullmatch(r"[\w-]+/[\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", action), action


@each_workflow
def test_no_checkout_keeps_the_token(path: Path) -> None:
    for step in steps(path):
        if step.get("uses", "").startswith("actions/checkout@"):
            assert step["with"]["persist-credentials"] is False


@each_workflow
def test_the_workflow_may_only_read(path: Path) -> None:
    assert contents(path)["permissions"] == {"contents": "read"}


def test_only_publish_may_write_and_it_runs_no_code_of_the_repository() -> None:
    jobs = {
        (path.stem, name): job for path in WORKFLOWS for name, job in contents(path)["jobs"].items()
    }
    (publish,) = (job for job in jobs.values() if "permissions" in job)
    assert publish is jobs["release", "publish"]
    assert not any("checkout" in step.get("uses", "") for step in publish["steps"])


def test_a_release_has_an_attestation_of_its_files() -> None:
    publish = contents(WORKFLOWS[0].with_name("release.yml"))["jobs"]["publish"]["steps"]
    used = [step.get("uses", "").partition("@")[0] for step in publish]
    assert used[:2] == ["actions/download-artifact", "actions/attest"]
    assert publish[1]["with"]["subject-path"] == f"{publish[0]['with']['path']}/**"
