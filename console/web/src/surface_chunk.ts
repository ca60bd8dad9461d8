// Chunks of the carved surface, as simulation/surface/chunk_bytes.h describes them.

// the format's constants
const HEAD_BYTES = 8, VERTEX_BYTES = 6, BRICK_EDGE = 8, STEPS_PER_VOXEL = 28, MAX_BYTE_INDICES = 256;
const METRES_PER_MM = 1e-3;

export interface Layout {
  type: "surface";
  origin_mm: [number, number, number];
  voxel_mm: number;
  bricks: [number, number, number];
  difference_step_mm?: number; // the materials are steps of difference to another bone, 64 for none
}

export interface Chunk {
  brick: number;
  positions: Float32Array; // [m], in G
  normals: Float32Array;
  materials: Uint8Array; // bits 0 … 6: index of the tissue, or step of difference; bit 7: on a cut face
  indices: Uint32Array; // two triangles for each quad
}

/** Place of a brick in the grid. */
export function placeOf(brick: number, layout: Layout): [number, number, number] {
  const [nx, ny] = layout.bricks;
  return [brick % nx, Math.floor(brick / nx) % ny, Math.floor(brick / nx / ny)];
}

/** The chunks of a message, which follow each other without a gap. @throws RangeError where bytes are missing */
export function decodeChunks(buffer: ArrayBuffer, layout: Layout): Chunk[] {
  const view = new DataView(buffer);
  const chunks: Chunk[] = [];
  for (let at = 0; at < buffer.byteLength; ) {
    const brick = view.getUint32(at, true);
    const vertices = view.getUint16(at + 4, true), quads = view.getUint16(at + 6, true);
    at += HEAD_BYTES;
    const bytes = new Uint8Array(buffer, at, vertices * VERTEX_BYTES);
    // lower corner of the brick's vertices, one voxel outside the brick [mm]
    const low = placeOf(brick, layout).map((b, i) => layout.origin_mm[i] + (b * BRICK_EDGE - 1) * layout.voxel_mm);
    const step = layout.voxel_mm / STEPS_PER_VOXEL;
    const chunk: Chunk = {
      brick,
      positions: new Float32Array(3 * vertices),
      normals: new Float32Array(3 * vertices),
      materials: new Uint8Array(vertices),
      indices: new Uint32Array(6 * quads),
    };
    for (let v = 0; v < vertices; ++v) {
      const from = v * VERTEX_BYTES;
      for (let i = 0; i < 3; ++i) chunk.positions[3 * v + i] = METRES_PER_MM * (low[i] + step * bytes[from + i]);
      octahedral(bytes[from + 3], bytes[from + 4], chunk.normals, 3 * v);
      chunk.materials[v] = bytes[from + 5];
    }
    at += vertices * VERTEX_BYTES;
    const wide = vertices > MAX_BYTE_INDICES;
    for (let q = 0; q < quads; ++q) {
      const corner = (i: number): number => (wide ? view.getUint16(at + 8 * q + 2 * i, true) : view.getUint8(at + 4 * q + i));
      chunk.indices.set([corner(0), corner(1), corner(2), corner(0), corner(2), corner(3)], 6 * q);
    }
    at += quads * (wide ? 8 : 4);
    chunks.push(chunk);
  }
  return chunks;
}

/** Decodes a unit normal from its octahedral coordinates, 0 … 255 each, into `to` from index `at` on. */
function octahedral(a: number, b: number, to: Float32Array, at: number): void {
  let x = a / 127.5 - 1, y = b / 127.5 - 1;
  const z = 1 - Math.abs(x) - Math.abs(y);
  if (z < 0) {
    const fold = (1 - Math.abs(y)) * Math.sign(x || 1);
    y = (1 - Math.abs(x)) * Math.sign(y || 1);
    x = fold;
  }
  const length = Math.hypot(x, y, z);
  to[at] = x / length;
  to[at + 1] = y / length;
  to[at + 2] = z / length;
}
