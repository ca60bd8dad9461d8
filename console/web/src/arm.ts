// The arm as simple bodies of our own, posed by its joints: frames as in kinematics/chain_params.h.

import { CapsuleGeometry, CylinderGeometry, Group, Matrix4, Mesh, MeshStandardMaterial, Vector3 } from "three";
import type { Hello } from "./messages";
import { matrixOf, vectorOf } from "./poses";

const BODY_RADIUS_M = 0.055; // of a link's drawn capsule
const JOINT_RADIUS_M = 0.068; // of a joint's drawn drum
const Y = new Vector3(0, 1, 0);

export class Arm {
  readonly group = new Group();
  private readonly links: Group[] = [];
  private readonly fixed: Matrix4[] = []; // X_PJ of each joint: its frame in the link before it
  private readonly axes: Vector3[] = []; // of each joint, in its frame
  private readonly flange: Matrix4; // in the last link's frame
  readonly X_BF = new Matrix4(); // flange in the base's frame, as posed last

  constructor(arm: Hello["arm"]) {
    const body = new MeshStandardMaterial({ color: 0xc9ced4, roughness: 0.55, metalness: 0.1 });
    const joint = new MeshStandardMaterial({ color: 0xd9822b, roughness: 0.6 });
    this.flange = matrixOf(arm.X_LF);
    this.group.add(this.bodyBetween(new Vector3(), new Vector3().setFromMatrixPosition(matrixOf(arm.joints[0].X_PJ)), body));
    arm.joints.forEach((each, i) => {
      const link = new Group();
      link.matrixAutoUpdate = false;
      this.fixed.push(matrixOf(each.X_PJ));
      this.axes.push(vectorOf(each.axis).normalize());
      const next = i + 1 < arm.joints.length ? matrixOf(arm.joints[i + 1].X_PJ) : this.flange;
      link.add(this.bodyBetween(new Vector3(), new Vector3().setFromMatrixPosition(next), body));
      const drum = new Mesh(new CylinderGeometry(JOINT_RADIUS_M, JOINT_RADIUS_M, 1.5 * JOINT_RADIUS_M, 24), joint);
      drum.quaternion.setFromUnitVectors(Y, this.axes[i]);
      link.add(drum);
      this.links.push(link);
      this.group.add(link);
    });
  }

  /** Poses the links. @param q joints [rad] */
  pose(q: number[]): void {
    const X_BL = new Matrix4();
    this.links.forEach((link, i) => {
      X_BL.multiply(this.fixed[i]).multiply(new Matrix4().makeRotationAxis(this.axes[i], q[i]));
      link.matrix.copy(X_BL);
      link.matrixWorldNeedsUpdate = true;
    });
    this.X_BF.copy(X_BL).multiply(this.flange);
  }

  /** A capsule between two points of a link's frame. */
  private bodyBetween(from: Vector3, to: Vector3, material: MeshStandardMaterial): Mesh {
    const along = to.clone().sub(from);
    const length = along.length();
    const mesh = new Mesh(new CapsuleGeometry(BODY_RADIUS_M, Math.max(length, 1e-3), 6, 20), material);
    mesh.position.copy(from).addScaledVector(along, 0.5);
    if (length > 1e-6) mesh.quaternion.setFromUnitVectors(Y, along.normalize());
    return mesh;
  }
}
