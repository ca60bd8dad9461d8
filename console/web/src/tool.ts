// The tool as its balls, which are exactly the shape that meets bone.

import { Group, IcosahedronGeometry, InstancedMesh, Matrix4, MeshStandardMaterial, Object3D, Quaternion, Vector3 } from "three";

const MANY = 300; // a tool with more balls is drawn with fewer faces for each

/** Colours of the cutting balls and of the others, and opacity 0 … 1. */
interface ToolLook {
  cutting: number;
  shaft: number;
  opacity: number;
}

/** A tool in its frame. @param balls [x, y, z, radius, 1 if cutting else 0], lengths in m */
export function toolOf(balls: number[][], look: ToolLook): Group {
  const group = new Group();
  const detail = balls.length > MANY ? 1 : 4;
  for (const cutting of [1, 0]) {
    const chosen = balls.filter((ball) => ball[4] === cutting);
    const material = new MeshStandardMaterial({
      color: cutting ? look.cutting : look.shaft,
      roughness: 0.35,
      metalness: look.opacity < 1 ? 0 : 0.6,
      transparent: look.opacity < 1,
      opacity: look.opacity,
      depthWrite: look.opacity === 1,
    });
    const mesh = new InstancedMesh(new IcosahedronGeometry(1, detail), material, chosen.length);
    chosen.forEach(([x, y, z, radius], i) =>
      mesh.setMatrixAt(i, new Matrix4().compose(new Vector3(x, y, z), new Quaternion(), new Vector3(radius, radius, radius))),
    );
    mesh.frustumCulled = false; // its bounds are one ball's
    group.add(mesh);
  }
  return group;
}

/** The cutting balls of a tool: the part that bends aside. */
export function headOf(tool: Object3D): Object3D {
  return tool.children[0];
}
