"""VTK scene of blocks in a stone look, off screen: lit faces, crisp edges, joints and forces in front of them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dem_cli.core.model.model import Model
from dem_cli.core.records.frames import STATES, Frame
from dem_cli.results.post import style
from dem_cli.results.post.scene.axonometry import Axonometry
from dem_cli.results.render import marks, solids

_STONES = ("#e6dac3", "#c3bfba", "#d9bfa3", "#cdd2cc", "#e8e2d6")  # by material
_TINT = 0.045  # by which stones differ
_EDGE, _EDGE_WIDTH, _THINNEST_EDGE = "#57503f", 0.55, 0.75  # colour; points; pixels
_FINER = 2  # pixels are means of so many by so many
_LIGHT = (-5.0, 8.0, 9.0)  # where it comes from: right, up and towards the reader who stands before the structure
_FRONT = {2: 0.0, 3: 2.0}  # of the picture: by so much forces are nearer; in 2D marks say where the front is
_AROUND = 1.02  # of the window is in the picture
_WIDEST_STRIPE, _THINNEST_STRIPE = 3.4, 1.1  # points
_REACH = 0.16  # of the picture's smaller side: the longest arrow


class Camera(NamedTuple):
    """Camera of a parallel projection that frames the visible points."""

    centre: np.ndarray  # point in the middle of the picture [m], (3,)
    direction: np.ndarray  # unit, towards the eye, (3,)
    up: np.ndarray  # unit, upwards in the picture, (3,)
    width: float  # of what is to be seen [m]
    height: float
    light: np.ndarray  # direction that it comes from, (3,)


def camera(view: Axonometry, points: np.ndarray, before: Axonometry) -> Camera:
    """Frame points in space [m], (n, 3). before: the view from the front, which sets the light."""
    axes = np.stack(view)
    seen = points @ axes.T
    low, high = seen.min(axis=0), seen.max(axis=0)
    width, height = (high - low)[:2].tolist()
    return Camera(0.5 * (low + high) @ axes, view.eye, view.up, width, height, np.array(_LIGHT) @ np.stack(before))


class Scene:
    """Scene of a structure that draws one picture after the other; it needs `opengl.choose_window` first."""

    def __init__(self, model: Model, eye: Camera, width: int, height: int, points: float, deep: bool):
        """Create the scene. points: pixels of a typographic point. deep: with shades in corners, for oblique views."""
        import pyvista

        self.pyvista, self.model = pyvista, model
        self.surface = solids.surface(model)
        size = [_FINER * width, _FINER * height]
        self.plotter: Any = pyvista.Plotter(off_screen=True, window_size=size, lighting="none")
        self.metres = _AROUND * max(eye.height / height, eye.width / width)  # of a pixel
        self.points = points
        self.nearer = self.metres * eye.direction  # edges are drawn before faces
        self.front = _FRONT[model.dimension] * max(eye.width, eye.height) * eye.direction
        self.edge = _FINER * max(_EDGE_WIDTH * points, _THINNEST_EDGE)
        self.reach = _REACH * self.metres * min(width, height)
        self._set_up(eye, height, deep)
        self.stones = stone_colours(model)

    def _set_up(self, eye: Camera, height: int, deep: bool) -> None:
        plotter = self.plotter
        plotter.set_background("white")
        plotter.render_window.SetMultiSamples(0)  # several pixels make one
        sun = self.pyvista.Light(position=eye.light, focal_point=(0, 0, 0), light_type="scene light", intensity=1.0)
        sun.positional = False
        plotter.add_light(sun)
        plotter.add_light(self.pyvista.Light(light_type="headlight", intensity=0.25))
        plotter.enable_parallel_projection()
        far = 6.0 * max(eye.width, eye.height)
        plotter.camera.focal_point, plotter.camera.up = eye.centre, eye.up
        plotter.camera.position = eye.centre + far * eye.direction
        plotter.camera.parallel_scale = 0.5 * height * self.metres
        if deep:
            size = min(eye.width, eye.height)
            plotter.enable_ssao(radius=0.08 * size, bias=0.005 * size, kernel_size=64, blur=True)

    def close(self) -> None:
        """Free the memory of VTK."""
        self.plotter.close()

    def picture(
        self, shown: Frame, scale: float, moved: np.ndarray, look: Any, colours: np.ndarray | None
    ) -> np.ndarray:
        """Draw the structure in a frame, at `scale` and `moved` along [m], (height, width, 3) bytes.

        look: which joints and forces (RenderOptions); colours: of the blocks, (n_blocks, 3) in 0 … 1, else of stone.
        """
        from PIL import Image

        offset = solids.lifted(moved[np.newaxis])[0]
        where = solids.pose(shown.positions, shown.orientations)
        self._draw_blocks(solids.placed(self.surface, where) + offset, self.stones if colours is None else colours)
        if look.joints:
            self._draw_joints(shown, scale, offset)
        if look.forces:
            self._draw_forces(shown, look.forces, offset)
        self._draw_links(shown, offset)
        self.plotter.renderer.ResetCameraClippingRange()
        self.plotter.render()
        fine = self.plotter.screenshot(None, return_img=True)
        return np.asarray(Image.fromarray(fine).reduce(_FINER))

    def _draw_blocks(self, points: np.ndarray, colours: np.ndarray) -> None:
        mesh = self.pyvista.PolyData(points, self.surface.faces)
        mesh.cell_data["colour"] = np.rint(255.0 * colours[self.surface.face_owners]).astype(np.uint8)
        self.plotter.add_mesh(
            mesh, scalars="colour", rgb=True, ambient=0.34, diffuse=0.64, specular=0.0, name="blocks",
            reset_camera=False, render=False,
        )  # fmt: skip
        pairs = self.surface.edges
        edges = np.column_stack([np.full(len(pairs), 2), pairs]).ravel()
        self.plotter.add_mesh(
            self.pyvista.PolyData(points + self.nearer, lines=edges), color=_EDGE, line_width=self.edge,
            lighting=False, name="edges", reset_camera=False, render=False,
        )  # fmt: skip

    def _draw_joints(self, shown: Frame, scale: float, offset: np.ndarray) -> None:
        if not len(shown.contacts.joint):
            self.plotter.remove_actor("joints", render=False)
            return
        points = np.clip(32.0 / np.sqrt(self.model.n_blocks + 1), _THINNEST_STRIPE, _WIDEST_STRIPE)
        found = marks.stripes(self.model, shown, scale, float(points) * self.points * self.metres)
        kept = found.states != STATES.index("sticking")  # the edges of the stones show these
        faces = found.faces.reshape(-1, 5)[kept]
        if not len(faces):
            self.plotter.remove_actor("joints", render=False)
            return
        colours = np.array([_rgb(style.STATE_COLOURS[name]) for name in STATES])[found.states[kept]]
        stone = np.array(_rgb(_STONES[0]))
        colours = np.where(found.faint[kept][:, np.newaxis], 0.55 * colours + 0.45 * stone, colours)
        mesh = self.pyvista.PolyData(found.points + offset, faces.ravel())
        mesh.cell_data["colour"] = np.rint(255.0 * colours).astype(np.uint8)
        self.plotter.add_mesh(
            mesh, scalars="colour", rgb=True, lighting=False, name="joints", reset_camera=False, render=False
        )

    def _draw_forces(self, shown: Frame, look: str, offset: np.ndarray) -> None:
        found = marks.forces(self.model, shown, look, self.reach)
        if found is None:
            self.plotter.remove_actor("forces", render=False)
            return
        mesh = self.pyvista.PolyData(found.points + offset + self.front, lines=found.lines)
        mesh.point_data["radius"] = found.radii
        tubes = mesh.tube(scalars="radius", absolute=True, n_sides=16, capping=True)
        self.plotter.add_mesh(
            tubes, color=style.THRUST, ambient=0.45, diffuse=0.6, name="forces", reset_camera=False, render=False
        )

    def _draw_links(self, shown: Frame, offset: np.ndarray) -> None:
        found = marks.links(self.model, shown, self.reach)
        if found is None:
            return
        mesh = self.pyvista.PolyData(found.points + offset + self.front, lines=found.lines)
        mesh.point_data["radius"] = found.radii
        tubes = mesh.tube(scalars="radius", absolute=True, n_sides=16, capping=True)
        self.plotter.add_mesh(
            tubes, color=style.STEEL, ambient=0.45, diffuse=0.6, name="links", reset_camera=False, render=False
        )


def stone_colours(model: Model) -> np.ndarray:
    """Return the colour of each block by its material, with slight variation; fixed blocks are ground, (n_blocks,
    3).
    """
    stones = np.array([_rgb(colour) for colour in _STONES])[model.block_material % len(_STONES)]
    tints = 1.0 + _TINT * np.random.default_rng(1).uniform(-1.0, 1.0, model.n_blocks)
    stones = np.clip(stones * tints[:, np.newaxis], 0.0, 1.0)
    return np.where(model.fixed[:, np.newaxis], _rgb(style.GROUND), stones)


def _rgb(colour: str) -> tuple[float, float, float]:
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
