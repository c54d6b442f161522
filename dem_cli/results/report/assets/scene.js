// The structure in WebGL: blocks as polyhedra that are placed anew for each frame. Knows nothing of the page around it;
// three.js does the drawing.

// How a normal changes the colour of a face: in the plane one that looks at the reader has its own; in space tops are
// light and the narrow sides dark, from wherever one looks.
const LIGHT = {
  2: (normal) => 0.78 - 0.08 * normal.x + 0.18 * normal.y + 0.22 * normal.z,
  3: (normal, [x, y]) => 0.88 + 0.14 * normal.z - 0.12 * Math.abs(x * normal.x + y * normal.y),
};
const RAMP = ["#f4cf8e", "#e8953a", "#bf4a24", "#6d0f23"]; // after the stone that stays: to what moves most
const STATES = ["open", "sticking", "sliding", "hairline"]; // as dem_cli/results/report/view.py counts them

function rgb(text) {
  const colour = new THREE.Color(text);
  return [colour.r, colour.g, colour.b];
}

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

/** Unit quaternion of a rotation vector, scalar first. */
function quaternion([x, y, z]) {
  const angle = Math.hypot(x, y, z), s = angle ? Math.sin(angle / 2) / angle : 0.5;
  return [Math.cos(angle / 2), s * x, s * y, s * z];
}

