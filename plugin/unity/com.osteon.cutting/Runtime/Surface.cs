using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Osteon
{
    /// <summary>A brick of the carved surface in Unity's axes: positions [m] and normals x y z, three indices a triangle,
    /// clockwise from outside. Empty: the brick has gone.</summary>
    public sealed class Brick
    {
        public uint Number;
        public float[] Positions, Normals;
        public byte[] Materials;
        /// <summary>Red, green, blue of each vertex, sRGB; a cut face is 0.85 as bright.</summary>
        public byte[] Colors;
        public bool[] Cut;
        public int[] Triangles;
    }

    /// <summary>A vertex as Mesh.SetVertexBufferData takes it: position [m], normal, colour of four bytes.</summary>
    [StructLayout(LayoutKind.Sequential)]
    public struct MeshVertex
    {
        public float x, y, z, nx, ny, nz;
        public byte r, g, b, a;
    }

    /// <summary>Where a changed brick lies in Surface.Vertices and Surface.Indices, and its box [m]. No vertex: it has
    /// gone.</summary>
    public struct BrickRange
    {
        public uint Number;
        public int FirstVertex, VertexCount, FirstIndex, IndexCount;
        public float MinX, MinY, MinZ, MaxX, MaxY, MaxZ;
    }

    /// <summary>The changed bricks of a session's surface, in buffers that are filled again and again: no garbage.</summary>
    public sealed class Surface : IDisposable
    {
        readonly Native.Chunk[] chunks = new Native.Chunk[256];
        readonly Native.Vertex[] vertices = new Native.Vertex[16 * Native.ChunkMaxVertices];
        readonly byte[] shades; // red, green, blue of each material, uncut then cut
        GCHandle chunksPin, verticesPin, indicesPin;
        ulong generation;

        /// <summary>The first Count are filled.</summary>
        public readonly BrickRange[] Ranges = new BrickRange[256];
        public readonly MeshVertex[] Vertices = new MeshVertex[16 * Native.ChunkMaxVertices];
        /// <summary>Each counted from its brick's first vertex; triangles clockwise from outside.</summary>
        public readonly ushort[] Indices = new ushort[16 * Native.ChunkMaxIndices];

        public int Count { get; private set; }
        /// <summary>Changed bricks that did not fit: take again.</summary>
        public ulong Left { get; private set; }

        internal Surface(IntPtr bone)
        {
            Native.BoneInfo info;
            Native.Check(Native.osteon_bone_info(bone, out info));
            shades = new byte[6 * info.material_count];
            var rgb = new byte[3];
            for (uint i = 0; i < info.material_count; ++i)
            {
                Native.Check(Native.osteon_bone_material_color(bone, i, rgb));
                for (var k = 0; k < 3; ++k)
                {
                    shades[6 * i + k] = rgb[k];
                    shades[6 * i + 3 + k] = (byte)(rgb[k] * 85 / 100);
                }
            }
            chunksPin = GCHandle.Alloc(chunks, GCHandleType.Pinned);
            verticesPin = GCHandle.Alloc(vertices, GCHandleType.Pinned);
            indicesPin = GCHandle.Alloc(Indices, GCHandleType.Pinned);
        }

        public void Dispose()
        {
            if (!chunksPin.IsAllocated) return;
            chunksPin.Free();
            verticesPin.Free();
            indicesPin.Free();
        }

        /// <summary>Fills the buffers with bricks that changed since the last call.</summary>
        internal void Take(IntPtr session)
        {
            Count = 0;
            Left = 0;
            var buffers = new Native.SurfaceBuffers
            {
                chunks = chunksPin.AddrOfPinnedObject(), vertices = verticesPin.AddrOfPinnedObject(),
                indices = indicesPin.AddrOfPinnedObject(), chunk_capacity = (UIntPtr)chunks.Length,
                vertex_capacity = (UIntPtr)vertices.Length, index_capacity = (UIntPtr)Indices.Length
            };
            Native.Check(Native.osteon_session_surface_changes(session, ref generation, ref buffers));
            Count = (int)buffers.chunk_count;
            Left = buffers.left;
            for (var i = 0; i < Count; ++i) Convert(ref chunks[i], ref Ranges[i]);
        }

        /// <summary>Copies of the bricks that were taken, with what MeshVertex leaves out.</summary>
        internal void CopyTo(List<Brick> changed)
        {
            for (var i = 0; i < Count; ++i) changed.Add(ToBrick(ref Ranges[i]));
        }

        void Convert(ref Native.Chunk chunk, ref BrickRange range)
        {
            range.Number = chunk.brick;
            range.FirstVertex = (int)chunk.first_vertex;
            range.VertexCount = (int)chunk.vertex_count;
            range.FirstIndex = (int)chunk.first_index;
            range.IndexCount = (int)chunk.index_count;
            range.MinX = range.MinY = range.MinZ = float.PositiveInfinity;
            range.MaxX = range.MaxY = range.MaxZ = float.NegativeInfinity;
            for (var i = range.FirstVertex; i < range.FirstVertex + range.VertexCount; ++i)
            {
                ConvertVertex(ref vertices[i], ref Vertices[i]);
                Widen(ref Vertices[i], ref range);
            }
            // the mirror turns triangles over: with two corners exchanged they face outward again
            for (var i = range.FirstIndex; i + 2 < range.FirstIndex + range.IndexCount; i += 3)
            {
                var second = Indices[i + 1];
                Indices[i + 1] = Indices[i + 2];
                Indices[i + 2] = second;
            }
        }

        void ConvertVertex(ref Native.Vertex from, ref MeshVertex to)
        {
            to.x = 1e-3f * from.x_mm;
            to.y = 1e-3f * from.z_mm;
            to.z = 1e-3f * from.y_mm;
            to.nx = from.nx;
            to.ny = from.nz;
            to.nz = from.ny;
            var shade = 6 * from.material + (from.cut != 0 ? 3 : 0);
            to.r = shades[shade];
            to.g = shades[shade + 1];
            to.b = shades[shade + 2];
            to.a = 255;
        }

        static void Widen(ref MeshVertex v, ref BrickRange range)
        {
            range.MinX = Math.Min(range.MinX, v.x);
            range.MinY = Math.Min(range.MinY, v.y);
            range.MinZ = Math.Min(range.MinZ, v.z);
            range.MaxX = Math.Max(range.MaxX, v.x);
            range.MaxY = Math.Max(range.MaxY, v.y);
            range.MaxZ = Math.Max(range.MaxZ, v.z);
        }

        Brick ToBrick(ref BrickRange range)
        {
            var n = range.VertexCount;
            var brick = new Brick
            {
                Number = range.Number, Positions = new float[3 * n], Normals = new float[3 * n], Materials = new byte[n],
                Colors = new byte[3 * n], Cut = new bool[n], Triangles = new int[range.IndexCount]
            };
            for (var i = 0; i < n; ++i)
            {
                var v = Vertices[range.FirstVertex + i];
                brick.Positions[3 * i] = v.x;
                brick.Positions[3 * i + 1] = v.y;
                brick.Positions[3 * i + 2] = v.z;
                brick.Normals[3 * i] = v.nx;
                brick.Normals[3 * i + 1] = v.ny;
                brick.Normals[3 * i + 2] = v.nz;
                brick.Colors[3 * i] = v.r;
                brick.Colors[3 * i + 1] = v.g;
                brick.Colors[3 * i + 2] = v.b;
                brick.Materials[i] = vertices[range.FirstVertex + i].material;
                brick.Cut[i] = vertices[range.FirstVertex + i].cut != 0;
            }
            for (var i = 0; i < range.IndexCount; ++i) brick.Triangles[i] = Indices[range.FirstIndex + i];
            return brick;
        }
    }
}
