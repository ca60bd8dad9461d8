// The surgical plan in the 3-D view: the planned cup or opening, its axis, and the corridor of the tool in use: a tube for the
// centre of its head, a cone for its tilt.

import {
  BufferGeometry, ConeGeometry, DoubleSide, EdgesGeometry, Group, Line, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import { CylinderGeometry } from "three";
import type { PlanNote, ProcedureNote } from "./messages";
import { vectorOf } from "./poses";

const CUP = 0x7fd6ff, INSIDE = 0x4ec27a, OUTSIDE = 0xe8b23a;
// Shown lengths above the planned centre: of the tube, and of the cone.
const SHOWN_M = { cup: [0.03, 0.06], opening: [0.008, 0.012] };
const SIDES = 48; // of tube and cone

/** A geometry's edges, drawn over everything else. */
function lines(geometry: BufferGeometry, color: number, opacity: number): LineSegments {
  return new LineSegments(geometry, new LineBasicMaterial({ color, transparent: true, opacity, depthTest: false }));
}
/** A transparent surface of the corridor. */
const skin = (geometry: BufferGeometry): Mesh =>
  new Mesh(geometry, new MeshBasicMaterial({ color: INSIDE, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }));

/** Objects of the plan. In the frames of cup and corridor, +z is the plan's axis, out of the cup or the opening. */
export class PlanView {
  readonly group = new Group();
  private readonly corridor = new Group(); // at the planned centre of the reamer in use
  private readonly tube: Mesh | null = null;
  private readonly cone: Mesh | null = null;
  private readonly tubeOf: (around_m: number) => BufferGeometry = () => new BufferGeometry();
  private tool = -1;

  constructor(private readonly plan: PlanNote) {
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), vectorOf(plan.axis));
    const cup = new Group();
    cup.quaternion.copy(turn);
    cup.position.copy(vectorOf(plan.cup_centre_m));
    const r = plan.cup_radius_m;
    const [tube_m, cone_m] = SHOWN_M[plan.kind];
    const floor = plan.kind === "cup" ? 0 : -0.5e-3 * plan.reamers[plan.reamers.length - 1].diameter_mm;
    const shell =
      plan.kind === "cup"
        ? new SphereGeometry(r, 24, 6, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2).rotateX(Math.PI / 2) // its lower half
        : new CylinderGeometry(r, r, tube_m, 24, 1, true).rotateX(Math.PI / 2).translate(0, 0, floor + tube_m / 2);
    cup.add(lines(new EdgesGeometry(shell, 1), CUP, 0.45));
    const axis = new BufferGeometry().setFromPoints([new Vector3(0, 0, -1.3 * r), new Vector3(0, 0, 3 * r)]);
    cup.add(new Line(axis, new LineBasicMaterial({ color: CUP, depthTest: false })));
    this.corridor.quaternion.copy(turn);
    this.group.add(cup, this.corridor);
    if (!plan.corridor) return;
    const { cone_rad, lateral_m, widening_rad } = plan.corridor;
    this.tubeOf = (around_m: number): BufferGeometry => {
      const narrow = around_m + lateral_m, wide = narrow + tube_m * Math.tan(widening_rad);
      return new CylinderGeometry(wide, narrow, tube_m, SIDES, 1, true).rotateX(Math.PI / 2).translate(0, 0, tube_m / 2);
    };
    this.tube = skin(this.tubeOf(plan.reamers[0].around_m));
    this.cone = skin(new ConeGeometry(cone_m * Math.tan(cone_rad), cone_m, SIDES, 1, true).rotateX(-Math.PI / 2).translate(0, 0, cone_m / 2));
    for (const part of [this.tube, this.cone]) this.corridor.add(part, this.edge(part));
  }

  show(note: ProcedureNote): void {
    if (note.tool !== this.tool) {
      this.tool = note.tool;
      const { centre_m, around_m } = this.plan.reamers[note.tool];
      this.corridor.position.copy(vectorOf(centre_m));
      if (this.tube) this.widen(this.tube, around_m);
    }
    this.paint(this.tube, note.beyond.aside || note.beyond.depth);
    this.paint(this.cone, note.beyond.tilt);
  }

  /** Gives the tube the width for a tool that is led in circles of this radius. */
  private widen(tube: Mesh, around_m: number): void {
    const edge = tube.userData.edge as LineSegments;
    tube.geometry.dispose();
    edge.geometry.dispose();
    tube.geometry = this.tubeOf(around_m);
    edge.geometry = new EdgesGeometry(tube.geometry, 20);
  }

  /** The edges of a part of the corridor, kept with it. */
  private edge(part: Mesh): LineSegments {
    const edge = lines(new EdgesGeometry(part.geometry, 20), INSIDE, 0.8);
    part.userData.edge = edge;
    return edge;
  }

  /** Colours a part of the corridor by whether the tool is outside of it. */
  private paint(part: Mesh | null, outside: boolean): void {
    if (!part) return;
    const color = outside ? OUTSIDE : INSIDE;
    (part.material as MeshBasicMaterial).color.setHex(color);
    ((part.userData.edge as LineSegments).material as LineBasicMaterial).color.setHex(color);
  }
}
