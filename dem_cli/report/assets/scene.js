// The structure in WebGL: blocks as polyhedra that are placed anew for each frame, joints and forces on top of them.
// Knows nothing of the page around it; three.js does the drawing.

const LIGHT = { x: -0.08, y: 0.18, z: 0.22, ambient: 0.78 }; // a face that looks at the reader has its own colour
const RAMP = ["#efe7d8", "#f4cf8e", "#e8953a", "#bf4a24", "#6d0f23"]; // from stone to what moves most
const STATES = ["open", "sticking", "sliding", "hairline"]; // as dem_cli/report/view.py counts them
const WIDEST_FORCE = 0.16; // of the smaller side of an ordinary block
const LONGEST_FORCE = 0.42; // of the smaller side of the smaller block, to either side of the joint

function rgb(text) {
  const colour = new THREE.Color(text);
  return [colour.r, colour.g, colour.b];
}

const RAMP_RGB = () => RAMP.map(rgb);

/** Rotation matrix of a rotation vector, row by row. */
function rotation(x, y, z) {
  const angle = Math.hypot(x, y, z);
  if (angle === 0) return [1, 0, 0, 0, 1, 0, 0, 0, 1];
  const s = Math.sin(angle), c = 1 - Math.cos(angle);
  const [a, b, d] = [x / angle, y / angle, z / angle];
  return [
    1 - c * (b * b + d * d), c * a * b - s * d, c * a * d + s * b,
    c * a * b + s * d, 1 - c * (a * a + d * d), c * b * d - s * a,
    c * a * d - s * b, c * b * d + s * a, 1 - c * (a * a + b * b),
  ];
}

