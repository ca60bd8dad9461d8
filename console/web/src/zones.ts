// The zones of apex, flange and elbow as wire frames.

import {
  BoxGeometry, CapsuleGeometry, CylinderGeometry, EdgesGeometry, Group, LineBasicMaterial, LineSegments, PlaneGeometry,
  SphereGeometry, WireframeGeometry,
} from "three";
import type { Zone } from "./messages";
import { place } from "./poses";

const PLANE_SIZE_M = 0.5; // edge of the shown piece of a half-space's face

/** A zone's wire frame in its own frame; the colour tells which point the zone is for. */
function wires(zone: Zone): LineSegments {
  const colour = zone.point === "apex" ? 0x58b6c9 : zone.point === "flange" ? 0x9a86d6 : 0x7fb069;
  const material = new LineBasicMaterial({ color: colour, transparent: true, opacity: 0.35 });
  switch (zone.shape) {
    case "half_space":
      return new LineSegments(new WireframeGeometry(new PlaneGeometry(PLANE_SIZE_M, PLANE_SIZE_M, 4, 4)), material);
    case "sphere":
      return new LineSegments(new WireframeGeometry(new SphereGeometry(zone.radius_m, 24, 12)), material);
    case "box": {
      const [x, y, z] = zone.half_edge_m!;
      return new LineSegments(new EdgesGeometry(new BoxGeometry(2 * x, 2 * y, 2 * z)), material);
    }
    case "cylinder":
      return new LineSegments(
        new EdgesGeometry(new CylinderGeometry(zone.radius_m, zone.radius_m, 2 * zone.half_length_m!, 24).rotateX(Math.PI / 2)),
        material,
      );
    case "capsule":
      return new LineSegments(
        new WireframeGeometry(new CapsuleGeometry(zone.radius_m, 2 * zone.half_length_m!, 6, 16).rotateX(Math.PI / 2)),
        material,
      );
  }
}

/** Wire frames of all zones, in W. */
export function zonesOf(zones: Zone[]): Group {
  const group = new Group();
  for (const zone of zones) {
    const lines = wires(zone);
    if (zone.X) place(lines, zone.X);
    else if (zone.p) lines.position.set(...zone.p);
    group.add(lines);
  }
  return group;
}
