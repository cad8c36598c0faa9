"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const $ = (id) => document.getElementById(id);
  const [width, height] = data.size;
  const pixels = width * height;
  const NBSP = "\u00a0";

  // Everything from the data becomes a text node here: a scene's name may hold anything.
  function fill(node, attributes, children) {
    for (const [name, value] of Object.entries(attributes || {})) {
      if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
    }
    node.append(...children.filter((child) => child !== null && child !== undefined));
    return node;
  }
  const el = (tag, attributes, ...children) => fill(document.createElement(tag), attributes, children);
  const svg = (tag, attributes, ...children) => fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);

  // ---- Numbers

  const known = (value) => typeof value === "number" && Number.isFinite(value);
  const count = (n) => (known(n) ? n.toLocaleString("en") : "—");
  const many = (n, one, more = one + "s") => `${count(n)}${NBSP}${n === 1 ? one : more}`;
  // A value that is not nothing never reads 0.
  function fixed(value, digits) {
    if (value === 0) return "0";
    const sign = value < 0 ? "−" : "", size = Math.abs(value), least = 10 ** -digits;
    if (size < least) return value < 0 ? `>−${least.toFixed(digits)}` : `<${least.toFixed(digits)}`;
    return sign + size.toLocaleString("en", { minimumFractionDigits: digits, maximumFractionDigits: digits });
  }
  function percent(share) {
    const value = share * 100, size = Math.abs(value);
    return fixed(value, size >= 10 ? 1 : size >= 0.1 ? 2 : 3);
  }
  // One number of digits for a whole column, so that its figures stand under one another.
  const digitsFor = (values, significant, most) => {
    const largest = Math.max(...values.map(Math.abs), 1e-9);
    return Math.min(most, Math.max(0, significant - 1 - Math.floor(Math.log10(largest))));
  };
  const column = (significant, most, scale = 1) => (values) => {
    const digits = digitsFor(values.map((v) => v * scale), significant, most);
    return (v) => fixed(v * scale, digits);
  };
  const always = (format) => () => format;
  const ratio4 = always((v) => fixed(v, 4));

  // ---- Columns, and what they mean

  const COLUMNS = [
    { key: "technique", name: "technique", group: "", define: "How shadows are made: name, id, and the parameters in which rows of one technique differ." },
    { key: "false_shadow", name: "false shadow", unit: "%", group: "Error against truth", format: always(percent), define: "Mean of max(0, V* − V): dark where truth is lit." },
    { key: "false_light", name: "false light", unit: "%", group: "Error against truth", format: always(percent), define: "Mean of max(0, V − V*): lit where truth is dark." },
    { key: "rmse", name: "rmse", group: "Error against truth", format: ratio4, define: "Root mean square of V − V*: large errors weigh most." },
    { key: "acne", name: "acne", unit: "%", group: "Error against truth", format: always(percent), define: "Share of sure receivers that are lit in truth and darker than 0.95: surfaces that shadow themselves." },
    { key: "leak", name: "leak", unit: "%", group: "Error against truth", format: always(percent), define: "Share of sure receivers that are in full shadow in truth and brighter than 0.05: light that comes through." },
    { key: "edge", name: "edge", unit: "band %", group: "Error against truth", format: ratio4, small: (r) => (known(r.band) ? percent(r.band) : null), define: "Mean |V − V*| in the edge band; beneath it, the band’s share of receivers." },
    { key: "gap_m", name: "gap", group: "Error against truth", define: "Greatest distance from where a caster touches its receiver to where its shadow begins.",
      unit: (values) => (Math.max(0, ...values) < 1 ? "mm" : "m"), format: (values) => (Math.max(0, ...values) < 1 ? column(3, 2, 1000) : column(4, 3))(values) },
    { key: "gap_texel", name: "gap", unit: "texels", group: "Error against truth", format: always((v) => fixed(v, 2)), define: "The same in widths of a map's texel there, across the light." },
    { key: "penumbra", name: "penumbra", unit: "× right", group: "Error against truth", format: always((v) => fixed(v, 2)), wrong: (v) => Math.abs(v - 1), define: "Width of soft edges over the width that similar triangles give: 1 is right." },
    { key: "flicker", name: "flicker", group: "Error against truth", format: ratio4, define: "Mean change of V between frames of a camera path, where truth does not change." },
    { key: "flip", name: "FLIP", group: "Error against truth", format: ratio4, define: "Perceptual difference of the final picture, 0 same to 1 (Andersson et al. 2020)." },
    { key: "cost_ms", name: "cost", unit: "ms", group: "Time", format: column(3, 3), define: "Time that the shadow adds to a frame: median; beneath it, ± half of the range measured.",
      small: (r, all) => (known(r.cost_min_ms) && known(r.cost_max_ms) && r.cost_max_ms > r.cost_min_ms ? `±${column(3, 3)(all)((r.cost_max_ms - r.cost_min_ms) / 2)}` : null) },
    { key: "frame_ms", name: "frame", unit: "ms", group: "Time", format: column(3, 3), define: "Time of the whole frame, shadow included: median." },
    { key: "memory_bytes", name: "memory", unit: "MiB", group: "Work", format: column(3, 2, 1 / 2 ** 20), define: "Memory that the technique keeps for its maps." },
    { key: "passes", name: "passes", group: "Work", format: always(count), define: "Passes that the technique adds to a frame." },
    { key: "draws", name: "draws", group: "Work", format: always(count), define: "Draw calls of these passes." },
    { key: "triangles", name: "triangles", group: "Work", format: always(count), define: "Triangles that these passes draw." },
    { key: "texels", name: "texels", unit: "million", group: "Work", format: column(3, 2, 1e-6), define: "Texels of the maps that are drawn in a frame." },
    { key: "taps", name: "taps", group: "Work", format: always(count), define: "Map lookups for each receiver." },
  ];
  const byKey = Object.fromEntries(COLUMNS.map((c) => [c.key, c]));
  const METRICS = ["rmse", "false_shadow", "false_light", "acne", "leak", "edge", "flip"];
  const TERMS = [
    ["V, V*", "Visibility, 1 lit to 0 in shadow: as drawn, and in truth."],
    ["receivers", "Pixels whose surface faces the light. All means are over them."],
    ["reach", "What a technique cannot resolve at a pixel: 2 pixels, or its filter radius and a texel seen in pixels, whichever is more."],
    ["edge band", "Receivers within reach of a place where V* changes. All others are sure."],
    ...COLUMNS.slice(1).map((c) => [c.name, c.define]),
  ];

  // ---- Rows

  const same = (a, b) => JSON.stringify(a) === JSON.stringify(b);
  const show = (value) => (typeof value === "string" ? value : JSON.stringify(value));
  const rows = data.results.map((result, index) => ({ ...result, index, differ: "" }));
  // Rows of one technique are told apart by the parameters in which they differ, or else by number.
  for (const row of rows) {
    const peers = rows.filter((r) => r.view === row.view && r.technique === row.technique);
    if (peers.length < 2) continue;
    const keys = [...new Set(peers.flatMap((r) => Object.keys(r.params || {})))];
    const told = keys.filter((k) => peers.some((r) => !same((r.params || {})[k], (peers[0].params || {})[k])));
    const twins = peers.filter((r) => same(r.params, row.params));
    row.differ = [...told.filter((k) => k in (row.params || {})).map((k) => `${k}=${show(row.params[k])}`),
      ...(twins.length > 1 ? [`#${twins.indexOf(row) + 1}`] : [])].join(" ");
  }
  const nameOf = (row) => row.label + (row.differ ? ` (${row.differ})` : "");

  const state = { view: null, rows: [], metric: "rmse", front: new Set(), chosen: null, sort: null, down: false, split: 0.5, zoom: 1, x: 0, y: 0 };

  // At least as good in both and better in one: with "better in both" every row without a leak would be on the front of leak.
  function frontOf(list, metric) {
    const beats = (a, b) => a.cost_ms <= b.cost_ms && a[metric] <= b[metric] && (a.cost_ms < b.cost_ms || a[metric] < b[metric]);
    const valid = list.filter((r) => known(r[metric]) && known(r.cost_ms));
    return valid.filter((r) => !valid.some((other) => beats(other, r)));
  }

  // ---- Header

  // Lines break between words only, not within --options.
  const command = (node, text) => node.replaceChildren(...text.split(/( )/).map((word) => (word === " " ? word : el("span", {}, word))));

  function copyButton(button, source) {
    button.addEventListener("click", async () => {
      const text = source().textContent;
      let done = false;
      try { await navigator.clipboard.writeText(text); done = true; } catch {
        // Some browsers give no clipboard to pages from disk.
        const area = el("textarea", { class: "visually-hidden" });
        area.value = text;
        document.body.append(area);
        area.select();
        done = document.execCommand("copy");
        area.remove();
        button.focus();
      }
      if (!done) getSelection().selectAllChildren(source());
      button.textContent = done ? "Copied" : "Selected";
      $("said").textContent = done ? "Copied" : "Selected, ready to copy";
      setTimeout(() => { button.textContent = "Copy"; $("said").textContent = ""; }, 1600);
    });
  }

  function header() {
    const { truth, scene } = data;
    const views = data.views.length, techniques = new Set(rows.map((r) => r.technique)).size;
    const rays = known(truth.rays_per_second) && truth.rays_per_second >= 1e6 ? `${fixed(truth.rays_per_second / 1e6, 2)} million rays` : many(Math.round(truth.rays_per_second), "ray");
    const facts = [
      ["Machine", data.adapter, [data.driver, data.backend].filter(Boolean).join(", ")],
      ["Scene", many(scene.triangles, "triangle"), many(scene.instances, "instance")],
      ["Picture", `${width} × ${height} pixels`, `${many(data.frames, "frame")} for each time`],
      ["Truth", `${many(truth.samples, "sample")} a pixel, ${many(truth.rays, "ray")}`, `${fixed(truth.seconds, 2)}${NBSP}s, ${rays} a second`],
      ["Excluded", many(truth.excluded_pixels, "pixel"), `${percent(truth.excluded_pixels / (pixels * views))}${NBSP}% of ${views > 1 ? "all pictures" : "the picture"}`],
    ];
    document.title = `${data.title} · Umbrage report`;
    $("version").textContent = data.version || "";
    $("title").textContent = scene.name || data.title;
    $("lede").textContent = `${data.title && data.title !== scene.name ? data.title + ": " : ""}${many(techniques, "shadow technique")} against ray-traced truth${views > 1 ? `, in ${count(views)} views` : ""}: what each gets wrong, and what it costs.`;
    $("facts").append(...facts.map(([term, first, second]) => el("div", {}, el("dt", {}, term), el("dd", {}, first), el("dd", {}, second))));
    command($("command"), data.command);
    if (data.warnings && data.warnings.length) {
      $("warnings").hidden = false;
      $("warnings").append(...data.warnings.map((text) => el("p", {}, el("b", {}, "Note "), text)));
    }
    $("terms").append(...TERMS.map(([term, text]) => el("div", {}, el("dt", {}, term), el("dd", {}, text))));
    copyButton($("copy-command"), () => $("command"));
    copyButton($("copy-technique"), () => $("technique-command"));
  }

  function viewBar() {
    const view = state.view, several = data.views.length > 1, name = (v) => `${v.camera}, ${v.light}`;
    if (!$("view-note")) {
      $("bar").classList.toggle("several", several);
      if (several) {
        const select = el("select", { id: "view" }, ...data.views.map((v) => el("option", { value: v.id }, name(v))));
        select.addEventListener("change", () => chooseView(data.views.find((v) => v.id === select.value)));
        $("bar").append(el("label", {}, "View", select));
      } else $("bar").append(el("b", {}, name(view)));
      $("bar").append(el("span", { id: "view-note" }));
    }
    $("view-note").textContent = `${many(view.receivers, "receiver")} (${percent(view.receivers / pixels)}${NBSP}% of the picture), ${count(view.excluded_pixels)} excluded (${percent(view.excluded_pixels / pixels)}${NBSP}%)`;
  }

  function chooseView(view) {
    const before = state.chosen;
    state.view = view;
    state.rows = rows.filter((r) => r.view === view.id);
    viewBar();
    const twin = before && state.rows.find((r) => r.technique === before.technique && same(r.params, before.params));
    const front = frontOf(state.rows, "rmse").sort((a, b) => a.rmse - b.rmse);
    const log = $("log-x"), costs = state.rows.map((r) => r.cost_ms).filter((v) => v > 0).sort((a, b) => a - b);
    log.checked = costs.length > 3 && costs[costs.length - 1] > 12 * costs[costs.length >> 1];
    tableRows();
    chooseMetric();
    choose(twin || front[0] || state.rows[0] || null);
  }

  function chooseMetric() {
    state.metric = $("plot-metric").value;
    state.front = new Set(frontOf(state.rows, state.metric).map((r) => r.index));
    // One very wrong technique (the unshadowed one) would press all others to the ground of a linear axis.
    const values = state.rows.map((r) => r[state.metric]).filter((v) => known(v) && v > 0);
    $("log-y").checked = values.length > 1 && Math.max(...values) > 15 * Math.min(...values);
    for (const tr of $("results").tBodies[0].rows) {
      const mark = tr.querySelector(".dot"), on = state.front.has(Number(tr.dataset.index));
      mark.classList.toggle("full", on);
      mark.title = on ? `On the front of cost and ${byKey[state.metric].name}` : "";
      tr.querySelector(".mark").textContent = on ? ", on the front" : "";
    }
    plot();
  }

  // ---- Plot

  // Nought, and noise below it, have no logarithm: where they occur the scale is straight near nought.
  function scaleOf(values, log, from, to) {
    let low = Math.min(...values), high = Math.max(...values);
    if (!(high > low)) high = low + (Math.abs(low) || 1);
    const straight = low <= 0;
    const knee = Math.max(Math.min(...values.map(Math.abs).filter((v) => v > 0), high), high * 1e-6) / 1.5;
    if (log && !straight) low = knee;
    const bend = !log ? (v) => v : straight ? (v) => Math.sign(v) * Math.log10(1 + Math.abs(v) / knee) : Math.log10;
    const ticks = [];
    if (log) {
      ticks.push(0);
      for (let e = Math.floor(Math.log10(knee)); e <= Math.ceil(Math.log10(Math.max(high, -low))); e++) {
        for (const m of high / knee > 300 ? [1] : [1, 2, 5]) ticks.push(m * 10 ** e, -m * 10 ** e);
      }
    } else {
      const rough = (high - low) / Math.max(2, Math.abs(to - from) / 90), power = 10 ** Math.floor(Math.log10(rough));
      const step = power * [1, 2, 5, 10].find((m) => m * power >= rough);
      low = Math.floor(low / step + 1e-9) * step;
      high = Math.ceil(high / step - 1e-9) * step;
      for (let k = Math.round(low / step); k * step <= high * (1 + 1e-9) + step * 1e-9; k++) ticks.push(k * step);
    }
    const a = bend(low), b = bend(high);
    const at = (v) => from + ((bend(Math.min(high, Math.max(low, v))) - a) / (b - a)) * (to - from);
    return { at, low, high, kind: !log ? "" : straight ? ", logarithmic, straight near 0" : ", logarithmic", ticks: ticks.filter((t) => t >= low * (1 + 1e-9) - 1e-12 && t <= high * (1 + 1e-9)) };
  }

  // Labels go where they touch nothing; those in the thick of it choose first, and of a few orders the best is kept.
  function placeLabels(dots, area, lines) {
    const hits = (a, b) => a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
    const near = (d) => dots.filter((o) => Math.hypot(o.x - d.x, (o.y - d.y) * 3) < 110).length;
    const marks = dots.map((d) => [d.x - 7, d.y - 7, d.x + 7, d.y + 7]);
    const orders = [(a, b) => near(b) - near(a) || a.y - b.y, (a, b) => a.x - b.x, (a, b) => b.y - a.y];
    let best = null;
    for (const order of orders) {
      const taken = [], leaders = [];
      let sum = 0;
      const placed = new Map();
      for (const d of [...dots].sort(order)) {
        let choice = null;
        for (const r of [10, 14, 20, 28, 40, 55, 75, 100, 130, 170, 220]) {
          for (let k = 0; k < 16; k++) {
            const turn = (k % 2 ? -1 : 1) * Math.ceil(k / 2) * (Math.PI / 8);
            const cos = Math.cos(turn), sin = Math.sin(turn), px = d.x + r * cos, py = d.y + r * sin;
            const left = cos > 0.3 ? px : cos < -0.3 ? px - d.w : px - d.w / 2;
            const top = Math.abs(cos) > 0.3 ? py - d.h / 2 : sin < 0 ? py - d.h + 3 : py - 3;
            const box = [left, top, left + d.w, top + d.h], wide = [left - 4, top - 1, left + d.w + 4, top + d.h + 1];
            if (box[0] < area[0] || box[1] < area[1] || box[2] > area[2] || box[3] > area[3]) continue;
            if (taken.some((b) => hits(b, wide)) || marks.some((b, n) => hits(b, dots[n] === d ? box : wide))) continue;
            const trail = r > 20 ? [0.25, 0.4, 0.55, 0.7, 0.85, 1].map((t) => [d.x + t * r * cos, d.y + t * r * sin]) : [];
            const spots = trail.map(([x, y]) => [x - 1, y - 1, x + 1, y + 1]);
            if (spots.some((s) => taken.some((b) => hits(b, s)) || marks.some((b, n) => dots[n] !== d && hits(b, s)))) continue;
            const cost = r + Math.ceil(k / 2) * 1.2 + lines.reduce((total, b) => total + (hits(b, box) ? b[4] || 8 : 0), 0) + 30 * leaders.filter((b) => hits(b, box)).length;
            if (!choice || cost < choice.cost) choice = { cost, box, spots, reach: r, end: r > 20 ? [px, py] : null, anchor: cos > 0.3 ? "start" : cos < -0.3 ? "end" : "middle" };
          }
        }
        if (!choice) { sum += 1000; continue; }
        sum += choice.cost;
        taken.push(choice.box);
        leaders.push(...choice.spots);
        placed.set(d, choice);
      }
      if (!best || sum < best.sum) best = { sum, placed };
    }
    return best.placed;
  }

  function plot() {
    const root = $("plot"), w = Math.max(280, root.clientWidth), narrow = w < 600, metric = byKey[state.metric], share = metric.unit === "%";
    const h = Math.round(Math.min(580, Math.max(340, w * 0.4)));
    const had = root.contains(document.activeElement);
    const area = [narrow ? 60 : 64, 26, w - 10, h - 40];
    root.replaceChildren();
    state.dots = [];
    root.setAttribute("viewBox", `0 0 ${w} ${h}`);
    root.setAttribute("height", h);
    const list = state.rows.filter((r) => known(r[state.metric]) && known(r.cost_ms));
    const left = state.rows.length - list.length;
    $("plot-note").textContent = left ? `${many(left, "row")} without a value not drawn. ` : "";
    if (!list.length) {
      root.append(svg("text", { x: w / 2, y: h / 2, "text-anchor": "middle" }, `No technique has a value for ${metric.name}.`));
      return readout(null);
    }

    // A whisker may not squeeze the plot: the axis follows the medians, and a long whisker runs out of it.
    const costs = list.map((r) => r.cost_ms), low = Math.min(0, ...costs), high = Math.max(...costs, 0.001);
    const least = Math.min(low, Math.max(low - 0.3 * (high - low), Math.min(...list.map((r) => r.cost_min_ms ?? r.cost_ms))));
    const most = Math.max(high, Math.min(high + 0.25 * (high - low), Math.max(...list.map((r) => r.cost_max_ms ?? r.cost_ms))));
    const X = scaleOf([...costs, least, most, 0], $("log-x").checked, area[0] + 14, area[2] - 14);
    const Y = scaleOf([...list.map((r) => r[state.metric]), ...($("log-y").checked ? [] : [0])], $("log-y").checked, area[3] - 10, area[1] + 8);
    const tick = (v) => String(Number(v.toPrecision(3))).replace("-", "−");

    const back = svg("g", { "aria-hidden": "true" });
    // Ticks nearer to one another than their numbers need are left out.
    const roomy = (scale, need) => scale.ticks.sort((a, b) => a - b).reduce((kept, t) => (kept.length && Math.abs(scale.at(t) - scale.at(kept[kept.length - 1])) < need(t) ? kept : [...kept, t]), []);
    for (const t of roomy(Y, () => 17)) {
      const y = Y.at(t);
      back.append(svg("line", { class: "grid", x1: area[0], x2: area[2], y1: y, y2: y }), svg("text", { x: area[0] - 8, y: y + 4, "text-anchor": "end" }, tick(share ? t * 100 : t)));
    }
    for (const t of roomy(X, (t) => 10 + tick(t).length * 7)) {
      const x = X.at(t);
      back.append(svg("line", { class: "grid", x1: x, x2: x, y1: area[1], y2: area[3] }), svg("text", { x, y: area[3] + 17, "text-anchor": "middle" }, tick(t)));
    }
    back.append(svg("line", { class: "axis", x1: area[0], x2: area[2], y1: area[3], y2: area[3] }), svg("line", { class: "axis", x1: area[0], x2: area[0], y1: area[1], y2: area[3] }));
    if (X.low < 0) back.append(svg("line", { class: "zero", x1: X.at(0), x2: X.at(0), y1: area[1], y2: area[3] }));
    back.append(svg("text", { x: 2, y: 13 }, `${metric.name}${share ? ", %" : ""}${Y.kind}`), svg("text", { x: area[2], y: h - 5, "text-anchor": "end" }, `cost, ms${X.kind}`));

    const dots = list.map((row) => ({ row, x: X.at(row.cost_ms), y: Y.at(row[state.metric]), full: state.front.has(row.index) }));
    const steps = dots.filter((d) => d.full).sort((a, b) => a.row.cost_ms - b.row.cost_ms || b.y - a.y);
    // What lies in the shadow of the front is worse in both.
    let path = "", edge = null;
    const lines = [];
    for (const d of steps) {
      path += edge ? `H${d.x}V${d.y}` : `M${d.x},${d.y}`;
      if (edge) lines.push([edge.x, edge.y - 1, d.x, edge.y + 1, 25], [d.x - 1, Math.min(edge.y, d.y), d.x + 1, Math.max(edge.y, d.y), 25]);
      edge = d;
    }
    lines.push([edge.x, edge.y - 1, area[2], edge.y + 1, 25]);
    back.append(svg("path", { class: "worse", d: `${path}H${area[2]}V${area[1]}H${steps[0].x}Z` }), svg("path", { class: "front", d: `${path}H${area[2]}` }));

    const spreads = svg("g", { "aria-hidden": "true" }), names = svg("g", { "aria-hidden": "true" }), marks = svg("g", {});
    root.append(back, svg("g", { id: "guides", "aria-hidden": "true" }), spreads, names, marks);
    for (const d of dots) {
      const { row } = d, from = row.cost_min_ms ?? row.cost_ms, to = row.cost_max_ms ?? row.cost_ms;
      if (to > from) {
        const a = X.at(from), b = X.at(to), cap = (v, x) => (v >= X.low && v <= X.high ? `M${x},${d.y - 3.5}v7` : "");
        spreads.append(svg("path", { class: "spread", "data-row": row.index, d: `M${a},${d.y}H${b}${cap(from, a)}${cap(to, b)}` }));
        lines.push([a, d.y - 1, b, d.y + 1]);
      }
      d.circle = svg("circle", { cx: d.x, cy: d.y, r: 5, class: d.full ? "full" : null, "data-index": row.index, "data-technique": row.technique, role: "button", tabindex: -1,
        "aria-label": `${nameOf(row)}: ${fixed(row.cost_ms, 2)} ms, ${metric.name} ${metric.format([])(row[state.metric])}${share ? " %" : ""}${d.full ? ", on the front" : ""}` });
      d.text = svg("text", { class: `label${d.full ? " full" : ""}`, "data-row": row.index });
      names.append(d.text);
      marks.append(d.circle);
    }
    // Whole names where they all fit without long leaders, else ids; what finds no room shows when pointed at.
    const cut = (text, n) => (text.length > n ? text.slice(0, n - 1).trimEnd() + "…" : text);
    const ways = [(r) => cut(r.label, 34) + (r.differ ? ` ${cut(r.differ, 28)}` : ""), (r) => cut(r.technique + (r.differ ? ` ${r.differ}` : ""), 26)];
    let placed = null, way = null;
    for (const text of ways) {
      for (const d of dots) d.text.textContent = text(d.row);
      for (const d of dots) Object.assign(d, { w: d.text.getComputedTextLength(), h: 15 });
      const trial = placeLabels(dots, [area[0] + 3, area[1] - 6, area[2], area[3] - 2], lines);
      if (!placed || trial.size >= placed.size) [placed, way] = [trial, text];
      if (trial.size === dots.length && ![...trial.values()].some((spot) => spot.reach > 55)) break;
    }
    for (const d of dots) {
      const spot = placed.get(d);
      if (!spot) { d.text.remove(); continue; }
      d.text.textContent = way(d.row);
      d.text.setAttribute("x", spot.anchor === "start" ? spot.box[0] : spot.anchor === "end" ? spot.box[2] : (spot.box[0] + spot.box[2]) / 2);
      d.text.setAttribute("y", spot.box[1] + 11.5);
      d.text.setAttribute("text-anchor", spot.anchor);
      if (spot.end) names.prepend(svg("line", { class: "leader", x1: d.x, y1: d.y, x2: spot.end[0], y2: spot.end[1] }));
    }
    if (placed.size < dots.length) $("plot-note").textContent += `No room for ${many(dots.length - placed.size, "name")}: point at a dot.`;
    Object.assign(state, { dots: dots.sort((a, b) => a.x - b.x || a.y - b.y), area });
    tabStops();
    mark(null);
    if (had && state.dots.length) (state.dots.find((d) => d.row === state.chosen) || state.dots[0]).circle.focus();
  }

  function readout(row) {
    const shown = row || state.chosen;
    const metric = byKey[state.metric];
    if (!shown) return $("readout").replaceChildren("");
    const values = state.rows.map((r) => r.cost_ms).filter(known), ms = column(3, 3)(values);
    const value = known(shown[state.metric]) ? metric.format([])(shown[state.metric]) + (metric.unit === "%" ? NBSP + "%" : "") : "unknown";
    const spread = known(shown.cost_min_ms) && shown.cost_max_ms > shown.cost_min_ms ? ` (${ms(shown.cost_min_ms)} to ${ms(shown.cost_max_ms)})` : "";
    $("readout").replaceChildren(el("b", {}, nameOf(shown)), `  ${ms(shown.cost_ms)}${NBSP}ms${spread}, ${metric.name} ${value}`);
  }

  // Dot, label, whisker and row of one technique light up together.
  function mark(hot) {
    for (const node of document.querySelectorAll("#plot [data-row], #plot circle, #results tbody tr")) {
      const index = Number(node.dataset.row ?? node.dataset.index);
      node.classList.toggle("hot", !!hot && index === hot.index);
      node.classList.toggle("chosen", !!state.chosen && index === state.chosen.index);
    }
    readout(hot);
    const dot = (state.dots || []).find((d) => d.row === (hot || state.chosen)), guides = $("guides");
    if (guides) guides.replaceChildren(...(dot && hot ? [svg("path", { class: "guide", fill: "none", d: `M${state.area[0]},${dot.y}H${dot.x}V${state.area[3]}` })] : []));
  }

  function plotEvents() {
    const root = $("plot");
    const nearest = (event) => {
      const box = root.getBoundingClientRect(), k = root.viewBox.baseVal.width / box.width;
      const x = (event.clientX - box.left) * k, y = (event.clientY - box.top) * k;
      const found = (state.dots || []).map((d) => [Math.hypot(d.x - x, d.y - y), d]).sort((a, b) => a[0] - b[0])[0];
      return found && found[0] < 18 ? found[1].row : null;
    };
    const rowOf = (node) => rows[Number(node.dataset.index)];
    root.addEventListener("pointermove", (e) => mark(nearest(e)));
    root.addEventListener("pointerleave", () => mark(null));
    root.addEventListener("click", (e) => { const row = nearest(e); if (row) choose(row); });
    root.addEventListener("focusin", (e) => { if (e.target.dataset.index) mark(rowOf(e.target)); });
    root.addEventListener("focusout", () => mark(null));
    root.addEventListener("keydown", (e) => {
      const here = state.dots.findIndex((d) => d.circle === e.target);
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[e.key];
      if (here < 0) return;
      if (step) state.dots[Math.min(state.dots.length - 1, Math.max(0, here + step))].circle.focus();
      else if (e.key === "Enter" || e.key === " ") choose(rowOf(e.target));
      else return;
      e.preventDefault();
    });
    let seen = 0;
    new ResizeObserver(() => {
      if (root.clientWidth !== seen) { seen = root.clientWidth; plot(); }
      pictures();
    }).observe(root);
  }

  // ---- Table

  const HINT = "Choose a row to compare it with truth below. Bold: the best, unshadowed aside.";
  const defineLine = (c) => $("define").replaceChildren(...(c ? [el("b", {}, `${c.name}: `), c.define] : [HINT]));

  function tableHead() {
    const groups = el("tr", { class: "groups" }), keys = el("tr", { class: "keys" });
    let group = null;
    for (const c of COLUMNS) {
      c.first = group === null || c.group !== group.name;
      if (c.first) {
        group = { name: c.group, th: el(c.group ? "th" : "td", { scope: c.group ? "colgroup" : null, class: c.group ? "first" : null, colspan: 0 }, ...(c.group ? [el("span", {}, c.group)] : [])) };
        groups.append(group.th);
      }
      group.th.colSpan = Number(group.th.getAttribute("colspan")) + 1;
      c.unitNode = el("small", {}, typeof c.unit === "string" ? c.unit : "");
      const button = el("button", { type: "button", title: c.define }, c.name, c.unitNode);
      button.addEventListener("click", () => sortBy(c));
      for (const on of ["pointerenter", "focus"]) button.addEventListener(on, () => defineLine(c));
      for (const off of ["pointerleave", "blur"]) button.addEventListener(off, () => defineLine(null));
      c.th = el("th", { scope: "col", "data-key": c.key, "aria-sort": "none", class: c.first && c.group ? "first" : null }, button);
      keys.append(c.th);
    }
    $("results").tHead.append(groups, keys);
    const box = $("results").parentNode;
    box.addEventListener("scroll", () => box.classList.toggle("scrolled", box.scrollLeft > 0), { passive: true });
    defineLine(null);
  }

  function tableRows() {
    const body = $("results").tBodies[0];
    body.replaceChildren(...state.rows.map((row) => el("tr", { "data-technique": row.technique, "data-index": row.index, tabindex: -1 })));
    for (const c of COLUMNS) {
      const values = state.rows.map((r) => r[c.key]).filter(known);
      const wrong = c.wrong || ((v) => v), format = c.format && c.format(values);
      const rivals = state.rows.filter((r) => r.technique !== "unshadowed").map((r) => r[c.key]).filter(known).map(wrong);
      const best = rivals.length > 1 && Math.min(...rivals) < Math.max(...rivals) ? Math.min(...rivals) : NaN;
      if (typeof c.unit === "function") c.unitNode.textContent = c.unit(values);
      const texts = state.rows.map((r) => (c.format && known(r[c.key]) ? format(r[c.key]) : ""));
      const places = (text) => (text.includes(".") ? text.length - text.indexOf(".") - 1 : 0), most = Math.max(0, ...texts.map(places));
      state.rows.forEach((row, n) => {
        const tr = body.rows[n], value = row[c.key];
        if (!c.format) {
          const id = [row.technique, row.differ].filter(Boolean).join(" ");
          tr.append(el("td", {}, el("i", { class: "dot" }), el("span", {}, row.label), el("small", {}, id), el("span", { class: "mark visually-hidden" })));
          return;
        }
        const small = c.small && known(value) ? c.small(row, values) : null;
        const isBest = row.technique !== "unshadowed" && known(value) && wrong(value) === best;
        const td = el("td", { class: [c.first && "first", isBest && "best", !known(value) && "none"].filter(Boolean).join(" ") || null, title: known(value) ? exact(c, row) : "not measured" },
          el("span", {}, known(value) ? texts[n] : "—"), small === null ? null : el("small", {}, small));
        // Points stand under one another, whatever the number of digits.
        const lack = known(value) ? most - places(texts[n]) : 0;
        if (lack) td.firstChild.style.marginRight = `${(lack + (places(texts[n]) ? 0 : 0.55)).toFixed(2)}ch`;
        tr.append(td);
      });
    }
    if (state.sort) sortRows();
  }

  function exact(c, row) {
    if (c.key === "cost_ms" && known(row.cost_min_ms)) return `${row.cost_min_ms} to ${row.cost_max_ms} ms`;
    return Math.abs(row[c.key]) >= 1000 ? count(row[c.key]) : String(row[c.key]);
  }

  function sortBy(c) {
    state.down = state.sort === c ? !state.down : false;
    state.sort = c;
    for (const other of COLUMNS) other.th.setAttribute("aria-sort", other !== c ? "none" : state.down ? "descending" : "ascending");
    sortRows();
  }

  function sortRows() {
    const { sort, down } = state, body = $("results").tBodies[0];
    const value = (tr) => { const row = rows[Number(tr.dataset.index)]; return sort.format ? row[sort.key] : nameOf(row); };
    const order = (a, b) => (typeof a === "string" ? a.localeCompare(b, "en", { numeric: true }) : a - b);
    const lacks = (v) => typeof v !== "string" && !known(v);
    body.append(...[...body.rows].sort((p, q) => {
      const a = value(p), b = value(q);
      if (lacks(a) || lacks(b)) return lacks(a) - lacks(b) || p.dataset.index - q.dataset.index;
      return (down ? order(b, a) : order(a, b)) || p.dataset.index - q.dataset.index;
    }));
    picker();
  }

  function tableEvents() {
    const body = $("results").tBodies[0], rowOf = (e) => { const tr = e.target.closest("tr"); return tr && rows[Number(tr.dataset.index)]; };
    body.addEventListener("click", (e) => choose(rowOf(e)));
    body.addEventListener("pointerover", (e) => mark(rowOf(e)));
    body.addEventListener("pointerleave", () => mark(null));
    body.addEventListener("focusin", (e) => mark(rowOf(e)));
    body.addEventListener("focusout", () => mark(null));
    body.addEventListener("keydown", (e) => {
      const tr = e.target.closest("tr");
      const to = { ArrowDown: tr.nextElementSibling, ArrowUp: tr.previousElementSibling, Home: body.firstElementChild, End: body.lastElementChild }[e.key];
      if (to) to.focus();
      else if (e.key === "Enter" || e.key === " ") choose(rowOf(e));
      else return;
      e.preventDefault();
    });
  }

  // ---- Comparison

  function picker() {
    const inOrder = [...$("results").tBodies[0].rows].map((tr) => rows[Number(tr.dataset.index)]);
    $("pick").replaceChildren(...inOrder.map((row) => el("option", { value: row.index }, nameOf(row))));
    if (state.chosen) $("pick").value = state.chosen.index;
    const here = $("pick").selectedIndex;
    $("previous").disabled = here <= 0;
    $("next").disabled = here < 0 || here >= inOrder.length - 1;
  }

  // One dot and one row take the focus: the chosen one, else the first; arrow keys lead to the others.
  function tabStops() {
    for (const list of ["#plot circle", "#results tbody tr"]) {
      const nodes = [...document.querySelectorAll(list)], is = (n) => !!state.chosen && Number(n.dataset.index) === state.chosen.index;
      const stop = nodes.find(is) || nodes[0];
      for (const node of nodes) {
        node.setAttribute("tabindex", node === stop ? 0 : -1);
        if (node.tagName !== "TR") node.setAttribute("aria-pressed", is(node));
        else if (is(node)) node.setAttribute("aria-current", "true");
        else node.removeAttribute("aria-current");
      }
    }
  }

  function choose(row) {
    state.chosen = row;
    tabStops();
    picker();
    mark(null);
    $("compare").hidden = !row;
    if (!row) return;
    $("summary").replaceChildren(el("b", {}, nameOf(row)), row.summary ? `: ${row.summary.replaceAll("`", "")}` : "");
    command($("technique-command"), row.command);
    const work = [many(row.passes, "pass", "passes"), many(row.draws, "draw"), many(row.triangles, "triangle"), many(row.texels, "texel"), `${fixed(row.memory_bytes / 2 ** 20, 2)}${NBSP}MiB`, `${many(row.taps, "map lookup")} for each receiver`];
    $("counts").textContent = work.join(", ") + ".";
    $("passes").replaceChildren(...(row.pass_names || []).map((name) => el("li", {}, name)));
    const params = Object.entries(row.params || {});
    $("params").replaceChildren(...params.map(([name, value]) => el("div", {}, el("dt", {}, name), el("dd", {}, show(value)))));
    $("params").parentNode.hidden = !params.length;
    pictures();
  }

  function put(img, source, alt) {
    img.hidden = !source;
    if (source && img.getAttribute("src") !== source) img.src = source;
    img.alt = alt;
  }

  function pictures() {
    const { chosen: row, view, zoom, split } = state;
    if (!row) return;
    const kind = document.querySelector("#kind input:checked").value, name = nameOf(row);
    put($("compare-bottom"), view[kind], `Truth, ${kind}`);
    put($("compare-top"), row[kind], `${name}, ${kind}`);
    put($("heat"), row.heat, `Where ${name} is wrong: orange false shadow, blue false light`);
    state.x = Math.min(1 - 1 / zoom, Math.max(0, state.x));
    state.y = Math.min(1 - 1 / zoom, Math.max(0, state.y));
    for (const pane of document.querySelectorAll(".pane")) {
      pane.style.aspectRatio = `${width} / ${height}`;
      pane.classList.toggle("zoomed", zoom > 1);
      const large = (pane.clientWidth * zoom) / width > 2;
      for (const img of pane.querySelectorAll("img")) {
        img.style.transform = zoom > 1 ? `translate(${-state.x * zoom * 100}%, ${-state.y * zoom * 100}%) scale(${zoom})` : "";
        img.style.imageRendering = large ? "pixelated" : "";
      }
    }
    // The picture is cut in its own coordinates, before it is zoomed.
    const cut = 1 - Math.min(1, Math.max(0, state.x + split / zoom));
    $("compare-top").style.clipPath = `inset(0 ${Number((cut * 100).toFixed(3))}% 0 0)`;
    $("handle").style.left = `${split * 100}%`;
    $("slider").value = Math.round(split * 100);
    $("slider").setAttribute("aria-valuetext", `${Math.round(split * 100)} % technique, the rest truth`);
    document.querySelector("#pane-compare .left").classList.toggle("away", split < 0.15);
    document.querySelector("#pane-compare .right").classList.toggle("away", split > 0.88);
  }

  function zoomTo(zoom) {
    const half = 0.5 / state.zoom;
    Object.assign(state, { zoom, x: state.x + half - 0.5 / zoom, y: state.y + half - 0.5 / zoom });
    pictures();
  }

  function comparisonEvents() {
    const step = (by) => { const to = $("pick").options[$("pick").selectedIndex + by]; if (to) choose(rows[Number(to.value)]); };
    $("previous").addEventListener("click", () => step(-1));
    $("next").addEventListener("click", () => step(1));
    $("pick").addEventListener("change", () => choose(rows[Number($("pick").value)]));
    $("slider").addEventListener("input", () => { state.split = $("slider").valueAsNumber / 100; pictures(); });
    $("kind").addEventListener("change", pictures);
    $("zoom").addEventListener("change", (e) => zoomTo(Number(e.target.value)));
    for (const pane of document.querySelectorAll(".pane")) {
      const at = (e) => { const box = pane.getBoundingClientRect(); return [(e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height]; };
      let drag = null;
      pane.addEventListener("pointerdown", (e) => {
        if (e.button !== 0) return;
        const slides = pane.id === "pane-compare" && (state.zoom === 1 || e.target === $("handle"));
        if (!slides && state.zoom === 1) return;
        drag = { slides, from: at(e), x: state.x, y: state.y };
        pane.setPointerCapture(e.pointerId);
        move(e);
      });
      const move = (e) => {
        const [x, y] = at(e);
        if (!drag) return;
        if (drag.slides) state.split = Math.min(1, Math.max(0, x));
        else Object.assign(state, { x: drag.x - (x - drag.from[0]) / state.zoom, y: drag.y - (y - drag.from[1]) / state.zoom });
        pictures();
      };
      pane.addEventListener("pointermove", move);
      for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) pane.addEventListener(end, () => { drag = null; });
    }
    $("pane-heat").addEventListener("keydown", (e) => {
      const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[e.key];
      if (!by || state.zoom === 1) return;
      e.preventDefault();
      state.x += (by[0] * 0.1) / state.zoom;
      state.y += (by[1] * 0.1) / state.zoom;
      pictures();
    });
  }

  // ---- Start

  header();
  tableHead();
  $("plot-metric").append(...METRICS.map((key) => el("option", { value: key }, byKey[key].name)));
  $("plot-metric").addEventListener("change", chooseMetric);
  for (const id of ["log-x", "log-y"]) $(id).addEventListener("change", plot);
  if (data.views.length) chooseView(data.views[0]);
  plotEvents();
  tableEvents();
  comparisonEvents();
})();
