using System;
using System.Runtime.InteropServices;

namespace Osteon
{
    /// <summary>The functions of osteon.h, one to one: right-handed, SI. See that file for what each guarantees.</summary>
    public static class Native
    {
        const string Library = "libosteon.so.0";
        /// <summary>OSTEON_ABI that these declarations were written for.</summary>
        public const uint Abi = 1;
        public const int ChunkMaxVertices = 5832, ChunkMaxIndices = 9216;

        [StructLayout(LayoutKind.Sequential)]
        public struct Pose
        {
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] position_m;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] orientation_wxyz;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Wrench
        {
            public double fx_N, fy_N, fz_N, tx_Nm, ty_Nm, tz_Nm;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct BoneParams
        {
            public string scene, mesh_file;
            public double mesh_scale_mm;
            public string packing_file;
            public IntPtr balls_mm;
            public UIntPtr ball_count;
            public string material;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] site_center_m;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] site_axis;
            public double site_radius_m;
            public string config_folder;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct ToolParams
        {
            public string name;
            public double diameter_m;
            public IntPtr balls_mm, cutting;
            public UIntPtr ball_count;
            public string config_folder;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Settings
        {
            public uint engine;
            public string device;
            public uint lockstep, surface;
            public double max_force_N, max_torque_Nm, stiffness_N_per_m, damping_Ns_per_m;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Figures
        {
            public ulong frame;
            public double pose_age_s, frame_time_s;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 3)] public double[] proxy_position_m;
            [MarshalAs(UnmanagedType.ByValArray, SizeConst = 4)] public double[] proxy_orientation_wxyz;
            public Wrench wrench;
            public double removed_volume_m3, removed_mass_kg, cutting_work_J, spindle_torque_Nm, engaged_area_m2, depth_m;
            public uint contacts, reserved;
            public ulong skipped_on_surface;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Vertex
        {
            public float x_mm, y_mm, z_mm, nx, ny, nz;
            public byte material, cut, reserved0, reserved1;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Chunk
        {
            public uint brick, first_vertex, vertex_count, first_index, index_count, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct SurfaceBuffers
        {
            public IntPtr chunks, vertices, indices;
            public UIntPtr chunk_capacity, vertex_capacity, index_capacity, chunk_count, vertex_count, index_count;
            public ulong left;
        }

        [DllImport(Library)] static extern IntPtr osteon_version();
        [DllImport(Library)] static extern IntPtr osteon_last_error();
        [DllImport(Library)] public static extern uint osteon_abi();
        [DllImport(Library)] public static extern int osteon_bone_create(uint abi, ref BoneParams parameters, out IntPtr bone);
        [DllImport(Library)] public static extern void osteon_bone_destroy(IntPtr bone);
        [DllImport(Library)] public static extern int osteon_bone_material_color(IntPtr bone, uint index, [Out] byte[] rgb);
        [DllImport(Library)] public static extern int osteon_bone_approach(IntPtr bone, double height_m, out Pose pose);
        [DllImport(Library)] public static extern int osteon_tool_create(uint abi, ref ToolParams parameters, out IntPtr tool);
        [DllImport(Library)] public static extern void osteon_tool_destroy(IntPtr tool);
        [DllImport(Library)] public static extern double osteon_tool_spindle_rad_per_s(IntPtr tool);
        [DllImport(Library)] public static extern void osteon_settings_default(out Settings settings);
        [DllImport(Library)]
        public static extern int osteon_session_create(uint abi, IntPtr bone, IntPtr tool, ref Settings settings, out IntPtr session);
        [DllImport(Library)] public static extern void osteon_session_destroy(IntPtr session);
        [DllImport(Library)]
        public static extern int osteon_session_set_tool_pose(IntPtr session, ref Pose pose, double spindle_rad_per_s);
        [DllImport(Library)]
        public static extern int osteon_session_step(IntPtr session, ref Pose pose, double spindle_rad_per_s, double dt_s);
        [DllImport(Library)]
        public static extern int osteon_session_evaluate(IntPtr session, ref Pose pose, IntPtr twist, out Wrench wrench);
        [DllImport(Library)] public static extern int osteon_session_figures(IntPtr session, out Figures figures);
        [DllImport(Library)] public static extern int osteon_session_mark(IntPtr session);
        [DllImport(Library)] public static extern int osteon_session_undo(IntPtr session, ref Pose pose);
        [DllImport(Library)]
        public static extern int osteon_session_surface_changes(IntPtr session, ref ulong generation, ref SurfaceBuffers buffers);
        [DllImport(Library)] public static extern int osteon_session_surface_wait(IntPtr session);

        public static string Version => Marshal.PtrToStringAnsi(osteon_version());

        /// <summary>Throws the library's text where a call was refused.</summary>
        public static void Check(int result)
        {
            if (result < 0) throw new InvalidOperationException("osteon: " + Marshal.PtrToStringAnsi(osteon_last_error()));
        }
    }
}
