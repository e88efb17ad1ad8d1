// Charts of a page: the numbers beside a picture, drawn in its place so that one can zoom. Dragging
// zooms all panels of a figure, a double click shows everything. uPlot stands in front of this text.
{
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const number = (value) => (value == null ? "–" : value.toPrecision(4));
  const numbers = (script) =>
    script.textContent.trim().split(" ").map((word) => (word === "-" ? null : Number(word)));

  // x, and the panels with their lines, as section.cc writes them.
  const read = (place) => {
    const [x, ...lines] = place.querySelectorAll("script");
    const panels = new Map();
    for (const line of lines) {
      const { panel, name, colour } = line.dataset;
      if (!panels.has(panel)) panels.set(panel, []);
      panels.get(panel).push({ name, colour, y: numbers(line) });
    }
    return { x: numbers(x), panels: [...panels] };
  };

  const options = (key, x_label, [label, lines], first, last, width, zoom) => {
    const axis = { stroke: colour("--soft"), grid: { stroke: colour("--line") }, ticks: { stroke: colour("--line") } };
    const value = (_, each) => number(each);
    return {
      width,
      height: first ? 300 : 180,
      cursor: { sync: { key }, drag: { x: true, y: false } },
      scales: { x: { time: false } },
      series: [
        { label: x_label, value },
        ...lines.map((line) => ({
          label: line.name,
          stroke: line.name === "measured" ? colour("--soft") : line.colour,
          width: line.name === "measured" ? 2.4 : 1.4,
          value,
        })),
      ],
      axes: [last ? { ...axis, label: x_label, labelSize: 22 } : axis, { ...axis, label, size: 64, labelSize: 22 }],
      hooks: { setScale: [(plot, scale) => scale === "x" && zoom(plot)] },
    };
  };

  const draw = (place, key) => {
    const { x, panels } = read(place);
    const { x: x_label, from, to } = place.dataset;
    const plots = [];
    let moving = false;
    const show = (min, max) => {
      moving = true;
      for (const plot of plots) plot.setScale("x", { min, max });
      moving = false;
    };
    const zoom = (plot) => {
      if (!moving && plots.length === panels.length) show(plot.scales.x.min, plot.scales.x.max);
    };
    const button = (text, act) => {
      const out = document.createElement("button");
      out.textContent = text;
      out.onclick = act;
      place.append(out);
    };
    button("Whole recording", () => show(x[0], x[x.length - 1]));
    button("Busiest part", () => show(Number(from), Number(to)));
    panels.forEach((panel, k) => {
      const form = options(key, x_label, panel, k === 0, k === panels.length - 1, place.clientWidth, zoom);
      plots.push(new uPlot(form, [x, ...panel[1].map((line) => line.y)], place));
    });
    show(Number(from), Number(to));
    new ResizeObserver(() => {
      for (const plot of plots) {
        if (plot.width !== place.clientWidth) plot.setSize({ width: place.clientWidth, height: plot.height });
      }
    }).observe(place);
  };

  document.body.classList.add("charts");
  document.querySelectorAll(".chart").forEach((place, k) => draw(place, `chart${k}`));
}
