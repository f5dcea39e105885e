"""A URDF quadruped with a floating base falls on its feet in 512 environments of different masses.

A URDF file does not describe a free base: ``floating=True`` adds one. ``--robot`` takes a robot of the package
robot_descriptions, such as go2_description, instead of the one here::

    python python/examples/floating_robot.py
    python python/examples/floating_robot.py --robot go2_description --plot floating_robot.png
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import plots

import clench

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEG = """
  <joint name="{name}" type="revolute">
    <parent link="trunk"/><child link="{name}_leg"/><origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/>
    <limit lower="-0.5" upper="0.5" effort="30" velocity="20"/><dynamics damping="2" friction="0.1"/>
  </joint>
  <link name="{name}_leg">
    <inertial><origin xyz="0 0 -0.15"/><mass value="0.5"/><inertia ixx="0.004" iyy="0.004" izz="0.0004" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 -0.3"/><geometry><sphere radius="0.03"/></geometry></collision>
  </link>"""
TRUNK = """
  <link name="trunk">
    <inertial><mass value="6"/><inertia ixx="0.03" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.4 0.2 0.1"/></geometry></collision>
  </link>"""
LEGS = {"front_left": (0.2, 0.1), "front_right": (0.2, -0.1), "rear_left": (-0.2, 0.1), "rear_right": (-0.2, -0.1)}


def main() -> None:
    """Run the example."""
    parser = plots.parser(__doc__)
    parser.add_argument("--robot", metavar="NAME", help="a robot of the package robot_descriptions")
    options = parser.parse_args()
    n = 64 if options.quick else 512

    if options.robot is None:
        legs = "".join(LEG.format(name=name, x=x, y=y) for name, (x, y) in LEGS.items())
        robot = clench.Model.from_xml(f'<robot name="quadruped">{TRUNK}{legs}</robot>', floating=True)
    else:
        robot = clench.load_description(options.robot, floating=True)
    spec = clench.ModelSpec.from_xml(robot.to_xml())
    spec.world.add_geom(name="floor", type="plane", size=[5, 5, 0.1])
    model = spec.build()

    # Contact stiffness relative to the load stays that of the original: its scales follow the masses.
    batch = clench.Batch(model, n)
    scale = np.random.default_rng(0).uniform(0.5, 2.0, (n, 1))
    batch.randomize("body_mass", batch.param("body_mass") * scale)
    batch.randomize("body_inertia", batch.param("body_inertia") * scale[..., np.newaxis], consistent=True)
    batch.qpos[:, 2] = 0.5
    rows = batch.rollout(steps=400 if options.quick else 1500, record=["qpos"], progress=True)
    height = rows["qpos"][:, :, 2]
    print(f"{n} robots of {batch.param('body_mass').sum(axis=1).min():.1f} to {batch.param('body_mass').sum(axis=1).max():.1f} kg")
    print(f"their trunks rest at {height[:, -1].min():.4f} to {height[:, -1].max():.4f} m")

    def draw(axes: Axes) -> None:
        axes.plot(np.arange(height.shape[1]) * float(model.timestep), height[:16].T, linewidth=0.8)
        axes.set(xlabel="time, s", ylabel="height of the trunk, m", title="Robots of different masses")

    plots.finish(options, draw)


if __name__ == "__main__":
    main()
