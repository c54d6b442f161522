// A table of runs that can be sorted and filtered, and a chart of any two of its columns.

const MOST_LINES = 12; // of a chart
const COMPARE = { "<": (a, b) => a < b, ">": (a, b) => a > b, "<=": (a, b) => a <= b, ">=": (a, b) => a >= b, "=": (a, b) => String(a) === String(b), "!=": (a, b) => String(a) !== String(b) };

class Runs {
  constructor(section, data) {
    Object.assign(this, { section, data, order: null, down: false, all: false });
    this.part = (name) => section.querySelector(`[data-part="${name}"]`);
    this.part("filter").addEventListener("input", () => this.show());
    this.part("all").addEventListener("change", (event) => { this.all = event.target.checked; this.show(); });
    const numeric = data.columns.filter((_, i) => data.rows.some((row) => typeof row[i] === "number"));
    for (const [name, chosen] of Object.entries(data.axes)) {
      const select = this.part(name);
      if (name === "family") select.add(new Option("none", ""));
      if (name === "family" && data.swept.length > 2) select.add(new Option(data.others));
      for (const column of name === "family" ? [...data.swept, "failure_mode", "status"] : numeric)
        if (data.columns.includes(column)) select.add(new Option(column));
      select.value = chosen || "";
      select.addEventListener("change", () => this.draw());
    }
    this.show();
  }

  column(name) {
    return this.data.columns.indexOf(name);
  }

  /** A word that a cell must hold, or a comparison such as friction>=0.6; all of them, between spaces. */
  rules() {
    return this.part("filter").value.split(/\s+/).filter(Boolean).map((text) => {
      const parts = text.match(/^(.+?)(<=|>=|!=|<|>|=)(.+)$/);
      const column = parts ? this.data.columns.findIndex((name) => name === parts[1] || name.endsWith(`.${parts[1]}`)) : -1;
      if (column < 0) return (row) => row.some((cell) => String(cell ?? "").toLowerCase().includes(text.toLowerCase()));
      const given = Number.isNaN(Number(parts[3])) ? parts[3] : Number(parts[3]);
      return (row) => row[column] !== null && COMPARE[parts[2]](row[column], given);
    });
  }

  show() {
    const rules = this.rules(), { rows } = this.data;
    this.shown = rows.filter((row) => rules.every((rule) => rule(row)));
    if (this.order !== null) {
      const sign = this.down ? -1 : 1, key = (row) => row[this.order];
      this.shown.sort((a, b) => {
        if (key(a) === null || key(b) === null) return (key(a) === null) - (key(b) === null);
        const both = typeof key(a) === "number" && typeof key(b) === "number";
        return sign * (both ? key(a) - key(b) : String(key(a)).localeCompare(String(key(b))));
      });
    }
    this.part("count").textContent = `${this.shown.length} of ${rows.length} runs`;
    this.table();
    this.draw();
  }

  table() {
    const { columns, main, links } = this.data, head = document.createElement("tr"), body = document.createElement("tbody");
    const chosen = (this.all ? columns : main).map((name) => this.column(name));
    for (const i of chosen) {
      const cell = document.createElement("th"), button = document.createElement("button");
      Object.assign(button, { type: "button", textContent: columns[i] });
      cell.scope = "col";
      if (this.order === i) cell.setAttribute("aria-sort", this.down ? "descending" : "ascending");
      button.addEventListener("click", () => {
        this.down = this.order === i && !this.down;
        this.order = i;
        this.show();
      });
      cell.append(button);
      head.append(cell);
    }
    for (const row of this.shown) {
      const line = document.createElement("tr");
      for (const i of chosen) {
        const cell = document.createElement("td"), value = row[i], text = typeof value === "number" ? number(value, 6) : String(value ?? "–");
        cell.title = String(value ?? "");
        if (typeof value === "number") cell.className = "number";
        if (columns[i] === "run" && links[value]) {
          const link = document.createElement("a");
          Object.assign(link, { href: links[value], textContent: text });
          cell.append(link);
        } else cell.textContent = text;
        line.append(cell);
      }
      if (String(row[this.column("status")]) !== "ok") line.className = "failed";
      body.append(line);
    }
    const table = this.part("table"), focused = table.contains(document.activeElement) ? document.activeElement.textContent : null;
    table.replaceChildren(document.createElement("thead"), body);
    table.tHead.append(head);
    if (focused) [...head.querySelectorAll("button")].find((button) => button.textContent === focused)?.focus();
  }

