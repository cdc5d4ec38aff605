"""Time series of probes, and files for ParaView."""

import math
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import skerry as sk
from skerry import _core
from worlds import RUBBER, ball_world

G = 9.81


def test_a_recorder_follows_every_call_of_advance() -> None:
    world, ball, floor = ball_world()
    probes: dict[str, sk.Probe] = {"ball": sk.BodyProbe(ball), "push": sk.ForceProbe(ball, by=floor)}
    with world.recorder(probes) as recorder:
        world.run(0.1, dt=0.01)
    world.advance(0.01)
    table = recorder.table()
    assert len(recorder) == 11
    np.testing.assert_allclose(table["time"], np.arange(11) * 0.01, atol=1e-12)
    free = table["time"] < 0.04
    np.testing.assert_allclose(table["ball.position_z"][free], 0.06 - G / 2 * table["time"][free] ** 2, atol=1e-3)
    assert table["ball.velocity_z"][4] == pytest.approx(-G * 0.04, rel=1e-6)
    assert np.isnan(table["push.force_z"][0]) and np.nanmax(table["push.force_z"]) > 4 * ball.mass * G
    assert recorder.units["ball.position_z"] == "m" and recorder.units["push.force_z"] == "N"
    assert list(recorder.units)[0] == "time" and recorder.units["push.contacts"] == "1"
    assert repr(recorder) == f"<skerry.Recorder 11 rows of {len(table)} columns>"


def test_rows_come_at_multiples_of_every() -> None:
    world, ball, _ = ball_world()
    with world.recorder({"ball": sk.BodyProbe(ball)}, every=0.02) as recorder:
        world.run(0.1, dt=0.01)
    np.testing.assert_allclose(recorder.table()["time"], np.arange(6) * 0.02, atol=1e-12)


def test_the_structured_array_has_the_columns_of_the_table() -> None:
    world, ball, _ = ball_world()
    with world.recorder({"ball": sk.BodyProbe(ball), "energy": sk.EnergyProbe()}) as recorder:
        world.run(0.05, dt=0.01)
    table, array = recorder.table(), recorder.array()
    assert array.dtype.names == tuple(table) and array.shape == (6,)
    for name, column in table.items():
        np.testing.assert_array_equal(array[name], column)
    pandas = pytest.importorskip("pandas")
    assert pandas.DataFrame(table).shape == (6, len(table))


def test_a_point_probe_follows_its_point() -> None:
    world, ball, _ = ball_world()
    probe = ball.probe((0, 0, 0.1))
    assert sum(probe.weight) == pytest.approx(1)
    with world.recorder({"top": probe}) as recorder:
        world.run(0.04, dt=0.02)
    table = recorder.table()
    assert table["top.position_z"][0] == pytest.approx(0.1)
    np.testing.assert_allclose(table["top.displacement_z"], table["top.position_z"] - 0.1, atol=1e-12)
    with pytest.raises(sk.SceneError, match="the nearest node is"):
        ball.probe((1, 0, 0))


def test_every_kind_of_probe_has_its_columns() -> None:
    world, ball, floor = ball_world()
    bar = world.add_body(sk.Mesh.box((0.1, 0.1, 0.2), 1), RUBBER, position=(1, 0, 1), dynamics="explicit", name="bar")
    grip = bar.attach(bar.select(above=1.05))
    wheel = world.add_body(sk.Cylinder(radius=0.1, height=0.1), RUBBER, position=(0, 1, 1), name="wheel")
    hinge = world.add_joint("hinge", wheel, point=(0, 1, 1), axis=(0, 0, 1), motor=sk.Motor(speed=2.0, strength=1.0))
    pad = world.add_body(sk.Mesh.box((0.1, 0.1, 0.1), 1), RUBBER, position=(2, 0, 1), dynamics="explicit", name="pad")
    glue = world.add_tie(pad, pad.select(above=1.04))
    probes: dict[str, sk.Probe] = {
        "point": ball.probe((0, 0, 0.06)),
        "body": sk.BodyProbe(ball, origin=(0, 0, 0)),
        "force": sk.ForceProbe(ball),
        "floor": sk.ForceProbe(floor, by=ball),
        "grip": sk.ReactionProbe(grip),
        "hinge": sk.JointProbe(hinge),
        "glue": sk.TieProbe(glue),
        "energy": sk.EnergyProbe(),
        "stress": sk.StressProbe(bar, bar.select(below=1.0)),
        "volume": sk.VolumeProbe(bar),
        "pose": sk.PoseProbe(wheel),
        "velocity": sk.VelocityProbe(wheel),
        "nodes": sk.NodesProbe(bar),
    }
    with world.recorder(probes) as recorder:
        world.run(0.5, dt=0.25)
    last = recorder.array()[-1]
    assert {name.split(".")[0] for name in recorder.units} == {"time", *probes}
    assert last["grip.force_z"] == pytest.approx(bar.mass * G, rel=0.05)
    assert last["glue.force_z"] == glue.state.force[2] > 0 and last["glue.error"] == glue.state.error
    assert last["hinge.angle"] == pytest.approx(1.0, rel=0.05)
    assert last["pose.rotation_z"] == pytest.approx(last["hinge.angle"])
    assert last["velocity.angular_velocity_z"] == pytest.approx(2.0, rel=1e-3)
    assert last["stress.largest_von_mises"] == pytest.approx(
        bar.von_mises("nodes")[bar.select(below=1.0)].max(), rel=0.05
    )
    assert last["volume.smallest_volume_ratio"] == pytest.approx(1, abs=0.01)
    assert last["energy.kinetic"] == pytest.approx(world.energy.kinetic)
    assert last["nodes.position_z_0"] == pytest.approx(bar.positions[0, 2])
    assert last["body.displacement_z"] == last["body.position_z"]
    assert last["floor.force_z"] == pytest.approx(-last["force.force_z"])


