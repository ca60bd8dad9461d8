using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Osteon
{
    // The structs and enums of osteon.h, field by field: right-handed, SI. All but the parameters with strings are plain
    // numbers, so that a call copies nothing and makes no garbage.
    public static partial class Native
    {
        public enum Result
        {
            Ok = 0, Empty = 1, Argument = -1, File = -2, Memory = -3, Device = -4, State = -5, Abi = -6, Fork = -7, Buffer = -8,
            Internal = -9
        }

        public enum Engine : uint { Auto = 0, Cpu = 1, Vulkan = 2 }

        public enum LogLevel : uint { Info = 0, Warning = 1, Error = 2 }

        /// <summary>double[3] of osteon.h.</summary>
        [StructLayout(LayoutKind.Sequential)]
        public struct Triple
        {
            public double x, y, z;

            public Triple(double x, double y, double z)
            {
                this.x = x;
                this.y = y;
                this.z = z;
            }

            public double[] ToArray() => new[] { x, y, z };
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Pose
        {
            public Triple position_m;
            public double w, x, y, z; // orientation_wxyz
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Twist
        {
            public Triple linear_m_per_s, angular_rad_per_s;
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
            public Triple site_center_m, site_axis;
            public double site_radius_m;
            public string config_folder;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct BoneInfo
        {
            public ulong balls, mass_points;
            public double volume_m3, mass_kg;
            public Triple site_center_m, site_axis;
            public double site_radius_m;
            public uint material_count;
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
            public Pose proxy;
            public Wrench wrench;
            public double removed_volume_m3, removed_mass_kg, cutting_work_J, spindle_torque_Nm, engaged_area_m2, depth_m;
            public uint contacts, reserved;
            public ulong skipped_on_surface;

            public double[] proxy_position_m => proxy.position_m.ToArray();
            public double[] proxy_orientation_wxyz => new[] { proxy.w, proxy.x, proxy.y, proxy.z };
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Event
        {
            ulong name0, name1, name2, name3, name4, name5; // char[48]
            public double value_m;
            public Triple position_m;
            public ulong frame;

            public string Name => Text(name0, name1, name2, name3, name4, name5);
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct ComplianceParams
        {
            public uint tool, layer, mount, reserved;
            public double period_s, push_N, noticed_m;
            public Triple mount_point_m;
            public double mount_mass_kg;
            public Triple mount_inertia_kg_m2, mount_stiffness_N_per_m, mount_stiffness_Nm_per_rad;
            public double mount_damping_ratio, mount_creep_N_per_m, mount_creep_s;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Deflection
        {
            public Pose head, bone;
            public Triple bend_m, bend_rad, layer_m, mount_m, mount_rad, mount_m_per_s, mount_rad_per_s;
            public uint gives_way, noticed, beyond_limit, reserved;
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

        [StructLayout(LayoutKind.Sequential)]
        public struct SurfaceInfo
        {
            public ulong triangles;
            public double volume_m3;
            public uint watertight, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct PlanParams
        {
            public string plan, rubric, config_folder;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct CupAngles
        {
            public double inclination_rad, anteversion_rad;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct PlanInfo
        {
            public Triple cup_center_m, cup_axis;
            public double cup_diameter_m;
            public Triple native_center_m;
            public CupAngles radiographic, operative, anatomic;
            public uint reamer_count, is_left, has_guidance, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Reamer
        {
            public double diameter_m;
            public Triple center_m, apex_m;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct GuidanceParams
        {
            public uint reamer, reserved;
            public double gain, max_force_N, max_torque_Nm, max_speed_m_per_s, period_s;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct GuidanceOutput
        {
            public Wrench wrench;
            public double cone_rad, lateral_m, depth_m, share, potential_J, energy_J;
            public uint inside, stop_spindle, jumped, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct Assessment
        {
            public double score, axis_error_rad, diameter_m, diameter_sd_m;
            public Triple center_m;
            public double form_p95_m, medial_m, superior_m, posterior_m, native_medial_m, native_superior_m, native_posterior_m;
            public double coverage, removed_m3, over_m3, under_m3, cartilage_left, rim_preserved, min_wall_m;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct ScoreItem
        {
            ulong metric0, metric1, metric2, metric3, unit0; // char[32], char[8]
            public double value, full, zero, weight, points;

            public string Metric => Text(metric0, metric1, metric2, metric3);
            public string Unit => Text(unit0);
        }

        /// <summary>Text of a char array, up to its first zero.</summary>
        static string Text(params ulong[] words)
        {
            var bytes = new byte[8 * words.Length];
            for (var i = 0; i < words.Length; ++i) BitConverter.GetBytes(words[i]).CopyTo(bytes, 8 * i);
            var end = Array.IndexOf(bytes, (byte)0);
            return Encoding.UTF8.GetString(bytes, 0, end < 0 ? bytes.Length : end);
        }
    }
}
