// Charts as SVG: lines, levels, bands; a mark that follows the view, and a pointer that reads values.

const SVG = "http://www.w3.org/2000/svg";
const ROOM = { right: 14, top: 10, bottom: 42 };
const TYPES = { f4: Float32Array, u4: Uint32Array, u1: Uint8Array };

/** Typed array of what dem_cli/results/report/pack.py packed; an array stays one. */
function unpack(packed) {
  if (Array.isArray(packed)) return packed;
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  return new TYPES[packed.type](bytes.buffer);
}

function element(tag, parent, attributes = {}, text = "") {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text) made.textContent = text;
  parent.append(made);
  return made;
}

/** Round numbers that divide a range into about `n` parts. */
function ticks(low, high, n) {
  const raw = (high - low) / n, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= raw * 0.999);
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return { found, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

function number(value, digits = 4) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e6 || size < 1e-4 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return text.replace("-", "−");
}

class Chart {
  /** pick(i): the reader chose mark i. */
  constructor(figure, spec, pick) {
    Object.assign(this, { figure, spec, pick, at: null, zoom: null });
    this.lines = spec.lines.map((line) => ({ ...line, x: unpack(line.x), y: unpack(line.y) }));
    this.spans = this.lines.flatMap((line) => (line.spans || []).map((span) => ({ ...span, line })));
    this.bands = (spec.bands || []).map((b) => ({ ...b, x: unpack(b.x), low: unpack(b.low), high: unpack(b.high) }));
    this.hidden = new Set();
    this.svg = element("svg", figure.querySelector(".plot"), { role: "img", "aria-label": this.says() });
    this.read = figure.querySelector(".reading");
    this.svg.addEventListener("pointermove", (event) => this.point(event));
    this.svg.addEventListener("pointerleave", () => this.point(null));
    this.svg.addEventListener("click", (event) => this.choose(event));
    this.legend();
    this.width = 0;
    const watch = new ResizeObserver(() => (this.svg.isConnected ? this.resize() : watch.disconnect()));
    watch.observe(this.svg.parentNode);
    this.resize();
  }

  says() {
    const names = this.spec.lines.map((line) => line.name).join(", ");
    return `${this.spec.title}: ${this.spec.y} against ${this.spec.x}; ${names}`;
  }

  legend() {
    const list = this.figure.querySelector(".legend");
    list.replaceChildren();
    const one = (name, colour, kind, toggle) => {
      const item = document.createElement("li"), key = document.createElement(toggle ? "button" : "span");
      const swatch = document.createElement("i");
      swatch.className = kind;
      swatch.style.color = `var(--line-${colour})`;
      key.append(swatch, name);
      if (toggle) {
        key.type = "button";
        key.setAttribute("aria-pressed", "true");
        key.addEventListener("click", () => {
          if (!this.hidden.delete(name)) this.hidden.add(name);
          key.setAttribute("aria-pressed", String(!this.hidden.has(name)));
          this.draw();
        });
      }
      item.append(key);
      list.append(item);
    };
    const many = this.lines.length > 1;
    for (const line of this.lines) one(line.name, line.colour, line.tints ? "shades" : line.bare ? "dot" : "stroke", many);
    for (const band of this.bands) one(band.name, band.colour, "area", false);
    if (this.spans.some((span) => span.alone)) one("bracket, no answer", "7", "dash", false);
    if ((this.spec.missing || []).length) one("no answer", "9", "cross", false);
    for (const level of this.spec.levels || []) one(level.name, level.colour, level.dash ? "dash" : "stroke", false);
    for (const vertical of this.spec.verticals || []) one(vertical.name, vertical.colour, "dash", false);
    for (const zoom of this.spec.zooms || []) {
      const item = document.createElement("li"), button = document.createElement("button");
      Object.assign(button, { type: "button", className: "zoom", textContent: zoom.name });
      button.setAttribute("aria-pressed", "false");
      button.addEventListener("click", () => {
        this.zoom = this.zoom ? null : zoom;
        button.setAttribute("aria-pressed", String(Boolean(this.zoom)));
        this.draw();
      });
      item.append(button);
      list.append(item);
    }
  }

  resize() {
    const width = Math.round(this.svg.parentNode.clientWidth);
    if (!width || width === this.width) return;
    this.width = width;
    this.height = Math.round(Math.min(340, Math.max(210, 0.68 * width)));
    this.draw();
  }

