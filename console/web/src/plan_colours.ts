// Colours of the bone by its distance to the planned cup, and their legend.

import { Color, Vector3 } from "three";
import { figure, t } from "./texts";

const STILL_THERE = 0x2f7df0, AS_PLANNED = 0x4ec27a, TOO_DEEP = 0xf06a24;
const RANGE_MM = 3; // distance from the planned cup at which the colours end
const METRES_TO_MM = 1e3;

const STILL_THERE_COLOUR = new Color(STILL_THERE), AS_PLANNED_COLOUR = new Color(AS_PLANNED), TOO_DEEP_COLOUR = new Color(TOO_DEEP);

/** A planned cup in the bone's frame G. */
export interface PlannedCup {
  centre: Vector3; // [m]
  axis: Vector3; // unit, out of the opening
  radius_m: number;
}

/** Depth of a place below the planned cup [mm]: negative where bone within the cup is still there. */
function beyondPlan_mm(p: Vector3, cup: PlannedCup): number {
  return METRES_TO_MM * (p.distanceTo(cup.centre) - cup.radius_m);
}

/** The colour of a place of the bone's surface; null: the place keeps its tissue's colour, because it lies above the cup's
 *  opening, or beyond the cup and was never cut. @param p  place in G [m] @param to  receives the colour */
export function planColour(p: Vector3, cut: boolean, cup: PlannedCup, to: Color): Color | null {
  const beyond_mm = beyondPlan_mm(p, cup);
  const above_m = (p.x - cup.centre.x) * cup.axis.x + (p.y - cup.centre.y) * cup.axis.y + (p.z - cup.centre.z) * cup.axis.z;
  if (above_m > 0 || (beyond_mm > 0 && !cut)) return null;
  const share = Math.min(1, Math.abs(beyond_mm) / RANGE_MM);
  return to.copy(AS_PLANNED_COLOUR).lerp(beyond_mm < 0 ? STILL_THERE_COLOUR : TOO_DEEP_COLOUR, share);
}

/** The scale in words, its ends with their distance. */
export function planLegend(): (string | HTMLElement)[] {
  const bar = document.createElement("i");
  const colours = [STILL_THERE, AS_PLANNED, TOO_DEEP].map((c) => `#${c.toString(16).padStart(6, "0")}`);
  bar.style.background = `linear-gradient(to right, ${colours.join()})`;
  return [`${t("stillToCut")} ≥ ${figure(RANGE_MM, 0)} mm`, bar, `≥ ${figure(RANGE_MM, 0)} mm ${t("beyondPlan")}`];
}
