"""noslip: a firmly pinched block creeps down through soft friction, and ten sweeps nearly stop it."""

import numpy as np

import program

PINCH = program.ROOT / "models/pinch.xml"
BLOCK_Z = 4  # qpos: two fingers, then the block's x, y, z


def creep(noslip_iterations):
    """Returns the speed, m/s, at which the block sinks once the grip is steady."""
    record, _ = program.simulate(PINCH, "--steps", 2000, "--noslip-iterations", noslip_iterations)
    time, height = record["time"], record["qpos"][:, BLOCK_Z]
    settled = len(time) // 2
    return (height[settled] - height[-1]) / (time[-1] - time[settled])


def test_noslip_stops_creep():
    without, with_noslip = creep(0), creep(10)
    assert 50e-6 < without < 500e-6, f"{without * 1e6:.1f} µm/s without noslip; MuJoCo has 135"
    assert abs(with_noslip) < without / 100, f"{with_noslip * 1e6:.2f} µm/s with noslip; MuJoCo has 0.64"


def test_creep_without_noslip_is_mujocos():
    """Soft friction is part of the model, so the creep agrees with MuJoCo 4.0: 135.25 µm/s."""
    assert np.isclose(creep(0), 135.25e-6, rtol=1e-2)
