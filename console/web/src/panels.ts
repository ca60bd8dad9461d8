// The column of figures: state, force, depth, limits, conditions, faults, health, events.

import { byId, element, list, set, table } from "./elements";
import { inGerman } from "./fault_texts";
import { inLanguage } from "./message_texts";
import type { Fault, Hello, Role, Status } from "./messages";
import { boundName, figure, getLanguage, limitName, permitName, stateDoes, stateName, t, type Word } from "./texts";

const FAULT_STATES = [7, 8, 10]; // stop 0, stop 1, fault
const WORKING_STATES = [4, 5]; // haptic, cutting
const SHOWN_EVENTS = 40; // number of the newest events in the list

const heading = (word: Word): HTMLElement => element("h2", "", t(word));

/** By how much tool, tissue and the bone's mount give way. */
function deflections(status: Status): [string, string][] {
  return [
    [t("bend"), `${figure(status.bend_mm ?? 0, 2)} mm`],
    [t("layer"), `${figure(status.layer_mm ?? 0, 2)} mm`],
    [t("mount"), `${figure(status.mount_mm ?? 0, 2)} mm`],
  ];
}

/** The cell's latency: the two sums, with their parts; an assumed part says so. */
function latencies(latency: NonNullable<Status["latency_ms"]>): [string, string][] {
  const sum = (value: number, skipped: string): string => {
    const parts = Object.entries(latency.parts).filter(([name]) => name !== skipped);
    const text = parts.map(([name, part]) => `${name} ${figure(part.mean, 1)}${part.measured ? "" : ` (${t("assumed")})`}`);
    return `${figure(value, 1)} ms: ${text.join(", ")}`;
  };
  return [
    [t("handToArm"), latency.hand_to_arm === null ? t("handMovesArm") : sum(latency.hand_to_arm, "model")],
    [t("boneToHand"), sum(latency.bone_to_hand, "sensor")],
  ];
}

/** Times of the tick. In virtual time they are 0 and not shown. */
function tickRows(status: Status, worst: { compute_us: number; wakeup_us: number }): [string, string][] {
  if (worst.compute_us === 0) return [[t("tickChart"), t("virtualTime")]];
  return [
    [t("tickMost"), `${figure(status.compute_p99_us, 0)} µs`],
    [t("tick"), `${figure(worst.compute_us, 0)} µs`],
    [t("wakeupMost"), `${figure(status.wakeup_p99_us, 0)} µs`],
    [t("wakeup"), `${figure(worst.wakeup_us, 0)} µs`],
  ];
}

/** Rows of ages, tick times, lost messages, disk space and latency; an unknown value has no row. */
function healthRows(status: Status, worst: { compute_us: number; wakeup_us: number }): [string, string][] {
  const age = (word: Word, age_ms: number | null): [string, string][] =>
    age_ms === null ? [] : [[t(word), `${figure(age_ms, 1)} ms`]];
  const lost = `${status.arm_messages_lost} ${t("ofTheArm")}, ${status.answers_lost} ${t("answers")}`;
  return [
    ...age("armAge", status.arm_age_ms),
    ...age("plcAge", status.plc_age_ms),
    ...age("modelAge", status.model_age_ms),
    ...age("sensorAge", status.sensor_age_ms),
    ...age("boneAge", status.bone_age_ms ?? null),
    ...(status.frame_us > 0 ? [[t("frame"), `${figure(status.frame_us, 0)} µs`] as [string, string]] : []),
    ...tickRows(status, worst),
    [t("lostMessages"), lost],
    ...(status.disk_left_B === null ? [] : [[t("diskLeft"), `${figure(1e-9 * status.disk_left_B, 1)} GB`] as [string, string]]),
    ...(status.latency_ms ? latencies(status.latency_ms) : []),
  ];
}

