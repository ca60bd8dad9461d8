// One cursor and one zoom for all plots over time of a page. Without this script the plots stand as they are.
// A plot's parts are described in report/svg_plot.cpp (DrawPanels).
"use strict";
(function () {
  const MIN_SPAN_S = 0.01, MIN_DRAG_PX = 6, MAX_TICKS = 10;
  const numbersOf = (text) => text.split(" ").map(Number);

  /** Points of a path that has M and L alone; a gap is a point without a place. */
  function pointsOf(path) {
    const x = [], y = [];
    for (const [, command, px, py] of path.getAttribute("d").matchAll(/([ML])(-?[\d.]+) (-?[\d.]+)/g)) {
      if (command === "M" && x.length > 0) [x[x.length], y[y.length]] = [Number(px), NaN];
      x.push(Number(px));
      y.push(Number(py));
    }
    return { x, y, colour: path.getAttribute("stroke") };
  }

  const panels = [...document.querySelectorAll("g.panel")].map((group) => {
    const [left, top, width, height] = numbersOf(group.dataset.area), [from, to] = numbersOf(group.dataset.x);
    const [low, high] = numbersOf(group.dataset.y);
    const part = (name) => group.querySelector("." + name);
    return {
      group, left, top, width, height, from, to, low, high, svg: group.ownerSVGElement,
      data: part("data"), grid: part("x-grid"), texts: part("x-texts"), names: [...group.querySelectorAll(".x-names")],
      whole: {
        grid: part("x-grid").innerHTML, texts: part("x-texts").innerHTML,
        line: group.querySelector(".x-grid line"), text: group.querySelector(".x-texts text"),
      },
      curves: null, cursor: null, readout: null,
    };
  });
  if (panels.length === 0) return;
  const whole = [Math.min(...panels.map((p) => p.from)), Math.max(...panels.map((p) => p.to))];
  let shown = whole;

  const rangeOf = (p) => (shown === whole ? [p.from, p.to] : shown);
  const toPixel = (p, time) => p.left + (p.width * (time - rangeOf(p)[0])) / (rangeOf(p)[1] - rangeOf(p)[0]);
  const toTime = (p, pixel) => rangeOf(p)[0] + ((pixel - p.left) / p.width) * (rangeOf(p)[1] - rangeOf(p)[0]);
  const made = (name, attributes, text) => changed(document.createElementNS(panels[0].svg.namespaceURI, name), attributes, text);
  const copied = (element, attributes, text) => changed(element.cloneNode(true), attributes, text);
  const changed = (element, attributes, text) => {
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    return element;
  };

  function ticksOf(from, to) {
    const rough = (to - from) / MAX_TICKS, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const ticks = [];
    for (let k = Math.ceil(from / step); k * step <= to; ++k) ticks.push([k * step, (k * step).toFixed(decimals)]);
    return ticks;
  }

  function show(range) {
    shown = range;
    for (const p of panels) {
      const [from, to] = rangeOf(p), perSecond = p.width / (p.to - p.from);
      const [x, y, width, height] = [p.left + (from - p.from) * perSecond, p.top, (to - from) * perSecond, p.height];
      p.data.setAttribute("viewBox", [x, y, width, height].join(" "));
      for (const each of p.names) each.style.display = range === whole ? "" : "none";
      if (range === whole) {
        p.grid.innerHTML = p.whole.grid;
        p.texts.innerHTML = p.whole.texts;
        continue;
      }
      const ticks = ticksOf(from, to);
      p.grid.replaceChildren(...ticks.map(([time]) => copied(p.whole.line, { x1: toPixel(p, time), x2: toPixel(p, time) })));
      p.texts.replaceChildren(...(p.whole.text
        ? ticks.map(([time, text]) => copied(p.whole.text, { x: toPixel(p, time) }, text)) : []));
    }
    reset.hidden = range === whole;
  }

  /** Least and most of a curve within half a pixel of a place; between two points if there is none. */
  function valuesAt(p, curve, time) {
    const perSecond = p.width / (p.to - p.from), x = p.left + (time - p.from) * perSecond;
    const half = (0.5 * (rangeOf(p)[1] - rangeOf(p)[0])) / (p.to - p.from);
    let [begin, end] = [0, curve.x.length];
    while (begin < end) {
      const middle = (begin + end) >> 1;
      if (curve.x[middle] < x - half) begin = middle + 1;
      else end = middle;
    }
    let least = Infinity, most = -Infinity;
    const add = (y) => {
      if (Number.isNaN(y)) return;
      const value = p.high - ((y - p.top) / p.height) * (p.high - p.low);
      [least, most] = [Math.min(least, value), Math.max(most, value)];
    };
    let i = begin;
    for (; i < curve.x.length && curve.x[i] <= x + half; ++i) add(curve.y[i]);
    if (i === begin && i > 0 && i < curve.x.length) {
      const share = (x - curve.x[i - 1]) / (curve.x[i] - curve.x[i - 1]);
      add(curve.y[i - 1] + share * (curve.y[i] - curve.y[i - 1]));
    }
    return least <= most ? [least, most] : null;
  }

  const figure = (p, value) => value.toFixed(Math.max(0, 2 - Math.floor(Math.log10(p.high - p.low))));

  function showCursor(time) {
    for (const p of panels) {
      if (!p.cursor) {
        p.curves = [...p.data.querySelectorAll("path")].map(pointsOf);
        p.cursor = made("line", { class: "cursor", y1: p.top, y2: p.top + p.height });
        p.readout = made("text", { class: "readout", y: p.top + 13 });
        p.group.append(p.cursor, p.readout);
      }
      const x = time === null ? NaN : toPixel(p, time), seen = x >= p.left && x <= p.left + p.width;
      p.cursor.style.display = p.readout.style.display = seen ? "" : "none";
      if (!seen) continue;
      p.cursor.setAttribute("x1", x);
      p.cursor.setAttribute("x2", x);
      const right = x < p.left + p.width / 2;
      p.readout.setAttribute("x", right ? x + 7 : x - 7);
      p.readout.setAttribute("text-anchor", right ? "start" : "end");
      p.readout.replaceChildren(made("tspan", {}, `${time.toFixed(3)} s`));
      for (const curve of p.curves) {
        const values = valuesAt(p, curve, time);
        if (!values) continue;
        const [least, most] = values.map((value) => figure(p, value));
        p.readout.append(made("tspan", { fill: curve.colour, dx: 9 }, least === most ? most : `${least} … ${most}`));
      }
    }
  }

  const reset = document.createElement("button");
  reset.type = "button";
  reset.className = "whole-run";
  reset.textContent = "Show the whole run";
  reset.hidden = true;
  reset.onclick = () => show(whole);
  document.body.append(reset);
  const hint = document.createElement("p");
  hint.className = "sub hint";
  hint.textContent = "The cursor is one for all plots over time. Drag across a plot to zoom them all; a double click shows the whole run.";
  const first = panels[0].svg.closest("figure");
  if (first) first.before(hint);

  for (const svg of new Set(panels.map((p) => p.svg))) {
    const own = panels.filter((p) => p.svg === svg);
    let drag = null;
    const placeOf = (event) => new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const panelAt = (place) => own.find((p) => place.y <= p.top + p.height + 20) || own[own.length - 1];
    svg.style.touchAction = "pan-x pan-y";
    svg.onpointerdown = (event) => {
      if (event.pointerType === "touch" || event.button !== 0) return;
      const place = placeOf(event), p = panelAt(place);
      if (place.x < p.left || place.x > p.left + p.width) return;
      event.preventDefault();
      svg.setPointerCapture(event.pointerId);
      drag = { p, x: place.x, band: made("rect", { class: "band", y: p.top, height: p.height }) };
      p.group.append(drag.band);
    };
    svg.onpointermove = (event) => {
      const place = placeOf(event), p = panelAt(place);
      showCursor(Math.min(Math.max(toTime(p, place.x), rangeOf(p)[0]), rangeOf(p)[1]));
      if (!drag) return;
      drag.band.setAttribute("x", Math.min(drag.x, place.x));
      drag.band.setAttribute("width", Math.abs(place.x - drag.x));
    };
    svg.onpointerup = (event) => {
      if (!drag) return;
      const { p, x, band } = drag, place = placeOf(event);
      band.remove();
      drag = null;
      if (Math.abs(place.x - x) < MIN_DRAG_PX) return;
      const clamp = (pixel) => Math.min(Math.max(pixel, p.left), p.left + p.width);
      const [from, to] = [toTime(p, clamp(Math.min(x, place.x))), toTime(p, clamp(Math.max(x, place.x)))];
      if (to - from >= MIN_SPAN_S) show([from, to]);
    };
    svg.ondblclick = () => show(whole);
    svg.onpointerleave = () => showCursor(null);
  }
  document.addEventListener("keydown", (event) => event.key === "Escape" && show(whole));
  window.addEventListener("beforeprint", () => show(whole));
})();
