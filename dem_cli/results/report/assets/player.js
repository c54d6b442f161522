// What the reader does with the scene: time, colours, scale, and the block under the pointer.

const FRAMES_A_SECOND = 8;
const SWING = 1.6; // s, of a mode that is played
const SMOOTH = 30; // ms: where blocks take longer to place, a film shows its frames alone

function metres(value) {
  const size = Math.abs(value);
  if (size >= 1) return `${number(value, 3)} m`;
  return size >= 1e-4 ? `${number(1e3 * value, 3)} mm` : `${number(1e6 * value, 3)} µm`;
}

class Player {
  constructor(section, data, moved) {
    Object.assign(this, { section, data, moved });
    this.part = (name) => section.querySelector(`[data-part="${name}"]`);
    this.at = data.start;
    this.canvas = this.part("canvas");
    this.scene = new Scene(this.canvas, data);
    this.exaggeration();
    this.controls();
    this.pointer();
    this.keys();
    new ResizeObserver(() => this.scene.eye.resize()).observe(this.canvas);
    this.scene.set(this.at, this.scale());
    this.scene.eye.fit();
    this.go(this.at);
  }

  /** The slider counts tenths of a decade. */
  exaggeration() {
    const largest = Math.max(this.data.scale, ...this.data.frames.map((frame) => frame.scale));
    const slider = this.part("scale");
    slider.max = this.data.modes ? 10 : Math.ceil(10 * Math.log10(Math.max(largest, 10)));
    slider.min = this.data.modes ? -10 : 0;
    slider.value = Math.round(10 * Math.log10(this.data.scale));
    if (this.data.frames.every((frame) => frame.scale === this.data.scale)) this.part("automatic").closest("label").remove();
  }

  scale() {
    const automatic = this.part("automatic");
    if (automatic && automatic.checked) return this.data.frames[this.at].scale;
    const value = Number(this.part("scale").value);
    if (value === Math.round(10 * Math.log10(this.data.scale))) return this.data.scale;
    return Number((10 ** (value / 10)).toPrecision(value % 10 ? 2 : 1));
  }

  controls() {
    const { frames } = this.data, slider = this.part("slider"), on = (name, event, what) => this.part(name)?.addEventListener(event, what);
    slider.max = frames.length - 1;
    on("slider", "input", () => this.go(Number(slider.value)));
    on("play", "click", () => this.play());
    on("scale", "input", () => { const box = this.part("automatic"); if (box) box.checked = false; this.refresh(); });
    on("automatic", "change", () => this.refresh());
    on("colour", "change", (event) => { this.scene.colouring = event.target.value; this.scene.tint(); this.legend(); });
    for (const name of ["joints", "forces", "ghost", "carried"])
      on(name, "change", (event) => { this.scene.show[name] = event.target.checked; this.refresh(); });
    on("fit", "click", () => this.scene.eye.fit());
    on("nearer", "click", () => this.scene.eye.zoom(1.25));
    on("farther", "click", () => this.scene.eye.zoom(0.8));
    on("turn", "click", (event) => {
      const pressed = event.currentTarget.getAttribute("aria-pressed") !== "true";
      event.currentTarget.setAttribute("aria-pressed", String(pressed));
      this.scene.eye.turnable(pressed);
    });
    const list = this.part("block");
    this.data.ids.forEach((id, i) => list.add(new Option(id, i)));
    on("block", "change", () => this.select(Number(list.value)));
    for (const name of ["joints", "forces", "ghost", "carried"]) if (this.part(name)) this.scene.show[name] = this.part(name).checked;
    if (this.part("turn")) this.part("turn").setAttribute("aria-pressed", String(this.data.dimension === 3));
    if (frames.length === 1) for (const name of ["play", "slider", "speed"]) this.part(name).disabled = true;
    this.cutting(on);
    this.stages();
  }

  /** A plane across an axis that takes away what is beyond it; between the ends of the structure as it was built. */
  cutting(on) {
    if (!this.part("cut")) return;
    const { low, high } = this.scene.extent(), place = this.part("cut-place");
    const cut = () => {
      const name = this.part("cut").value, axis = name ? "xyz".indexOf(name) : null;
      const at = name ? low[axis] + (Number(place.value) / Number(place.max)) * (high[axis] - low[axis]) : 0;
      this.scene.section.cut(axis, at, this.part("cut-side").checked);
      this.part("cut-place").disabled = this.part("cut-side").disabled = !name;
      this.part("cut-says").textContent = name ? `${name} = ${number(at, 3)} m` : "";
    };
    for (const name of ["cut", "cut-place", "cut-side"]) on(name, name === "cut-place" ? "input" : "change", cut);
    cut();
  }

  /** A strip below the slider: which stretch of frames belongs to which stage. */
  stages() {
    const strip = this.part("stages"), { frames } = this.data;
    for (let a = 0, b = 0; a < frames.length; a = b) {
      while (b < frames.length && frames[b].stage === frames[a].stage) b++;
      const part = document.createElement("span");
      part.textContent = b - a > 0.16 * frames.length ? frames[a].stage : "";
      part.title = frames[a].stage;
      part.style.flexGrow = b - a;
      part.style.setProperty("--colour", `var(--line-${frames[a].stage})`);
      strip.append(part);
    }
  }

  refresh() {
    this.scene.set(this.at, this.scale());
    this.say();
  }

  /** Show frame i. */
  go(i) {
    this.at = Math.min(Math.max(i, 0), this.data.frames.length - 1);
    this.part("slider").value = this.at;
    this.refresh();
    this.moved(this.at);
  }

