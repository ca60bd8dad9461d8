// The strip charts: half a minute of force, depth, removed volume and tick time, with events as marks.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { t, type Word } from "./texts";

const SHOWN_S = 30; // length of the charts' time axis
const DRAW_EVERY_MS = 100; // shortest time between two drawings
// names in Hello.fields of the numbers that the charts need from a window's row
const FIELDS = ["time_s", "force_least_N", "force_most_N", "hand_most_N", "depth_mm", "removed_mm3", "compute_most_us"];
const GRID = "#303a45", TEXT = "#a3b1bf";

interface Series {
  field: string;
  colour: string;
  band?: string; // lower field of a band below this one
}
interface ChartDef {
  title: Word;
  unit: string;
  series: Series[];
  withoutAny?: Word; // shown in place of the curve where every value is 0
}
const CHARTS: ChartDef[] = [
  {
    title: "forceChart",
    unit: "N",
    series: [
      { field: "force_most_N", colour: "#5aa9f0", band: "force_least_N" },
      { field: "hand_most_N", colour: "#c58af0" },
    ],
  },
  { title: "depth", unit: "mm", series: [{ field: "depth_mm", colour: "#58d0a0" }] },
  { title: "removedChart", unit: "mm³", series: [{ field: "removed_mm3", colour: "#e0e6a0" }] },
  { title: "tickChart", unit: "µs", series: [{ field: "compute_most_us", colour: "#e8b23a" }], withoutAny: "virtualTime" },
];

/**
 * Makes a chart whose canvas is drawn by the processor, for which uPlot has no option. A software graphics driver takes
 * several times as long for lines, and delays the figures meanwhile.
 */
function onProcessor(make: () => uPlot): uPlot {
  const prototype = HTMLCanvasElement.prototype as { getContext: (kind: string, options?: object) => unknown };
  const own = prototype.getContext;
  prototype.getContext = function (kind, options) {
    return own.call(this, kind, kind === "2d" ? { ...options, willReadFrequently: true } : options);
  };
  try {
    return make();
  } finally {
    prototype.getContext = own;
  }
}

type Columns = Record<string, number[]>;
const noColumns = (): Columns => Object.fromEntries(FIELDS.map((name) => [name, []]));
const lastOf = (columns: Columns): number => columns.time_s[columns.time_s.length - 1] ?? 0;

/** The last half minute of windows, column by column. */
class History {
  private readonly columns = noColumns();
  private indices: number[] = [];

  begin(fields: string[]): void {
    this.indices = FIELDS.map((name) => fields.indexOf(name));
    this.clear();
  }
  clear(): void {
    for (const name of FIELDS) this.columns[name] = [];
  }
  add(row: number[]): void {
    FIELDS.forEach((name, i) => this.columns[name].push(row[this.indices[i]]));
    const times = this.columns.time_s;
    while (times.length > 0 && times[0] < times[times.length - 1] - SHOWN_S)
      for (const name of FIELDS) this.columns[name].shift();
  }
  copy(): Columns {
    return Object.fromEntries(FIELDS.map((name) => [name, [...this.columns[name]]]));
  }
}

export class Charts {
  private readonly history = new History();
  private readonly plots: { plot: uPlot; def: ChartDef; box: HTMLElement }[] = [];
  private events: [number, string][] = [];
  private shown = noColumns(); // what the charts show: frozen ones keep it while the history goes on
  private frozen = false;
  private drawnAt = -Infinity;
  private drawsSoon = 0; // timer of a drawing that waits for DRAW_EVERY_MS; 0: none

  constructor(private readonly parent: HTMLElement) {
    new ResizeObserver(() => this.resize()).observe(parent);
  }

  begin(fields: string[]): void {
    this.history.begin(fields);
    this.events = [];
    this.setFrozen(false);
    this.build();
  }

  /** A playback went to another time: forgets the shown windows, and draws the next ones without waiting. */
  restart(): void {
    this.history.clear();
    this.events = [];
    this.drawnAt = -Infinity;
    if (this.frozen) this.setFrozen(false);
  }

  /** Makes the charts anew, for example in another language. */
  build(): void {
    for (const { plot } of this.plots) plot.destroy();
    this.plots.length = 0;
    this.parent.replaceChildren();
    for (const def of CHARTS) {
      const box = document.createElement("div");
      box.className = "chart";
      box.title = t("zoomHint");
      this.parent.append(box);
      const plot = onProcessor(() => new uPlot(this.options(def, box), this.dataOf(def), box));
      this.plots.push({ plot, def, box });
      box.append(this.bar(plot));
    }
  }

  add(rows: number[][]): void {
    for (const row of rows) this.history.add(row);
    const wait = this.drawnAt + DRAW_EVERY_MS - performance.now();
    if (wait <= 0) this.draw();
    else if (!this.drawsSoon) this.drawsSoon = setTimeout(() => this.draw(), wait); // the last rows of a playback that halts
  }

  private draw(): void {
    clearTimeout(this.drawsSoon);
    this.drawsSoon = 0;
    if (this.frozen) return;
    this.drawnAt = performance.now();
    this.shown = this.history.copy();
    for (const { plot, def } of this.plots) plot.setData(this.dataOf(def), true);
  }

  addEvents(events: [number, string][]): void {
    this.events.push(...events);
    this.events = this.events.slice(-100);
  }

