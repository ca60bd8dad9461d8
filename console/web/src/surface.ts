// The carved bone: bricks of the surface, 4³ of them in one mesh, made anew as the server sends bricks again.

import { BufferAttribute, BufferGeometry, Color, DoubleSide, FrontSide, Group, Mesh, MeshStandardMaterial, Plane, Vector3 } from "three";
import { FIRST_DEEPER, NO_DIFFERENCE, SAME, SECOND_DEEPER } from "./difference_colours";
import { planColour, type PlannedCup } from "./plan_colours";
import { decodeChunks, placeOf, type Chunk, type Layout } from "./surface_chunk";

const MAX_WAIT_MS = 200; // bricks of an incomplete change are shown after this time; a live change comes in one message
const GROUP_EDGE = 4; // bricks along a mesh: larger meshes need fewer draw calls, smaller ones less work for a change
const MATERIAL = 0x7f, CUT = 0x80; // bits of a vertex's byte: number of its material; on a cut face

// colours by a material's name
const COLOURS: Record<string, number> = {
  cartilage: 0xdfe9ea, cortical: 0xefe6cf, cancellous: 0xe2a878, marrow: 0xb5473c, enamel: 0xf7f7f2, dentine: 0xe9d79b,
};
const OTHER = 0xe6d8bd; // colour of any other material
const CUT_TINT = new Color(0xf2c9a8), CUT_SHARE = 0.35; // mixed into the colour of a cut face, to distinguish it

const SAME_COLOUR = new Color(SAME), SECOND_COLOUR = new Color(SECOND_DEEPER), FIRST_COLOUR = new Color(FIRST_DEEPER);

/** Bricks that share a mesh, by their number in the grid. */
interface Block {
  chunks: Map<number, Chunk>;
  mesh: Mesh | null;
}

/** A dent in the tissue: everything within the radius of the centre is displaced by `by`, in the bone's frame [m]. */
export interface Dent {
  centre: Vector3;
  by: Vector3;
  radius_m: number;
}
const DENT_FADES = 1.3; // distance at which the drawn dent ends, in radii of the dent

export class Surface {
  private readonly blocks = new Map<string, Block>();
  private readonly changed = new Set<string>(); // keys of blocks whose meshes are out of date
  private readonly material = new MeshStandardMaterial({ vertexColors: true, roughness: 0.75 });
  private readonly dent = {
    dentCentre: { value: new Vector3() }, dentBy: { value: new Vector3() }, dentRadius: { value: 1 },
  };
  private colours: Color[] = [new Color(OTHER)];
  private layout: Layout | null = null;
  private range_mm = 1; // of the difference's colours
  private cup: PlannedCup | null = null; // the bone is coloured by its distance to this cup
  private waiting: Chunk[] = []; // of a change that is not whole yet
  private began: number | null = null; // time at which that change began
  private accepted = 0; // time at which bricks were last handed to the picture
  triangles = 0;
  chunks = 0; // taken so far
  whole = 0; // changes so far

