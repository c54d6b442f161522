// Puts the page together.

function start() {
  document.documentElement.dataset.theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  const data = JSON.parse(document.getElementById("data").textContent), page = { charts: [] };
  globalThis.dem = page; // for the console, and for tests
  const section = document.getElementById("view");
  if (data.view) {
    try {
      page.player = new Player(section, data.view, (i) => page.charts.forEach((chart) => chart.mark(i)));
    } catch (error) {
      section.classList.add("without");
      section.querySelector(".without-webgl").hidden = false;
      console.warn(`no interactive view: ${error.message}`);
    }
  }
  for (const spec of data.charts || []) {
    const figure = document.getElementById(`chart-${spec.id}`);
    const chart = new Chart(figure, spec, page.player && spec.marks ? (i) => page.player.go(i) : null);
    chart.mark(page.player ? page.player.at : null);
    page.charts.push(chart);
  }
  if (data.runs) page.runs = new Runs(document.getElementById("runs"), data.runs);
  theme(page);
  const frame = globalThis.frameElement; // of a notebook: as high as what it holds
  if (frame && document.body.classList.contains("brief")) frame.style.height = `${document.body.offsetHeight + 4}px`;
}

/** Light or dark as the system has it, until the reader chooses; light on paper, with nothing folded. */
function theme(page) {
  const root = document.documentElement, button = document.getElementById("theme"), dark = matchMedia("(prefers-color-scheme: dark)");
  let before = null;
  const wear = (name) => {
    root.dataset.theme = name;
    page.player?.scene.themed();
    page.player?.scene.draw();
  };
  button.hidden = false;
  button.addEventListener("click", () => wear(root.dataset.theme === "dark" ? "light" : "dark"));
  dark.addEventListener("change", () => wear(dark.matches ? "dark" : "light"));
  addEventListener("beforeprint", () => {
    const folded = [...document.querySelectorAll("details.print:not([open])")];
    before = { theme: root.dataset.theme, folded };
    folded.forEach((details) => { details.open = true; });
    wear("light");
  });
  addEventListener("afterprint", () => {
    before.folded.forEach((details) => { details.open = false; });
    wear(before.theme);
  });
}

start();
