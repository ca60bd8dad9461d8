// The surgical plan in the 3-D view: the planned cup, its axis, and the corridor of the reamer in use: a tube for the
// centre of its head, a cone for its tilt.

import {
  BufferGeometry, ConeGeometry, DoubleSide, EdgesGeometry, Group, Line, LineBasicMaterial, LineSegments, Mesh,
  MeshBasicMaterial, Quaternion, SphereGeometry, Vector3,
} from "three";
import { CylinderGeometry } from "three";
import type { PlanNote, ProcedureNote } from "./messages";
import { vectorOf } from "./poses";

const CUP = 0x7fd6ff, INSIDE = 0x4ec27a, OUTSIDE = 0xe8b23a;
const TUBE_M = 0.03, CONE_M = 0.06; // shown lengths above the planned centre
const SIDES = 48;

function lines(geometry: BufferGeometry, color: number, opacity: number): LineSegments {
  return new LineSegments(geometry, new LineBasicMaterial({ color, transparent: true, opacity, depthTest: false }));
}
const skin = (geometry: BufferGeometry): Mesh =>
  new Mesh(geometry, new MeshBasicMaterial({ color: INSIDE, transparent: true, opacity: 0.16, side: DoubleSide, depthWrite: false }));

/** In its own frame: +z along the cup's axis, out of the opening. */
export class PlanView {
  readonly group = new Group();
  private readonly corridor = new Group(); // at the planned centre of the reamer in use
  private readonly tube: Mesh | null = null;
  private readonly cone: Mesh | null = null;
  private tool = -1;

  constructor(private readonly plan: PlanNote) {
    const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 0, 1), vectorOf(plan.axis));
    const cup = new Group();
    cup.quaternion.copy(turn);
    cup.position.copy(vectorOf(plan.cup_centre_m));
    const r = plan.cup_radius_m;
    const shell = new SphereGeometry(r, 24, 6, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2).rotateX(Math.PI / 2); // its lower half
    cup.add(lines(new EdgesGeometry(shell, 1), CUP, 0.45));
    const axis = new BufferGeometry().setFromPoints([new Vector3(0, 0, -1.3 * r), new Vector3(0, 0, 3 * r)]);
    cup.add(new Line(axis, new LineBasicMaterial({ color: CUP, depthTest: false })));
    this.corridor.quaternion.copy(turn);
    this.group.add(cup, this.corridor);
    if (!plan.corridor) return;
    const { cone_rad, lateral_m, widening_rad } = plan.corridor;
    const wide = lateral_m + TUBE_M * Math.tan(widening_rad);
    this.tube = skin(new CylinderGeometry(wide, lateral_m, TUBE_M, SIDES, 1, true).rotateX(Math.PI / 2).translate(0, 0, TUBE_M / 2));
    this.cone = skin(new ConeGeometry(CONE_M * Math.tan(cone_rad), CONE_M, SIDES, 1, true).rotateX(-Math.PI / 2).translate(0, 0, CONE_M / 2));
    for (const part of [this.tube, this.cone]) this.corridor.add(part, this.edge(part));
  }

  show(note: ProcedureNote): void {
    if (note.tool !== this.tool) {
      this.tool = note.tool;
      this.corridor.position.copy(vectorOf(this.plan.reamers[note.tool].centre_m));
    }
    this.paint(this.tube, note.beyond.aside || note.beyond.depth);
    this.paint(this.cone, note.beyond.tilt);
  }

  private edge(part: Mesh): LineSegments {
    const edge = lines(new EdgesGeometry(part.geometry, 20), INSIDE, 0.8);
    part.userData.edge = edge;
    return edge;
  }

  private paint(part: Mesh | null, outside: boolean): void {
    if (!part) return;
    const color = outside ? OUTSIDE : INSIDE;
    (part.material as MeshBasicMaterial).color.setHex(color);
    ((part.userData.edge as LineSegments).material as LineBasicMaterial).color.setHex(color);
  }
}