def test_files_have_all_rows(tmp_path: Path) -> None:
    world, ball, _ = ball_world()
    recorder = world.recorder({"ball": sk.BodyProbe(ball)})
    recorder.stream_csv(tmp_path / "stream.csv")
    with recorder:
        world.run(0.05, dt=0.01)
    recorder.to_csv(tmp_path / "all.csv")
    text = (tmp_path / "all.csv").read_text()
    assert text == (tmp_path / "stream.csv").read_text()
    assert text.startswith("time [s],ball.position_x [m],")
    rows = np.loadtxt(tmp_path / "all.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(rows[:, 3], recorder.table()["ball.position_z"])
    if _core.has_hdf5:
        recorder.to_hdf5(tmp_path / "all.h5")
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "all.h5") as file:
            np.testing.assert_array_equal(file["ball/position_z"], recorder.table()["ball.position_z"])


def test_wrong_probes_are_refused_by_name() -> None:
    world, ball, _ = ball_world()
    with pytest.raises(sk.SceneError, match="time"):
        world.recorder({"time": sk.BodyProbe(ball)})
    with pytest.raises(TypeError, match="probe 'ball': found <skerry.Body 'ball' .*, expected a probe such as"):
        world.recorder({"ball": ball})  # type: ignore[dict-item]
    with pytest.raises(sk.SceneError, match="every"):
        world.recorder({"ball": sk.BodyProbe(ball)}, every=-1)
    ball.remove()
    with pytest.raises(sk.SceneError, match="body 'ball' was removed"):
        world.recorder({"ball": sk.BodyProbe(ball)})


def test_a_recorder_ends_with_its_block_after_an_error_too() -> None:
    world, ball, _ = ball_world()
    with pytest.raises(ZeroDivisionError), world.recorder({"ball": sk.BodyProbe(ball)}) as recorder:
        world.advance(0.01)
        raise ZeroDivisionError
    world.advance(0.01)
    assert len(recorder) == 2


def test_a_recorder_changes_no_bit_of_the_run() -> None:
    plain, _, _ = ball_world()
    plain.run(0.1, dt=0.01)
    world, ball, _ = ball_world()
    with world.recorder({"ball": sk.ForceProbe(ball)}), world.record():
        world.run(0.1, dt=0.01)
    assert world.state_hash == plain.state_hash


def test_paraview_files_have_a_frame_for_each_time(tmp_path: Path) -> None:
    world, ball, _ = ball_world()
    with world.vtk(tmp_path, name="drop", every=0.02, materials=["rubber"]):
        world.run(0.05, dt=0.01)
    frames = ElementTree.parse(tmp_path / "drop.pvd").getroot().iter("DataSet")
    files = [(float(frame.get("timestep", math.nan)), frame.get("file", "")) for frame in frames]
    times = sorted({time for time, _ in files})
    np.testing.assert_allclose(times, [0, 0.02, 0.04, 0.05], atol=1e-9)
    assert all((tmp_path / name).is_file() for _, name in files)
    pyvista = pytest.importorskip("pyvista")
    last = pyvista.read(tmp_path / next(name for time, name in files if time == times[-1] and name.endswith(".vtu")))
    np.testing.assert_allclose(last.points, ball.positions, atol=1e-12)


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    world, _, _ = ball_world()
    (tmp_path / "file").write_text("")
    with pytest.raises(sk.SceneError, match="file"), world.vtk(tmp_path / "file"):
        pass
    world.advance(0.01)


def test_a_point_probe_has_four_nodes_and_weights() -> None:
    world = sk.World(threads=1)
    ball = world.add_body(sk.Mesh.ball(0.1, 4), sk.Material())
    with pytest.raises(TypeError, match=r"^PointProbe\.node: found an array of the shape \(1,\), expected \(4,\)"):
        sk.PointProbe(ball, node=(0,), weight=(1, 0, 0, 0))  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"^PointProbe\.weight: found an array of the shape \(1,\), expected \(4,\)"):
        sk.PointProbe(ball, node=(0, -1, -1, -1), weight=(1,))  # type: ignore[arg-type]


