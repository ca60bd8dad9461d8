// The difference of two recordings over the whole time line: force, depth, distance of the tools, removed bone.

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Difference } from "./messages";
import { padded } from "./charts";
import { t, type Word } from "./texts";

const GRID = "#303a45", TEXT = "#a3b1bf", NOW = "#e8edf2", HEIGHT_PX = 150;
const FIRST = "#5aa9f0", SECOND = "#e8b23a", APART = "#f0635a";

const COLOURS = [FIRST, SECOND, APART], DASHES = [[], [6, 3], [2, 2]], MARKS = ["──", "─ ─", "┈┈"];

/** Explains the lines of all charts: mark, colour and name of each. */
export function legend(): HTMLElement[] {
  return [t("first"), t("second"), t("difference")].map((name, i) => {
    const entry = document.createElement("span");
    entry.textContent = `${MARKS[i]} ${name}`;
    entry.style.color = COLOURS[i];
    return entry;
  });
}

interface ChartDef {
  title: Word;
  unit: string;
  columns: (difference: Difference) => (number | null)[][];
  colours: string[];
}
const CHARTS: ChartDef[] = [
  { title: "force", unit: "N", columns: (d) => [...d.force_N, d.force_apart_N], colours: [FIRST, SECOND, APART] },
  { title: "deepest", unit: "mm", columns: (d) => d.depth_mm, colours: [FIRST, SECOND] },
  { title: "apart", unit: "mm", columns: (d) => [d.apart_mm], colours: [APART] },
  { title: "removed", unit: "mm³", columns: (d) => d.removed_mm3, colours: [FIRST, SECOND] },
];

export class DifferenceCharts {
  private plots: uPlot[] = [];
  private at_s = 0;

  /** @param seek  called with the time that was clicked */
  constructor(
    private readonly parent: HTMLElement,
    private readonly seek: (at_s: number) => void,
  ) {
    new ResizeObserver(() => {
      for (const plot of this.plots) plot.setSize({ width: this.width(plot.root.parentElement!), height: HEIGHT_PX });
    }).observe(parent);
  }

  show(difference: Difference): void {
    const times = difference.apart_mm.map((_, bin) => bin * difference.step_s);
    CHARTS.forEach((def, i) => {
      const data = [times, ...def.columns(difference)] as uPlot.AlignedData;
      if (this.plots[i]) this.plots[i].setData(data, false);
      else this.plots[i] = this.make(def, data);
      const whole = { min: 0, max: Math.max(times[times.length - 1] ?? 0, difference.step_s) };
      if (!this.zoomed(this.plots[i], whole.max)) this.plots[i].setScale("x", whole);
    });
  }

  showTime(at_s: number): void {
    this.at_s = at_s;
    for (const plot of this.plots) plot.redraw(false);
  }

  /** Whether a person has zoomed in: the time axis does not reach from 0 to max. */
  private zoomed(plot: uPlot, max: number): boolean {
    const { min: from, max: to } = plot.scales.x;
    return from !== undefined && to !== undefined && (from > 0 || to < max) && to > 0.05;
  }

  private width(box: HTMLElement): number {
    return Math.max(box.clientWidth - 12, 200);
  }

  private make(def: ChartDef, data: uPlot.AlignedData): uPlot {
    const box = document.createElement("div");
    box.className = "chart";
    this.parent.append(box);
    const axis = { stroke: TEXT, grid: { stroke: GRID, width: 1 }, ticks: { show: false }, font: "11px DejaVu Sans, sans-serif" };
    const plot = new uPlot(
      {
        title: `${t(def.title)} [${def.unit}]`,
        width: this.width(box),
        height: HEIGHT_PX,
        legend: { show: false },
        cursor: { sync: { key: "difference" }, drag: { x: true, y: false } },
        scales: { x: { time: false }, y: { range: (_, low, high) => padded(low, high) } },
        axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((s) => `${s} s`) }, { ...axis, size: 48 }],
        series: [{}, ...def.colours.map((stroke, i) => ({
          stroke, width: 1.3, dash: DASHES[COLOURS.indexOf(def.colours[i])], points: { show: false }, spanGaps: true,
        }))],
        hooks: { draw: [(each) => this.drawNow(each)] },
      },
      data,
      box,
    );
    plot.over.addEventListener("click", () => {
      const left = plot.cursor.left ?? -1;
      if (left >= 0 && plot.select.width === 0) this.seek(plot.posToVal(left, "x"));
    });
    return plot;
  }

  /** Draws a line at the time that is shown. */
  private drawNow(plot: uPlot): void {
    const { left, top, width, height } = plot.bbox;
    const x = plot.valToPos(this.at_s, "x", true);
    if (!(x >= left && x <= left + width)) return;
    plot.ctx.save();
    plot.ctx.strokeStyle = NOW;
    plot.ctx.setLineDash([]);
    plot.ctx.beginPath();
    plot.ctx.moveTo(x, top);
    plot.ctx.lineTo(x, top + height);
    plot.ctx.stroke();
    plot.ctx.restore();
  }
}
