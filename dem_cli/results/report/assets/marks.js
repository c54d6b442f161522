// What is drawn on the blocks of a scene: joints by their state, forces, and the outline of the start. In the plane all of
// it stands before the blocks, whatever the direction of the look; in space blocks hide all but forces.

const WIDEST_FORCE = 0.16; // of the smaller side of an ordinary block
const LONGEST_FORCE = 0.42; // of the smaller side of the smaller block, to either side of the joint
const THINNEST_FORCE = 0.06; // of the widest

class Marks {
  constructor(scene) {
    const over = { depthTest: false, transparent: true }, among = { depthTest: scene.data.dimension === 3, transparent: true };
    this.scene = scene;
    this.jointLook = new THREE.LineMaterial({ ...among, vertexColors: true, linewidth: Math.min(3.2, Math.max(1.1, 32 / Math.sqrt(scene.n))) });
    this.joints = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), this.jointLook);
    this.forceLook = new THREE.MeshBasicMaterial({ ...over, opacity: 0.85 });
    this.bar = new THREE.BoxGeometry(1, 1, 1);
    this.ghostLook = new THREE.LineBasicMaterial({ ...among, opacity: 0.65 });
    this.looks = [this.jointLook, this.forceLook, this.ghostLook];
    this.ghost = new THREE.LineSegments(this.outline(), this.ghostLook);
    [this.ghost, this.joints].forEach((thing, i) => {
      thing.renderOrder = i + 1;
      thing.frustumCulled = false;
      scene.world.add(thing);
    });
  }

  themed() {
    this.forceLook.color.setRGB(...this.scene.paint.force);
    this.ghostLook.color.setRGB(...this.scene.paint.ghost);
  }

  draw() {
    this.drawJoints();
    this.drawForces();
    this.ghost.visible = this.scene.show.ghost;
  }

  /** Edges of the blocks at the start; in 2D of the faces that look at the reader. */
  outline() {
    const { faces, face_blocks: owners, fixed, centroids, data } = this.scene, ends = [];
    if (data.dimension === 3) {
      for (const end of this.scene.edgeEnds) {
        const block = this.scene.corner_blocks[end];
        if (!fixed[block]) this.scene.corner(end).forEach((value, axis) => ends.push(value + centroids[3 * block + axis]));
      }
    } else for (let at = 0, face = 0; at < faces.length; at += faces[at] + 1, face++) {
      const ring = faces.subarray(at + 1, at + 1 + faces[at]), block = owners[face];
      if (fixed[block] || this.scene.normal(ring).z < 0.999) continue;
      ring.forEach((corner, k) => {
        for (const end of [corner, ring[(k + 1) % ring.length]])
          this.scene.corner(end).forEach((value, axis) => ends.push(value + centroids[3 * block + axis]));
      });
    }
    return new THREE.BufferGeometry().setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends), 3));
  }

  /** A stroke from each contact point to the middle of its joint. */
  drawJoints() {
    const { frame, paint, show } = this.scene, ends = [], colours = [];
    frame.states.forEach((state, i) => {
      const block = frame.stroke_blocks[2 * i];
      for (const at of [6 * i, 6 * i + 3]) {
        ends.push(...this.scene.placed(block, frame.strokes.subarray(at, at + 3)));
        colours.push(...paint[STATES[state]]);
      }
    });
    this.joints.visible = show.joints && ends.length > 0;
    if (!this.joints.visible) return;
    this.joints.geometry.dispose();
    this.joints.geometry = new THREE.LineSegmentsGeometry().setPositions(ends).setColors(colours);
  }

  /** Bars as thick as the force is large: the thrust line through arches and columns, one bar a joint in walls. */
  drawForces() {
    const { world, frame, show, sides } = this.scene;
    if (this.bars) {
      world.remove(this.bars);
      this.bars.dispose();
      this.bars = null;
    }
    if (!show.forces || !frame.force_blocks.length) return;
    const found = this.thrust() || this.strokes(), most = Math.max(...found.map((bar) => bar.size));
    this.bars = new THREE.InstancedMesh(this.bar, this.forceLook, found.length);
    found.forEach(({ from, to, size }, i) => {
      const start = new THREE.Vector3(...from), along = new THREE.Vector3(...to).sub(start);
      const width = WIDEST_FORCE * median(sides) * Math.max(size / most, THINNEST_FORCE);
      const turn = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(1, 0, 0), along.clone().normalize());
      const extent = new THREE.Vector3(along.length(), width, width);
      this.bars.setMatrixAt(i, new THREE.Matrix4().compose(start.addScaledVector(along, 0.5), turn, extent));
    });
    this.bars.renderOrder = 3;
    this.bars.frustumCulled = false;
    world.add(this.bars);
  }

  force(i) {
    const { frame } = this.scene, vector = frame.forces.subarray(3 * i, 3 * i + 3), arm = frame.force_arms.subarray(3 * i, 3 * i + 3);
    return { vector, size: Math.hypot(...vector), at: this.scene.placed(frame.force_blocks[2 * i], arm) };
  }

  /** From joint to joint through every block that has two; null where thrust branches. */
  thrust() {
    const { n, frame, fixed } = this.scene, of = Array.from({ length: n }, () => []);
    frame.force_blocks.forEach((block, k) => fixed[block] || of[block].push(k >> 1));
    const chained = of.filter((joints) => joints.length === 2);
    if (!chained.length || of.some((joints) => joints.length > 2)) return null;
    return chained.map((joints) => {
      const [a, b] = joints.map((joint) => this.force(joint));
      return { from: a.at, to: b.at, size: 0.5 * (a.size + b.size) };
    });
  }

  strokes() {
    const { frame, sides } = this.scene, blocks = frame.force_blocks;
    return Array.from({ length: blocks.length / 2 }, (_, i) => {
      const { vector, size, at } = this.force(i);
      const reach = LONGEST_FORCE * Math.min(sides[blocks[2 * i]], sides[blocks[2 * i + 1]]);
      const end = (sign) => at.map((value, k) => value + (sign * reach * vector[k]) / size);
      return { from: end(-1), to: end(1), size };
    });
  }
}

function median(values) {
  return values.slice().sort((a, b) => a - b)[values.length >> 1];
}
