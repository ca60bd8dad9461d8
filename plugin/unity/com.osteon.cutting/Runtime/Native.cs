using System;
using System.Runtime.InteropServices;

namespace Osteon
{
    /// <summary>The functions of osteon.h, one to one: right-handed, SI. See that file for what each guarantees.</summary>
    public static partial class Native
    {
        const string Library = "libosteon.so.0";
        /// <summary>OSTEON_ABI that these declarations were written for.</summary>
        public const uint Abi = 1;
        public const int ChunkMaxVertices = 5832, ChunkMaxIndices = 9216;

        [DllImport(Library)] static extern IntPtr osteon_version();
        [DllImport(Library)] static extern IntPtr osteon_last_error();
        [DllImport(Library)] static extern IntPtr osteon_result_text(Result result);
        [DllImport(Library)] public static extern uint osteon_abi();

        [DllImport(Library)] public static extern void osteon_bone_params_default(out BoneParams parameters);
        [DllImport(Library)] public static extern int osteon_bone_params_init(uint abi, out BoneParams parameters);
        [DllImport(Library)] public static extern int osteon_bone_create(uint abi, ref BoneParams parameters, out IntPtr bone);
        [DllImport(Library)] public static extern void osteon_bone_destroy(IntPtr bone);
        [DllImport(Library)] static extern IntPtr osteon_bone_warning(IntPtr bone);
        [DllImport(Library)] public static extern int osteon_bone_info(IntPtr bone, out BoneInfo info);
        [DllImport(Library)] static extern IntPtr osteon_bone_material(IntPtr bone, uint index);
        [DllImport(Library)] public static extern int osteon_bone_material_color(IntPtr bone, uint index, [Out] byte[] rgb);
        [DllImport(Library)] public static extern int osteon_bone_approach(IntPtr bone, double height_m, out Pose pose);

        [DllImport(Library)] public static extern void osteon_tool_params_default(out ToolParams parameters);
        [DllImport(Library)] public static extern int osteon_tool_params_init(uint abi, out ToolParams parameters);
        [DllImport(Library)] public static extern int osteon_tool_create(uint abi, ref ToolParams parameters, out IntPtr tool);
        [DllImport(Library)] public static extern void osteon_tool_destroy(IntPtr tool);
        [DllImport(Library)] public static extern double osteon_tool_spindle_rad_per_s(IntPtr tool);

        [DllImport(Library)] public static extern void osteon_settings_default(out Settings settings);
        [DllImport(Library)] public static extern int osteon_settings_init(uint abi, out Settings settings);
        [DllImport(Library)]
        public static extern int osteon_session_create(uint abi, IntPtr bone, IntPtr tool, ref Settings settings, out IntPtr session);
        [DllImport(Library)] public static extern void osteon_session_destroy(IntPtr session);
        [DllImport(Library)] static extern IntPtr osteon_session_engine(IntPtr session);

