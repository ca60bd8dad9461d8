// The 3-D view: bone, tool with its ghost, contact planes, forces, zones, arm; camera, presets, cut-open view.

import {
  AmbientLight, ArrowHelper, AxesHelper, Color, DirectionalLight, Group, LineBasicMaterial, LineLoop, BufferGeometry, Mesh,
  MeshBasicMaterial, Object3D, PerspectiveCamera, Plane, RingGeometry, Scene, Vector3, WebGLRenderer, CircleGeometry, DoubleSide, Line,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { Arm } from "./arm";
import type { Hello, PlanNote, ProcedureNote, View } from "./messages";
import { PlanView } from "./plan";
import { matrixOf, place, vectorOf } from "./poses";
import { Surface } from "./surface";
import { headOf, toolOf } from "./tool";
import { zonesOf } from "./zones";

const LIMIT_IN_SITES = 1.8; // length of an arrow at the force limit, in radii of the site; also the ring's radius
const MIN_SHOWN_N = 0.5; // a smaller force has no arrow
const MAX_CONTACTS = 8; // number of contact planes that are shown
const MIN_PAUSE_MS = 16; // shortest pause between two pictures
const KEY_TURN_RAD = Math.PI / 36, KEY_MOVE_PX = 20, KEY_ZOOM = 0.9; // effect of one key press on the camera

export type Preset = "whole" | "site" | "axis" | "above" | "behind";

export class SceneView {
  readonly surface: Surface;
  private readonly renderer: WebGLRenderer;
  private readonly gl: WebGL2RenderingContext;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(40, 1, 0.005, 20);
  private readonly controls: OrbitControls;
  private readonly bone = new Group();
  private readonly lasting = new Group(); // made anew with each hello
  private readonly moving = new Group(); // moves with the bone: bone, its marks, proxy and contacts
  private readonly undented = new Group(); // in `moving`: bone and marks, without the indentation under the tool
  private readonly clipPlane = new Plane();
  private tool: Object3D | null = null;
  private proxy: Object3D | null = null;
  private arm: Arm | null = null;
  private zones: Object3D | null = null;
  private planView: PlanView | null = null;
  private plan: PlanNote | null = null;
  private byPlan = false; // the bone is coloured by its distance to the plan
  private toolIndex = -1; // index in Hello.tools of the tool that is shown
  private contacts: Group[] = [];
  private force = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.1, 0x5aa9f0, 0.02, 0.012);
  private hand = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.1, 0xc58af0, 0.02, 0.012);
  private limit: Mesh | null = null;
  private hello: Hello | null = null;
  private view: View | null = null;
  private alone = false; // the bone is shown without the tool
  private readonly shown = { arm: true, zones: false, plan: true }; // by the buttons
  private wanted = false; // a new picture is needed
  private lastRender_ms = 0; // duration of the last picture
  private begunAt = 0; // time at which the last picture was begun [ms]
  private drawnAt = 0; // time at which it was seen to be finished [ms]
  private drawing: WebGLSync | null = null; // the picture that is not yet finished
  private followed = new Vector3(); // the tool's apex where the camera followed it last
  private following = false;
  private metresPerNewton = 0.0005;
  drawn = 0; // pictures so far

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: !drawsInSoftware(), preserveDrawingBuffer: true });
    this.gl = this.renderer.getContext() as WebGL2RenderingContext;
    this.renderer.localClippingEnabled = true;
    this.scene.background = new Color(0x0e1114);
    this.scene.add(new AmbientLight(0xffffff, 0.9));
    const sun = new DirectionalLight(0xffffff, 2.2);
    this.camera.add(sun);
    sun.position.set(0.4, 0.8, 1);
    this.undented.add(this.bone);
    this.moving.add(this.undented);
    this.scene.add(this.camera, this.moving, this.lasting, this.force, this.hand);
    this.force.visible = this.hand.visible = false;
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.redraw());
    this.surface = new Surface(this.bone);
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
  }

  begin(hello: Hello): void {
    this.hello = hello;
    this.lasting.clear();
    this.moving.clear();
    this.undented.clear();
    this.undented.add(this.bone);
    this.moving.add(this.undented);
    this.moving.matrixAutoUpdate = false;
    this.moving.matrix.identity();
    this.surface.clear();
    this.surface.setMaterials(hello.materials);
    place(this.bone, hello.X_WG);
    this.arm = new Arm(hello.arm);
    this.arm.group.visible = this.shown.arm;
    place(this.arm.group, hello.X_WB);
    this.setTool(hello.tool.balls);
    this.planView = null;
    this.plan = null;
    this.colourBone(this.byPlan);
    this.toolIndex = -1;
    this.zones = zonesOf(hello.zones);
    this.zones.visible = this.shown.zones;
    const ring = LIMIT_IN_SITES * hello.site.radius_m;
    this.metresPerNewton = ring / hello.force_limit_N;
    this.limit = new Mesh(
      new RingGeometry(0.985 * ring, ring, 96),
      new MeshBasicMaterial({ color: 0x5aa9f0, transparent: true, opacity: 0.5, side: DoubleSide, depthTest: false }),
    );
    this.limit.visible = false;
    this.contacts = Array.from({ length: MAX_CONTACTS }, () => contactPlane());
    this.lasting.add(this.arm.group, this.zones, this.limit, this.frames(hello));
    this.moving.add(...this.contacts);
    this.undented.add(this.siteMarks(hello));
    this.preset("site");
  }

  /** Replaces the drawn tool and its ghost, the proxy. @param balls as in toolOf */
  private setTool(balls: number[][]): void {
    if (this.tool && this.proxy) {
      this.lasting.remove(this.tool);
      this.moving.remove(this.proxy);
    }
    this.tool = toolOf(balls, { cutting: 0xd8dde3, shaft: 0x8b98a6, opacity: 1 });
    this.proxy = toolOf(balls, { cutting: 0x58d0a0, shaft: 0x58d0a0, opacity: 0.28 });
    this.tool.visible = this.proxy.visible = false;
    this.lasting.add(this.tool);
    this.moving.add(this.proxy);
  }

  setPlan(plan: PlanNote): void {
    if (this.planView) this.lasting.remove(this.planView.group);
    this.planView = new PlanView(plan);
    this.plan = plan;
    this.colourBone(this.byPlan);
    this.planView.group.visible = this.shown.plan;
    this.lasting.add(this.planView.group);
    this.redraw();
  }

  /** Colours the bone by its distance to the planned cup, where there is one, or by tissue. */
  colourBone(byPlan: boolean): void {
    this.byPlan = byPlan;
    if (!this.hello) return;
    const X_GW = matrixOf(this.hello.X_WG).invert();
    const plan = byPlan && this.plan?.kind === "cup" ? this.plan : null;
    this.surface.colourByPlan(plan && {
      centre: vectorOf(plan.cup_centre_m).applyMatrix4(X_GW),
      axis: vectorOf(plan.axis).transformDirection(X_GW),
      radius_m: plan.cup_radius_m,
    });
    this.redraw();
  }

  showPlan(note: ProcedureNote): void {
    this.planView?.show(note);
    this.redraw();
  }

  /** Shows the bone without what would cover it: tool, forces, contacts. */
  showBoneAlone(alone: boolean): void {
    this.alone = alone;
    if (this.view) this.show(this.view);
  }

  show(view: View): void {
    this.view = view;
    if (!this.hello || !this.tool || !this.proxy || !this.arm) return;
    if (view.tool !== this.toolIndex && this.hello.tools[view.tool]) {
      this.toolIndex = view.tool;
      this.setTool(this.hello.tools[view.tool]);
    }
    this.tool.visible = !this.alone;
    place(this.tool, view.X_WT);
    this.showGivingWay(view);
    this.proxy.visible = view.X_WP !== undefined && !this.alone;
    if (view.X_WP) place(this.proxy, view.X_WP);
    this.arm.pose(view.q);
    const p_WT = vectorOf([view.X_WT[3], view.X_WT[7], view.X_WT[11]]);
    this.arrow(this.force, view.force, p_WT);
    const p_WF = new Vector3().setFromMatrixPosition(this.arm.X_BF).applyMatrix4(matrixOf(this.hello.X_WB));
    this.arrow(this.hand, view.hand, p_WF);
    if (this.alone) this.force.visible = this.hand.visible = false;
    this.limit!.visible = this.force.visible;
    this.limit!.position.copy(p_WT);
    this.contacts.forEach((plane, i) => {
      plane.visible = i < view.contacts.length && !this.alone;
      if (!plane.visible) return;
      plane.position.copy(vectorOf(view.contacts[i]));
      plane.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), vectorOf(view.contacts[i], 3).normalize());
    });
    if (this.following) this.move(p_WT);
    this.redraw();
  }

  /** Displaces the bone and the tool's cutting head as they give way, to scale. */
  private showGivingWay(view: View): void {
    if (!this.tool) return;
    if (view.X_WM) this.moving.matrix.copy(matrixOf(view.X_WM));
    else this.moving.matrix.identity();
    this.moving.matrixWorldNeedsUpdate = true;
    this.showIndentation(view);
    const head = headOf(this.tool);
    head.matrixAutoUpdate = false;
    if (view.X_WE) head.matrix.copy(matrixOf(view.X_WT).invert().multiply(matrixOf(view.X_WE)));
    else head.matrix.identity();
    head.matrixWorldNeedsUpdate = true;
  }

  /** Dents the surface under the head by the tissue's indentation, to scale. How the dent fades beside the head is only a
   *  picture, not a result. */
  private showIndentation(view: View): void {
    if (!this.hello) return;
    const layer = vectorOf(view.layer ?? [0, 0, 0]);
    this.undented.position.copy(layer).negate();
    const balls = this.hello.tools[this.toolIndex] ?? this.hello.tool.balls;
    const [head] = balls.filter((ball) => ball[4] === 1).sort((a, b) => b[3] - a[3]);
    if (!view.X_WP || !head || layer.length() === 0) {
      this.surface.setDent(null);
      return;
    }
    const X_GW = matrixOf(this.hello.X_WG).invert();
    const by = layer.clone().transformDirection(X_GW).multiplyScalar(layer.length());
    this.surface.setDent({ centre: vectorOf(head).applyMatrix4(matrixOf(view.X_WP)).applyMatrix4(X_GW), by, radius_m: head[3] });
  }

  toggle(what: "arm" | "zones" | "plan", on: boolean): void {
    this.shown[what] = on;
    if (what === "arm" && this.arm) this.arm.group.visible = on;
    if (what === "zones" && this.zones) this.zones.visible = on;
    if (what === "plan" && this.planView) this.planView.group.visible = on;
    this.redraw();
  }

  /** Cuts the bone open along the site's axis, on the side of the camera. */
  clip(on: boolean): void {
    if (!this.hello) return;
    if (on) {
      const X_WG = matrixOf(this.hello.X_WG);
      const centre = vectorOf(this.hello.site.center).applyMatrix4(X_WG);
      const axis = vectorOf(this.hello.site.axis).transformDirection(X_WG);
      const away = centre.clone().sub(this.camera.position);
      away.addScaledVector(axis, -away.dot(axis)).normalize();
      this.clipPlane.setFromNormalAndCoplanarPoint(away, centre);
    }
    this.surface.setClip(on ? this.clipPlane : null);
    this.redraw();
  }

  preset(preset: Preset): void {
    if (!this.hello) return;
    const X_WG = matrixOf(this.hello.X_WG);
    const site = vectorOf(this.hello.site.center).applyMatrix4(X_WG);
    const axis = vectorOf(this.hello.site.axis).transformDirection(X_WG);
    const size = Math.max(this.hello.site.radius_m, 0.006);
    const p_WT = this.view ? vectorOf([this.view.X_WT[3], this.view.X_WT[7], this.view.X_WT[11]]) : site;
    const side = new Vector3(1, -1, 0.35).normalize();
    let target = site, from: Vector3, distance = 7 * size;
    if (preset === "axis") from = axis.clone().addScaledVector(side, 0.02);
    else if (preset === "above") from = new Vector3(0.01, 0, 1);
    else if (preset === "behind") [target, from] = [p_WT, axis.clone().addScaledVector(side, 0.45)];
    else if (preset === "whole") {
      target = site.clone().multiplyScalar(0.55).setZ(0.35);
      from = side;
      distance = 2.3;
    } else from = side.clone().multiplyScalar(0.8).addScaledVector(axis, 0.6);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(from.normalize(), distance);
    this.followed.copy(p_WT);
    this.controls.update();
    this.redraw();
  }

  /** Position and target of the camera as text, for setPose of another page's scene. */
  pose(): string {
    const digits = 5;
    return [...this.camera.position.toArray(), ...this.controls.target.toArray()].map((x) => x.toFixed(digits)).join();
  }

  setPose(pose: string): void {
    const at = pose.split(",").map(Number);
    this.camera.position.fromArray(at);
    this.controls.target.fromArray(at, 3);
    this.controls.update();
    this.redraw();
  }

  /** Turns by the arrow keys, moves by them with Shift, zooms by + and -. @returns whether the key is one of them */
  moveByKey(event: KeyboardEvent): boolean {
    const ways: Record<string, [number, number]> = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const way = ways[event.key];
    if (way && event.shiftKey) this.controls.pan(KEY_MOVE_PX * way[0], KEY_MOVE_PX * way[1]);
    else if (way) {
      this.controls.rotateLeft(KEY_TURN_RAD * way[0]);
      this.controls.rotateUp(KEY_TURN_RAD * way[1]);
    } else if (event.key === "+") this.controls.dollyIn(KEY_ZOOM);
    else if (event.key === "-") this.controls.dollyOut(KEY_ZOOM);
    else return false;
    return true;
  }

  setFollowing(on: boolean): void {
    this.following = on;
    if (this.view) this.followed.copy(vectorOf([this.view.X_WT[3], this.view.X_WT[7], this.view.X_WT[11]]));
  }

  redraw(): void {
    if (this.wanted) return;
    this.wanted = true;
    if (!this.drawing) this.renderSoon();
  }

  /** Draws after a pause of twice the last picture's duration, which leaves time for clicks and messages. */
  private renderSoon(): void {
    const pause = Math.max(MIN_PAUSE_MS, 2 * this.lastRender_ms - (performance.now() - this.drawnAt));
    setTimeout(() => requestAnimationFrame(() => this.render()), pause - MIN_PAUSE_MS);
  }

  /** Waits until the picture is finished, then begins the next one if it is wanted. A software rasteriser is slow and works
   *  in another process: the page draws less often, instead of queueing pictures that would delay clicks and messages. */
  private waitUntilDrawn(): void {
    if (!this.drawing) return;
    if (this.gl.getSyncParameter(this.drawing, this.gl.SYNC_STATUS) === this.gl.UNSIGNALED) {
      setTimeout(() => this.waitUntilDrawn(), MIN_PAUSE_MS);
      return;
    }
    this.gl.deleteSync(this.drawing);
    this.drawing = null;
    this.drawnAt = performance.now();
    this.lastRender_ms = this.drawnAt - this.begunAt;
    if (this.wanted) this.renderSoon();
  }

  private render(): void {
    this.wanted = false;
    this.begunAt = performance.now();
    this.surface.update();
    this.limit?.quaternion.copy(this.camera.quaternion);
    this.renderer.render(this.scene, this.camera);
    const first = !this.drawing; // else waitUntilDrawn is already under way
    if (this.drawing) this.gl.deleteSync(this.drawing);
    this.drawing = this.gl.fenceSync(this.gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    this.gl.flush();
    if (first) setTimeout(() => this.waitUntilDrawn(), MIN_PAUSE_MS);
    ++this.drawn;
  }

  /** Moves the camera as the tool's apex has moved. */
  private move(p_WT: Vector3): void {
    const step = p_WT.clone().sub(this.followed);
    this.camera.position.add(step);
    this.controls.target.add(step);
    this.followed.copy(p_WT);
    this.controls.update();
  }

  /** Shows a force [N] as an arrow from a point in W, or hides it below MIN_SHOWN_N. */
  private arrow(arrow: ArrowHelper, force: number[], from: Vector3): void {
    const f = vectorOf(force);
    const size = f.length();
    arrow.visible = size >= MIN_SHOWN_N;
    if (!arrow.visible) return;
    arrow.position.copy(from);
    arrow.setDirection(f.clone().divideScalar(size));
    const length = this.metresPerNewton * size;
    arrow.setLength(length, Math.min(0.4 * length, 0.012), Math.min(0.25 * length, 0.008));
  }

  /** The axes of world and base. */
  private frames(hello: Hello): Object3D {
    const frames = new Group();
    const world = new AxesHelper(0.1), base = new AxesHelper(0.15);
    place(base, hello.X_WB);
    frames.add(world, base);
    return frames;
  }

  /** The site's rim, axis and axes, which go with the bone. */
  private siteMarks(hello: Hello): Object3D {
    const X_WG = matrixOf(hello.X_WG);
    const axis = vectorOf(hello.site.axis).normalize();
    const rim = new Group();
    rim.position.copy(vectorOf(hello.site.center));
    rim.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), axis);
    const points = Array.from({ length: 64 }, (_, i) => {
      const angle = (2 * Math.PI * i) / 64;
      return new Vector3(Math.cos(angle), Math.sin(angle), 0).multiplyScalar(hello.site.radius_m);
    });
    const material = new LineBasicMaterial({ color: 0xe8b23a });
    rim.add(new LineLoop(new BufferGeometry().setFromPoints(points), material));
    const ends = [new Vector3(0, 0, -1.5), new Vector3(0, 0, 2.5)].map((p) => p.multiplyScalar(hello.site.radius_m));
    rim.add(new Line(new BufferGeometry().setFromPoints(ends), material));
    const inBone = new Group();
    inBone.matrixAutoUpdate = false;
    inBone.matrix.copy(X_WG);
    inBone.add(rim);
    rim.add(new AxesHelper(hello.site.radius_m));
    return inBone;
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.redraw();
  }
}

/** Whether the browser draws without a GPU. Smooth edges would then double the time for a picture. */
function drawsInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return true;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|lavapipe|softpipe|software/i.test(name);
}

/** A disc with its normal along +z, for one contact. */
function contactPlane(): Group {
  const plane = new Group();
  const disc = new Mesh(
    new CircleGeometry(0.006, 24),
    new MeshBasicMaterial({ color: 0xf0a35a, transparent: true, opacity: 0.45, side: DoubleSide, depthWrite: false }),
  );
  const normal = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), 0.012, 0xf0a35a, 0.004, 0.003);
  plane.add(disc, normal);
  plane.visible = false;
  return plane;
}

