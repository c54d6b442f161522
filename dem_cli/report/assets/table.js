// A table of runs that can be sorted and filtered, and a chart of any two of its columns.

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

  /** What tells the line of a run from the others. */
  family(row) {
    const name = this.part("family").value, axis = this.part("x").value;
    const keys = name === this.data.others ? this.data.swept.filter((key) => key !== axis) : [name].filter(Boolean);
    const words = keys.map((key) => {
      const value = row[this.column(key)];
      return typeof value === "string" ? value : `${key.split(".").pop()} ${typeof value === "number" ? number(value) : value ?? "–"}`;
    });
    return words.join(", ") || "runs";
  }

  /** Points joined to a line for each value of the family, in the order of x. */
  draw() {
    const [x, y] = ["x", "y"].map((name) => this.column(this.part(name).value));
    const figure = this.section.querySelector("figure"), groups = new Map();
    figure.querySelector(".plot").replaceChildren();
    figure.querySelector("h3").textContent = x < 0 || y < 0 ? "" : `${this.data.columns[y]} over ${this.data.columns[x]}`;
    if (x < 0 || y < 0) return;
    for (const row of this.shown) {
      if (typeof row[x] !== "number" || typeof row[y] !== "number") continue;
      const name = this.family(row);
      groups.set(name, [...(groups.get(name) || []), row]);
    }
    const lines = [];
    [...groups].forEach(([name, rows], i) => {
      rows.sort((a, b) => a[x] - b[x]);
      const points = { name, x: rows.map((row) => row[x]), y: rows.map((row) => row[y]), colour: String(i % 10), width: 1.2 };
      const bare = new Set(points.x).size < points.x.length || groups.size > 12;
      lines.push({ ...points, bare, points: rows.length > 60 ? 2.5 : 4, labels: rows.map((row) => `${name}, run ${row[this.column("run")]}`) });
    });
    this.chart = new Chart(figure, { id: "sweep", title: "Sweep", x: this.data.columns[x], y: this.data.columns[y], lines });
  }
}
