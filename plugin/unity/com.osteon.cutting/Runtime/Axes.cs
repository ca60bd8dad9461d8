namespace Osteon
{
    /// <summary>
    /// Between Unity's axes (left-handed, +y up, metres) and Osteon's (right-handed, +z up, metres). Both swap y and z,
    /// which mirrors: a rotation keeps its axis with y and z swapped and turns the other way, a triangle is turned over.
    /// </summary>
    public static class Axes
    {
        /// <summary>A place or a direction, either way.</summary>
        public static void Swap(double x, double y, double z, out double x2, out double y2, out double z2)
        {
            x2 = x;
            y2 = z;
            z2 = y;
        }

        /// <summary>A quaternion, either way.</summary>
        public static void SwapRotation(double w, double x, double y, double z, out double w2, out double x2, out double y2, out double z2)
        {
            w2 = w;
            x2 = -x;
            y2 = -z;
            z2 = -y;
        }

        /// <summary>A place, a direction, a velocity or a force, either way.</summary>
        public static Native.Triple Swap(Native.Triple v) => new Native.Triple(v.x, v.z, v.y);

        /// <summary>A torque or an angular velocity, either way: an axis of rotation, mirrored, turns the other way.</summary>
        public static Native.Triple SwapAxial(Native.Triple v) => new Native.Triple(-v.x, -v.z, -v.y);

        /// <summary>What has no sign along an axis, such as a stiffness, either way.</summary>
        public static Native.Triple SwapEach(Native.Triple v) => new Native.Triple(v.x, v.z, v.y);

        public static Native.Pose Swap(Native.Pose pose)
        {
            Native.Pose swapped;
            swapped.position_m = Swap(pose.position_m);
            SwapRotation(pose.w, pose.x, pose.y, pose.z, out swapped.w, out swapped.x, out swapped.y, out swapped.z);
            return swapped;
        }

        /// <summary>position x y z [m], rotation w x y z in Unity's axes, to Osteon's.</summary>
        public static Native.Pose ToOsteon(double[] pose)
        {
            Native.Pose X;
            X.position_m = new Native.Triple(pose[0], pose[2], pose[1]);
            SwapRotation(pose[3], pose[4], pose[5], pose[6], out X.w, out X.x, out X.y, out X.z);
            return X;
        }

        public static double[] FromOsteon(Native.Pose X)
        {
            var swapped = Swap(X);
            var p = swapped.position_m;
            return new[] { p.x, p.y, p.z, swapped.w, swapped.x, swapped.y, swapped.z };
        }

        /// <summary>linear x y z [m/s], angular x y z [rad/s] in Unity's axes, to Osteon's. Null: rest.</summary>
        public static Native.Twist TwistToOsteon(double[] twist)
        {
            var V = new Native.Twist();
            if (twist == null) return V;
            V.linear_m_per_s = new Native.Triple(twist[0], twist[2], twist[1]);
            V.angular_rad_per_s = new Native.Triple(-twist[3], -twist[5], -twist[4]);
            return V;
        }

        /// <summary>Null: none.</summary>
        public static Native.Wrench WrenchToOsteon(double[] force_N, double[] torque_Nm)
        {
            var F = new Native.Wrench();
            if (force_N != null) Swap(force_N[0], force_N[1], force_N[2], out F.fx_N, out F.fy_N, out F.fz_N);
            if (torque_Nm != null) Swap(-torque_Nm[0], -torque_Nm[1], -torque_Nm[2], out F.tx_Nm, out F.ty_Nm, out F.tz_Nm);
            return F;
        }

        public static void WrenchFromOsteon(Native.Wrench F, double[] force_N, double[] torque_Nm)
        {
            Swap(F.fx_N, F.fy_N, F.fz_N, out force_N[0], out force_N[1], out force_N[2]);
            Swap(-F.tx_Nm, -F.ty_Nm, -F.tz_Nm, out torque_Nm[0], out torque_Nm[1], out torque_Nm[2]);
        }
    }
}