/** Rotation vector a share of the way from one rotation to another, about one axis, the shorter way round. */
function between(from, to, share) {
  const a = quaternion(from), [w, x, y, z] = quaternion(to);
  const cosine = a[0] * w + a[1] * x + a[2] * y + a[3] * z, sign = cosine < 0 ? -1 : 1;
  const angle = Math.acos(Math.min(1, Math.abs(cosine))), sine = Math.sin(angle);
  const [p, q] = sine < 1e-6 ? [1 - share, share] : [Math.sin((1 - share) * angle) / sine, Math.sin(share * angle) / sine];
  const mixed = [w, x, y, z].map((value, k) => p * a[k] + q * sign * value), vector = mixed.slice(1);
  const length = Math.hypot(...vector), turn = 2 * Math.atan2(length, mixed[0]);
  return vector.map((value) => (length ? (turn / length) * value : 0));
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
    this.renderer.localClippingEnabled = true;
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.world = new THREE.Scene();
    this.blocks();
    this.marks = new Marks(this);
    this.eye = new Eye(this);
    this.themed();
  }

  /** One mesh of all faces; its corners are written for each frame. */
  blocks() {
    const owners = [], corners = [], triangles = [];
    this.rings = [];
    for (let at = 0; at < this.faces.length; at += this.faces[at] + 1) {
      const ring = this.faces.subarray(at + 1, at + 1 + this.faces[at]), first = corners.length;
      for (const corner of ring) {
        corners.push(corner);
        owners.push(this.corner_blocks[corner]);
      }
      this.rings.push({ first, after: corners.length, block: this.corner_blocks[ring[0]], normal: this.normal(ring) });
      for (let k = 2; k < ring.length; k++) triangles.push(first, first + k - 1, first + k);
    }
    Object.assign(this, { owners, vertexCorners: corners, shades: new Float32Array(corners.length) });
    for (const ring of this.rings) this.shade(ring, ring.normal);
    this.shape = new THREE.BufferGeometry();
    this.places = new Float32Array(3 * corners.length);
    this.colours = new Float32Array(3 * corners.length);
    this.shape.setAttribute("position", new THREE.BufferAttribute(this.places, 3));
    this.shape.setAttribute("color", new THREE.BufferAttribute(this.colours, 3));
    this.shape.setIndex(triangles);
    const behind = { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }; // of the lines on them
    this.mesh = new THREE.Mesh(this.shape, new THREE.MeshBasicMaterial({ vertexColors: true, ...(this.data.edges && behind) }));
    this.mesh.frustumCulled = false;
    this.world.add(this.mesh);
    this.section = new Section(this);
    this.edgeEnds = this.data.edges ? unpack(this.data.edges) : [];
    const edges = new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * this.edgeEnds.length), 3));
    this.edges = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.5 }));
    this.edges.frustumCulled = false;
    this.world.add(this.edges);
    this.sides = this.smallest();
  }

  /** The box around everything as it was built. */
  extent() {
    return box(Array.from(this.corner_blocks, (block, i) => Array.from(this.corner(i), (value, k) => value + this.centroids[3 * block + k])));
  }

  corner(i) {
    return this.corners.subarray(3 * i, 3 * i + 3);
  }

  normal(ring) {
    const points = Array.from(ring, (corner) => new THREE.Vector3(...this.corner(corner))), sum = new THREE.Vector3();
    points.forEach((point, k) => sum.add(point.clone().cross(points[(k + 1) % points.length])));
    return sum.normalize();
  }

  shade({ first, after }, normal) {
    this.shades.fill(LIGHT[this.data.dimension](normal, this.data.along), first, after);
  }

  /** Light comes from where it comes from, however blocks in space have turned. */
  light() {
    if (this.data.dimension === 2) return;
    for (const ring of this.rings) {
      const { turn } = this.poses[ring.block], { x, y, z } = ring.normal;
      const [a, b, c] = [0, 3, 6].map((row) => turn[row] * x + turn[row + 1] * y + turn[row + 2] * z);
      this.shade(ring, { x: a, y: b, z: c });
    }
  }

  /** The smallest side of the box around each block. */
  smallest() {
    const points = Array.from({ length: this.n }, () => []);
    this.corner_blocks.forEach((block, i) => points[block].push(Array.from(this.corner(i))));
    return points.map(box).map(({ low, high }) => Math.min(...low.slice(0, this.data.dimension).map((value, k) => high[k] - value)));
  }

  /** Colours from the style sheet; again whenever the reader wants it dark. */
  themed() {
    const style = getComputedStyle(this.canvas);
    const named = (name) => rgb(style.getPropertyValue(name).trim());
    this.paint = Object.fromEntries(["stone", "ground", "accent", "force", "ghost", "section", ...STATES].map((name) => [name, named(`--${name}`)]));
    this.ramp = [this.paint.stone, ...RAMP.map(rgb)];
    this.edges.material.color.setRGB(...this.paint.section);
    this.marks.themed();
    if (this.frame) this.set(this.at, this.scale);
  }

  /** Show frame `at` with displacements times `scale`, or blocks a share of the way from it to the next one. */
  set(at, scale, share = 0) {
    this.at = at;
    this.scale = scale;
    this.frame = this.frames[at];
    const now = this.frame, next = share ? this.frames[at + 1] : now, ground = this.ground(share);
    this.poses = Array.from({ length: this.n }, (_, block) => {
      const i = 3 * block, [from, to] = [now, next].map(({ turns }) => [0, 1, 2].map((k) => scale * turns[i + k]));
      const shift = (k) => now.shifts[i + k] + share * (next.shifts[i + k] - now.shifts[i + k]);
      const turn = rotation(...(share ? between(from, to, share) : from));
      return { turn, place: ground.map((value, k) => value + this.centroids[i + k] + scale * shift(k)) };
    });
    this.light();
    for (let v = 0; v < this.owners.length; v++)
      this.places.set(this.placed(this.owners[v], this.corner(this.vertexCorners[v])), 3 * v);
    this.shape.attributes.position.needsUpdate = true;
    const ends = this.edges.geometry.attributes.position;
    this.edgeEnds.forEach((corner, e) => ends.array.set(this.placed(this.corner_blocks[corner], this.corner(corner)), 3 * e));
    ends.needsUpdate = true;
    this.shape.computeBoundingSphere();
    this.tint();
    this.section.draw();
    this.marks.draw();
    this.request();
  }

  /** Where the ground is. */
  ground(share = 0) {
    const { ground } = this.data, next = ground[Math.min(this.at + 1, ground.length - 1)];
    return this.show.carried ? ground[this.at].map((value, k) => value + share * (next[k] - value)) : [0, 0, 0];
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
    const colours = this.blockColours = Array.from({ length: this.n }, (_, block) => {
      const mixed = block === this.picked ? 0.75 : block === this.hovered ? 0.4 : 0;
      return own(block).map((value, k) => value + mixed * (this.paint.accent[k] - value));
    });
    this.owners.forEach((block, v) => {
      for (let k = 0; k < 3; k++) this.colours[3 * v + k] = Math.min(1, this.shades[v] * colours[block][k]);
    });
    this.shape.attributes.color.needsUpdate = true;
    this.section.tint();
    this.request();
  }

  along(share) {
    const at = Math.min(Math.max(share, 0), 1) * (this.ramp.length - 1), low = Math.min(Math.floor(at), this.ramp.length - 2);
    return this.ramp[low].map((value, k) => value + (at - low) * (this.ramp[low + 1][k] - value));
  }

  request() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.waiting = 0;
    this.renderer.render(this.world, this.eye.camera);
    this.eye.compass();
  }
}

function unpacked(frame) {
  const names = ["shifts", "turns", "stroke_blocks", "strokes", "states", "force_blocks", "force_arms", "forces"];
  return Object.fromEntries(names.map((name) => [name, unpack(frame[name])]));
}