  /** Lowest and highest of what is shown, with some room. */
  range(axis) {
    let low = Infinity, high = -Infinity;
    const take = (value) => {
      if (!Number.isFinite(value)) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    };
    const inside = (x) => !this.zoom || x <= this.zoom.to;
    for (const line of this.lines) {
      if (this.hidden.has(line.name)) continue;
      for (let i = 0; i < line.x.length; i++) if (inside(line.x[i])) take(line[axis][i]);
    }
    for (const span of this.spans) if (!this.hidden.has(span.line.name)) (axis === "x" ? [span.x] : [span.low, span.high ?? NaN]).forEach(take);
    if (axis === "x") (this.spec.missing || []).forEach(take);
    if (axis === "y") {
      for (const band of this.bands) { band.low.forEach(take); band.high.forEach(take); }
      for (const level of this.spec.levels || []) take(level.value);
    }
    if (axis === "y" && this.spec.limits) [low, high] = this.spec.limits;
    if (!(low <= high)) [low, high] = [0, 1];
    if (axis === "x" && this.zoom) high = this.zoom.to;
    if (low > 0 && low < 0.4 * high) low = 0;
    const room = 0.05 * (high - low) || Math.abs(high) || 1;
    return [low === 0 && axis === "x" ? 0 : low - room, high + room];
  }

  draw() {
    const { svg, width, height } = this;
    if (!width) return;
    const right = width - ROOM.right, floor = height - ROOM.bottom;
    const [x0, x1] = this.range("x"), [y0, y1] = this.range("y");
    this.up = ticks(y0, y1, Math.max(3, Math.round((floor - ROOM.top) / 48)));
    this.left = 34 + 7 * Math.max(...this.up.found.map((y) => label(y, this.up.digits).length));
    this.px = (x) => this.left + ((x - x0) / (x1 - x0)) * (right - this.left);
    this.py = (y) => floor - ((y - y0) / (y1 - y0)) * (floor - ROOM.top);
    svg.replaceChildren();
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.axes(x0, x1, right, floor);
    const id = `clip-${this.spec.id}`;
    const clip = element("clipPath", element("defs", svg), { id });
    element("rect", clip, { x: this.left, y: ROOM.top - 4, width: right - this.left, height: floor - ROOM.top + 8 });
    const inside = element("g", svg, { "clip-path": `url(#${id})` });
    for (const band of this.bands) this.area(inside, band);
    for (const level of this.spec.levels || []) this.level(inside, level, right);
    for (const vertical of this.spec.verticals || []) this.stroke(inside, vertical, this.px(vertical.value), ROOM.top, this.px(vertical.value), floor);
    for (const line of this.lines) if (!this.hidden.has(line.name)) this.line(inside, line);
    for (const span of this.spans) if (!this.hidden.has(span.line.name)) this.span(inside, span);
    for (const x of this.spec.missing || []) this.cross(svg, this.px(x), floor - 6);
    this.pointer = element("circle", svg, { class: "pointer", r: 4 });
    this.now = element("g", svg, { class: "now" });
    this.mark(this.at);
  }

  axes(x0, x1, right, floor) {
    const { svg } = this, grid = element("g", svg, { class: "grid" });
    const across = ticks(x0, x1, Math.max(3, Math.round((right - this.left) / 90)));
    for (const y of this.up.found) {
      element("line", grid, { x1: this.left, x2: right, y1: this.py(y), y2: this.py(y), class: Math.abs(y) < 1e-12 ? "zero" : "" });
      element("text", svg, { x: this.left - 8, y: this.py(y) + 4, "text-anchor": "end" }, label(y, this.up.digits));
    }
    for (const x of across.found) {
      element("line", grid, { x1: this.px(x), x2: this.px(x), y1: floor, y2: floor + 4 });
      element("text", svg, { x: this.px(x), y: floor + 18, "text-anchor": "middle" }, label(x, across.digits));
    }
    element("line", grid, { x1: this.left, x2: right, y1: floor, y2: floor, class: "zero" });
    element("text", svg, { x: (this.left + right) / 2, y: floor + 36, "text-anchor": "middle", class: "name" }, this.spec.x);
    element("text", svg, { transform: `translate(13 ${(ROOM.top + floor) / 2}) rotate(-90)`, "text-anchor": "middle", class: "name" }, this.spec.y);
  }

  area(parent, band) {
    const up = Array.from(band.x, (x, i) => `${this.px(x)} ${this.py(band.high[i])}`);
    const down = Array.from(band.x, (x, i) => `${this.px(x)} ${this.py(band.low[i])}`).reverse();
    element("path", parent, { d: `M${up.concat(down).join("L")}Z`, class: "band" }).style.fill = `var(--line-${band.colour})`;
  }

  level(parent, level, right) {
    if (level.band) {
      const [low, high] = level.band.map(this.py);
      const box = element("rect", parent, { x: this.left, width: right - this.left, y: high, height: Math.max(low - high, 0.5), class: "band" });
      box.style.fill = `var(--line-${level.colour})`;
    }
    this.stroke(parent, level, this.left, this.py(level.value), right, this.py(level.value));
  }

