// Makes the page's tables sortable and filterable, its cells chartable, its kept images comparable.
// Everything is read from the tables and images that stand in the page: no data of its own, no network.
"use strict";
(() => {
  const $ = (selector, root = document) => [...root.querySelectorAll(selector)];
  const make = (name, props = {}, ...children) => {
    const element = Object.assign(document.createElement(name), props);
    element.append(...children);
    return element;
  };
  const colours = JSON.parse(document.getElementById("colours").textContent);
  const numeric = (text) => (text === "" || text === undefined ? null : Number.isFinite(+text) ? +text : null);
  const byValue = new Intl.Collator("en", { numeric: true }).compare;

  // A field's value: a number where it holds one, else its text; null where it is empty.
  const valueOf = (cell) => {
    const raw = cell.dataset.v ?? (cell.dataset.i ? cell.textContent.split(" ")[0] : cell.textContent);
    return raw === "" ? null : numeric(raw) ?? raw;
  };

  // --- tables ---
  const meanings = new Map($("th[title]").map((head) => [head.textContent, head.title]));  // they stand in the first table

  function sortable(table) {
    const heads = $("thead th", table);
    heads.forEach((head, column) => {
      head.title = meanings.get(head.textContent) ?? "";
      const button = make("button", { type: "button", textContent: head.textContent });
      head.replaceChildren(button);
      button.addEventListener("click", () => {
        const up = head.getAttribute("aria-sort") !== "ascending";
        heads.forEach((other) => other.removeAttribute("aria-sort"));
        head.setAttribute("aria-sort", up ? "ascending" : "descending");
        const rows = [...table.tBodies[0].rows].map((row) => [valueOf(row.cells[column]), row]);
        rows.sort(([a], [b]) => {
          if (a === null || b === null) return (a === null) - (b === null);
          const order = typeof a === "number" && typeof b === "number" ? a - b : byValue(a, b);
          return up ? order : -order;
        });
        table.tBodies[0].append(...rows.map(([, row]) => row));
      });
    });
  }

  const choice = (name, values, all) => {
    const select = make("select", {}, ...(all ? [make("option", { value: "", textContent: all })] : []),
      ...values.map((value) => make("option", { value, textContent: value })));
    return [make("label", {}, name, select), select];
  };

  // Choices for each column that has a few different words, and a field for any text.
  function filterable(details) {
    const table = details.querySelector("table"), rows = [...table.tBodies[0].rows];
    const heads = $("thead th", table);
    const search = make("input", { type: "search" });
    const shown = make("output", {});
    const bar = make("div", { className: "filter" }, make("label", {}, "contains", search));
    const selects = heads.map((head, column) => {
      if (head.classList.contains("measure")) return null;
      const name = head.textContent;
      const text = (row) => (name === "status" ? row.cells[column].firstChild?.textContent ?? "" : row.cells[column].textContent);
      const values = [...new Set(rows.map(text))].filter(Boolean).sort(byValue);
      if (values.length < 2 || values.length > 60) return null;
      const [label, select] = choice(name, values, "all");
      bar.append(label);
      return [select, text];
    }).filter(Boolean);
    const apply = () => {
      const wanted = search.value.toLowerCase();
      let count = 0;
      for (const row of rows) {
        row.hidden = !(row.textContent.toLowerCase().includes(wanted)
          && selects.every(([select, text]) => !select.value || text(row) === select.value));
        count += !row.hidden;
      }
      shown.textContent = `${count} of ${rows.length} cells`;
    };
    bar.addEventListener("input", apply);
    bar.append(shown);
    details.querySelector(".scroll").before(bar);
    apply();
  }

  // --- colours ---
  // A method's colour is that of the figures, which are white: on another ground it is mixed with white or black until it
  // stands out, by the contrast that WCAG 2 asks of graphics.
  const CONTRAST = 3;
  const channels = (text) => (text[0] === "#" ? [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16))
    : text.match(/\d+/g).slice(0, 3).map(Number));
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((c) => (c / 255 <= 0.04045 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  function standingOut(colour) {
    const ground = channels(getComputedStyle(document.body).backgroundColor), back = luminance(ground);
    const end = back > 0.18 ? 0 : 255;
    for (let share = 0; share < 1; share += 0.05) {
      const mixed = channels(colour).map((c) => Math.round(c + share * (end - c))), front = luminance(mixed);
      if ((Math.max(front, back) + 0.05) / (Math.min(front, back) + 0.05) >= CONTRAST) return `rgb(${mixed.join(", ")})`;
    }
    return `rgb(${end}, ${end}, ${end})`;
  }

  // --- charts ---
  // Lines of one column by another: a series for each method and for every other place that tells its cells apart.
  function explorer(details, table) {
    const heads = $("thead th", table).map((head) => head.textContent);
    const axes = table.dataset.axes ? table.dataset.axes.split("|") : [];
    const rows = [...table.tBodies[0].rows];
    const measures = $("thead th.measure", table).map((head) => head.textContent)
      .filter((name) => rows.some((row) => row.cells[heads.indexOf(name)].textContent !== ""));
    if (!measures.length) return;
    const device = heads.indexOf("device");
    const devices = device < 0 ? [] : [...new Set(rows.map((row) => row.cells[device].textContent))];
    const [xLabel, x] = choice("x", axes.length ? axes : ["method"]);
    const [yLabel, y] = choice("y", measures);
    const [dLabel, d] = choice("device", devices, "all");
    const tick = (name, checked) => {
      const box = make("input", { type: "checkbox", checked });
      return [make("label", { className: "tick" }, box, name), box];
    };
    const [lxLabel, logX] = tick("log x", false), [lyLabel, logY] = tick("log y", true);
    const reset = make("button", { type: "button", textContent: "Show all" });
    const controls = details.querySelector(".controls"), holder = details.querySelector(".chart");
    controls.append(xLabel, yLabel, ...(devices.length ? [dLabel] : []), lxLabel, lyLabel, reset);
    let plot = null;

    function series() {
      const at = heads.indexOf(x.value), of = heads.indexOf(y.value);
      const others = axes.filter((axis) => axis !== x.value).map((axis) => heads.indexOf(axis));
      const found = new Map(), places = new Set();
      for (const row of rows) {
        const cell = row.cells[of], middle = numeric(valueOf(cell) ?? ""), place = valueOf(row.cells[at]);
        if (middle === null || place === null || (d.value && row.cells[device].textContent !== d.value)) continue;
        const name = [row.cells[0].textContent, ...others.map((i) => row.cells[i].textContent && `${heads[i]} ${row.cells[i].textContent}`),
          d.value || devices.length < 2 ? "" : row.cells[device].textContent].filter(Boolean).join(", ");
        if (!found.has(name)) found.set(name, { name, method: row.dataset.m, points: new Map() });
        found.get(name).points.set(place, [middle, ...(cell.dataset.i?.split(",").map(Number) ?? [null, null])]);
        places.add(place);
      }
      return { lines: [...found.values()], places: [...places].sort((a, b) => (typeof a === "number" && typeof b === "number" ? a - b : byValue(String(a), String(b)))) };
    }

    function draw() {
      const { lines, places } = series();
      plot?.destroy();
      plot = null;
      holder.replaceChildren();
      if (!lines.length) {
        holder.append("No cell has both.");
        return;
      }
      const words = places.some((place) => typeof place !== "number");
      const xs = words ? places.map((_, i) => i) : places;
      logX.disabled = words || xs[0] <= 0;
      const column = (line, i) => places.map((place) => line.points.get(place)?.[i] ?? null);
      const ink = getComputedStyle(document.body).color;
      const colourOf = (line) => (colours[line.method] ? standingOut(colours[line.method]) : ink);
      const positive = lines.every((line) => [...line.points.values()].every(([middle]) => middle > 0));
      logY.disabled = !positive;
      const axis = { stroke: ink, grid: { stroke: "#8884", width: 1 }, ticks: { stroke: "#8884" } };
      const dashes = [[], [8, 3], [2, 3], [8, 3, 2, 3], [4, 4]];
      const tip = make("div", { className: "tip", hidden: true });
      plot = new uPlot({
        width: Math.max(300, holder.clientWidth), height: 420,
        scales: { x: { time: false, distr: logX.checked && !logX.disabled ? 3 : 1, log: 2,
                       range: words ? [-0.5, xs.length - 0.5] : undefined },
                  y: { distr: logY.checked && positive ? 3 : 1, log: 10 } },
        axes: [{ ...axis, label: x.value, splits: words || xs.length <= 12 ? () => xs : undefined,
                 values: (_, splits) => splits.map((v) => (v === null ? "" : words ? places[v] ?? "" : `${v}`)) },
               { ...axis, label: y.value, size: 70 }],
        series: [{ label: x.value, value: (_, v) => (v === null ? "" : words ? places[v] : `${v}`) },
          ...lines.map((line, i) => ({ label: line.name, stroke: colourOf(line), width: 1.6, spanGaps: true,
            dash: dashes[i % dashes.length], points: { show: true, size: 6 },
            value: (_, v) => (v === null ? "" : (+v.toPrecision(4)).toString()) }))],
        cursor: { drag: { x: true, y: true, uni: 20 }, focus: { prox: 24 } },
        focus: { alpha: 0.25 },
        hooks: {
          drawSeries: [(u, i) => {
            if (!i || !u.series[i].show) return;
            u.ctx.save();
            u.ctx.strokeStyle = u.series[i]._stroke ?? colourOf(lines[i - 1]);
            u.ctx.lineWidth = 1.2 * devicePixelRatio;
            u.ctx.beginPath();
            lines[i - 1].points.forEach(([, low, high], place) => {
              if (low === null || high === null) return;
              const px = u.valToPos(words ? places.indexOf(place) : place, "x", true);
              u.ctx.moveTo(px, u.valToPos(low, "y", true));
              u.ctx.lineTo(px, u.valToPos(high, "y", true));
            });
            u.ctx.stroke();
            u.ctx.restore();
          }],
          setCursor: [(u) => {
            const { idx, left, top } = u.cursor;
            let best = null;
            if (idx !== null && idx !== undefined && left >= 0) {
              lines.forEach((line, i) => {
                const point = line.points.get(places[idx]);
                if (!point || !u.series[i + 1].show) return;
                const away = Math.abs(u.valToPos(point[0], "y") - top);
                if (!best || away < best.away) best = { away, line, point };
              });
            }
            tip.hidden = !best;
            if (!best) return;
            const short = (v) => (+v.toPrecision(4)).toString(), [middle, low, high] = best.point;
            tip.textContent = `${best.line.name}: ${short(middle)}${low !== null && high !== null ? ` (${short(low)} to ${short(high)})` : ""}`;
            const overflow = left + 16 + tip.offsetWidth > u.over.clientWidth;
            tip.style.left = `${Math.max(0, overflow ? left - tip.offsetWidth - 8 : left + 12)}px`;
            tip.style.top = `${Math.max(0, top - 28)}px`;
          }],
        },
      }, [xs, ...lines.map((line) => column(line, 0))], holder);
      plot.over.append(tip);
    }
    const show = () => details.open && draw();
    show();
    details.addEventListener("toggle", show);
    controls.addEventListener("change", show);
    reset.addEventListener("click", show);
    addEventListener("resize", () => plot && show());
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plot && show());
  }

  // --- kept images ---
  // Two images behind a slider, or their difference, enlarged by a factor.
  function comparison(details) {
    const images = $("img", details), holder = details.querySelector(".compare");
    if (images.length < 2) return;
    const names = $(".kept span", details).map((name, i) => `${i + 1}: ${name.textContent}`);
    const [aLabel, a] = choice("left", names), [bLabel, b] = choice("right", names);
    b.selectedIndex = 1;
    const [kindLabel, kind] = choice("shown", ["slider", "difference × 1", "difference × 8", "difference × 64"]);
    const slider = make("input", { type: "range", min: 0, max: 100, value: 50 });
    const canvas = make("canvas", {}), said = make("output", {});
    canvas.setAttribute("role", "img");
    holder.append(make("div", { className: "controls" }, aLabel, bLabel, kindLabel, make("label", {}, "place of the slider", slider), said),
      make("div", { className: "stage" }, canvas));
    const pixels = (image) => {
      const sheet = make("canvas", { width: canvas.width, height: canvas.height });
      const context = sheet.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, canvas.width, canvas.height);
    };
    function draw() {
      const [left, right] = [images[a.selectedIndex], images[b.selectedIndex]];
      Object.assign(canvas, { width: left.naturalWidth, height: left.naturalHeight });
      const context = canvas.getContext("2d");
      const same = left.naturalWidth === right.naturalWidth && left.naturalHeight === right.naturalHeight;
      slider.disabled = kind.selectedIndex > 0;
      if (!same) {
        said.textContent = "These two differ in size.";
      } else if (kind.selectedIndex === 0) {
        const edge = Math.round(canvas.width * slider.value / 100);
        context.drawImage(right, 0, 0);
        if (edge) context.drawImage(left, 0, 0, edge, canvas.height, 0, 0, edge, canvas.height);
        context.fillRect(edge - 0.5, 0, 1, canvas.height);
        said.textContent = "";
      } else {
        const one = pixels(left), two = pixels(right), gain = [1, 8, 64][kind.selectedIndex - 1];
        let most = 0;
        for (let i = 0; i < one.data.length; i += 4) {
          for (let c = 0; c < 3; c++) {
            const away = Math.abs(one.data[i + c] - two.data[i + c]);
            most = Math.max(most, away);
            one.data[i + c] = Math.min(255, gain * away);
          }
          one.data[i + 3] = 255;
        }
        context.putImageData(one, 0, 0);
        said.textContent = `Largest difference of a channel: ${most} of 255.`;
      }
      canvas.setAttribute("aria-label", `${kind.value} of ${a.value} and ${b.value}`);
    }
    holder.addEventListener("input", draw);
    images.forEach((image) => { image.loading = "eager"; });
    Promise.all(images.map((image) => image.decode().catch(() => {}))).then(draw);
  }

  // --- shaders ---
  // The GLSL of each pass of a method, from the texts that are packed in the page.
  async function shaderBrowser(details) {
    const packed = Uint8Array.from(atob(document.getElementById("packed").textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const { lines, texts, rows } = JSON.parse(await new Response(stream).text());
    const names = $("tbody th", details).map((head) => head.textContent);
    const holder = details.querySelector(".source");
    const [methodLabel, method] = choice("method", names);
    const [passLabel, pass] = choice("pass and stage", []);
    const text = make("pre", { tabIndex: 0 });
    text.setAttribute("aria-label", "GLSL");
    text.setAttribute("role", "region");
    const passes = () => {
      pass.replaceChildren(...rows[method.selectedIndex].map(([name, entry], i) => make("option", { value: i, textContent: `${name}: ${entry}` })));
    };
    const show = () => {
      const row = rows[method.selectedIndex][pass.selectedIndex];
      text.textContent = row ? texts[row[2]].map((line) => lines[line]).join("\n") : "This method has no shaders.";
    };
    method.addEventListener("change", () => { passes(); show(); });
    pass.addEventListener("change", show);
    holder.append(make("div", { className: "controls" }, methodLabel, passLabel), text);
    passes();
    show();
  }

  // --- the page ---
  $("[data-needs-script]").forEach((element) => { element.hidden = false; });
  $("figure .enlarge").forEach((button) => button.addEventListener("click", () => {
    const large = button.parentElement.classList.toggle("large");
    button.textContent = large ? "Fit" : "Enlarge";
  }));
  // What folds is made ready when it is first opened: a page of thousands of cells is there at once.
  const ready = (details, prepare) => {
    const once = () => details.open && (details.removeEventListener("toggle", once), prepare());
    details.addEventListener("toggle", once);
    once();
  };
  $("details.cells").forEach((details) => ready(details, () => {
    sortable(details.querySelector("table"));
    filterable(details);
  }));
  $("details.explore").forEach((details) => ready(details, () => {
    explorer(details, details.parentElement.querySelector("details.cells table"));
  }));
  $("details.images").forEach((details) => ready(details, () => comparison(details)));
  $("#shaders details").forEach((details) => ready(details, () => shaderBrowser(details)));
  const claims = document.querySelector("#claims table");
  if (claims) sortable(claims);
  document.documentElement.dataset.ready = "true";
})();
