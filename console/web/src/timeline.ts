// The time line of a recording: play, seek, speed, and jumps to its events.

import type { PlaybackState, TimelineNews } from "./messages";
import { figure, t } from "./texts";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10];
const STEP_S = 1; // step of an arrow key

export interface Player {
  play(): void;
  halt(): void;
  seek(at_s: number): void;
  speed(factor: number): void;
}

export class Timeline {
  private readonly play = document.createElement("button");
  private readonly before = document.createElement("button");
  private readonly next = document.createElement("button");
  private readonly slider = document.createElement("input");
  private readonly canvas = document.createElement("canvas");
  private readonly time = document.createElement("output");
  private readonly speed = document.createElement("select");
  private state: PlaybackState | null = null;
  private news: TimelineNews | null = null;
  private dragging = false;

  constructor(
    private readonly parent: HTMLElement,
    private readonly player: Player,
  ) {
    this.play.id = "play";
    this.play.dataset.key = " ";
    this.play.onclick = () => (this.state?.playing ? player.halt() : player.play());
    this.before.textContent = "|◀";
    this.before.dataset.key = ",";
    this.before.onclick = () => this.toEvent(-1);
    this.next.textContent = "▶|";
    this.next.dataset.key = ".";
    this.next.onclick = () => this.toEvent(1);
    this.slider.type = "range";
    this.slider.min = "0";
    this.slider.step = "0.01";
    this.slider.oninput = () => {
      this.dragging = true;
      player.seek(Number(this.slider.value));
    };
    this.slider.onchange = () => (this.dragging = false);
    for (const factor of SPEEDS) {
      const option = document.createElement("option");
      option.value = String(factor);
      option.textContent = `${factor}×`;
      this.speed.append(option);
    }
    this.speed.value = "1";
    this.speed.onchange = () => player.speed(Number(this.speed.value));
    const track = document.createElement("div");
    track.className = "track";
    track.append(this.canvas, this.slider);
    for (const each of [this.play, this.before, this.next, this.speed]) each.classList.add("small");
    parent.append(this.play, this.before, this.next, track, this.time, this.speed);
    new ResizeObserver(() => this.draw()).observe(track);
  }

  /** Texts in the chosen language. */
  setTexts(): void {
    this.before.title = this.before.ariaLabel = t("eventBefore");
    this.next.title = this.next.ariaLabel = t("eventNext");
    this.slider.ariaLabel = t("time");
    this.speed.ariaLabel = t("speedOf");
    if (this.state) this.time.textContent = `${figure(this.state.at_s, 2)} ${t("of")} ${figure(this.state.duration_s, 1)} s`;
    this.play.textContent = this.state?.playing ? `❚❚ ${t("halt")}` : `▶ ${t("play")}`;
  }

  show(state: PlaybackState): void {
    this.parent.hidden = false;
    this.state = state;
    this.slider.max = String(state.duration_s);
    if (!this.dragging) this.slider.value = String(state.at_s);
    this.setTexts();
  }

  showNews(news: TimelineNews): void {
    this.news = news;
    this.draw();
  }

  step(direction: number): void {
    if (this.state) this.player.seek(this.state.at_s + direction * STEP_S);
  }

  /** Goes to the next event (direction 1) or the previous one (-1), and passes over the event that is shown now. */
  private toEvent(direction: number): void {
    if (!this.state || !this.news) return;
    const at = this.state.at_s;
    const events = this.news.events.map(([time]) => time);
    const wanted = direction > 0 ? events.find((time) => time > at + 0.02) : events.reverse().find((time) => time < at - 0.05);
    if (wanted !== undefined) this.player.seek(wanted);
  }

  /** The force of each second, and the events as marks. */
  private draw(): void {
    if (!this.news || !this.state || this.canvas.clientWidth === 0) return;
    const width = (this.canvas.width = this.canvas.clientWidth * devicePixelRatio);
    const height = (this.canvas.height = this.canvas.clientHeight * devicePixelRatio);
    const context = this.canvas.getContext("2d")!;
    const most = Math.max(1, ...this.news.force_N);
    const perSecond = width / Math.max(this.state.duration_s, 1e-3);
    context.fillStyle = "#2f5f8c";
    this.news.force_N.forEach((force, second) => {
      const tall = (force / most) * height;
      context.fillRect(second * perSecond, height - tall, Math.max(perSecond, 1), tall);
    });
    context.fillStyle = "#e8b23a";
    for (const [time] of this.news.events) context.fillRect(time * perSecond - 1, 0, 2, height);
  }
}
