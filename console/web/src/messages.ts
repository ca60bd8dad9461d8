// The server's messages, as console/stream/live_json.h and session/run/console_scene.h describe them.

import type { Layout } from "./surface_chunk";

export type Vector = [number, number, number];
/** Rows of [R | p], 12 numbers. */
export type PoseRows = number[];

export interface Hello {
  type: "hello";
  version: string;
  command: string;
  cell: string;
  scene: string;
  seconds: number;
  recording: string;
  force_limit_N: number;
  speed_limit_mm_per_s: number;
  law: string;
  fields: string[];
  X_WB: PoseRows;
  X_WG: PoseRows;
  site: { center: Vector; axis: Vector; radius_m: number };
  materials: string[];
  tool: { name: string; balls: number[][]; X_FT: PoseRows };
  tools: number[][][]; // balls of each tool of a procedure; empty: `tool` is the only one
  arm: { joints: { X_PJ: PoseRows; axis: Vector }[]; X_LF: PoseRows };
  arm_name: string;
  zones: Zone[];
}

export interface Zone {
  shape: "half_space" | "sphere" | "box" | "cylinder" | "capsule";
  point: "apex" | "flange" | "elbow";
  keep_in: boolean;
  p?: Vector;
  X?: PoseRows;
  half_edge_m?: Vector;
  radius_m: number;
  half_length_m?: number;
}

export interface Fault {
  name: string;
  cause: string;
  reaction: string;
  clearing: string;
  allows_recovery: boolean;
  seen: string; // what was measured, and what is accepted; empty: not known
  page: string; // path of the stop's page, once the run has ended; empty: none
}

export interface Status {
  known: boolean;
  state_number: number;
  state: string;
  does: string;
  leave: string;
  can_pause: boolean;
  can_resume: boolean;
  can_recover: boolean;
  moves: boolean;
  permits_known: boolean;
  permits: { text: string; holds: boolean }[];
  limits: string[];
  limit_numbers: number[];
  limits_for_s: number[];
  faults: Fault[];
  force_N: number;
  force_limit_N: number;
  force_limit_from: string; // which bound force_limit_N is
  force_limit_now_N: number;
  force_limit_number: number; // safety::Limit that makes force_limit_now_N lower than force_limit_N; -1: none does
  torque_Nm: number;
  torque_limit_Nm: number;
  hand_N: number;
  depth_mm: number;
  deepest_mm: number;
  depth_left_mm: number | null; // null: no depth limit
  feed_mm_per_s: number | null;
  speed_mm_per_s: number;
  spindle_rpm: number;
  spindle_torque_Nm: number;
  removed_mm3: number;
  /** Absent in recordings' pages of older builds. */
  gives_way?: boolean;
  bend_mm?: number;
  layer_mm?: number;
  mount_mm?: number;
  model_age_ms: number | null; // null: none has come yet
  sensor_age_ms: number | null;
  arm_age_ms: number | null; // null: no message yet
  plc_age_ms: number | null; // null: no PLC
  compute_p99_us: number;
  wakeup_p99_us: number;
  arm_messages_lost: number;
  answers_lost: number;
  disk_left_B: number | null;
  bone_age_ms?: number | null; // of the carved bone; null, or absent: no bone follows a cut
  frame_us: number;
  rendered_s: number;
  paused_s: number;
  /** Null before the arm was commanded; absent in recordings' pages. */
  latency_ms?: {
    hand_to_arm: number | null; // null: the hand moves the arm itself
    bone_to_hand: number;
    measured: boolean;
    parts: Record<string, { mean: number; measured: boolean }>;
  } | null;
}

export interface View {
  tool: number; // index in Hello.tools of the one in use
  X_WT: PoseRows;
  X_WP?: PoseRows;
  X_WM?: PoseRows; // displacement of the bone's world by mount and tissue; X_WP and contacts are in this frame
  X_WE?: PoseRows; // the tool's head, displaced by bending
  layer?: Vector; // part of X_WM, in M [m]: the tissue's indentation under the tool, which the rest of the bone lacks
  q: number[];
  force: Vector;
  hand: Vector;
  contacts: number[][]; // [p_W, n_W, gap_m]
}