  /** The buttons of a chart: freeze, and save as a picture. */
  private bar(plot: uPlot): HTMLElement {
    const bar = document.createElement("div");
    bar.className = "bar";
    const freeze = document.createElement("button");
    freeze.textContent = t("freeze");
    freeze.setAttribute("aria-pressed", String(this.frozen));
    freeze.onclick = () => this.setFrozen(!this.frozen);
    freeze.classList.add("freeze");
    const save = document.createElement("button");
    save.textContent = t("picture");
    save.onclick = () => {
      const link = document.createElement("a");
      link.href = plot.ctx.canvas.toDataURL("image/png");
      link.download = "osteon_chart.png";
      link.click();
    };
    bar.append(freeze, save);
    return bar;
  }

  private setFrozen(frozen: boolean): void {
    this.frozen = frozen;
    for (const each of this.parent.querySelectorAll(".freeze")) each.setAttribute("aria-pressed", String(frozen));
    this.draw();
  }

  /** The part of the time axis that a chart shows [s, 0 is the newest window]: in a frozen chart the dragged part; otherwise,
   *  and after a double click, the whole axis. */
  private spanOf(from: number, to: number): [number, number] {
    const { time_s: times } = this.shown;
    const whole = times.length === 0 || (from <= times[0] - lastOf(this.shown) && to >= 0);
    return !this.frozen || whole ? [-SHOWN_S, 0] : [Math.max(from, -SHOWN_S), Math.min(to, 0)];
  }

  /** The data of a chart for uPlot: times before the newest window [s], then a column for each line. */
  private dataOf(def: ChartDef): uPlot.AlignedData {
    const { shown } = this;
    const last = lastOf(shown);
    const data: (number | null)[][] = [shown.time_s.map((time) => time - last)];
    for (const series of def.series) {
      data.push(this.hasNone(def) ? shown[series.field].map(() => null) : shown[series.field]);
      if (series.band) data.push(shown[series.band]);
    }
    return data as uPlot.AlignedData;
  }

  private options(def: ChartDef, box: HTMLElement): uPlot.Options {
    const series: uPlot.Series[] = [{}];
    const bands: uPlot.Band[] = [];
    for (const each of def.series) {
      series.push({ stroke: each.colour, width: 1.5, points: { show: false } });
      if (each.band) {
        series.push({ stroke: each.colour, width: 1, points: { show: false } });
        bands.push({ series: [series.length - 2, series.length - 1], fill: each.colour + "44" });
      }
    }
    const axis = { stroke: TEXT, grid: { stroke: GRID, width: 1 }, ticks: { show: false }, font: "11px DejaVu Sans, sans-serif" };
    return {
      title: `${t(def.title)} [${def.unit}]`,
      width: Math.max(box.clientWidth - 12, 200),
      height: 130,
      legend: { show: false },
      cursor: { sync: { key: "strips" }, drag: { x: true, y: false } },
      scales: { x: { time: false, range: (_, from, to) => this.spanOf(from, to) }, y: { range: (_, low, high) => padded(low, high) } },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((s) => `${s} s`) }, { ...axis, size: 44 }],
      series,
      bands,
      hooks: {
        draw: [(plot) => this.drawEvents(plot), (plot) => this.sayWithoutAny(plot, def)],
        setSelect: [(plot) => plot.select.width > 0 && this.setFrozen(true)], // a zoom freezes the charts: new windows would undo it
      },
    };
  }

  /** Whether the chart has a text for the case that every value is 0, and every value is 0. */
  private hasNone(def: ChartDef): boolean {
    const values = this.shown[def.series[0].field];
    return def.withoutAny !== undefined && values.length > 0 && values.every((value) => value === 0);
  }

  /** Writes the chart's text in place of values that are all 0. */
  private sayWithoutAny(plot: uPlot, def: ChartDef): void {
    if (!def.withoutAny || !this.hasNone(def)) return;
    const { left, top, width, height } = plot.bbox;
    plot.ctx.save();
    plot.ctx.fillStyle = TEXT;
    plot.ctx.font = `${12 * devicePixelRatio}px DejaVu Sans, sans-serif`;
    plot.ctx.textAlign = "center";
    const words = t(def.withoutAny).split(": ");
    words.forEach((line, i) => plot.ctx.fillText(line, left + width / 2, top + height / 2 + 16 * devicePixelRatio * (i - 0.5), width));
    plot.ctx.restore();
  }

  /** Marks each event by a dashed line. */
  private drawEvents(plot: uPlot): void {
    if (this.shown.time_s.length === 0) return;
    const last = lastOf(this.shown);
    const { left, top, width, height } = plot.bbox;
    plot.ctx.save();
    plot.ctx.strokeStyle = "#e8b23a";
    plot.ctx.setLineDash([4, 4]);
    for (const [time] of this.events) {
      const x = plot.valToPos(time - last, "x", true);
      if (x < left || x > left + width) continue;
      plot.ctx.beginPath();
      plot.ctx.moveTo(x, top);
      plot.ctx.lineTo(x, top + height);
      plot.ctx.stroke();
    }
    plot.ctx.restore();
  }

  private resize(): void {
    for (const { plot, box } of this.plots) plot.setSize({ width: Math.max(box.clientWidth - 12, 200), height: 130 });
  }
}

/** The range of a chart's value axis: contains 0, and is at least one unit long, since the numbers on a shorter axis would
 *  be equal when rounded. */
export function padded(low: number | null, high: number | null): [number, number] {
  const from = Math.min(low ?? 0, 0), to = Math.max(high ?? 1, from + 1);
  return [from - 0.05 * (to - from), to + 0.08 * (to - from)];
}