  stroke(parent, look, x1, y1, x2, y2) {
    const made = element("line", parent, { x1, y1, x2, y2, "stroke-dasharray": look.dash || "4 3" });
    if (!look.dash && look.band !== undefined) made.removeAttribute("stroke-dasharray");
    made.style.stroke = `var(--line-${look.colour})`;
  }

  line(parent, line) {
    for (let i = 0; line.points && i < line.x.length; i++) {
      const dot = element("circle", parent, { cx: this.px(line.x[i]), cy: this.py(line.y[i]), r: line.points });
      dot.style.fill = line.tints ? line.tints[i] : `var(--line-${line.colour})`;
    }
    if (line.bare) return;
    let path = "", pen = "M";
    for (let i = 0; i < line.x.length; i++) {
      const x = this.px(line.x[i]), y = this.py(line.y[i]);
      if (!Number.isFinite(x) || !Number.isFinite(y)) { pen = "M"; continue; }
      path += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
      pen = "L";
    }
    const made = element("path", parent, { d: path, class: "line", "data-name": line.name });
    made.style.stroke = `var(--line-${line.colour})`;
    if (line.width) made.style.strokeWidth = line.width;
  }

  /** A bracket: a bar between its ends, dashed where it is all that is known; an arrow up where the upper end is not. */
  span(parent, { x, low, high, alone, line }) {
    const at = this.px(x), from = this.py(low), to = high === null ? from : this.py(high);
    const top = high === null ? `M${at - 4} ${from}L${at} ${from - 7}L${at + 4} ${from}Z` : `M${at - 4} ${to}H${at + 4}`;
    const stem = element("path", parent, { d: `M${at} ${from}V${to}`, class: alone ? "span alone" : "span", "stroke-dasharray": alone ? "2 2" : "none" });
    const ends = element("path", parent, { d: `M${at - 4} ${from}H${at + 4}${top}`, class: "span" });
    for (const made of [stem, ends]) made.style.stroke = `var(--line-${line.colour})`;
  }

  /** On the axis: a run of which nothing is known. */
  cross(parent, x, y) {
    element("path", parent, { d: `M${x - 4} ${y - 4}l8 8M${x - 4} ${y + 4}l8 -8`, class: "missing" });
  }

  /** Show where the view is: a point on the curve, or an instant. */
  mark(i) {
    this.at = i;
    const marks = this.spec.marks;
    if (!this.now || !marks || i === null || !marks[i]) return;
    const [x, y] = marks[i], place = Math.min(this.px(x), this.width - 2), floor = this.height - ROOM.bottom;
    this.now.replaceChildren();
    if (x === null) return;
    element("line", this.now, { x1: place, x2: place, y1: ROOM.top, y2: floor });
    if (y !== null) element("circle", this.now, { cx: place, cy: this.py(y), r: 5.5 });
  }

  /** The sample nearest to the pointer. */
  nearest(event) {
    const box = this.svg.getBoundingClientRect(), scale = this.width / box.width;
    const x = (event.clientX - box.left) * scale, y = (event.clientY - box.top) * scale;
    let best = null, least = 60 ** 2;
    for (const line of this.lines) {
      if (this.hidden.has(line.name)) continue;
      for (let i = 0; i < line.x.length; i++) {
        const away = (this.px(line.x[i]) - x) ** 2 + (this.py(line.y[i]) - y) ** 2;
        if (away < least) { least = away; best = { line, i }; }
      }
    }
    return { x, y, best };
  }

  point(event) {
    const best = event && this.nearest(event).best;
    this.pointer.style.opacity = best ? 1 : 0;
    this.read.textContent = "";
    if (!best) return;
    const x = best.line.x[best.i], y = best.line.y[best.i], names = best.line.labels;
    this.pointer.setAttribute("cx", this.px(x));
    this.pointer.setAttribute("cy", this.py(y));
    this.read.textContent = `${names ? names[best.i] : best.line.name}: ${number(x)} → ${number(y)}`;
  }

  choose(event) {
    const { marks } = this.spec;
    if (!marks || !this.pick) return;
    const { x, y } = this.nearest(event);
    const away = marks.map(([a, b]) => (this.px(a) - x) ** 2 + (b === null ? 0 : (this.py(b) - y) ** 2));
    this.pick(away.indexOf(Math.min(...away)));
  }
}

function label(value, digits) {
  if (Math.abs(value) >= 1e6 || digits > 5) return number(value, 3);
  return value.toFixed(digits).replace("-", "−").replace(/^−(0(\.0*)?)$/, "$1");
}