/** The force's limit and its source: "200 N (cell)", or "84.0 of 200 N (arm's torque)" while a limit reduces the force. */
function forceLimit(status: Status): string {
  const whole = `${figure(status.force_limit_N, 0)} N`;
  if (status.force_limit_number < 0) return status.force_limit_from ? `${whole} (${boundName(status.force_limit_from)})` : whole;
  return `${figure(status.force_limit_now_N, 1)} ${t("of")} ${whole} (${limitName(status.force_limit_number, "")})`;
}

export class Panels {
  private events: [number, string][] = [];
  private readonly acknowledged = new Set<string>(); // names of faults that were read; they stay latched
  private began_s: number | null = null; // time from which the events' times are counted

  begin(hello: Hello): void {
    this.events = [];
    this.began_s = null;
    document.title = `Osteon: ${hello.cell}`;
    // the tools of a procedure change: its card says which one is in use
    byId("title").textContent = `Osteon ${hello.command}: ${hello.scene}${hello.tools.length > 1 ? "" : `, ${hello.tool.name}`}`;
  }

  /** A playback went to another time. */
  restart(): void {
    this.events = [];
    this.addEvents([]);
  }

  /** Counts the events' times from a recording's start; else from the first event. */
  countFrom(start_s: number): void {
    this.began_s = start_s;
  }

  show(status: Status, hello: Hello, worst: { compute_us: number; wakeup_us: number }): void {
    this.showState(status, hello);
    this.showForce(status);
    set(
      "figures",
      table([
        [t("depth"), `${figure(status.depth_mm, 2)} mm`],
        ...(status.depth_left_mm === null ? [] : [[t("depthLeft"), `${figure(status.depth_left_mm, 2)} mm`] as [string, string]]),
        [t("deepest"), `${figure(status.deepest_mm, 2)} mm`],
        [t("removed"), `${figure(status.removed_mm3, 0)} mm³`],
        [t("speed"), `${figure(status.speed_mm_per_s, 0)} ${t("of")} ${figure(hello.speed_limit_mm_per_s, 0)} mm/s`],
        ...(status.feed_mm_per_s === null ? [] : [[t("feed"), `${figure(status.feed_mm_per_s, 1)} mm/s`] as [string, string]]),
        [t("spindle"), `${figure(status.spindle_rpm, 0)} rpm, ${figure(status.spindle_torque_Nm, 1)} N·m`],
        ...(status.gives_way ? deflections(status) : []),
      ]),
    );
    const acting: [string, string][] = status.limit_numbers.map((n, i) => [
      "acts",
      `${limitName(n, status.limits[i])}, ${t("since")} ${figure(status.limits_for_s[i], 1)} s`,
    ]);
    set("limits", heading("acting"), acting.length > 0 ? list(acting) : element("div", "dim", t("none")));
    this.showPermits(status);
    this.showFaults(status);
    set("health", heading("health"), table(healthRows(status, worst)));
  }

  addEvents(events: [number, string][]): void {
    this.events.push(...events);
    this.events = this.events.slice(-SHOWN_EVENTS);
    this.began_s ??= this.events.length > 0 ? this.events[0][0] : null;
    const rows = [...this.events].reverse().map(([time, text]): [string, string] => {
      return ["event", `${figure(time - (this.began_s ?? time), 1)} s  ${inLanguage(text)}`];
    });
    set("events", heading("events"), list(rows));
  }

  showRole(role: Role): void {
    byId("role").textContent = `${role.mine ? t("operator") : t("watch")} (${role.pages} ${t(role.pages === 1 ? "page" : "pages")})`;
    const button = byId("take-role") as HTMLButtonElement;
    button.textContent = role.mine ? t("giveRole") : t("takeRole");
    button.disabled = role.taken && !role.mine;
  }

