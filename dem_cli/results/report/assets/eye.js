// From where the reader looks at a scene: what is shown, what mouse and fingers do, what lies under the pointer.

const ROOMY = 1.16; // the picture over what it shows
const FARTHEST = 0.8; // of the size of the structure: what falls farther is not shown

class Eye {
  constructor(scene) {
    this.scene = scene;
    this.canvas = scene.canvas;
    this.flat = scene.data.dimension === 2;
    this.camera = new THREE.OrthographicCamera();
    this.camera.up.set(0, this.flat ? 1 : 0, this.flat ? 0 : 1); // the controls ask once, when they are made
    // the page scrolls over a view that nobody has clicked; this must hear the wheel before the controls do
    this.canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== this.canvas && !event.ctrlKey && !event.metaKey) event.stopImmediatePropagation();
    }, { capture: true });
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.canvas.style.touchAction = "pan-y"; // a finger that moves up or down scrolls the page
    this.controls.addEventListener("change", () => scene.request());
    this.turnable(!this.flat);
    const arrows = this.canvas.parentNode.querySelectorAll('[data-part="compass"] g');
    this.arrows = Array.from(arrows, (group, k) => ({
      direction: new THREE.Vector3().setComponent(k, 1), line: group.querySelector("line"), name: group.querySelector("text"),
    }));
  }

  /** What dragging does: turn, or move along. The other button or Shift does the other. */
  turnable(yes) {
    const { MOUSE, TOUCH } = THREE, [first, second] = yes ? [MOUSE.ROTATE, MOUSE.PAN] : [MOUSE.PAN, MOUSE.ROTATE];
    this.controls.mouseButtons = { LEFT: first, MIDDLE: MOUSE.DOLLY, RIGHT: second };
    this.controls.touches = yes ? { ONE: TOUCH.ROTATE, TWO: TOUCH.DOLLY_PAN } : { ONE: TOUCH.PAN, TWO: TOUCH.DOLLY_ROTATE };
  }

  /** Turn to the front and show all free blocks, where they were and where they come, but no corner that fell far. */
  fit() {
    const { low, high } = this.bounds(), size = high.map((value, k) => value - low[k]);
    const far = 4 * Math.hypot(...size), [x, y, z] = this.flat ? [0, 0, 1] : this.scene.data.eye;
    this.extent = this.seen(size, [x, y, z]).map((value) => ROOMY * value);
    this.controls.target.set(...low.map((value, k) => (value + high[k]) / 2));
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(x * far, y * far, z * far));
    Object.assign(this.camera, { near: -2 * far, far: 4 * far, zoom: 1 });
    this.controls.update();
    this.resize();
  }

  /** Width and height of a box of a size, seen from a direction. */
  seen(size, [x, y, z]) {
    if (this.flat) return size.slice(0, 2);
    const flat = Math.hypot(x, y), right = [-y / flat, x / flat, 0], up = [(-z * x) / flat, (-z * y) / flat, flat];
    return [right, up].map((axis) => size.reduce((sum, value, k) => sum + Math.abs(axis[k] * value), 0));
  }

  /** Turn around the structure by an angle. */
  orbit(angle) {
    const arm = this.camera.position.clone().sub(this.controls.target).applyAxisAngle(this.camera.up, angle);
    this.camera.position.copy(this.controls.target).add(arm);
    this.controls.update();
    this.scene.request();
  }

  /** Where x, y and z point, in a corner of the picture. */
  compass() {
    for (const axis of this.arrows || []) {
      const { x, y } = axis.direction.clone().transformDirection(this.camera.matrixWorldInverse);
      axis.line.setAttribute("x2", 20 * x);
      axis.line.setAttribute("y2", -20 * y);
      axis.name.setAttribute("x", 28 * x);
      axis.name.setAttribute("y", -28 * y);
    }
  }

  /** What all frames need, where they are drawn as they are; else this one. */
  bounds() {
    const { scene } = this;
    if (scene.data.window && scene.scale === 1) return { low: scene.data.window[0], high: scene.data.window[1] };
    const ground = scene.ground(), rest = [], now = [];
    scene.owners.forEach((block, v) => {
      if (scene.fixed[block] && scene.fixed.includes(0)) return;
      const corner = scene.corner(scene.vertexCorners[v]), at = scene.centroids.subarray(3 * block, 3 * block + 3);
      rest.push(ground.map((value, k) => value + at[k] + corner[k]));
      now.push(Array.from(scene.places.subarray(3 * v, 3 * v + 3)));
    });
    const start = box(rest), reach = FARTHEST * Math.max(...start.high.map((value, k) => value - start.low[k]).slice(0, this.flat ? 2 : 3));
    const near = (point) => point.every((value, k) => value > start.low[k] - reach && value < start.high[k] + reach);
    return box([...rest, ...now.filter(near)]);
  }

  resize() {
    const { camera, canvas } = this, { clientWidth: width, clientHeight: height } = canvas;
    if (!width || !height || !this.extent) return;
    this.scene.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio || 1, 3));
    this.scene.renderer.setSize(width, height, false);
    const unit = Math.max(this.extent[0] / width, this.extent[1] / height) / 2; // metres in half a pixel
    Object.assign(camera, { left: -unit * width, right: unit * width, top: unit * height, bottom: -unit * height });
    camera.updateProjectionMatrix();
    this.scene.request();
  }

  zoom(factor) {
    this.camera.zoom *= factor;
    this.camera.updateProjectionMatrix();
    this.scene.request();
  }

  /** The block at a place of the window, or −1. */
  under(clientX, clientY) {
    const view = this.canvas.getBoundingClientRect(), ray = new THREE.Raycaster();
    const x = ((clientX - view.left) / view.width) * 2 - 1, y = 1 - ((clientY - view.top) / view.height) * 2;
    ray.setFromCamera(new THREE.Vector2(x, y), this.camera);
    const hit = ray.intersectObject(this.scene.mesh).find(({ point }) => !this.scene.section.takes(point));
    return hit ? this.scene.owners[hit.face.a] : -1;
  }

  /** Where the centroid of a block is in the window. */
  place(block) {
    const view = this.canvas.getBoundingClientRect();
    const point = new THREE.Vector3(...this.scene.poses[block].place).project(this.camera);
    return [view.left + ((point.x + 1) / 2) * view.width, view.top + ((1 - point.y) / 2) * view.height];
  }
}

function box(points) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const point of points) {
    point.forEach((value, k) => {
      low[k] = Math.min(low[k], value);
      high[k] = Math.max(high[k], value);
    });
  }
  return { low, high };
}
