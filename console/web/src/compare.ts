// Two recordings side by side on one time line, with their difference. Each side is a frame with the console's page.

import "./main.css";
import "./compare.css";
import { BoneMap } from "./bone_map";
import { Connection } from "./connection";
import { DifferenceCharts, legend } from "./difference";
import { byId } from "./elements";
import type { Message } from "./messages";
import { Timeline } from "./timeline";
import { figure, t } from "./texts";

interface Camera {
  pose(): string;
  setPose(pose: string): void;
}

class ComparePage {
  private readonly sides = [1, 2].map((number) => byId(`side-${number}`) as HTMLIFrameElement);
  private readonly charts = new DifferenceCharts(byId("charts"), (at_s) => this.connection.ask("seek", at_s));
  private readonly timeline = new Timeline(byId("timeline"), {
    play: () => this.connection.ask("play"),
    halt: () => this.connection.ask("halt"),
    seek: (at_s) => this.connection.ask("seek", at_s),
    speed: (factor) => this.connection.ask("speed", factor),
  });
  private readonly map = new BoneMap(byId("bones"), (on) => this.connection.ask("map", on ? 1 : 0));
  private readonly connection: Connection;
  private pose = ""; // of both cameras, after turnTogether

  constructor() {
    const query = new URLSearchParams(location.search);
    this.sides.forEach((side, i) => {
      query.set("stream", String(i + 1));
      side.src = `index.html?${query}`;
    });
    this.connection = new Connection({ message: (message) => this.take(message), binary: () => {}, state: () => {} });
    this.nameOf(1, "");
    document.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.target instanceof HTMLSelectElement) return;
      if (event.target instanceof HTMLInputElement) return; // the time line's own keys
      const buttons = [...document.querySelectorAll<HTMLButtonElement>("#timeline button, #bones button")];
      const chosen = buttons.find((b) => b.dataset.key === event.key.toLowerCase());
      if (event.key === "ArrowRight") this.timeline.step(1);
      else if (event.key === "ArrowLeft") this.timeline.step(-1);
      else if (chosen) {
        event.preventDefault(); // a space would press the button that has the focus as well
        chosen.click();
      }
    });
    const follow = (): void => {
      this.turnTogether();
      requestAnimationFrame(follow);
    };
    follow();
  }

  private nameOf(side: number, recording: string): void {
    byId(`name-${side}`).textContent = recording ? `${side}: ${recording}` : String(side);
  }

  private take(message: Message): void {
    switch (message.type) {
      case "hello":
        this.nameOf(1, message.recording);
        break;
      case "playback":
        this.timeline.show(message);
        this.charts.showTime(message.at_s);
        for (const [i, side] of this.sides.entries()) this.nameOf(i + 1, recordingOf(side) ?? "");
        break;
      case "timeline":
        this.timeline.showNews(message);
        break;
      case "bone_difference":
        this.map.show(message);
        break;
      case "difference": {
        this.charts.show(message);
        const { most } = message;
        const part = (name: string, [value, at_s]: [number, number], unit: string): string =>
          `${name} ${figure(Math.abs(value), 3)} ${unit} ${t("at")} ${figure(at_s, 2)} s`;
        const same = [most.force_N, most.apart_mm, most.turn_deg, most.removed_mm3].every(([value]) => value === 0);
        const text = same
          ? `${t("noDifference")} (${message.ticks} ${t("ticksCompared")})`
          : `${t("largest")}: ${[
              part(t("force"), most.force_N, "N"), part(t("deepest"), most.depth_mm, "mm"), part(t("apart"), most.apart_mm, "mm"),
              part(t("turned"), most.turn_deg, "°"), part(t("removed"), most.removed_mm3, "mm³"),
            ].join(" · ")}${message.done ? "" : " …"}`;
        byId("most").replaceChildren(...legend(), text);
        break;
      }
    }
  }

  /** If a person moved the camera of one side, gives the other side's camera the same pose. */
  private turnTogether(): void {
    const cameras = this.sides.map(cameraOf);
    if (!cameras[0] || !cameras[1]) return;
    const poses = cameras.map((camera) => camera!.pose());
    const moved = poses.findIndex((pose) => pose !== this.pose);
    if (moved < 0) return;
    this.pose = poses[moved];
    cameras[1 - moved]!.setPose(this.pose);
  }
}

interface Side {
  osteon?: { scene: Camera; hello: { recording: string } | null };
}
/** The camera of a side; undefined until its page has its first message. */
const cameraOf = (side: HTMLIFrameElement): Camera | undefined => {
  const page = (side.contentWindow as (Window & Side) | null)?.osteon;
  return page?.hello ? page.scene : undefined;
};
/** Name of a side's recording; undefined until its page has its first message. */
const recordingOf = (side: HTMLIFrameElement): string | undefined => (side.contentWindow as (Window & Side) | null)?.osteon?.hello?.recording;

(window as unknown as { osteon: ComparePage }).osteon = new ComparePage();
