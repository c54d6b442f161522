// A plane that cuts the structure open: what lies beyond it is not drawn, blocks on it show their section.

const SECTION = 0.82; // how dark a section is
const RAISED = 3e-3; // of the size of the structure: its outline stands out

class Section {
  constructor(scene) {
    this.scene = scene;
    this.axis = null; // 0, 1, 2; null: nothing is cut
    // through a plane one sees the inside of a block: in one colour it is the section; the outside of the next one, which touches it, is set back
    this.shape = new THREE.BufferGeometry();
    this.colours = new Float32Array(scene.places.length);
    this.shape.setAttribute("position", scene.shape.attributes.position);
    this.shape.setAttribute("color", new THREE.BufferAttribute(this.colours, 3));
    this.shape.setIndex(scene.shape.index);
    const before = { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -2 }; // edges that lie on it
    const look = { vertexColors: true, side: THREE.BackSide, ...before };
    this.mesh = new THREE.Mesh(this.shape, new THREE.MeshBasicMaterial(look));
    this.outline = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial());
    for (const thing of [this.mesh, this.outline]) {
      thing.frustumCulled = false;
      thing.visible = false;
      scene.world.add(thing);
    }
  }

  /** Take away what lies beyond a place on an axis, or before it; null: nothing. */
  cut(axis, place, before) {
    const { scene } = this, side = before ? 1 : -1;
    Object.assign(this, { axis, place });
    this.plane = axis === null ? null : new THREE.Plane(new THREE.Vector3().setComponent(axis, side), -side * place);
    for (const look of [scene.mesh.material, scene.edges.material, this.mesh.material, ...scene.marks.looks]) look.clippingPlanes = this.plane ? [this.plane] : [];
    this.mesh.visible = this.outline.visible = axis !== null;
    this.tint();
    this.draw();
    scene.request();
  }

  /** Whether a cut took a point away. */
  takes(point) {
    return this.axis !== null && this.plane.distanceToPoint(point) < 0;
  }

  tint() {
    if (this.axis === null) return;
    this.outline.material.color.setRGB(...this.scene.paint.section);
    this.scene.owners.forEach((block, v) => {
      for (let k = 0; k < 3; k++) this.colours[3 * v + k] = SECTION * this.scene.blockColours[block][k];
    });
    this.shape.attributes.color.needsUpdate = true;
  }

  /** Where the plane cuts the faces of the blocks. */
  draw() {
    if (this.axis === null) return;
    const { faces, places, data } = this.scene, ends = [];
    const raised = -RAISED * data.size * this.plane.normal.getComponent(this.axis);
    const beyond = (v) => places[3 * v + this.axis] > this.place;
    for (let at = 0, v = 0; at < faces.length; v += faces[at], at += faces[at] + 1) {
      for (let k = 0; k < faces[at]; k++) {
        const a = v + k, b = v + ((k + 1) % faces[at]);
        if (beyond(a) === beyond(b)) continue;
        const [from, to] = [a, b].map((corner) => places.subarray(3 * corner, 3 * corner + 3));
        const share = (this.place - from[this.axis]) / (to[this.axis] - from[this.axis]);
        ends.push(...from.map((value, i) => value + share * (to[i] - value) + (i === this.axis ? raised : 0)));
      }
    }
    this.outline.geometry.dispose();
    this.outline.geometry = new THREE.BufferGeometry();
    this.outline.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(ends), 3));
  }
}