  constructor(private readonly parent: Group) {
    this.material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.dent);
      shader.vertexShader =
        "uniform vec3 dentCentre, dentBy;\nuniform float dentRadius;\n" +
        shader.vertexShader.replace(
          "#include <begin_vertex>",
          `#include <begin_vertex>
          float dentShare = 1.0 - smoothstep(dentRadius, ${DENT_FADES} * dentRadius, distance(position, dentCentre));
          transformed += dentShare * dentBy;`,
        );
    };
  }

  setMaterials(names: string[]): void {
    this.colours = names.map((name) => new Color(COLOURS[name] ?? OTHER));
    if (this.colours.length === 0) this.colours = [new Color(OTHER)];
  }

  /** Sets the difference of two bones at which the colours end. */
  setRange(range_mm: number): void {
    if (range_mm === this.range_mm) return;
    this.range_mm = range_mm;
    if (this.layout?.difference_step_mm !== undefined) this.changeAll();
  }

  /** Colours the bone by its distance to a planned cup; null: by tissue. */
  colourByPlan(cup: PlannedCup | null): void {
    this.cup = cup;
    this.changeAll();
  }

  /** Marks all meshes to be made anew, since their colours have changed. */
  private changeAll(): void {
    for (const key of this.blocks.keys()) this.changed.add(key);
  }

  /** Presses the surface in; null: nowhere. */
  setDent(dent: Dent | null): void {
    this.dent.dentBy.value.set(0, 0, 0);
    if (!dent) return;
    this.dent.dentCentre.value.copy(dent.centre);
    this.dent.dentBy.value.copy(dent.by);
    this.dent.dentRadius.value = dent.radius_m;
  }

  setClip(plane: Plane | null): void {
    this.material.clippingPlanes = plane ? [plane] : null;
    this.material.side = plane ? DoubleSide : FrontSide; // the surface is closed: its inside is seen where it is cut open
    this.material.needsUpdate = true;
  }

  /** Begins anew on another grid. */
  begin(layout: Layout): void {
    this.clear();
    this.layout = layout;
  }

  clear(): void {
    for (const block of this.blocks.values()) this.drop(block);
    this.blocks.clear();
    this.changed.clear();
    this.waiting = [];
    this.began = null;
    this.triangles = 0;
  }

  /** Takes bricks; the picture shows them once the change is whole, or after a while. */
  take(bytes: ArrayBuffer): void {
    if (!this.layout) return;
    const now = performance.now();
    if (this.began === null) this.began = this.accepted = now;
    const chunks = decodeChunks(bytes, this.layout);
    this.chunks += chunks.length;
    this.waiting.push(...chunks);
    if (now - this.accepted > MAX_WAIT_MS) this.accept();
  }

  /** Ends a change: the bricks so far belong to one time. */
  complete(): void {
    this.accept();
    this.began = null;
    ++this.whole;
  }

  /** Time since the first bricks of an incomplete change came [ms]; 0: no change is incomplete. */
  unfinished_ms(): number {
    return this.began === null ? 0 : performance.now() - this.began;
  }

  /** Puts the waiting bricks into their blocks, for the next picture. */
  private accept(): void {
    this.accepted = performance.now();
    if (!this.layout) return;
    for (const chunk of this.waiting) {
      const key = placeOf(chunk.brick, this.layout).map((b) => Math.floor(b / GROUP_EDGE)).join();
      const block = this.blocks.get(key) ?? { chunks: new Map<number, Chunk>(), mesh: null };
      if (chunk.indices.length === 0) block.chunks.delete(chunk.brick);
      else block.chunks.set(chunk.brick, chunk);
      this.blocks.set(key, block);
      this.changed.add(key);
    }
    this.waiting = [];
  }

  /** Makes the meshes that have changed. Called before a picture is drawn. */
  update(): void {
    for (const key of this.changed) {
      const block = this.blocks.get(key)!;
      this.drop(block);
      if (block.chunks.size > 0) this.build(block);
    }
    this.changed.clear();
  }

  /** Makes a block's mesh from its bricks. */
  private build(block: Block): void {
    const chunks = [...block.chunks.values()];
    const vertices = chunks.reduce((sum, c) => sum + c.materials.length, 0);
    const indices = new Uint32Array(chunks.reduce((sum, c) => sum + c.indices.length, 0));
    const positions = new Float32Array(3 * vertices), normals = new Float32Array(3 * vertices), colours = new Float32Array(3 * vertices);
    let vertex = 0, index = 0;
    for (const chunk of chunks) {
      positions.set(chunk.positions, 3 * vertex);
      normals.set(chunk.normals, 3 * vertex);
      for (let i = 0; i < chunk.materials.length; ++i) this.colour(chunk, i).toArray(colours, 3 * (vertex + i));
      for (let i = 0; i < chunk.indices.length; ++i) indices[index + i] = vertex + chunk.indices[i];
      vertex += chunk.materials.length;
      index += chunk.indices.length;
    }
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new BufferAttribute(normals, 3));
    geometry.setAttribute("color", new BufferAttribute(colours, 3));
    geometry.setIndex(new BufferAttribute(indices, 1));
    block.mesh = new Mesh(geometry, this.material);
    this.triangles += indices.length / 3;
    this.parent.add(block.mesh);
  }

  private readonly mixed = new Color(); // scratch of colour()
  private readonly at = new Vector3(); // scratch of colour()
  /** A vertex's colour: by the difference of two bones, by the plan, or by tissue. */
  private colour(chunk: Chunk, vertex: number): Color {
    const material = chunk.materials[vertex];
    const step_mm = this.layout?.difference_step_mm;
    if (step_mm !== undefined) {
      const share = (((material & MATERIAL) - NO_DIFFERENCE) * step_mm) / this.range_mm;
      return this.mixed.copy(SAME_COLOUR).lerp(share < 0 ? FIRST_COLOUR : SECOND_COLOUR, Math.min(1, Math.abs(share)));
    }
    const cut = (material & CUT) !== 0;
    const planned = this.cup && planColour(this.at.fromArray(chunk.positions, 3 * vertex), cut, this.cup, this.mixed);
    if (planned) return planned;
    const own = this.colours[Math.min(material & MATERIAL, this.colours.length - 1)];
    return cut ? this.mixed.copy(own).lerp(CUT_TINT, CUT_SHARE) : own;
  }

  /** Removes a block's mesh. */
  private drop(block: Block): void {
    if (!block.mesh) return;
    this.triangles -= block.mesh.geometry.getIndex()!.count / 3;
    this.parent.remove(block.mesh);
    block.mesh.geometry.dispose();
    block.mesh = null;
  }
}
