// Poses as the server writes them, for three.

import { Matrix4, Object3D, Vector3 } from "three";
import type { PoseRows } from "./messages";

/** A pose's rows as a matrix. */
export function matrixOf(rows: PoseRows): Matrix4 {
  return new Matrix4().set(
    rows[0], rows[1], rows[2], rows[3],
    rows[4], rows[5], rows[6], rows[7],
    rows[8], rows[9], rows[10], rows[11],
    0, 0, 0, 1,
  );
}

/** Puts an object at a pose in its parent. */
export function place(object: Object3D, rows: PoseRows): void {
  object.matrixAutoUpdate = false;
  object.matrix.copy(matrixOf(rows));
  object.matrixWorldNeedsUpdate = true;
}

/** Three numbers of a list as a vector. @param first  index of x */
export function vectorOf(v: number[], first = 0): Vector3 {
  return new Vector3(v[first], v[first + 1], v[first + 2]);
}