  private showState(status: Status, hello: Hello): void {
    const panel = byId("state");
    const level = FAULT_STATES.includes(status.state_number) ? "bad" : WORKING_STATES.includes(status.state_number) ? "good" : "look";
    if (panel.className !== level) panel.className = level;
    if (!status.known) return set("state", element("div", "name", t("waits")));
    if (hello.command === "view") status = { ...status, does: `${t("recording")} ${hello.recording}` };
    let time = `${figure(status.rendered_s, 1)} s`;
    if (hello.seconds > 0) time += ` ${t("of")} ${figure(hello.seconds, 0)} s`;
    time += ` ${t("rendered")}`;
    if (status.paused_s > 0) time += `, ${figure(status.paused_s, 1)} s ${t("paused")}`;
    set(
      "state",
      element("div", "name", stateName(status.state_number, status.state)),
      element("div", "does", hello.command === "view" ? status.does : stateDoes(status.state_number, status.does)),
      ...(hello.command === "view" ? [] : [element("div", "time", time)]),
    );
  }

  private showForce(status: Status): void {
    const gauge = element("div", "gauge", "");
    const bar = document.createElement("div");
    bar.style.width = `${Math.min(100, (100 * status.force_N) / status.force_limit_N)}%`;
    gauge.append(bar);
    const hand = document.createElement("i");
    hand.style.left = `calc(${Math.min(100, (100 * status.hand_N) / status.force_limit_N)}% - 1px)`;
    gauge.append(hand);
    const number = element("div", "big", `${figure(status.force_N, 1)} N`);
    number.id = "force-number";
    set(
      "force",
      heading("force"),
      number,
      gauge,
      table([
        [t("limitOf"), forceLimit(status)],
        [t("torqueToHand"), `${figure(status.torque_Nm, 1)} ${t("of")} ${figure(status.torque_limit_Nm, 0)} N·m`],
        [t("hand"), `${figure(status.hand_N, 1)} N`],
      ]),
    );
  }

  private showPermits(status: Status): void {
    const rows = status.permits.map((permit, i): [string, string] => [permit.holds ? "holds" : "missing", permitName(i, permit.text)]);
    if (!status.permits_known) return set("permits", heading("conditions"), element("div", "dim", t("conditionsLater")));
    const note = status.moves ? [element("div", "dim", t("conditionsHeld"))] : [];
    set("permits", heading("conditions"), ...note, list(rows));
  }

  private showFaults(status: Status): void {
    for (const name of this.acknowledged)
      if (!status.faults.some((fault) => fault.name === name)) this.acknowledged.delete(name); // if it comes again, it is unread
    const key = status.faults.find((fault) => !this.acknowledged.has(fault.name)); // the first unread fault has the shortcut
    set("faults", ...status.faults.map((fault) => this.faultCard(status, fault, fault === key)));
  }

  /** A fault's card: cause, reaction and cure, or its name alone once it was acknowledged. */
  private faultCard(status: Status, fault: Fault, hasKey: boolean): HTMLElement {
    const text = getLanguage() === "de" ? inGerman(fault) : fault;
    const known = this.acknowledged.has(fault.name);
    const card = element("div", known ? "fault known" : "fault", "");
    card.append(element("b", "", `${t("fault")}: ${text.name}`));
    if (!known) {
      const seen = fault.seen ? `${text.cause}: ${inLanguage(fault.seen)}` : text.cause;
      card.append(
        element("div", "", `${t("seen")}: ${seen}`),
        element("div", "", `${t("did")}: ${text.reaction}`),
        element("div", "", `${t("cure")}: ${text.clearing}`),
      );
      if (!fault.allows_recovery) card.append(element("div", "dim", t("recoverNever")));
      if (fault.page) card.append(element("div", "dim", `${t("stopPage")}: ${fault.page}`));
    }
    if (status.can_recover) card.append(element("div", "", t("recoverNow")));
    const button = element("button", "small", t(known ? "showAgain" : "acknowledge"));
    if (hasKey) {
      button.dataset.key = "K";
      button.append(element("kbd", "", "K"));
    }
    button.onclick = () => {
      if (!this.acknowledged.delete(fault.name)) this.acknowledged.add(fault.name);
      this.showFaults(status);
    };
    card.append(button);
    return card;
  }
}
