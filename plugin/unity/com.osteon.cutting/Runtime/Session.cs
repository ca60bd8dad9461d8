using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Osteon
{
    /// <summary>A bone that is cut by a tool. Poses, velocities and wrenches are in Unity's axes, in the bone's frame.</summary>
    public sealed class Session : IDisposable
    {
        readonly string configFolder;
        IntPtr bone, tool, session;
        GCHandle logHandle;

        /// <summary>The changed bricks, after TakeBricks.</summary>
        public Surface Surface { get; private set; }

        /// <param name="scene">a shipped scene, such as "acetabulum"</param>
        /// <param name="toolName">a shipped tool, such as "reamer"</param>
        /// <param name="diameter_m">0: the tool's usual one</param>
        /// <param name="lockstep">frames are computed by Step alone, the same in every run</param>
        /// <param name="configFolder">null: that of the installation</param>
        public Session(string scene, string toolName, double diameter_m, bool lockstep, string configFolder, double maxForce_N = 200.0)
        {
            this.configFolder = configFolder;
            try
            {
                var boneParams = new Native.BoneParams { scene = scene, config_folder = configFolder };
                Native.Check(Native.osteon_bone_create(Native.Abi, ref boneParams, out bone));
                tool = CreateTool(toolName, diameter_m);
                Native.Settings settings;
                Native.Check(Native.osteon_settings_init(Native.Abi, out settings));
                settings.lockstep = lockstep ? 1u : 0u;
                settings.max_force_N = maxForce_N;
                Native.Check(Native.osteon_session_create(Native.Abi, bone, tool, ref settings, out session));
                Surface = new Surface(bone);
            }
            catch
            {
                Dispose();
                throw;
            }
        }

        public void Dispose()
        {
            Native.osteon_session_destroy(session);
            Native.osteon_tool_destroy(tool);
            Native.osteon_bone_destroy(bone);
            session = tool = bone = IntPtr.Zero;
            if (Surface != null) Surface.Dispose();
            if (logHandle.IsAllocated) logHandle.Free();
        }

        /// <summary>The tool's usual spindle speed [rad/s].</summary>
        public double Spindle => Native.osteon_tool_spindle_rad_per_s(tool);

        /// <summary>What computes the frames, such as "cpu on one thread, AVX-512 (…)".</summary>
        public string Engine => Native.EngineOf(session);

        /// <summary>What was assumed to make a solid of the bone's mesh; empty: nothing. Show it to a person.</summary>
        public string BoneWarning => Native.WarningOf(bone);

        /// <summary>Names of the tissues, by the index in Brick.Materials.</summary>
        public string[] Materials
        {
            get
            {
                var names = new List<string>();
                for (var name = Native.MaterialOf(bone, 0); name != null; name = Native.MaterialOf(bone, (uint)names.Count)) names.Add(name);
                return names.ToArray();
            }
        }

        /// <summary>A pose that points into the site, its apex height_m above the site's centre: position x y z [m],
        /// rotation w x y z.</summary>
        public double[] Approach(double height_m)
        {
            Native.Pose pose;
            Native.Check(Native.osteon_bone_approach(bone, height_m, out pose));
            return Axes.FromOsteon(pose);
        }

        /// <summary>Where the tool is; not in lockstep. Wait-free, no garbage.</summary>
        public void SetToolPose(double[] pose, double spindle_rad_per_s)
        {
            var X = Axes.ToOsteon(pose);
            Native.Check(Native.osteon_session_set_tool_pose(session, ref X, spindle_rad_per_s));
        }

        /// <summary>Lockstep: one frame.</summary>
        public void Step(double[] pose, double spindle_rad_per_s, double dt_s)
        {
            var X = Axes.ToOsteon(pose);
            Native.Check(Native.osteon_session_step(session, ref X, spindle_rad_per_s, dt_s));
        }

        /// <summary>The force [N] and the torque [N m] that the hand should feel at this pose, at rest. Wait-free.</summary>
        public void Evaluate(double[] pose, double[] force_N, double[] torque_Nm) => Evaluate(pose, null, force_N, torque_Nm);

        /// <summary>… with a tool that moves: the coupling's damping counts. Wait-free, no garbage.</summary>
        /// <param name="twist">of the apex: linear x y z [m/s], angular x y z [rad/s]; null: rest</param>
        public void Evaluate(double[] pose, double[] twist, double[] force_N, double[] torque_Nm)
        {
            var X = Axes.ToOsteon(pose);
            var V = Axes.TwistToOsteon(twist);
            Native.Wrench F;
            Native.Check(Native.osteon_session_evaluate(session, ref X, ref V, out F));
            Axes.WrenchFromOsteon(F, force_N, torque_Nm);
        }

        /// <summary>The newest frame's figures, in Osteon's axes.</summary>
        public Native.Figures Figures
        {
            get
            {
                Native.Figures figures;
                Native.Check(Native.osteon_session_figures(session, out figures));
                return figures;
            }
        }

        /// <summary>Takes the oldest event of the scene that was not taken; its place is in Unity's axes.</summary>
        /// <returns>false: none waits</returns>
        public bool NextEvent(out Native.Event happened)
        {
            var result = Native.osteon_session_next_event(session, out happened);
            Native.Check(result);
            happened.position_m = Axes.Swap(happened.position_m);
            return result == 0;
        }

        /// <summary>Another tool from now on, at a pose that is free of bone; where it is refused the earlier one stays.</summary>
        public void ChangeTool(string toolName, double diameter_m, double[] pose)
        {
            var other = CreateTool(toolName, diameter_m);
            var X = Axes.ToOsteon(pose);
            var result = Native.osteon_session_change_tool(session, other, ref X);
            if (result == 0)
            {
                var earlier = tool;
                tool = other;
                other = earlier;
            }
            Native.osteon_tool_destroy(other); // leaves the text of a refusal
            Native.Check(result);
        }

        /// <summary>All off; 1 ms, 60 N, 0.1 mm; a mount of 12 kg and 10 Hz.</summary>
        public static Native.ComplianceParams DefaultCompliance()
        {
            Native.ComplianceParams parameters;
            Native.Check(Native.osteon_compliance_params_init(Native.Abi, out parameters));
            return SwapAxes(parameters);
        }

        /// <summary>What gives way from the next Evaluate on: tool, layer, mount. Points and triples are along Unity's axes.</summary>
        public void SetCompliance(Native.ComplianceParams parameters)
        {
            var swapped = SwapAxes(parameters);
            Native.Check(Native.osteon_session_set_compliance(Native.Abi, session, ref swapped));
        }

        /// <summary>Displacements after the newest Evaluate, in Unity's axes; draw the bone at `bone`.</summary>
        public Native.Deflection Deflection
        {
            get
            {
                Native.Deflection found;
                Native.Check(Native.osteon_session_deflection(session, out found));
                found.head = Axes.Swap(found.head);
                found.bone = Axes.Swap(found.bone);
                found.bend_m = Axes.Swap(found.bend_m);
                found.bend_rad = Axes.SwapAxial(found.bend_rad);
                found.layer_m = Axes.Swap(found.layer_m);
                found.mount_m = Axes.Swap(found.mount_m);
                found.mount_rad = Axes.SwapAxial(found.mount_rad);
                found.mount_m_per_s = Axes.Swap(found.mount_m_per_s);
                found.mount_rad_per_s = Axes.SwapAxial(found.mount_rad_per_s);
                return found;
            }
        }

        /// <summary>Remembers the bone for Undo.</summary>
        public void Mark() => Native.Check(Native.osteon_session_mark(session));

        /// <summary>Returns to the last mark; the tool must be free of the bone that comes back.</summary>
        public void Undo(double[] pose)
        {
            var X = Axes.ToOsteon(pose);
            Native.Check(Native.osteon_session_undo(session, ref X));
        }

        /// <summary>Saves the carved bone.</summary>
        public void Save(string file) => Native.Check(Native.osteon_session_save(session, file));

        /// <summary>Returns to a saved bone; the tool must be free of it.</summary>
        public void Restore(string file, double[] pose)
        {
            var X = Axes.ToOsteon(pose);
            Native.Check(Native.osteon_session_restore(session, file, ref X));
        }

        /// <summary>Writes the carved bone as one mesh in millimetres, in Osteon's axes: .stl, .ply or .obj.</summary>
        public Native.SurfaceInfo ExportSurface(string file)
        {
            Native.SurfaceInfo info;
            Native.Check(Native.osteon_session_surface_export(session, file, out info));
            return info;
        }

        /// <summary>Measures the bone as it is, beside a plan of it; takes about 0.1 s. The found centre is in Unity's axes.</summary>
        /// <returns>the rows of the score</returns>
        public Native.ScoreItem[] Assess(Plan plan, out Native.Assessment assessment)
        {
            var items = new Native.ScoreItem[64];
            UIntPtr count;
            Native.Check(Native.osteon_session_assess(session, plan.Handle, out assessment, items, (UIntPtr)items.Length, out count));
            assessment.center_m = Axes.Swap(assessment.center_m);
            Array.Resize(ref items, (int)count);
            return items;
        }

        /// <summary>Tells `told` what happens in the session; null: nobody. It is called from the session's own thread, too,
        /// and must call nothing of this session.</summary>
        public void SetLog(Action<Native.LogLevel, string> told)
        {
            var earlier = logHandle;
            logHandle = told == null ? new GCHandle() : GCHandle.Alloc(told);
            var user = told == null ? IntPtr.Zero : GCHandle.ToIntPtr(logHandle);
            Native.Check(Native.osteon_session_set_log(session, told == null ? null : Tell, user));
            if (earlier.IsAllocated) earlier.Free(); // the library calls it no more
        }

        /// <summary>Waits until all frames so far are in the surface.</summary>
        public void WaitForSurface() => Native.Check(Native.osteon_session_surface_wait(session));

        /// <summary>Fills Surface with bricks that changed since the last call, at most one buffer of them. No garbage.</summary>
        /// <returns>how many; Surface.Left are left</returns>
        public int TakeBricks()
        {
            Surface.Take(session);
            return Surface.Count;
        }

        /// <summary>Adds copies of the bricks that changed since the last call, at most one buffer of them.</summary>
        /// <returns>whether more are left</returns>
        public bool SurfaceChanges(List<Brick> changed)
        {
            TakeBricks();
            Surface.CopyTo(changed);
            return Surface.Left > 0;
        }

        static readonly Native.LogCallback Tell = TellUser; // alive for ever

        [MonoPInvokeCallback(typeof(Native.LogCallback))]
        static void TellUser(IntPtr user, Native.LogLevel level, IntPtr text)
        {
            try
            {
                ((Action<Native.LogLevel, string>)GCHandle.FromIntPtr(user).Target)(level, Marshal.PtrToStringAnsi(text));
            }
            catch (Exception)
            {
                // no exception crosses the library's border
            }
        }

        IntPtr CreateTool(string toolName, double diameter_m)
        {
            IntPtr made;
            var parameters = new Native.ToolParams { name = toolName, diameter_m = diameter_m, config_folder = configFolder };
            Native.Check(Native.osteon_tool_create(Native.Abi, ref parameters, out made));
            return made;
        }

        static Native.ComplianceParams SwapAxes(Native.ComplianceParams parameters)
        {
            parameters.mount_point_m = Axes.Swap(parameters.mount_point_m);
            parameters.mount_inertia_kg_m2 = Axes.SwapEach(parameters.mount_inertia_kg_m2);
            parameters.mount_stiffness_N_per_m = Axes.SwapEach(parameters.mount_stiffness_N_per_m);
            parameters.mount_stiffness_Nm_per_rad = Axes.SwapEach(parameters.mount_stiffness_Nm_per_rad);
            return parameters;
        }
    }

    /// <summary>Ahead-of-time compilers look for it by its name.</summary>
    [AttributeUsage(AttributeTargets.Method)]
    sealed class MonoPInvokeCallbackAttribute : Attribute
    {
        public MonoPInvokeCallbackAttribute(Type type) {}
    }
}
