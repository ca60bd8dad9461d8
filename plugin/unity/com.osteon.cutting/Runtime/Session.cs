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

    /// <summary>A bone that is cut by a tool. Poses and wrenches are in Unity's axes, in the bone's frame.</summary>
    public sealed class Session : IDisposable
    {
        IntPtr bone, tool, session;
        ulong generation;
        readonly List<byte[]> colors = new List<byte[]>(); // of the materials
        readonly Native.Chunk[] chunks = new Native.Chunk[256];
        readonly Native.Vertex[] vertices = new Native.Vertex[16 * Native.ChunkMaxVertices];
        readonly ushort[] indices = new ushort[16 * Native.ChunkMaxIndices];

        /// <param name="scene">a shipped scene, such as "acetabulum"</param>
        /// <param name="toolName">a shipped tool, such as "reamer"</param>
        /// <param name="diameter_m">0: the tool's usual one</param>
        /// <param name="lockstep">frames are computed by Step alone, the same in every run</param>
        /// <param name="configFolder">null: that of the installation</param>
        public Session(string scene, string toolName, double diameter_m, bool lockstep, string configFolder, double maxForce_N = 200.0)
        {
            try
            {
                var boneParams = new Native.BoneParams { scene = scene, config_folder = configFolder };
                Native.Check(Native.osteon_bone_create(Native.Abi, ref boneParams, out bone));
                var toolParams = new Native.ToolParams { name = toolName, diameter_m = diameter_m, config_folder = configFolder };
                Native.Check(Native.osteon_tool_create(Native.Abi, ref toolParams, out tool));
                for (var rgb = new byte[3]; Native.osteon_bone_material_color(bone, (uint)colors.Count, rgb) == 0; rgb = new byte[3])
                    colors.Add(rgb);
                Native.Settings settings;
                Native.osteon_settings_default(out settings);
                settings.lockstep = lockstep ? 1u : 0u;
                settings.max_force_N = maxForce_N;
                Native.Check(Native.osteon_session_create(Native.Abi, bone, tool, ref settings, out session));
            }
            catch
            {
                Dispose();
                throw;
            }
        }

        /// <summary>The tool's usual spindle speed [rad/s].</summary>
        public double Spindle => Native.osteon_tool_spindle_rad_per_s(tool);

        /// <summary>A pose that points into the site, its apex height_m above the site's centre: position x y z [m],
        /// rotation w x y z.</summary>
        public double[] Approach(double height_m)
        {
            Native.Pose pose;
            Native.Check(Native.osteon_bone_approach(bone, height_m, out pose));
            return FromOsteon(pose.position_m, pose.orientation_wxyz);
        }

        /// <summary>Where the tool is; not in lockstep. Wait-free.</summary>
        public void SetToolPose(double[] pose, double spindle_rad_per_s)
        {
            var X = ToOsteon(pose);
            Native.Check(Native.osteon_session_set_tool_pose(session, ref X, spindle_rad_per_s));
        }

        /// <summary>Lockstep: one frame.</summary>
        public void Step(double[] pose, double spindle_rad_per_s, double dt_s)
        {
            var X = ToOsteon(pose);
            Native.Check(Native.osteon_session_step(session, ref X, spindle_rad_per_s, dt_s));
        }

        /// <summary>The force [N] and the torque [N m] that the hand should feel at this pose. Wait-free.</summary>
        public void Evaluate(double[] pose, double[] force_N, double[] torque_Nm)
        {
            var X = ToOsteon(pose);
            Native.Wrench F;
            Native.Check(Native.osteon_session_evaluate(session, ref X, IntPtr.Zero, out F));
            Axes.Swap(F.fx_N, F.fy_N, F.fz_N, out force_N[0], out force_N[1], out force_N[2]);
            // a torque is an axis of rotation: mirrored it turns the other way
            Axes.Swap(-F.tx_Nm, -F.ty_Nm, -F.tz_Nm, out torque_Nm[0], out torque_Nm[1], out torque_Nm[2]);
        }

        public Native.Figures Figures
        {
            get
            {
                Native.Figures figures;
                Native.Check(Native.osteon_session_figures(session, out figures));
                return figures;
            }
        }

        /// <summary>Remembers the bone for Undo.</summary>
        public void Mark() => Native.Check(Native.osteon_session_mark(session));

        /// <summary>Returns to the last mark; the tool must be free of the bone that comes back.</summary>
        public void Undo(double[] pose)
        {
            var X = ToOsteon(pose);
            Native.Check(Native.osteon_session_undo(session, ref X));
        }

        /// <summary>Waits until all frames so far are in the surface.</summary>
        public void WaitForSurface() => Native.Check(Native.osteon_session_surface_wait(session));

        /// <summary>Adds the bricks that changed since the last call, at most one buffer of them.</summary>
        /// <returns>whether more are left</returns>
        public bool SurfaceChanges(List<Brick> changed)
        {
            var pins = new[]
            {
                GCHandle.Alloc(chunks, GCHandleType.Pinned), GCHandle.Alloc(vertices, GCHandleType.Pinned),
                GCHandle.Alloc(indices, GCHandleType.Pinned)
            };
            try
            {
                var buffers = new Native.SurfaceBuffers
                {
                    chunks = pins[0].AddrOfPinnedObject(), vertices = pins[1].AddrOfPinnedObject(),
                    indices = pins[2].AddrOfPinnedObject(), chunk_capacity = (UIntPtr)chunks.Length,
                    vertex_capacity = (UIntPtr)vertices.Length, index_capacity = (UIntPtr)indices.Length
                };
                Native.Check(Native.osteon_session_surface_changes(session, ref generation, ref buffers));
                for (var i = 0; i < (int)buffers.chunk_count; ++i) changed.Add(ToBrick(chunks[i]));
                return buffers.left > 0;
            }
            finally
            {
                foreach (var pin in pins) pin.Free();
            }
        }

        public void Dispose()
        {
            Native.osteon_session_destroy(session);
            Native.osteon_tool_destroy(tool);
            Native.osteon_bone_destroy(bone);
            session = tool = bone = IntPtr.Zero;
        }

        Brick ToBrick(Native.Chunk chunk)
        {
            var n = (int)chunk.vertex_count;
            var brick = new Brick
            {
                Number = chunk.brick, Positions = new float[3 * n], Normals = new float[3 * n], Materials = new byte[n], Colors = new byte[3 * n],
                Cut = new bool[n], Triangles = new int[chunk.index_count]
            };
            for (var i = 0; i < n; ++i)
            {
                var v = vertices[chunk.first_vertex + i];
                brick.Positions[3 * i] = 1e-3f * v.x_mm;
                brick.Positions[3 * i + 1] = 1e-3f * v.z_mm;
                brick.Positions[3 * i + 2] = 1e-3f * v.y_mm;
                brick.Normals[3 * i] = v.nx;
                brick.Normals[3 * i + 1] = v.nz;
                brick.Normals[3 * i + 2] = v.ny;
                brick.Materials[i] = v.material;
                brick.Cut[i] = v.cut != 0;
                for (var k = 0; k < 3; ++k) brick.Colors[3 * i + k] = (byte)(colors[v.material][k] * (v.cut != 0 ? 85 : 100) / 100);
            }
            // the mirror turns triangles over: with two corners exchanged they face outward again
            for (var i = 0; i + 2 < brick.Triangles.Length; i += 3)
            {
                brick.Triangles[i] = indices[chunk.first_index + i];
                brick.Triangles[i + 1] = indices[chunk.first_index + i + 2];
                brick.Triangles[i + 2] = indices[chunk.first_index + i + 1];
            }
            return brick;
        }

        static Native.Pose ToOsteon(double[] pose)
        {
            var X = new Native.Pose { position_m = new double[3], orientation_wxyz = new double[4] };
            Axes.Swap(pose[0], pose[1], pose[2], out X.position_m[0], out X.position_m[1], out X.position_m[2]);
            var q = X.orientation_wxyz;
            Axes.SwapRotation(pose[3], pose[4], pose[5], pose[6], out q[0], out q[1], out q[2], out q[3]);
            return X;
        }

        static double[] FromOsteon(double[] p, double[] q)
        {
            var pose = new double[7];
            Axes.Swap(p[0], p[1], p[2], out pose[0], out pose[1], out pose[2]);
            Axes.SwapRotation(q[0], q[1], q[2], q[3], out pose[3], out pose[4], out pose[5], out pose[6]);
            return pose;
        }
    }
}