export interface Live {
  type: "live";
  windows: number[][]; // rows of Hello.fields
  status: Status;
  view: View;
}
export interface Events {
  type: "events";
  events: [number, string][];
}
export interface Role {
  type: "role";
  mine: boolean;
  taken: boolean;
  pages: number;
}
export interface Answer {
  type: "answer";
  ask: string;
  done: boolean;
  reason: string;
}
/** Names this page to the server when it opens again. */
export interface PageKey {
  type: "key";
  key: string;
}
/** Why the server closed this page's last connection; code: RFC 6455. */
export interface Closed {
  type: "closed";
  code: number;
  reason: string;
}
/** Where the playback of a recording stands. */
export interface PlaybackState {
  type: "playback";
  at_s: number;
  duration_s: number;
  start_s: number; // of the time line, in the time of events and windows
  playing: boolean;
  speed: number;
  error: string;
}
/** What is known of a whole recording, so far. */
export interface TimelineNews {
  type: "timeline";
  events: [number, string][];
  force_N: number[]; // the largest of each second
  done: boolean;
}
/** Two recordings on one time line, in bins of step_s; null: no tick in a bin. */
export interface Difference {
  type: "difference";
  step_s: number;
  force_N: (number | null)[][]; // two lists, of the first and the second recording; so are the next two
  depth_mm: (number | null)[][];
  removed_mm3: (number | null)[][];
  force_apart_N: (number | null)[];
  apart_mm: (number | null)[];
  turn_deg: (number | null)[];
  most: Record<"force_N" | "depth_mm" | "apart_mm" | "turn_deg" | "removed_mm3", [number, number]>; // largest difference, and its time [s]
  ticks: number;
  done: boolean;
}
/** The two bones at the time that is shown (session/view/bone_difference.h). */
export interface BoneDifference {
  type: "bone_difference";
  on: boolean;
  range_mm: number; // of the colours
  largest_mm: number; // positive where the second is deeper
  at_mm: Vector; // place of the largest difference, in the bone's frame
  limit_mm: number; // a larger difference is given as this value
}
/** A change of the bone is complete: the bricks sent so far belong to one time. */
export interface SurfaceWhole {
  type: "surface_whole";
  age_ms?: number; // how old the bone was when it was sent
}
/** The feed begins anew at another time. */
export interface Restart {
  type: "restart";
}
/** The simulated cell alone, as `osteon cell` knows it (session/run/cell_console.h). */
export interface CellNote {
  type: "cell";
  session: string; // state of the arm's session
  commanded: boolean;
  stop: string; // why the arm's session went back; empty: it did not
  script_done: boolean;
  run_permitted: boolean;
  power_on: boolean;
  blocks: string;
  sent: number;
  answered: number;
  lost: number;
  overruns: number;
}
/** The gains that an operator may change, and how far (session/gains/gains_panel.h). */
export interface GainsNote {
  type: "gains";
  stiffness_N_per_m: number;
  min_stiffness_N_per_m: number;
  own_stiffness_N_per_m: number;
  has_drag: boolean;
  drag_Ns_per_m: number;
  own_drag_Ns_per_m: number;
  max_drag_Ns_per_m: number;
  stable_age_ms: number;
  can_undo: boolean;
  /** Results of `osteon tune` (session/gains/tune_advice.h); null: there are none, for the reason `tune_why`. */
  tune?: {
    file: string;
    asked_margin: number;
    margin: number | null; // lower bound for the present gains; null: they are neither the cell's own nor softer
    worst_age_ms: number;
    wall_N_per_m: number | null; // the stiffest stable wall at the present drag, by tune's map
    recommended: { mass_kg: number | null; stiffness_N_per_m: number | null; drag_Ns_per_m: number; margin: number } | null;
  } | null;
  tune_why?: string;
}
/** The plan of a procedure, in the world (session/procedure/procedure_panel.h). */
export interface PlanNote {
  type: "plan";
  name: string;
  axis: Vector; // unit, out of the opening
  cup_centre_m: Vector;
  cup_radius_m: number;
  kind: "cup" | "opening"; // of an opening, `cup_radius_m` is half its width
  reamers: { diameter_mm: number; centre_m: Vector; around_m: number }[]; // around_m: radius of the circle it is led in
  confirms: boolean; // a change of tool has to be confirmed by a person
  corridor: { cone_rad: number; lateral_m: number; widening_rad: number } | null;
}
/** Where a procedure's session stands. */
export interface ProcedureNote {
  type: "procedure";
  known: boolean;
  tool: number; // index of the reamer in use
  to_go_mm: number;
  aside_mm: number;
  tilt_deg: number;
  beyond: { tilt: boolean; aside: boolean; depth: boolean };
  axis_error_deg: number | null; // of the reamer in use, weighted by what it removed
  removed_mm3: number;
  outside_s: number;
  passes: number;
  undone: number;
  guidance: number | null; // gain; null: the plan has none
  cup: boolean;
}
/** The score of a procedure's session so far (session/procedure/live_score.h). */
export interface ScoreNote {
  type: "score";
  known: boolean; // false: no pass has ended yet, or there is no rubric: `why`
  why: string;
  total: number; // this and the following only if known
  of: number;
  open_points: number;
  unfinished: string; // what is left of the plan; empty: nothing
  guided: boolean;
  passes: number; // number of passes that the score includes
  age_s: number;
  newer: boolean; // bone was cut after the score was computed
  items: { metric: string; text: string; unit: string; value: number | null; points: number; weight: number; open: boolean }[];
  deductions: { name: string; points: number }[];
}
export type ProcedureAsk = "next_tool" | "tool" | "undo_pass" | "save" | "cup" | "guidance" | "finish";
export type Message = PageKey | Closed | PlanNote | SurfaceWhole | ProcedureNote | ScoreNote | GainsNote | CellNote | Hello | Live | Events | Role | Answer | Layout | PlaybackState | TimelineNews | Difference | BoneDifference | Restart;
export type Ask = ProcedureAsk | "pause" | "resume" | "recover" | "stop" | "role" | "watch" | "all" | "play" | "halt" | "seek" | "speed" | "map" | "stiffness" | "drag" | "undo_gains" | "drawn";
