"""The backend for UniSim: its own conformance checks, and what they leave open. Skipped without UniSim and PyTorch."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import clench
import numpy as np
import pytest
from scenes import PUPPET, ROOT

unisim: Any = pytest.importorskip("unisim", reason="UniSim is not installed (pip install unisim-core)")
torch: Any = pytest.importorskip("torch", reason="PyTorch is not installed")
conformance: Any = pytest.importorskip("unisim.conformance")
base: Any = pytest.importorskip("unisim.backend.base")
dr: Any = pytest.importorskip("unisim.dr.types")
scenes: Any = pytest.importorskip("unisim.scene")
backends: Any = pytest.importorskip("clench.unisim")

WITH_SENSORS = """
<mujoco>
  <sensor><jointpos name="angle" joint="pan"/><framepos name="place" objtype="body" objname="box"/></sensor>
</mujoco>"""
MODELS = ("arm_and_box", "grasp", "humanoid", "quadruped")


def backend_of(name: str = "arm_and_box", num_envs: int = 3, dt: float = 0.002, **arguments: Any) -> Any:
    scene = scenes.SceneCfg(model_file=str(ROOT / f"models/{name}.xml"))
    return backends.create_backend(scene, num_envs, dt, threads=1, **arguments)


def puppets(folder: Path, **arguments: Any) -> Any:
    path = folder / "puppet.xml"
    path.write_text(PUPPET)
    return backends.create_backend(scenes.SceneCfg(model_file=str(path)), 2, 0.002, threads=1, **arguments)


def floats(values: Any) -> Any:
    return torch.tensor(np.asarray(values), dtype=torch.float32)


def put(backend: Any, envs: Any, qpos: Any, qvel: Any = None, **terms: Any) -> Any:
    envs = torch.tensor(envs)
    qvel = np.zeros((len(envs), backend.nv)) if qvel is None else qvel
    payload = dr.TensorResetRandomizationPayload(**{term: floats(values) for term, values in terms.items()})
    return backend.set_state_tensor(envs, floats(qpos), floats(qvel), payload if terms else None)


# UniSim's own checks.


@pytest.mark.parametrize("name, precision", list(itertools.product(MODELS, ("32", "64"))))
def test_it_conforms(name: str, precision: str) -> None:
    conformance.assert_backend_conformance(backend_of(name, precision=precision))


def test_it_conforms_with_mocap_bodies_and_tracked_ones(tmp_path: Path) -> None:
    backend = puppets(tmp_path, body_state_required=True, base_name="torso", push_body_name="torso")
    conformance.assert_backend_conformance(backend)
    assert backend.get_tensor_capabilities().packed_reset_mocap
    assert backend.get_capabilities().get("tensor.packed_reset_mocap").support.value == "exact"


def test_it_conforms_to_ray_casting() -> None:
    pytest.skip(
        "assert_ray_caster_conformance checks unisim.RayCaster, another contract, which clench does not implement"
    )


@pytest.mark.parametrize("term", sorted(spec.name for spec in dr.RESET_TERM_SPECS if not spec.is_delta))
def test_each_reset_term_reads_back(term: str) -> None:
    backend = backend_of()
    table = backend.get_reset_term_default(term)
    row = table[1] if term == "body_iquat" else 1.1 * table[1] + (0.01 if term in ("kp", "kd", "dof_damping") else 0)
    put(backend, [1], backend.get_default_qpos()[None], **{term: row[None]})
    after = backend.get_reset_term_default(term)
    np.testing.assert_allclose(after[1], row, rtol=1e-5, atol=1e-6)
    assert (after[[0, 2]] == table[[0, 2]]).all()


# Motion.


def test_it_steps_as_a_batch_does() -> None:
    backend = backend_of(precision="64")
    batch = clench.Batch(clench.Model.from_file(ROOT / "models/arm_and_box.xml"), 3, "64", 1)
    ctrl = floats(np.linspace(-0.5, 0.5, 18).reshape(3, 6))
    batch.ctrl[:] = ctrl.numpy()
    for _ in range(3):
        result = backend.step_tensor(ctrl, nsteps=4)
        batch.step(4)
    assert {"physics_ms", "tensor_control_d2h_ms"} <= result["timing"].keys()
    assert (backend.batch.qpos == batch.qpos).all() and (backend.batch.time == batch.time).all()
    views = backend.get_state_views(("qpos", "qvel", "ctrl"))
    assert views["qpos"].dtype == torch.float32 and torch.equal(views["ctrl"], ctrl)
    assert torch.equal(views["qpos"], floats(batch.qpos))


def test_a_reset_changes_the_chosen_environments_alone() -> None:
    backend = backend_of()
    backend.step_tensor(torch.ones(3, 6), 10)
    before = backend.get_physics_state()
    qpos = backend.get_default_qpos()
    qpos[0] = 0.25
    put(backend, [2], qpos[None], np.full((1, backend.nv), 0.5))
    after = backend.get_physics_state()
    assert (after[:2] == before[:2]).all()
    parts = backend.get_physics_state_layout().split_state(after[2])
    assert parts.time == 0 and parts.qpos[0] == 0.25 and (parts.qvel == 0.5).all()
    assert (backend.batch.ctrl[2] == 0).all()
    state = [floats(np.broadcast_to(row, (3, row.size))).contiguous() for row in (qpos, np.zeros(backend.nv))]
    backend.set_state_tensor_mask(torch.tensor([False, True, False]), *state, full_refresh=True)
    assert (backend.batch.time == [before[0, 0], 0, 0]).all()


def test_heavier_environments_fall_alike_and_press_harder() -> None:
    backend = backend_of("quadruped", base_name="trunk")
    mass = backend.get_body_mass()
    trunk = int(backend.get_body_ids(["trunk"])[0])
    for _ in range(2):  # A difference is from the model's mass, not from the last one.
        put(backend, [0, 2], np.tile(backend.get_default_qpos(), (2, 1)), base_mass_delta=[1.5, 2.0])
    assert np.allclose(backend.get_reset_term_default("body_mass")[:, trunk], mass[trunk] + [1.5, 0, 2.0])
    assert np.allclose(backend.batch.param("body_subtreemass")[:, 0], mass.sum() + [1.5, 0, 2.0], rtol=1e-5)
    put(backend, [1], backend.get_default_qpos()[None], base_com_offset=[[0.01, 0, 0]])
    assert np.allclose(backend.get_body_ipos([1])[0, trunk], backend.get_body_ipos()[trunk] + [0.01, 0, 0])


def test_a_refused_reset_changes_nothing() -> None:
    backend = backend_of()
    backend.step_tensor(torch.ones(3, 6), 5)
    before, friction = backend.get_physics_state(), backend.get_reset_term_default("geom_friction")
    qpos = backend.get_default_qpos()[None]
    with pytest.raises(ValueError, match="geom_size"):
        put(backend, [0], qpos, geom_friction=2 * friction[:1], geom_size=np.zeros((1, 8, 3)))
    with pytest.raises(ValueError, match="body_mass must not be negative"):
        put(backend, [0], qpos, geom_friction=2 * friction[:1], body_mass=-np.ones((1, 8)))
    with pytest.raises(NotImplementedError, match="base_mass_delta"):
        put(backend, [0], qpos, base_mass_delta=[1.0])
    assert (backend.get_physics_state() == before).all()
    assert (backend.get_reset_term_default("geom_friction") == friction).all()


# Forces.


def test_forces_act_for_one_step(tmp_path: Path) -> None:
    backend = puppets(tmp_path, base_name="torso", push_body_name="torso", precision="64")
    torso = backend.get_body_ids(["torso"])
    force = np.zeros((2, 1, 3))
    force[1, 0, 0] = 5
    operations = [
        dr.IntervalTermOp("body_force", floats(force), torch.tensor(torso)),
        dr.IntervalTermOp("body_torque", floats(force), torch.tensor(torso)),
    ]
    backend.apply_interval_randomization(dr.IntervalRandomizationPlan(tuple(operations)))
    sim = clench.Sim(clench.Model.from_xml(PUPPET))
    sim.xfrc_applied[torso[0], [0, 3]] = 5
    sim.step(3)
    backend.step_tensor(torch.zeros(2, 2), 3)
    assert np.allclose(backend.batch.qvel[1], sim.qvel, rtol=1e-12, atol=1e-13)
    assert abs(backend.batch.qvel[0, 3]) < 1e-2 < abs(sim.qvel[3])
    assert (backend.batch.xfrc_applied == 0).all()
    backend.apply_interval_randomization(
        dr.IntervalRandomizationPlan((dr.IntervalTermOp("push", floats(force[:, 0])),))
    )
    backend.step_tensor(torch.zeros(2, 2))
    assert backend.batch.qvel[1, 0] > sim.qvel[0]  # Nothing else pushes along x.


def test_kicks_are_in_world_axes() -> None:
    backend = backend_of("quadruped", base_name="trunk")
    trunk = torch.tensor(backend.get_body_ids(["trunk"]))
    qpos = backend.get_default_qpos()
    qpos[3:7] = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]  # A quarter turn about z.
    put(backend, [0, 1, 2], np.tile(qpos, (3, 1)))
    delta = np.zeros((3, 1, 3))
    delta[1, 0, 0] = 0.5
    terms = ("body_linear_velocity_delta", "body_angular_velocity_delta")
    plan = tuple(dr.IntervalTermOp(term, floats(delta), trunk) for term in terms)
    backend.apply_interval_randomization(dr.IntervalRandomizationPlan(plan))
    assert np.allclose(backend.batch.qvel[1, :6], [0.5, 0, 0, 0, -0.5, 0], atol=1e-6)
    assert (backend.batch.qvel[[0, 2]] == 0).all()
    velocity = backend.batch.velocity(body="trunk")[1]
    assert np.allclose(velocity, [[0.5, 0, 0], [0.5, 0, 0]], atol=1e-6)


def test_controls_are_asked_for_before_each_substep() -> None:
    backend = backend_of(precision="64", body_state_required=True, tracked_body_names=["box"])
    seen: list[float] = []

    def control(asked: Any, ctrl: Any) -> Any:
        seen.append(float(asked.get_state_views("qpos")["qpos"][0, 0]))
        force = np.zeros((3, 1, 3))
        force[0, 0, 2] = 0.1 * len(seen)
        return base.PreStepControlOutput(ctrl + 0.1 * len(seen), body_ids=asked.get_body_ids(["box"]), force=force)

    backend.set_pre_step_control(control)
    backend.step_tensor(torch.zeros(3, 6), 3)
    sim = clench.Sim(backend.model)
    for step in range(1, 4):
        assert np.isclose(seen[step - 1], sim.qpos[0], rtol=1e-6)
        sim.ctrl[:] = np.float32(0.1 * step)
        sim.xfrc_applied[sim.model.body("box").id, 2] = 0.1 * step
        sim.step()
    assert np.allclose(backend.batch.qpos[0], sim.qpos, rtol=1e-6)
    assert not np.allclose(backend.batch.qpos[1, -5], backend.batch.qpos[0, -5], rtol=0, atol=1e-9)


# Reads.


def test_fragments_and_sensors(tmp_path: Path) -> None:
    (tmp_path / "sensors.xml").write_text(WITH_SENSORS)
    scene = scenes.SceneCfg(
        model_file=str(ROOT / "models/arm_and_box.xml"), fragment_files=[str(tmp_path / "sensors.xml")]
    )
    backend = backends.create_backend(scene, 2, 0.004, threads=1)
    assert backend.batch.param("timestep").tolist() == pytest.approx([0.004, 0.004])
    assert [(sensor.name, sensor.width) for sensor in backend.get_sensor_inventory()] == [("angle", 1), ("place", 3)]
    qpos = np.tile(backend.get_default_qpos(), (2, 1))
    qpos[1, 0] = 0.5
    put(backend, [0, 1], qpos)
    view = backend.bind_sensor_data(["place", "angle"])
    assert np.allclose(view.read(), [[0.456, 0, 0.04, 0], [0.456, 0, 0.04, 0.5]])
    assert torch.allclose(backend.get_sensor_view("angle"), torch.tensor([[0.0], [0.5]]))


def test_tracked_bodies_are_those_of_the_present_state() -> None:
    backend = backend_of(precision="64", body_state_required=True, base_name="base")
    backend.step_tensor(torch.ones(3, 6), 20)
    views = backend.get_tracked_body_views(["hand", "box"])
    assert views.pos_w.shape == (3, 2, 3) and views.quat_w.shape == (3, 2, 4)
    sim = backend.batch.sim(1)
    for place, name in enumerate(views.body_names):
        assert np.allclose(views.pos_w[1, place], sim.body(name).xpos, atol=1e-6)
        assert np.allclose(views.quat_w[1, place], sim.body(name).xquat, atol=1e-6)
        velocity = sim.velocity(body=name)
        assert np.allclose(views.lin_vel_w[1, place], velocity[0], atol=1e-5)
        assert np.allclose(views.ang_vel_w[1, place], velocity[1], atol=1e-5)
    assert backend.get_sensor_view("track_pos_b_hand").shape == (3, 3)


def test_jacobians_of_sites(tmp_path: Path) -> None:
    backend = puppets(tmp_path)
    translation, rotation = backend.get_site_jacobian_w(int(backend.get_site_ids(["top"])[0]), np.array([2, 5]))
    assert np.allclose(translation[0], [[0, 0], [0, 0], [1, 0]]) and np.allclose(rotation[1], [[0, 0], [0, 0], [0, 1]])


def test_heights_below_a_body(tmp_path: Path) -> None:
    path = tmp_path / "ground.xml"
    path.write_text("""
    <mujoco>
      <asset><hfield name="ground" size="2 2 1 0.1" nrow="2" ncol="2" elevation="0 1 0 1"/></asset>
      <worldbody>
        <geom name="ground" type="hfield" hfield="ground"/>
        <body name="scout" pos="0 0 2"><freejoint/><geom size="0.1"/><site name="eye"/></body>
      </worldbody>
      <actuator><motor site="eye"/></actuator>
    </mujoco>""")
    backend = backends.create_backend(scenes.SceneCfg(model_file=str(path)), 2, 0.002, threads=1)
    conformance.assert_backend_conformance(backend)
    put(backend, [0, 1], [[0, 0, 2, 1, 0, 0, 0], [0.5, 0, 2, np.sqrt(0.5), 0, 0, np.sqrt(0.5)]])
    arguments: dict[str, Any] = {"hfield_geom_id": 0, "frame_body_id": 1}
    heights = backend.bind_height_scanner(offsets=[[0, 0], [1, 0]], **arguments).scan()
    assert np.allclose(heights, [[0.5, 0.75], [0.625, 0.625]], atol=1e-6)  # The slope is along x.
    with pytest.raises(NotImplementedError, match="yaw"):
        backend.bind_height_scanner(offsets=[[0, 0]], alignment="pitch", **arguments)


def test_the_model_answers() -> None:
    backend = backend_of(
        position_actuator_gains={"kp": 100.0, "kd": 2.0}, options=clench.RigidOptions(iterations=3), base_name="box"
    )
    assert backend.get_actuator_names() == backend.get_actuator_joint_names() == tuple(backend.model.names("joint")[:6])
    assert backend.get_joint_state_qpos_indices(["elbow"]).tolist() == [2]
    assert backend.get_root_state_layout("box").qvel_indices == tuple(range(6, 12))
    assert backend.get_body_subtree_ids(5).tolist() == [5, 6]
    assert np.allclose(backend.get_joint_range(names=["pan"]), [[-2.5, 2.5]])
    assert np.allclose(backend.get_keyframe_qpos("pushing")[6:9], [0.456, 0, 0.04])
    assert (backend.get_reset_term_default("kp") == 100).all() and (backend.get_reset_term_default("kd") == 2).all()
    assert backend.get_geom_size("box").tolist() == [0.04, 0.05, 0.04]
    assert backend.get_body_id("box") == 7 and backend.get_geom_id("box") == 7
    assert backend.num_dof_vel == 12 and backend.get_default_dof_pos().size == backend.nq
    assert backend_of("humanoid").num_dof_vel == 21


# Snapshots and pictures.


def test_snapshots_bring_states_back(tmp_path: Path) -> None:
    backend = puppets(tmp_path)
    binding = backend.bind_mocap_pose("hand")
    assert np.allclose(binding.default_pose, [0, 0, 1.2, 1, 0, 0, 0])
    backend.set_mocap_pose_tensor("hand", torch.tensor([1]), floats([[0.2, 0, 1.2, 1, 0, 0, 0]]))
    assert np.allclose(binding.read()[:, 0], [0, 0.2])
    snapshot = backend.get_physics_state()
    backend.step_tensor(torch.zeros(2, 2), 5)
    backend.set_physics_state(snapshot)
    assert (backend.get_physics_state() == snapshot).all()
    with pytest.raises(ValueError, match="snapshot"):
        backend.set_physics_state(snapshot[:1])


def test_pictures_and_playback() -> None:
    backend = backend_of(num_envs=2)
    backend.bind_renderer(headless=True, capture=True, width=32, height=24, camera_kwargs={"cam_tracking_env_idx": 1})
    try:
        frame = backend.capture_video_frame()
    except NotImplementedError as error:
        pytest.skip(f"this build draws nothing: {error}")
    assert frame.shape == (24, 32, 3) and frame.dtype == np.uint8 and frame.std() > 0
    plan = backend.resolve_play_render_plan(play_render_mode="none", play_steps=None, output_video=None)
    assert not plan.record_video
    steps: list[int] = []

    def step(observation: int) -> int:
        steps.append(observation)
        return observation + 1

    backend.run_playback(env=None, initialize=lambda: 0, step=step, num_steps=3)
    assert steps == [0, 1, 2]
    with pytest.raises(NotImplementedError, match="window"):
        backend.bind_renderer(headless=False)


# Bad input.


@pytest.mark.parametrize(
    "arguments, message",
    [
        ({"num_envs": 0}, "num_envs"),
        ({"dt": 0.0}, "sim_dt"),
        ({"base_name": "bx"}, "no body 'bx'"),
        ({"tracked_body_names": ["box"]}, "body_state_required"),
        ({"body_state_required": True, "tracked_body_names": ["bx"]}, "no body 'bx' to track"),
        ({"position_actuator_gains": {"kp": 1.0}}, "kp, kd"),
        ({"iterations": 3, "options": clench.RigidOptions()}, "options"),
    ],
)
def test_bad_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        backend_of(**arguments)


def test_scenes_that_it_cannot_build() -> None:
    with pytest.raises(TypeError, match="SceneCfg"):
        backends.create_backend("robot.xml")
    with pytest.raises(ValueError, match="model_file"):
        backends.create_backend(scenes.SceneCfg())
    scene = scenes.SceneCfg(model_file="robot.xml", terrain=scenes.TerrainSceneCfg())
    with pytest.raises(NotImplementedError, match="terrain"):
        backends.create_backend(scene)
    with pytest.raises(clench.LoadError):
        backends.create_backend(scenes.SceneCfg(model_file="no such file.xml"))


def test_bad_tensors() -> None:
    backend = backend_of()
    zeros, rows = torch.zeros(3, 6), torch.tensor([0])
    state = floats(backend.get_default_qpos()[None]), torch.zeros(1, backend.nv)
    bad: list[tuple[type[Exception], str, Any]] = [
        (TypeError, "ctrl must be a torch.Tensor", lambda: backend.step_tensor(zeros.numpy())),
        (TypeError, "float32", lambda: backend.step_tensor(zeros.double())),
        (ValueError, "shape", lambda: backend.step_tensor(zeros[:2])),
        (ValueError, "contiguous", lambda: backend.step_tensor(torch.zeros(6, 3).T)),
        (ValueError, "finite", lambda: backend.step_tensor(zeros / 0)),
        (ValueError, "nsteps", lambda: backend.step_tensor(zeros, 0)),
        (TypeError, "int64", lambda: backend.set_state_tensor(rows.int(), *state)),
        (ValueError, "env_ids", lambda: backend.set_state_tensor(rows + 3, *state)),
        (ValueError, "shape", lambda: backend.set_state_tensor(torch.tensor([0, 1]), *state)),
        (KeyError, "sensor", lambda: backend.get_sensor_view("gyro")),
        (KeyError, "state field", lambda: backend.get_state_views("act")),
        (ValueError, "meta", lambda: backend.get_state_views("qpos", device="meta")),
        (NotImplementedError, "tracked", lambda: backend.get_tracked_body_views()),
        (ValueError, "no mocap body", lambda: backend.bind_mocap_pose("box")),
        (IndexError, "environment 3", lambda: backend.get_playback_model(3)),
    ]
    for error, message, call in bad:
        with pytest.raises(error, match=message):
            call()
    backend.close()
    backend.close()
    with pytest.raises(unisim.BackendError, match="closed"):
        backend.step_tensor(zeros)
