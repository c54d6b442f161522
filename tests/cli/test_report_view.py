"""Reports in a real browser: the picture of the structure, what is drawn where, and what mouse and keys do with it."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp
from shown.opened import near, until
from synthetic import LENGTH, wall_frames, wall_model
from synthetic.solid_runs import DEPTH, HEIGHT, solid_frames, solid_wall
from synthetic.tumbling import DURATION, column, frame_at

from dem_cli.results.post.frame_measures import scaled
from dem_cli.results.post.scene.axonometry import axonometry
from dem_cli.results.render.chamfered import sharp
from dem_cli.results.render.solids import placed, pose, surface

STONE, RAMP_END = (0xEF, 0xE7, 0xD8), (0x6D, 0x0F, 0x23)  # of assets/page.css and assets/scene.js
JOINTS = {"open": (0xC5, 0x1B, 0x7D), "sticking": (0x9A, 0xA3, 0xAD), "sliding": (0xE0, 0x82, 0x14)}
SKY = (0xE9, 0xEE, 0xF3)
SECTION = tuple(0.82 * value for value in STONE)  # of assets/section.js
SOLID = solid_wall(3, 2)  # of the page "solid"
TOP_RIGHT, FOOT = 21, 1  # blocks: one that moves, one that does not


def test_blocks_are_drawn_where_they_are_and_move_with_the_slider(opened):
    model, frames = wall_model(), wall_frames(wall_model())
    page = opened("wall")
    last = page.place(TOP_RIGHT)
    screen = page.screen()
    assert near(page.colour(page.place(FOOT), screen), STONE)
    assert near(page.colour(last, screen), STONE)
    slider = page.part("slider")
    page.keys(slider, *["\ue012"] * 11)  # arrow left, to the first frame
    assert page.run("return dem.player.at") == 0
    assert page.part("says").text.startswith("gravity")
    first, foot = page.place(TOP_RIGHT), page.place(FOOT)
    between = model.centroids[TOP_RIGHT] - model.centroids[FOOT]
    scale = (first - foot)[0] / between[0]  # pixels a metre
    assert first - foot == pytest.approx(scale * between * (1, -1), abs=0.5)
    moved = (frames[-1].positions - frames[0].positions)[TOP_RIGHT]
    assert last - first == pytest.approx(scale * moved * (1, -1), abs=0.5)
    right = scale * (0.25 * LENGTH + 0.5 * moved[0])
    beyond = (first[0] + right, first[1])  # beside the wall at the start, stone at the end
    assert near(page.colour(beyond), SKY)
    page.keys(slider, "\ue010")  # end
    assert near(page.colour(beyond), STONE)


def test_every_corner_is_where_the_results_have_it(opened):
    model, frames = wall_model(), wall_frames(wall_model())
    page, skin = opened("wall"), surface(model)
    for at, scale in ((11, 1.0), (9, 1.0), (11, 3.0)):
        page.run("dem.player.scene.set(arguments[0], arguments[1])", at, scale)
        drawn = np.array(page.run("return Array.from(dem.player.scene.places)")).reshape(-1, 3)
        which = page.run("return dem.player.scene.vertexCorners")
        shown = scaled(model, frames[at], scale)
        expected = placed(skin, pose(shown.positions, shown.orientations))[which]
        np.testing.assert_allclose(drawn, expected, atol=1e-7)


def test_rotations_in_space(opened):
    """The view places 2D blocks with the rotations of 3D."""
    page = opened("wall")
    for vector in ([0.0, 0.0, 0.3], [0.4, -1.2, 2.0], [1e-9, 0.0, 0.0], [0.0, 0.0, 0.0]):
        found = np.reshape(page.run("return rotation(...arguments[0])", vector), (3, 3))
        np.testing.assert_allclose(found, Rotation.from_rotvec(vector).as_matrix(), atol=1e-14)


def test_the_whole_structure_is_on_the_canvas(opened):
    page = opened("wall")
    stone = (np.abs(page.canvas() - STONE).max(axis=2) <= 3).mean()
    assert 0.2 < stone < 0.8
    left, top, width, height = page.box("canvas")
    places = np.array([page.place(block) for block in range(1, 22)])
    assert (places > (left, top)).all()
    assert (places < (left + width, top + height)).all()


def test_keys_and_play(opened):
    page = opened("wall")
    canvas = page.part("canvas")
    page.keys(canvas, "\ue011")  # home
    assert page.run("return dem.player.at") == 0
    page.keys(canvas, "\ue014", "\ue014")  # right, right
    assert page.run("return dem.player.at") == 2
    page.keys(canvas, "nn")
    assert page.part("block").get_attribute("value") == "1"
    before = page.run("return dem.player.scene.eye.camera.zoom")
    page.keys(canvas, "+")
    assert page.run("return dem.player.scene.eye.camera.zoom") == pytest.approx(1.25 * before)
    page.keys(canvas, " ")
    assert page.part("play").get_attribute("aria-label") == "Pause"
    assert until(lambda: page.run("return dem.player.at"), 11)
    assert until(lambda: page.part("play").get_attribute("aria-label"), "Play")


def test_pointer_and_inspector(opened):
    from selenium.webdriver import ActionChains

    page = opened("wall")
    canvas, place = page.part("canvas"), page.place(TOP_RIGHT)
    box = page.box("canvas")
    offset = np.rint(place - box[:2] - 0.5 * box[2:]).astype(int).tolist()
    ActionChains(page.browser, duration=0).move_to_element_with_offset(canvas, *offset).perform()
    assert until(lambda: page.part("tip").is_displayed(), True)
    assert page.part("tip").text.startswith(f"wall-{TOP_RIGHT}\n")
    ActionChains(page.browser, duration=0).move_to_element_with_offset(canvas, *offset).click().perform()
    assert page.part("block").get_attribute("value") == str(TOP_RIGHT)
    frames = wall_frames(wall_model())
    moved = np.linalg.norm((frames[-1].positions - frames[0].positions)[TOP_RIGHT])
    text = page.part("inspector").text
    assert f"{1e3 * moved:.3g} mm" in text
    assert f"{np.degrees(abs(frames[-1].orientations[TOP_RIGHT, 0])):.3g}°" in text
    assert not near(page.colour(place), STONE)  # it is marked


def test_colours_exaggeration_and_forces(opened):
    page = opened("wall")
    page.part("joints").click()
    most = int(np.argmax(np.linalg.norm(wall_frames(wall_model())[-1].positions - wall_model().centroids, axis=1)))
    page.run("const c = dem.player.part('colour'); c.value = 'displacement'; c.dispatchEvent(new Event('change'))")
    screen = page.screen()
    assert near(page.colour(page.place(most), screen), RAMP_END)
    assert near(page.colour(page.place(FOOT), screen), STONE)
    page.keys(page.part("slider"), "\ue011")
    page.keys(page.part("slider"), "\ue014")
    still = page.place(TOP_RIGHT)
    page.part("automatic").click()
    scale = page.run("return dem.player.scale()")
    assert scale > 100
    assert page.part("drawn").text == f"× {scale:g}"
    page.part("automatic").click()
    assert page.place(TOP_RIGHT) == pytest.approx(still)
    page.keys(page.part("slider"), "\ue010")
    before = page.canvas()
    page.part("forces").click()
    assert (np.abs(page.canvas() - before).max(axis=2) > 40).sum() > 100


def test_joints_have_the_colour_of_what_they_do(opened):
    page = opened("wall")
    page.run("dem.player.go(7)")  # the last frames have no joint that sticks
    shown = page.canvas()
    page.part("joints").click()
    hidden = page.canvas()
    for state, colour in JOINTS.items():
        there, gone = ((np.abs(picture - colour).max(axis=2) <= 4).sum() for picture in (shown, hidden))
        assert there > gone + 50, state
    page.part("joints").click()
    page.run("dem.player.go(1)")  # a frame in which nothing touches
    assert (np.abs(page.canvas() - JOINTS["sticking"]).max(axis=2) <= 4).sum() == 0


def test_solids_are_where_the_results_have_them(opened):
    frames = solid_frames(SOLID)
    page, skin = opened("solid"), sharp(SOLID)
    for at, scale in ((7, 1.0), (3, 100.0), (7, -0.5)):  # a mode swings to both sides
        page.run("dem.player.scene.set(arguments[0], arguments[1])", at, scale)
        shown = scaled(SOLID, frames[at], scale)
        expected = placed(skin, pose(shown.positions, shown.orientations))
        drawn = np.array(page.run("return Array.from(dem.player.scene.places)")).reshape(-1, 3)
        np.testing.assert_allclose(drawn, expected[page.run("return dem.player.scene.vertexCorners")], atol=1e-6)
        ends = np.array(page.run("return Array.from(dem.player.scene.edges.geometry.attributes.position.array)"))
        np.testing.assert_allclose(ends.reshape(-1, 3), expected[skin.edges.ravel()], atol=1e-6)
    assert not page.complaints()


def test_one_walks_around_a_structure_in_space(opened):
    """It falls towards +y: there the reader stands, x to the left; dragging and keys turn it, z stays upwards."""
    from selenium.webdriver import ActionChains

    page = opened("solid")
    eye = """const {camera, controls} = dem.player.scene.eye;
        return camera.position.clone().sub(controls.target).normalize().toArray()"""
    start = np.array(page.run(eye))
    np.testing.assert_allclose(start, axonometry(SOLID, solid_frames(SOLID)[-1]).eye, atol=1e-6)
    canvas = page.part("canvas")
    page.keys(canvas, "d")
    turned = np.array(page.run(eye))
    assert np.degrees(np.arctan2(*turned[1::-1]) - np.arctan2(*start[1::-1])) == pytest.approx(15.0)
    assert turned[2] == pytest.approx(start[2])
    mouse = ActionChains(page.browser).move_to_element_with_offset(canvas, 40, 0)
    mouse.click_and_hold().move_by_offset(60, 0).release().perform()
    dragged = np.array(page.run(eye))
    assert np.arctan2(*dragged[1::-1]) < np.arctan2(*turned[1::-1]) - 0.1
    assert dragged[2] == pytest.approx(start[2])
    page.run("dem.player.scene.draw()")
    arrows = """const lines = document.querySelectorAll('[data-part="compass"] line');
        return Array.from(lines, ({x2, y2}) => [x2.baseVal.value, y2.baseVal.value])"""
    z = np.array(page.run(arrows))[2]
    assert z[0] == pytest.approx(0.0, abs=1e-4)
    assert z[1] < -5.0  # upwards


def test_blocks_that_tumble_turn_evenly_between_frames(opened):
    """Half way between two frames: about one axis, and no block changes its shape; the ground goes along."""
    page, model = opened("tumbling"), column()
    times = np.linspace(0.0, DURATION, 60)
    at, share = 45, 0.375
    before, after = (frame_at(model, "collapse", 0, times[k]) for k in (at, at + 1))
    page.run("dem.player.scene.show.carried = true; dem.player.scene.set(arguments[0], 1, arguments[1])", at, share)
    drawn = np.array(page.run("return Array.from(dem.player.scene.places)")).reshape(-1, 3)
    corners = page.run("return dem.player.scene.vertexCorners")
    ground = np.array(page.run("return dem.player.data.ground"))
    moved = ground[at] + share * (ground[at + 1] - ground[at])
    skin, expected = sharp(model), np.zeros((len(drawn), 3))
    for block in range(model.n_blocks):
        turns = Rotation.from_quat([f.orientations[block] for f in (before, after)], scalar_first=True)
        middle = (1.0 - share) * before.positions[block] + share * after.positions[block]
        own = skin.owners[corners] == block
        expected[own] = middle + Slerp([0.0, 1.0], turns)(share).apply(skin.points[corners][own])
    np.testing.assert_allclose(drawn, expected + moved, atol=2e-6)
    assert np.linalg.norm(after.positions - before.positions, axis=1).max() > 0.05
    for one, other in (((0.0, 0.0, 3.0), (0.0, 0.0, -3.0)), ((0.0, 0.0, 0.0), (0.4, -1.2, 2.0))):  # the shorter way
        found = page.run("return between(...arguments)", one, other, 0.5)
        wanted = Slerp([0.0, 1.0], Rotation.from_rotvec([one, other]))(0.5)
        np.testing.assert_allclose(Rotation.from_rotvec(found).as_matrix(), wanted.as_matrix(), atol=1e-12)


def test_light_stays_where_it_is_when_blocks_turn(opened):
    """A face that looks upwards is the lightest, whatever face it was."""
    page = opened("tumbling")
    script = """dem.player.scene.set(arguments[0], 1);
        const {rings, shades, poses} = dem.player.scene;
        return rings.map(({first, block, normal: {x, y, z}}) => {
          const {turn} = poses[block];
          return [shades[first], turn[6] * x + turn[7] * y + turn[8] * z];
        })"""
    for at in (0, 50):
        shades, upwards = np.array(page.run(script, at)).T
        order = np.argsort(upwards)
        assert upwards[order[-1]] > 0.7
        assert shades[upwards > 0.7].min() > shades[np.abs(upwards) < 0.3].max()


def test_the_picture_shows_where_blocks_come(opened):
    """It opens at the collapse; what falls later is on the canvas too, and plays."""
    page = opened("tumbling")
    left, top, width, height = page.box("canvas")
    for at in (0, 30, 59):
        page.run("dem.player.go(arguments[0])", at)
        places = np.array([page.place(block) for block in range(1, 7)])
        assert (places > (left, top)).all()
        assert (places < (left + width, top + height)).all()
    page.run("dem.player.go(40); dem.player.part('speed').value = '0.1'; dem.player.play()")
    assert until(lambda: page.run("return dem.player.at > 40"), True)
    page.run("dem.player.play()")
    frame = page.run("return dem.player.at")
    shifts = np.array(page.run("return Array.from(dem.player.scene.poses, ({place}) => place)"))
    base = np.array(page.run("return dem.player.scene.ground()"))
    wanted = frame_at(column(), "collapse", 0, np.linspace(0.0, DURATION, 60)[frame]).positions
    np.testing.assert_allclose(shifts - base, wanted, atol=1e-5)  # where it stands, it is a computed state


def test_a_cut_shows_sections_and_takes_what_is_beyond(opened):
    page = opened("solid")
    page.keys(page.part("slider"), "\ue011")  # home: nothing has moved
    choose = """const part = document.querySelector(`[data-part="${arguments[0]}"]`);
        part[arguments[2]] = arguments[1]; part.dispatchEvent(new Event(part.type === "range" ? "input" : "change"))"""
    assert not page.part("cut-place").is_enabled()
    page.run(choose, "cut", "y", "value")
    assert page.part("cut-says").text == f"y = {DEPTH / 2:.3g} m"
    place = page.place(1)  # the middle of the first block lies in the plane of the cut
    assert near(page.colour(place + 3), SECTION)
    ends = np.array(page.run("return Array.from(dem.player.scene.section.outline.geometry.attributes.position.array)"))
    ends = ends.reshape(-1, 2, 3)
    np.testing.assert_allclose(ends[:, :, 1], DEPTH / 2, atol=0.02)  # it stands out a little
    lengths = np.abs(ends[:, 1] - ends[:, 0]).sum(axis=1)
    free = np.prod(np.ptp(SOLID.vertices.reshape(-1, 8, 3), axis=1)[1:, ::2], axis=1)
    assert free.sum() == pytest.approx(2.0 * 3 * HEIGHT)
    around = 2.0 * np.ptp(SOLID.vertices.reshape(-1, 8, 3), axis=1)[:, ::2].sum()
    assert lengths.sum() == pytest.approx(around, rel=1e-5)  # each block with its own outline
    page.run(choose, "cut-place", 0, "value")
    assert page.run("return dem.player.scene.eye.under(arguments[0], arguments[1])", *place) == -1  # all is gone
    page.run(choose, "cut-side", True, "checked")
    assert page.run("return dem.player.scene.eye.under(arguments[0], arguments[1])", *place) == 1
    page.run(choose, "cut", "", "value")
    assert near(page.colour(place + 3), STONE, 45)