  /** The keys by which lines differ. */
  families() {
    const name = this.part("family").value, axis = this.part("x").value;
    return name === this.data.others ? this.data.swept.filter((key) => key !== axis) : [name].filter(Boolean);
  }

  /** What tells the line of a run from the others. */
  family(row) {
    const words = this.families().map((key) => {
      const value = row[this.column(key)];
      return typeof value === "string" ? value : `${short(key)} ${typeof value === "number" ? number(value) : value ?? "–"}`;
    });
    return words.join(", ") || "runs";
  }

  /** The chart of what the filter leaves. */
  draw() {
    const [x, y] = ["x", "y"].map((name) => this.column(this.part(name).value)), figure = this.section.querySelector("figure");
    figure.querySelector(".plot").replaceChildren();
    figure.querySelector("h3").textContent = x < 0 || y < 0 ? "" : `${this.data.columns[y]} over ${this.data.columns[x]}`;
    if (x < 0 || y < 0) return;
    const at = this.shown.filter((row) => typeof row[x] === "number");
    const rows = at.filter((row) => typeof row[y] === "number" || this.bracket(row, y));
    const missing = at.filter((row) => !rows.includes(row)).map((row) => row[x]);
    const names = [...new Set(rows.map((row) => this.family(row)))];
    const lines = names.length > MOST_LINES ? [this.cloud(rows, x, y)] : names.map((name, i) => this.line(rows, x, y, name, i));
    this.chart = new Chart(figure, { id: "sweep", title: "Sweep", x: this.data.columns[x], y: this.data.columns[y], lines, missing });
  }

  /** Between which values the answer of a run lies; high null where that end is not known, null where neither is. */
  bracket(row, y) {
    const [low, high] = [0, 1].map((end) => row[this.column(`${this.data.columns[y]}_bracket.${end}`)] ?? null);
    return typeof low === "number" ? { low, high } : null;
  }

  /** Points of the runs that have an answer, and brackets of all that have one. */
  points(all, x, y) {
    const rows = all.filter((row) => typeof row[y] === "number");
    const spans = all.filter((row) => this.bracket(row, y)).map((row) => ({ x: row[x], ...this.bracket(row, y), alone: typeof row[y] !== "number" }));
    const labels = rows.map((row) => `${this.family(row)}, run ${row[this.column("run")]}`);
    return { x: rows.map((row) => row[x]), y: rows.map((row) => row[y]), labels, spans, points: rows.length > 60 ? 2.5 : 4 };
  }

  /** The runs of one family in the order of x, joined where there is one for each x. */
  line(rows, x, y, name, i) {
    const own = rows.filter((row) => this.family(row) === name).sort((a, b) => a[x] - b[x]);
    const bare = new Set(own.map((row) => row[x])).size < own.length; // several runs at one x: no line
    return { ...this.points(own, x, y), name, bare, colour: String(i % 10), width: 1.2 };
  }

  /** Too many families for lines: points, in shades of the value by which they differ. */
  cloud(rows, x, y) {
    const [key, ...more] = this.families(), values = rows.filter((row) => typeof row[y] === "number").map((row) => row[this.column(key)]), found = this.points(rows, x, y);
    if (more.length || !values.length || values.some((value) => typeof value !== "number")) return { ...found, name: "runs", bare: true, colour: "0" };
    const low = Math.min(...values), span = Math.max(...values) - low || 1;
    const tints = values.map((value) => `color-mix(in oklab, var(--line-1) ${(100 * (value - low)) / span}%, var(--line-0))`);
    return { ...found, name: `${short(key)} ${number(low)} to ${number(low + span)}`, bare: true, colour: "0", tints };
  }
}

/** The end of a path that says something: `block.1`, not `1`. */
function short(key) {
  const parts = key.split(".");
  return parts.slice(/^\d+$/.test(parts.at(-1)) ? -2 : -1).join(".");
}