class Scene {
  constructor(canvas, data) {
    THREE.ColorManagement.enabled = false;
    this.canvas = canvas;
    this.data = data;
    this.n = data.ids.length;
    for (const name of ["masses", "fixed", "centroids", "corners", "corner_blocks", "faces", "face_blocks"])
      this[name] = unpack(data[name]);
    this.frames = data.frames.map((frame) => ({ ...frame, ...unpacked(frame) }));
    this.show = { joints: true, forces: false, ghost: false, carried: data.carried };
    this.colouring = "stone";
    this.picked = this.hovered = -1;
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.world = new THREE.Scene();
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -1000, 1000);
    this.blocks();
    this.marks();
    this.steer();
    this.themed();
  }

  /** One mesh of all faces; its corners are written for each frame. */
  blocks() {
    const owners = [], corners = [], triangles = [], shades = [];
    for (let at = 0; at < this.faces.length; at += this.faces[at] + 1) {
      const ring = this.faces.subarray(at + 1, at + 1 + this.faces[at]), first = corners.length;
      const shade = this.shade(ring);
      for (const corner of ring) {
        corners.push(corner);
        owners.push(this.corner_blocks[corner]);
        shades.push(shade);
      }
      for (let k = 2; k < ring.length; k++) triangles.push(first, first + k - 1, first + k);
    }
    Object.assign(this, { owners, vertexCorners: corners, shades });
    this.shape = new THREE.BufferGeometry();
    this.places = new Float32Array(3 * corners.length);
    this.colours = new Float32Array(3 * corners.length);
    this.shape.setAttribute("position", new THREE.BufferAttribute(this.places, 3));
    this.shape.setAttribute("color", new THREE.BufferAttribute(this.colours, 3));
    this.shape.setIndex(triangles);
    this.triangles = triangles;
    this.mesh = new THREE.Mesh(this.shape, new THREE.MeshBasicMaterial({ vertexColors: true }));
    this.mesh.frustumCulled = false;
    this.world.add(this.mesh);
    this.sides = Array.from({ length: this.n }, (_, block) => this.side(block));
  }

  corner(i) {
    return this.corners.subarray(3 * i, 3 * i + 3);
  }

  normal(ring) {
    const [a, b, c] = [0, 1, 2].map((k) => new THREE.Vector3(...this.corner(ring[k])));
    return b.sub(a).cross(c.sub(a)).normalize();
  }

  shade(ring) {
    const normal = this.normal(ring);
    return LIGHT.ambient + LIGHT.x * normal.x + LIGHT.y * normal.y + LIGHT.z * normal.z;
  }

  /** The smallest side of the box around a block. */
  side(block) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < this.corner_blocks.length; i++) {
      if (this.corner_blocks[i] !== block) continue;
      this.corner(i).forEach((value, k) => {
        low[k] = Math.min(low[k], value);
        high[k] = Math.max(high[k], value);
      });
    }
    return Math.min(...low.map((value, k) => high[k] - value).slice(0, this.data.dimension));
  }

  /** Joints, forces and the outline of the start: drawn over the blocks whatever stands before them. */
  marks() {
    const over = { depthTest: false, transparent: true };
    this.jointLook = new THREE.LineMaterial({ ...over, vertexColors: true, linewidth: this.n > 150 ? 2.2 : 3.2 });
    this.joints = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), this.jointLook);
    this.forceLook = new THREE.MeshBasicMaterial({ ...over, opacity: 0.85 });
    this.bar = new THREE.BoxGeometry(1, 1, 1);
    this.ghostLook = new THREE.LineBasicMaterial({ ...over, opacity: 0.65 });
    this.ghost = new THREE.LineSegments(this.outline(), this.ghostLook);
    [this.ghost, this.joints].forEach((thing, i) => {
      thing.renderOrder = i + 1;
      thing.frustumCulled = false;
      this.world.add(thing);
    });
  }

  /** Edges of the faces at the start; in 2D those that look at the reader. */
  outline() {
    const ends = [];
    for (let at = 0, face = 0; at < this.faces.length; at += this.faces[at] + 1, face++) {
      const ring = this.faces.subarray(at + 1, at + 1 + this.faces[at]), block = this.face_blocks[face];
      if (this.fixed[block] || (this.data.dimension === 2 && this.normal(ring).z < 0.999)) continue;
      ring.forEach((corner, k) => {
        for (const end of [corner, ring[(k + 1) % ring.length]])
          this.corner(end).forEach((value, axis) => ends.push(value + this.centroids[3 * block + axis]));
      });
    }
    return new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends), 3));
  }

  steer() {
    // the page scrolls over a view that nobody has clicked; this must hear the wheel before the controls do
    this.canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== this.canvas && !event.ctrlKey && !event.metaKey) event.stopImmediatePropagation();
    }, { capture: true });
    this.controls = new THREE.OrbitControls(this.camera, this.canvas);
    this.canvas.style.touchAction = "pan-y";
    this.controls.addEventListener("change", () => this.request());
    this.turnable(this.data.dimension === 3);
  }

  /** What dragging does: turn, or move along. The other button or Shift does the other. */
  turnable(yes) {
    const { MOUSE, TOUCH } = THREE;
    this.controls.mouseButtons = { LEFT: yes ? MOUSE.ROTATE : MOUSE.PAN, MIDDLE: MOUSE.DOLLY, RIGHT: yes ? MOUSE.PAN : MOUSE.ROTATE };
    this.controls.touches = { ONE: yes ? TOUCH.ROTATE : TOUCH.PAN, TWO: yes ? TOUCH.DOLLY_ROTATE : TOUCH.DOLLY_PAN };
  }

  /** Colours from the style sheet; again whenever the reader wants it dark. */
  themed() {
    const style = getComputedStyle(this.canvas);
    const named = (name) => rgb(style.getPropertyValue(name).trim());
    this.paint = Object.fromEntries(["stone", "ground", "accent", "force", "ghost", ...STATES].map((name) => [name, named(`--${name}`)]));
    this.ramp = [this.paint.stone, ...RAMP_RGB().slice(1)];
    this.forceLook.color.setRGB(...this.paint.force);
    this.ghostLook.color.setRGB(...this.paint.ghost);
    if (this.frame) this.set(this.at, this.scale);
  }

  /** Show frame `at` with displacements times `scale`. */
  set(at, scale) {
    this.at = at;
    this.scale = scale;
    this.frame = this.frames[at];
    const { shifts, turns } = this.frame, ground = this.ground();
    this.poses = Array.from({ length: this.n }, (_, block) => {
      const i = 3 * block, turn = rotation(scale * turns[i], scale * turns[i + 1], scale * turns[i + 2]);
      return { turn, place: ground.map((value, k) => value + this.centroids[i + k] + scale * shifts[i + k]) };
    });
    for (let v = 0; v < this.owners.length; v++)
      this.places.set(this.placed(this.owners[v], this.corner(this.vertexCorners[v])), 3 * v);
    this.shape.attributes.position.needsUpdate = true;
    this.shape.computeBoundingSphere();
    this.tint();
    this.drawJoints();
    this.drawForces();
    this.ghost.visible = this.show.ghost;
    this.request();
  }

  /** Where the ground is. */
  ground() {
    return this.show.carried ? this.data.ground[this.at] : [0, 0, 0];
  }

  /** A point that hangs on a block, in space. */
  placed(block, arm) {
    const { turn, place } = this.poses[block];
    return [0, 3, 6].map((row, k) => place[k] + turn[row] * arm[0] + turn[row + 1] * arm[1] + turn[row + 2] * arm[2]);
  }

  displacement(block) {
    return Math.hypot(...this.frame.shifts.subarray(3 * block, 3 * block + 3));
  }

  angle(block) {
    return Math.hypot(...this.frame.turns.subarray(3 * block, 3 * block + 3));
  }

  /** What the joints of each block do: sliding before open before sticking. */
  states() {
    const worst = new Array(this.n).fill(1), rank = [2, 1, 3, 1];
    this.frame.states.forEach((state, i) => {
      for (const block of this.frame.stroke_blocks.subarray(2 * i, 2 * i + 2))
        if (rank[state] > rank[worst[block]]) worst[block] = state;
    });
    return worst;
  }

  /** The largest value of what the colours show, in this frame. */
  largest() {
    const measure = { displacement: (b) => this.displacement(b), rotation: (b) => this.angle(b) }[this.colouring];
    if (!measure) return null;
    let most = 0;
    for (let block = 0; block < this.n; block++) if (!this.fixed[block]) most = Math.max(most, measure(block));
    return { most, measure };
  }

  tint() {
    const scale = this.largest(), states = this.colouring === "state" ? this.states() : null;
    const own = (block) => {
      if (this.fixed[block]) return this.paint.ground;
      if (states) return this.paint[STATES[states[block]]];
      return scale && scale.most > 0 ? this.along(scale.measure(block) / scale.most) : this.paint.stone;
    };
    const colours = Array.from({ length: this.n }, (_, block) => {
      const mixed = block === this.picked ? 0.75 : block === this.hovered ? 0.4 : 0;
      return own(block).map((value, k) => value + mixed * (this.paint.accent[k] - value));
    });
    this.owners.forEach((block, v) => {
      for (let k = 0; k < 3; k++) this.colours[3 * v + k] = Math.min(1, this.shades[v] * colours[block][k]);
    });
    this.shape.attributes.color.needsUpdate = true;
    this.request();
  }

  along(share) {
    const at = Math.min(Math.max(share, 0), 1) * (this.ramp.length - 1), low = Math.min(Math.floor(at), this.ramp.length - 2);
    return this.ramp[low].map((value, k) => value + (at - low) * (this.ramp[low + 1][k] - value));
  }

  drawJoints() {
    const { strokes, states, stroke_blocks: blocks } = this.frame, ends = [], colours = [];
    states.forEach((state, i) => {
      const block = blocks[2 * i];
      ends.push(...this.placed(block, strokes.subarray(6 * i, 6 * i + 3)), ...this.placed(block, strokes.subarray(6 * i + 3, 6 * i + 6)));
      colours.push(...this.paint[STATES[state]], ...this.paint[STATES[state]]);
    });
    this.joints.visible = this.show.joints && ends.length > 0;
    if (!this.joints.visible) return;
    this.joints.geometry.dispose();
    this.joints.geometry = new THREE.LineSegmentsGeometry().setPositions(ends).setColors(colours);
  }

  /** Bars as thick as the force is large: the thrust line through arches and columns, one bar a joint in walls. */
  drawForces() {
    if (this.bars) {
      this.world.remove(this.bars);
      this.bars.dispose();
      this.bars = null;
    }
    if (!this.show.forces || !this.frame.force_blocks.length) return;
    const found = this.thrust() || this.strokes(), widest = WIDEST_FORCE * median(this.sides);
    const most = Math.max(...found.map((bar) => bar.size));
    this.bars = new THREE.InstancedMesh(this.bar, this.forceLook, found.length);
    found.forEach(({ from, to, size }, i) => {
      const a = new THREE.Vector3(...from), along = new THREE.Vector3(...to).sub(a), width = widest * Math.max(size / most, 0.06);
      const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(1, 0, 0), along.clone().normalize());
      const middle = a.addScaledVector(along, 0.5);
      this.bars.setMatrixAt(i, new THREE.Matrix4().compose(middle, turn, new THREE.Vector3(along.length(), width, width)));
    });
    this.bars.renderOrder = 3;
    this.bars.frustumCulled = false;
    this.world.add(this.bars);
  }

  force(i) {
    const vector = this.frame.forces.subarray(3 * i, 3 * i + 3), block = this.frame.force_blocks[2 * i];
    return { vector, size: Math.hypot(...vector), at: this.placed(block, this.frame.force_arms.subarray(3 * i, 3 * i + 3)) };
  }

  /** From joint to joint through every block that has two; null where thrust branches. */
  thrust() {
    const of = Array.from({ length: this.n }, () => []);
    this.frame.force_blocks.forEach((block, k) => this.fixed[block] || of[block].push(k >> 1));
    const chained = of.filter((joints) => joints.length === 2);
    if (!chained.length || of.some((joints) => joints.length > 2)) return null;
    return chained.map((joints) => {
      const [a, b] = joints.map((joint) => this.force(joint));
      return { from: a.at, to: b.at, size: 0.5 * (a.size + b.size) };
    });
  }

  strokes() {
    const { force_blocks: blocks } = this.frame;
    return Array.from({ length: blocks.length / 2 }, (_, i) => {
      const { vector, size, at } = this.force(i);
      const reach = LONGEST_FORCE * Math.min(this.sides[blocks[2 * i]], this.sides[blocks[2 * i + 1]]);
      const end = (sign) => at.map((value, k) => value + (sign * reach * vector[k]) / size);
      return { from: end(-1), to: end(1), size };
    });
  }

  /** Turn to the front and show all free blocks, where they were and where they are now, but no corner that fell far. */
  fit() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity], rest = [], now = [];
    const ground = this.ground();
    this.owners.forEach((block, v) => {
      if (this.fixed[block] && this.fixed.includes(0)) return;
      rest.push(Array.from(this.corner(this.vertexCorners[v]), (value, k) => value + this.centroids[3 * block + k] + ground[k]));
      now.push(Array.from(this.places.subarray(3 * v, 3 * v + 3)));
    });
    const widen = (point) => point.forEach((value, k) => {
      low[k] = Math.min(low[k], value);
      high[k] = Math.max(high[k], value);
    });
    rest.forEach(widen);
    const reach = 0.8 * Math.max(...high.map((value, k) => value - low[k]).slice(0, this.data.dimension));
    const [bottom, top] = [low.slice(), high.slice()];
    now.filter((point) => point.every((value, k) => value > bottom[k] - reach && value < top[k] + reach)).forEach(widen);
    this.middle = low.map((value, k) => (value + high[k]) / 2);
    this.extent = [1.16 * (high[0] - low[0]), 1.16 * (high[1] - low[1])];
    if (this.data.dimension === 3) this.extent = [1.2, 1.2].map((f) => f * Math.hypot(...high.map((value, k) => value - low[k])));
    const far = 4 * Math.hypot(...this.extent, high[2] - low[2]);
    const from = this.data.dimension === 3 ? [0.5, -0.75, 0.4] : [0, 0, 1];
    this.camera.up.set(0, this.data.dimension === 3 ? 0 : 1, this.data.dimension === 3 ? 1 : 0);
    this.camera.position.set(...this.middle.map((value, k) => value + from[k] * far));
    Object.assign(this.camera, { near: -2 * far, far: 4 * far, zoom: 1 });
    this.controls.target.set(...this.middle);
    this.controls.update();
    this.resize();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height || !this.extent) return;
    this.renderer.setPixelRatio(Math.min(globalThis.devicePixelRatio || 1, 3));
    this.renderer.setSize(width, height, false);
    const unit = Math.max(this.extent[0] / width, this.extent[1] / height); // metres a pixel
    Object.assign(this.camera, { left: -unit * width / 2, right: unit * width / 2, top: unit * height / 2, bottom: -unit * height / 2 });
    this.camera.updateProjectionMatrix();
    this.request();
  }

  zoom(factor) {
    this.camera.zoom *= factor;
    this.camera.updateProjectionMatrix();
    this.request();
  }

  request() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.waiting = 0;
    this.renderer.render(this.world, this.camera);
  }

  /** The block at a place of the window, or −1. */
  at_pointer(clientX, clientY) {
    const box = this.canvas.getBoundingClientRect();
    const where = new THREE.Vector2(((clientX - box.left) / box.width) * 2 - 1, 1 - ((clientY - box.top) / box.height) * 2);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(where, this.camera);
    const [hit] = ray.intersectObject(this.mesh);
    return hit ? this.owners[this.triangles[3 * hit.faceIndex]] : -1;
  }

  /** Where the centroid of a block is in the window. */
  on_screen(block) {
    const box = this.canvas.getBoundingClientRect();
    const point = new THREE.Vector3(...this.poses[block].place).project(this.camera);
    return [box.left + ((point.x + 1) / 2) * box.width, box.top + ((1 - point.y) / 2) * box.height];
  }
}

function unpacked(frame) {
  const names = ["shifts", "turns", "stroke_blocks", "strokes", "states", "force_blocks", "force_arms", "forces"];
  return Object.fromEntries(names.map((name) => [name, unpack(frame[name])]));
}

function median(values) {
  return values.slice().sort((a, b) => a - b)[values.length >> 1];
}
