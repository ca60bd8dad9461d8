using System;

namespace Osteon
{
    /// <summary>A surgical plan: where the cup goes, with which reamers, how a hand is guided, and what scores. Places are in
    /// Unity's axes, in the bone's frame.</summary>
    public sealed class Plan : IDisposable
    {
        internal IntPtr Handle;

        /// <param name="plan">name of a shipped plan, or its YAML file; null: "acetabulum"</param>
        /// <param name="rubric">likewise; null: by the plan's kind</param>
        /// <param name="configFolder">null: that of the installation</param>
        public Plan(string plan = null, string rubric = null, string configFolder = null)
        {
            var parameters = new Native.PlanParams { plan = plan, rubric = rubric, config_folder = configFolder };
            Native.Check(Native.osteon_plan_create(Native.Abi, ref parameters, out Handle));
        }

        public void Dispose()
        {
            Native.osteon_plan_destroy(Handle);
            Handle = IntPtr.Zero;
        }

        public Native.PlanInfo Info
        {
            get
            {
                Native.PlanInfo info;
                Native.Check(Native.osteon_plan_info(Handle, out info));
                info.cup_center_m = Axes.Swap(info.cup_center_m);
                info.cup_axis = Axes.Swap(info.cup_axis);
                info.native_center_m = Axes.Swap(info.native_center_m);
                return info;
            }
        }

        /// <summary>A reamer of the plan's sequence, by its index from 0.</summary>
        public Native.Reamer Reamer(uint index)
        {
            Native.Reamer reamer;
            Native.Check(Native.osteon_plan_reamer(Handle, index, out reamer));
            reamer.center_m = Axes.Swap(reamer.center_m);
            reamer.apex_m = Axes.Swap(reamer.apex_m);
            return reamer;
        }
    }

    /// <summary>What holds a hand to a plan with one of its reamers: a funnel, a cone of tilt and a depth. One thread at a
    /// time; wait-free but for making and disposing of it.</summary>
    public sealed class Guidance : IDisposable
    {
        IntPtr guidance;

        public Guidance(Plan plan) : this(plan, Defaults()) {}

        public Guidance(Plan plan, Native.GuidanceParams parameters)
        {
            Native.Check(Native.osteon_guidance_create(Native.Abi, plan.Handle, ref parameters, out guidance));
        }

        public void Dispose()
        {
            Native.osteon_guidance_destroy(guidance);
            guidance = IntPtr.Zero;
        }

        /// <summary>The first reamer, the plan's own gain, 200 N, 20 N m, 0.25 m/s, 1 ms.</summary>
        public static Native.GuidanceParams Defaults()
        {
            Native.GuidanceParams parameters;
            Native.Check(Native.osteon_guidance_params_init(Native.Abi, out parameters));
            return parameters;
        }

        /// <summary>The guidance to add to the other wrench, once in each period. No garbage.</summary>
        /// <param name="twist">as for Session.Evaluate; null: rest</param>
        /// <param name="otherForce_N">what is rendered beside it and comes first, with otherTorque_Nm; null: none</param>
        /// <returns>distances, share and flags; its wrench is in Osteon's axes</returns>
        public Native.GuidanceOutput Evaluate(double[] pose, double[] twist, double[] otherForce_N, double[] otherTorque_Nm,
                                              double[] force_N, double[] torque_Nm)
        {
            var X = Axes.ToOsteon(pose);
            var V = Axes.TwistToOsteon(twist);
            var other = Axes.WrenchToOsteon(otherForce_N, otherTorque_Nm);
            Native.GuidanceOutput output;
            Native.Check(Native.osteon_guidance_evaluate(guidance, ref X, ref V, ref other, out output));
            Axes.WrenchFromOsteon(output.wrench, force_N, torque_Nm);
            return output;
        }

        /// <summary>Sets the gain, 0 … 1.</summary>
        public void SetGain(double gain) => Native.Check(Native.osteon_guidance_set_gain(guidance, gain));

        /// <summary>Age of the contact model that the other wrench is made of: from 20 ms on the guidance fades.</summary>
        public void SetModelAge(double age_s) => Native.Check(Native.osteon_guidance_set_model_age(guidance, age_s));

        /// <summary>Begins anew, after a change of tool or a jump of the pose.</summary>
        public void Reset() => Native.Check(Native.osteon_guidance_reset(guidance));
    }
}
