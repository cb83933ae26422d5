"""Two joints of an arm that push each other, in MuJoCo: each motor's equation is enough."""

import json
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from recorded_logs import write_log
from sigmahat.cli import main

GEAR, INERTIA, FRICTION = 100.0, 1e-4, 5e-4  # of both motors [kg.m2, N.m.s/rad]
STIFFNESS = {"shoulder": 900.0, "elbow": 350.0}  # [N.m/rad]
ARMATURE, DAMPING = INERTIA * GEAR**2, FRICTION * GEAR**2
MODEL = f"""
<mujoco>
  <option timestep="0.00025" integrator="implicit"/>
  <default><geom type="capsule" size="0.04" density="700"/></default>
  <worldbody>
    <body name="drive1"><inertial pos="0 0 0" mass="0.01" diaginertia="1e-5 1e-5 1e-5"/>
      <joint name="m1" axis="0 1 0" armature="{ARMATURE}" damping="{DAMPING}"/>
      <body name="link1"><joint name="d1" axis="0 1 0" stiffness="{STIFFNESS["shoulder"]}"/>
        <geom fromto="0 0 0 0 0 -0.5"/>
        <body name="drive2" pos="0 0 -0.5">
          <inertial pos="0 0 0" mass="0.01" diaginertia="1e-5 1e-5 1e-5"/>
          <joint name="m2" axis="0 1 0" armature="{ARMATURE}" damping="{DAMPING}"/>
          <body name="link2"><joint name="d2" axis="0 1 0" stiffness="{STIFFNESS["elbow"]}"/>
            <geom fromto="0 0 0 0 0 -0.4"/><geom type="sphere" size="0.06" pos="0 0 -0.4" mass="2"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator><motor joint="m1"/><motor joint="m2"/></actuator>
</mujoco>
"""


def arm_log(seconds: float = 20.0) -> dict[str, np.ndarray]:
    """What the drives record at 1 kHz: angles as encoders resolve them, torques with noise."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(MODEL)
    data, rng, steps = mujoco.MjData(model), np.random.default_rng(3), 4
    rows = []
    for k in range(round(1000 * seconds)):
        t = 1e-3 * k
        target = [
            0.5 * np.sin(2.2 * t) + 0.1 * np.sin(9.1 * t),
            0.6 * np.sin(3.1 * t) + 0.1 * np.sin(12.7 * t),
        ]
        motor, speed = data.qpos[[0, 2]], data.qvel[[0, 2]]
        data.ctrl[:] = 600.0 * (target - motor) - 30.0 * speed
        rows.append([t, *motor, *(motor + data.qpos[[1, 3]]), *(data.ctrl / GEAR)])
        for _ in range(steps):
            mujoco.mj_step(model, data)
    t, m1, m2, q1, q2, tau1, tau2 = np.array(rows).T
    log = {"time_s": t}
    for name, motor, link, tau in (("shoulder", m1, q1, tau1), ("elbow", m2, q2, tau2)):
        log[f"{name}_motor_counts"] = np.round(motor * GEAR * 4096 / (2 * np.pi))
        log[f"{name}_link_counts"] = np.round(link * 262144 / (2 * np.pi))
        log[f"{name}_torque_Nm"] = tau + rng.normal(0, 0.003, len(t))
    return log


@pytest.mark.slow("an arm is simulated, and two joints are identified and estimated")
def test_joints_that_push_each_other_are_estimated_one_by_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("mujoco", reason="to install MuJoCo: cmake --workflow --preset rivals")
    monkeypatch.chdir(tmp_path)
    write_log(arm_log(), Path("arm.csv"))
    assert main(["init", "arm.csv", "--quiet"]) == 0
    document = tomlkit.parse(Path("arm.toml").read_text())
    for name in ("shoulder", "elbow"):
        own = document["joints"][name]["ports"]
        own["theta"]["gear_ratio"], own["theta"]["counts_per_turn"] = GEAR, 4096
        own["q"]["counts_per_turn"] = 262144
    Path("arm.toml").write_text(tomlkit.dumps(document))
    assert main(["identify", "arm.csv", "--quiet"]) == 0
    assert main(["estimate", "arm.csv", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["joints"]
    for name, true in STIFFNESS.items():
        low, high = found[name]["curve"][1]["interval [N.m/rad]"]
        assert low < true < high < 1.2 * low
        assert found[name]["confident"] > 0.9