        /// <summary>Keep it alive as long as it may be called; it is called from the session's own thread, too.</summary>
        [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
        public delegate void LogCallback(IntPtr user, LogLevel level, IntPtr text);
        [DllImport(Library)] public static extern int osteon_session_set_log(IntPtr session, LogCallback callback, IntPtr user);

        [DllImport(Library)]
        public static extern int osteon_session_set_tool_pose(IntPtr session, ref Pose pose, double spindle_rad_per_s);
        [DllImport(Library)]
        public static extern int osteon_session_step(IntPtr session, ref Pose pose, double spindle_rad_per_s, double dt_s);
        [DllImport(Library)]
        public static extern int osteon_session_evaluate(IntPtr session, ref Pose pose, ref Twist twist, out Wrench wrench);
        [DllImport(Library)] public static extern int osteon_session_figures(IntPtr session, out Figures figures);
        [DllImport(Library)] public static extern int osteon_session_next_event(IntPtr session, out Event happened);
        [DllImport(Library)] public static extern int osteon_session_change_tool(IntPtr session, IntPtr tool, ref Pose pose);

        [DllImport(Library)] public static extern int osteon_compliance_params_init(uint abi, out ComplianceParams parameters);
        [DllImport(Library)]
        public static extern int osteon_session_set_compliance(uint abi, IntPtr session, ref ComplianceParams parameters);
        [DllImport(Library)] public static extern int osteon_session_deflection(IntPtr session, out Deflection deflection);

        [DllImport(Library)] public static extern int osteon_session_mark(IntPtr session);
        [DllImport(Library)] public static extern int osteon_session_undo(IntPtr session, ref Pose pose);
        [DllImport(Library)] public static extern int osteon_session_save(IntPtr session, string file);
        [DllImport(Library)] public static extern int osteon_session_restore(IntPtr session, string file, ref Pose pose);

        [DllImport(Library)]
        public static extern int osteon_session_surface_changes(IntPtr session, ref ulong generation, ref SurfaceBuffers buffers);
        [DllImport(Library)] public static extern int osteon_session_surface_wait(IntPtr session);
        [DllImport(Library)] public static extern int osteon_session_surface_export(IntPtr session, string file, out SurfaceInfo info);

        [DllImport(Library)] public static extern void osteon_plan_params_default(out PlanParams parameters);
        [DllImport(Library)] public static extern int osteon_plan_params_init(uint abi, out PlanParams parameters);
        [DllImport(Library)] public static extern int osteon_plan_create(uint abi, ref PlanParams parameters, out IntPtr plan);
        [DllImport(Library)] public static extern void osteon_plan_destroy(IntPtr plan);
        [DllImport(Library)] public static extern int osteon_plan_info(IntPtr plan, out PlanInfo info);
        [DllImport(Library)] public static extern int osteon_plan_reamer(IntPtr plan, uint index, out Reamer reamer);

        [DllImport(Library)] public static extern void osteon_guidance_params_default(out GuidanceParams parameters);
        [DllImport(Library)] public static extern int osteon_guidance_params_init(uint abi, out GuidanceParams parameters);
        [DllImport(Library)]
        public static extern int osteon_guidance_create(uint abi, IntPtr plan, ref GuidanceParams parameters, out IntPtr guidance);
        [DllImport(Library)] public static extern void osteon_guidance_destroy(IntPtr guidance);
        [DllImport(Library)]
        public static extern int osteon_guidance_evaluate(IntPtr guidance, ref Pose pose, ref Twist twist, ref Wrench other, out GuidanceOutput output);
        [DllImport(Library)] public static extern int osteon_guidance_set_gain(IntPtr guidance, double gain);
        [DllImport(Library)] public static extern int osteon_guidance_set_model_age(IntPtr guidance, double age_s);
        [DllImport(Library)] public static extern int osteon_guidance_reset(IntPtr guidance);

        [DllImport(Library)]
        public static extern int osteon_session_assess(IntPtr session, IntPtr plan, out Assessment assessment, [Out] ScoreItem[] items,
                                                       UIntPtr item_capacity, out UIntPtr item_count);

        public static string Version => Marshal.PtrToStringAnsi(osteon_version());
        /// <summary>Meaning of a result, in a few words.</summary>
        public static string TextOf(Result result) => Marshal.PtrToStringAnsi(osteon_result_text(result));
        /// <summary>What was assumed to make a solid of a bone's mesh; empty: nothing.</summary>
        public static string WarningOf(IntPtr bone) => Marshal.PtrToStringAnsi(osteon_bone_warning(bone));
        /// <summary>Name of a tissue; null where there is no such index.</summary>
        public static string MaterialOf(IntPtr bone, uint index) => Marshal.PtrToStringAnsi(osteon_bone_material(bone, index));
        /// <summary>What computes a session's frames.</summary>
        public static string EngineOf(IntPtr session) => Marshal.PtrToStringAnsi(osteon_session_engine(session));

        /// <summary>Throws the library's text where a call was refused.</summary>
        public static void Check(int result)
        {
            if (result < 0) Refuse();
        }

        static void Refuse()
        {
            throw new InvalidOperationException("osteon: " + Marshal.PtrToStringAnsi(osteon_last_error()));
        }
    }
}