  play() {
    this.playing = !this.playing;
    const button = this.part("play");
    button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    button.classList.toggle("playing", this.playing);
    if (!this.playing) return this.refresh();
    if (!this.data.modes && this.at === this.data.frames.length - 1) this.go(0);
    this.since = performance.now();
    this.smooth = this.data.follows;
    this.tick();
  }

  tick() {
    if (!this.playing) return;
    requestAnimationFrame(() => this.tick());
    const speed = Number(this.part("speed").value), passed = ((performance.now() - this.since) / 1000) * speed;
    if (this.data.modes) return this.scene.set(this.at, this.scale() * Math.cos((2 * Math.PI * passed) / SWING));
    const { frames } = this.data;
    if (this.at === frames.length - 1) return this.play();
    const step = (i) => (this.data.in_seconds ? frames[i + 1].time - frames[i].time : 1 / FRAMES_A_SECOND);
    let at = this.at, left = passed;
    while (at < frames.length - 1 && left >= step(at)) left -= step(at++); // frames may be closer than what a screen shows
    if (at !== this.at) {
      this.since = performance.now() - (1000 * left) / speed;
      this.go(at);
    } else if (this.smooth && left > 0) {
      const before = performance.now();
      this.scene.set(at, this.scale(), left / step(at));
      this.smooth = performance.now() - before < SMOOTH;
    }
  }

  say() {
    const frame = this.data.frames[this.at], scale = this.scale(), words = this.data.modes ? [] : [frame.stage];
    if (frame.says) words.push(frame.says);
    if (frame.displacement && !this.data.of_any_size) words.push(`moved ${metres(frame.displacement)}`);
    this.part("says").textContent = words.join(" · ");
    this.part("slider").setAttribute("aria-valuetext", words.join(", "));
    this.part("drawn").textContent = this.data.of_any_size ? "of any size" : scale === 1 ? "true scale" : `× ${number(scale, 3)}`;
    this.legend();
    this.inspect();
  }

  legend() {
    const colours = this.scene.largest(), bar = this.part("ramp"), angle = this.scene.colouring === "rotation";
    bar.hidden = !colours;
    if (colours) this.part("most").textContent = angle ? `${number((180 / Math.PI) * colours.most, 3)}°` : metres(colours.most);
  }

  select(block) {
    this.scene.picked = block;
    this.part("block").value = block;
    this.scene.tint();
    this.inspect();
  }

  /** Everything known about the chosen block in this frame. */
  inspect() {
    const list = this.part("inspector"), block = this.scene.picked;
    list.replaceChildren();
    if (block < 0) return;
    for (const [name, text] of this.facts(block)) {
      const term = document.createElement("dt"), value = document.createElement("dd");
      term.textContent = name;
      value.textContent = text;
      list.append(term, value);
    }
  }

  facts(block) {
    const { shifts, turns } = this.scene.frame, d = this.data.dimension, i = 3 * block;
    const shares = Array.from(shifts.subarray(i, i + d), (value, k) => `${"xyz"[k]} ${metres(value)}`).join(", ");
    const turn = (180 / Math.PI) * (d === 2 ? turns[i + 2] : this.scene.angle(block));
    const state = this.data.frames[this.at].states.data ? STATES[this.scene.states()[block]] : "";
    return [
      ["displacement", `${metres(this.scene.displacement(block))} (${shares})`],
      ["rotation", `${number(turn, 3)}°`],
      ["joints", this.scene.fixed[block] ? "fixed block" : state],
      ["mass", `${number(this.scene.masses[block])} kg, ${this.data.materials[block]}`],
    ];
  }

  pointer() {
    const tip = this.part("tip"), box = this.canvas.parentNode;
    const leave = () => { tip.hidden = true; this.hover(-1); };
    this.canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) return leave();
      const block = this.scene.eye.under(event.clientX, event.clientY);
      if (block < 0) return leave();
      this.hover(block);
      const [displacement, rotation] = this.facts(block);
      tip.textContent = `${this.data.ids[block]}\n${displacement[1]}\n${rotation[1]}`;
      tip.hidden = false;
      const place = box.getBoundingClientRect(), left = event.clientX - place.left;
      tip.style.left = `${Math.min(left + 14, place.width - tip.offsetWidth - 4)}px`;
      tip.style.top = `${Math.max(event.clientY - place.top - tip.offsetHeight - 10, 4)}px`;
    });
    this.canvas.addEventListener("pointerleave", leave);
    this.canvas.addEventListener("pointerdown", (event) => { this.down = [event.clientX, event.clientY]; });
    this.canvas.addEventListener("click", (event) => {
      const dragged = this.down && Math.hypot(event.clientX - this.down[0], event.clientY - this.down[1]) > 4;
      if (!dragged) this.select(this.scene.eye.under(event.clientX, event.clientY));
    });
  }

  hover(block) {
    if (this.scene.hovered === block) return;
    this.scene.hovered = block;
    this.scene.tint();
  }

  keys() {
    const does = {
      " ": () => this.play(), ArrowRight: () => this.go(this.at + 1), ArrowLeft: () => this.go(this.at - 1),
      Home: () => this.go(0), End: () => this.go(this.data.frames.length - 1),
      "+": () => this.scene.eye.zoom(1.25), "-": () => this.scene.eye.zoom(0.8), 0: () => this.scene.eye.fit(),
      n: () => this.select((this.scene.picked + 1) % this.scene.n), Escape: () => this.select(-1),
    };
    if (this.data.dimension === 3) Object.assign(does, { a: () => this.scene.eye.orbit(-Math.PI / 12), d: () => this.scene.eye.orbit(Math.PI / 12) });
    this.canvas.addEventListener("keydown", (event) => {
      if (!does[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      does[event.key]();
    });
  }
}