def test_a_recorder_counts_the_steps_of_a_call_that_ends_with_an_exception() -> None:
    world, ball, _ = ball_world()
    world.advance(0.045)
    probes: dict[str, sk.Probe] = {"push": sk.ForceProbe(ball), "ball": sk.BodyProbe(ball)}
    with world.recorder(probes) as recorder:
        start = world.time
        momentum = ball.mass * recorder.table()["ball.velocity_z"][0]
        raised = False

        def interrupt(report: sk.StepReport) -> None:
            if world.time > start + 0.005:
                raise KeyboardInterrupt

        world.watch_steps(interrupt)
        try:
            world.advance(0.01)
        except KeyboardInterrupt:
            raised = True
        world.watch_steps(None)
        assert raised and len(recorder) == 2
        world.advance(0.01)
    table = recorder.table()
    intervals = np.diff(table["time"])
    pushed = float(np.sum(table["push.force_z"][1:] * intervals))
    gained = ball.mass * table["ball.velocity_z"][-1] - momentum
    # The velocity after a step of the leapfrog method is half a step off.
    assert pushed == pytest.approx(gained + ball.mass * G * float(np.sum(intervals)), rel=0.02)


def test_a_call_inside_a_callback_leaves_a_recorder_as_it_is() -> None:
    def recorded(nested: bool) -> np.ndarray:
        world, ball, _ = ball_world()
        world.advance(0.045)

        def look(report: sk.StepReport) -> None:
            with pytest.raises(sk.SceneError, match="advance"):
                world.advance(0.01)

        with world.recorder({"push": sk.ForceProbe(ball)}) as recorder:
            if nested:
                world.watch_steps(look)
            world.advance(0.01)
        return recorder.table()["push.force_z"]

    np.testing.assert_array_equal(recorded(True), recorded(False))


def test_a_step_is_not_taken_if_a_recorder_could_not_record_it() -> None:
    world, ball, floor = ball_world()
    other = world.add_body(sk.Mesh.ball(0.05, 4), RUBBER, position=(1, 0, 1), name="other")
    with world.recorder({"pair": sk.ForceProbe(ball, by=other)}) as recorder:
        world.advance(0.01)
        world.measure_forces(on=False)
        with pytest.raises(sk.SceneError, match="recorder: measures_forces: found False, expected True"):
            world.advance(0.01)
        world.measure_forces()
        other.remove()
        with pytest.raises(sk.SceneError, match="recorder: probe 'pair': found an object that was removed"):
            world.advance(0.01)
        assert world.time == pytest.approx(0.01) and len(recorder) == 2
    assert world.advance(0.01).ok


def test_a_world_does_not_jump_in_time_while_a_recorder_follows_it() -> None:
    world, ball, _ = ball_world()
    saved = world.copy()
    with world.recorder({"push": sk.ForceProbe(ball)}) as recorder:
        world.advance(0.01)
        with pytest.raises(sk.SceneError, match="reset: saved: found a recorder of 'push' in its `with` block"):
            world.reset(saved)
        world.advance(0.01)
    assert len(recorder) == 3
    world.reset(saved)
    assert world.time == 0


def test_a_write_error_of_a_film_is_raised_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class FullDisk:
        """A film writer that fails at its third frame, and then refuses calls as a closed one."""

        def __init__(self, *_: Any) -> None:
            self.frames = 0

        def add_frame(self, _: Any) -> None:
            self.frames += 1
            if self.frames >= 3:
                raise OSError("disk full" if self.frames == 3 else "closed")

        def close(self) -> None:
            raise OSError("closed")

    monkeypatch.setattr(_core, "FilmWriter", FullDisk)
    world, _, _ = ball_world()
    with pytest.raises(OSError, match="disk full"), world.usd(tmp_path / "a.usd", every=0.01):
        world.run(0.05, dt=0.01)


def test_an_error_estimator_names_the_error_of_each_body() -> None:
    world, ball, _ = ball_world()
    with world.error_estimator() as errors:
        world.run(0.1, dt=0.01)
    table = errors.table()
    assert table["body"] == [ball.name]
    assert 0 < table["mesh"][0] < 1 and 0 < table["step"][0] < 1
    by_tetrahedron = ball.mesh_error()
    assert by_tetrahedron.shape == (len(ball.tetrahedra),) and by_tetrahedron.max() > 0


def test_a_world_with_an_active_error_estimator_is_not_reset() -> None:
    world, _, _ = ball_world()
    saved = world.copy()
    with world.error_estimator(), pytest.raises(sk.SceneError, match="an error estimator in its `with` block"):
        world.reset(saved)
