// Tests the package's binding by P/Invoke: reams the cup, follows the mesh, and checks axes and structs. Exit code 1: a check
// failed.
using System;
using System.Collections.Generic;
using System.IO;
using System.Runtime.InteropServices;
using Osteon;

static class BindingTest
{
    static void Expect(bool good, string what)
    {
        if (good) return;
        Console.WriteLine("failed: " + what);
        Environment.Exit(1);
    }

    /// Turns a vector by a quaternion w x y z, as both Unity and Osteon do.
    static double[] TurnVector(double w, double x, double y, double z, double[] v)
    {
        var t = new[] { 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0]) };
        return new[]
        {
            v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]
        };
    }

    static double[] Cross(double[] a, double[] b)
    {
        return new[] { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
    }

    static void AxesMirrorRotations()
    {
        var random = new Random(5);
        for (var i = 0; i < 100; ++i)
        {
            var q = new double[4];
            var norm = 0.0;
            for (var k = 0; k < 4; ++k)
            {
                q[k] = random.NextDouble() - 0.5;
                norm += q[k] * q[k];
            }
            for (var k = 0; k < 4; ++k) q[k] /= Math.Sqrt(norm);
            var v = new[] { random.NextDouble(), random.NextDouble(), random.NextDouble() };
            var turned = TurnVector(q[0], q[1], q[2], q[3], v);
            double w2, x2, y2, z2;
            Axes.SwapRotation(q[0], q[1], q[2], q[3], out w2, out x2, out y2, out z2);
            var other = TurnVector(w2, x2, y2, z2, new[] { v[0], v[2], v[1] });
            Expect(Math.Abs(other[0] - turned[0]) + Math.Abs(other[1] - turned[2]) + Math.Abs(other[2] - turned[1]) < 1e-12,
                   "a turned vector, swapped, is the swapped vector turned");
            double w, x, y, z;
            Axes.SwapRotation(w2, x2, y2, z2, out w, out x, out y, out z);
            Expect(w == q[0] && x == q[1] && y == q[2] && z == q[3], "a rotation there and back is the same");
            // a turning tool's velocity at r, computed as angular × r in either axes, is the same
            var twist = Axes.TwistToOsteon(new[] { v[0], v[1], v[2], q[0], q[1], q[2] });
            var angular = twist.angular_rad_per_s;
            double[] r = { 0.3, -0.2, 0.7 };
            var at = Cross(new[] { q[0], q[1], q[2] }, r);
            var atOther = Cross(new[] { angular.x, angular.y, angular.z }, new[] { r[0], r[2], r[1] });
            Expect(Math.Abs(at[0] - atOther[0]) + Math.Abs(at[2] - atOther[1]) + Math.Abs(at[1] - atOther[2]) < 1e-12,
                   "an angular velocity");
            Expect(twist.linear_m_per_s.x == v[0] && twist.linear_m_per_s.y == v[2] && twist.linear_m_per_s.z == v[1], "a velocity");
            Axes.Swap(v[0], v[1], v[2], out x2, out y2, out z2);
            Axes.Swap(x2, y2, z2, out x, out y, out z);
            Expect(x == v[0] && y == v[1] && z == v[2], "a place there and back is the same");
        }
    }

    /// Updates `bricks` by the changed ones. Returns the number of all triangles.
    static long Triangles(Session session, Dictionary<uint, Brick> bricks)
    {
        session.WaitForSurface();
        var changed = new List<Brick>();
        while (session.SurfaceChanges(changed)) {}
        foreach (var brick in changed) bricks[brick.Number] = brick;
        long count = 0;
        foreach (var brick in bricks.Values) count += brick.Triangles.Length / 3;
        return count;
    }

    /// Clockwise from outside, as Unity shows it: in its left-handed axes the cross product then points outward.
    static void TrianglesFaceOutward(IEnumerable<Brick> bricks)
    {
        long good = 0, all = 0;
        foreach (var brick in bricks)
            for (var i = 0; i + 2 < brick.Triangles.Length; i += 3)
            {
                int a = 3 * brick.Triangles[i], b = 3 * brick.Triangles[i + 1], c = 3 * brick.Triangles[i + 2];
                var p = brick.Positions;
                double ux = p[b] - p[a], uy = p[b + 1] - p[a + 1], uz = p[b + 2] - p[a + 2];
                double vx = p[c] - p[a], vy = p[c + 1] - p[a + 1], vz = p[c + 2] - p[a + 2];
                var along = (uy * vz - uz * vy) * brick.Normals[a] + (uz * vx - ux * vz) * brick.Normals[a + 1] +
                            (ux * vy - uy * vx) * brick.Normals[a + 2];
                good += along > 0 ? 1 : 0;
                ++all;
            }
        Expect(all > 1000 && good > 0.98 * all, "triangles face outward: " + good + " of " + all);
    }

    /// Native has each struct of the C header, with its size in bytes; an enum has that of an int.
    static void StructsHaveTheHeadersSizes(string file)
    {
        var count = 0;
        foreach (var line in File.ReadAllLines(file))
        {
            var words = line.Split(' ');
            var name = words[0].Substring("Osteon".Length);
            var type = typeof(Native).GetNestedType(name);
            Expect(type != null, "Native has no " + name);
            var size = type.IsEnum ? Marshal.SizeOf(Enum.GetUnderlyingType(type)) : Marshal.SizeOf(type);
            Expect(size == int.Parse(words[1]), name + ": found " + size + " bytes, accepted " + words[1]);
            ++count;
        }
        Expect(count > 20, "the list of structs: " + count);
    }

    /// Presses the tool into the cup for 0.3 s. Returns the last force [N].
    static double[] Press(Session session, double height_m)
    {
        double[] force = new double[3], torque = new double[3];
        session.Step(session.Approach(0.0), 0.0, 0.001);
        var pose = session.Approach(height_m);
        for (var ms = 0; ms < 300; ++ms)
        {
            session.Step(pose, 0.0, 0.001);
            session.Evaluate(pose, force, torque);
        }
        return force;
    }

    static void VelocityAndMountAreFelt(string config)
    {
        using (var session = new Session("acetabulum", "reamer", 0.0, true, config))
        {
            var levels = Session.DefaultCompliance();
            levels.mount = 1;
            levels.mount_point_m = new Native.Triple(0.0, -0.02, 0.0);
            session.SetCompliance(levels);
            var rest = Press(session, -0.0195);
            var moved = session.Deflection;
            Expect(moved.gives_way == 1 && moved.mount_m.y < -2e-5, "the bone is pushed down its mount, along -y: " + moved.mount_m.y);
            Expect(Math.Abs(moved.bone.position_m.y - moved.mount_m.y) < 1e-4, "it is drawn where it has gone");
            double[] force = new double[3], torque = new double[3];
            session.Evaluate(session.Approach(-0.0195), new[] { 0.0, -0.05, 0.0, 0.0, 0.0, 0.0 }, force, torque);
            Expect(force[1] > rest[1] + 1.0, "a tool that moves into the bone is damped: " + rest[1] + " N, then " + force[1] + " N");
            session.SetCompliance(Session.DefaultCompliance());
            Expect(session.Deflection.gives_way == 0, "all off");
        }
    }

    static void ToolsFilesAndLog(string config, string folder)
    {
        using (var session = new Session("acetabulum", "reamer", 0.0, true, config))
        {
            var told = new List<string>();
            session.SetLog((level, text) => told.Add(level + " " + text));
            Expect(told.Count == 1 && told[0].Contains("cpu"), "the log is told the engine");
            var free = session.Approach(0.0);
            session.Step(free, 0.0, 0.001);
            session.Save(folder + "/kept.osp");
            session.ChangeTool("reamer", 0.048, free);
            Expect(told.Count == 2, "the log is told of another tool");
            session.SetLog(null);
            session.Restore(folder + "/kept.osp", free);
            Expect(told.Count == 2, "nobody is told any more");
            Expect(session.ExportSurface(folder + "/bone.stl").watertight == 1, "a watertight mesh");
            Expect(session.Engine.Contains("cpu") && session.BoneWarning == "" && session.Materials.Length > 1, "what the session says of itself");
            Expect(Native.TextOf(Native.Result.State).Length > 5, "a result's text");
            using (var plan = new Plan(null, null, config))
            {
                Native.Assessment assessment;
                var items = session.Assess(plan, out assessment);
                Expect(items.Length > 3 && items[0].Metric == "axis_error" && items[0].Unit == "deg", "rows of the score");
                Expect(assessment.removed_m3 == 0.0, "nothing is removed");
            }
        }
        using (var session = new Session("molar", "round_burr", 0.0, true, config))
        {
            Native.Event happened;
            Expect(!session.NextEvent(out happened), "no event waits");
            var names = "";
            for (var height_m = 3e-3; height_m > -12e-3 && names == ""; height_m -= 4e-6)
            {
                session.Step(session.Approach(height_m), session.Spindle, 0.002);
                while (session.NextEvent(out happened)) names += happened.Name + " ";
            }
            Expect(names.Contains("pulp reached"), "the burr comes to the pulp: " + names);
        }
    }

    static void PlanGuides(string config)
    {
        using (var plan = new Plan(null, null, config))
        using (var guidance = new Guidance(plan))
        {
            var info = plan.Info;
            Expect(info.reamer_count == 4, "four reamers");
            var axis = info.cup_axis;
            var apex = plan.Reamer(0).apex_m;
            // half a turn about the axis halfway between the feed and Unity's +y: the feed then points into the cup
            double hx = -axis.x, hy = 1.0 - axis.y, hz = -axis.z, length = Math.Sqrt(hx * hx + hy * hy + hz * hz);
            double[] force = new double[3], torque = new double[3];
            var output = new Native.GuidanceOutput();
            for (var i = 0; i <= 400; ++i)
            {
                var height = 1e-3 - 1e-5 * i;
                var pose = new[]
                {
                    apex.x + height * axis.x, apex.y + height * axis.y, apex.z + height * axis.z, 0.0, hx / length, hy / length, hz / length
                };
                output = guidance.Evaluate(pose, new[] { -0.01 * axis.x, -0.01 * axis.y, -0.01 * axis.z, 0, 0, 0 }, null, null, force, torque);
            }
            Expect(Math.Abs(output.depth_m - 0.003) < 5e-5, "deeper than planned: " + output.depth_m);
            Expect(force[0] * axis.x + force[1] * axis.y + force[2] * axis.z > 20.0, "pushed out of the cup, in Unity's axes");
            guidance.SetModelAge(0.1);
            guidance.SetGain(0.5);
            guidance.Reset();
        }
    }

    /// A device's loop and a frame's call make no garbage: half a million times an object of 24 bytes would be three
    /// collections of mono's nursery.
    static void LoopsMakeNoGarbage(string config)
    {
        using (var session = new Session("thin_plate", "twist_drill", 0.0, false, config))
        using (var plan = new Plan(null, null, config))
        using (var guidance = new Guidance(plan))
        {
            double[] pose = session.Approach(0.1), twist = new double[6], force = new double[3], torque = new double[3];
            Action device = () =>
            {
                session.SetToolPose(pose, 0.0);
                session.Evaluate(pose, twist, force, torque);
                guidance.Evaluate(pose, twist, force, torque, force, torque);
            };
            device();
            session.WaitForSurface();
            while (session.TakeBricks() > 0) {}
            GC.Collect();
            var before = GC.CollectionCount(0);
            for (var i = 0; i < 500000; ++i) device();
            Expect(GC.CollectionCount(0) == before, "a device's loop makes garbage: " + (GC.CollectionCount(0) - before) + " collections");
            for (var i = 0; i < 200000; ++i) session.TakeBricks();
            Expect(GC.CollectionCount(0) == before, "TakeBricks makes garbage");
            Native.Event happened;
            for (var i = 0; i < 200000; ++i) session.NextEvent(out happened);
            Expect(GC.CollectionCount(0) == before, "NextEvent makes garbage");
        }
    }

    static void Main(string[] arguments)
    {
        Console.WriteLine("osteon " + Native.Version);
        Expect(Native.osteon_abi() == Native.Abi, "the binding is of this ABI");
        AxesMirrorRotations();
        StructsHaveTheHeadersSizes(arguments[1]);
        VelocityAndMountAreFelt(arguments[0]);
        ToolsFilesAndLog(arguments[0], arguments[2]);
        PlanGuides(arguments[0]);
        LoopsMakeNoGarbage(arguments[0]);
        using (var session = new Session("acetabulum", "reamer", 0.0, true, arguments[0]))
        {
            var up = session.Approach(0.1);
            Expect(Math.Abs(up[1] - 0.1) < 1e-12 && Math.Abs(up[0]) + Math.Abs(up[2]) < 1e-12, "the cup opens along Unity's +y");
            var bricks = new Dictionary<uint, Brick>();
            session.Step(session.Approach(0.0), session.Spindle, 0.001);
            var uncut = Triangles(session, bricks);
            double largest_N = 0.0;
            double[] force = new double[3], torque = new double[3];
            for (var ms = 0; ms < 4000; ++ms)
            {
                var pose = session.Approach(-0.017 - 0.002e-3 * ms);
                session.Step(pose, session.Spindle, 0.001);
                session.Evaluate(pose, force, torque);
                if (force[1] > largest_N) largest_N = force[1];
            }
            var cut = Triangles(session, bricks);
            var removed_mm3 = 1e9 * session.Figures.removed_volume_m3;
            Console.WriteLine("up to {0:F1} N along +y, {1:F0} mm3, {2} triangles, then {3}", largest_N, removed_mm3, uncut, cut);
            Expect(largest_N > 10.0, "the bone pushes the reamer out, along +y");
            Expect(removed_mm3 > 100.0 && cut != uncut, "bone is removed, and the mesh follows");
            TrianglesFaceOutward(bricks.Values);
            var colors = new HashSet<int>();
            foreach (var brick in bricks.Values)
                for (var i = 0; i + 2 < brick.Colors.Length; i += 3)
                    colors.Add(brick.Colors[i] << 16 | brick.Colors[i + 1] << 8 | brick.Colors[i + 2]);
            Expect(colors.Count >= 2 && colors.Count < 20, "tissues have colours of their own: " + colors.Count);
            // the proxy follows a tool along each axis
            for (var axis = 0; axis < 3; ++axis)
            {
                var free = session.Approach(0.1);
                session.Step(free, 0.0, 0.001);
                for (var i = 0; i < 400; ++i) session.Step(free, 0.0, 0.001);
                free[axis] += 0.001;
                for (var i = 0; i < 20; ++i) session.Step(free, 0.0, 0.001);
                var proxy = session.Figures.proxy_position_m;
                var there = new[] { proxy[0], proxy[2], proxy[1] };
                Expect(Math.Abs(there[axis] - free[axis]) < 1e-9, "axis " + axis);
            }
        }
        try
        {
            new Session("no_such_scene", "reamer", 0.0, true, arguments[0]).Dispose();
            Expect(false, "a scene that is missing is refused");
        }
        catch (InvalidOperationException error)
        {
            Expect(error.Message.Contains("no_such_scene"), "the refusal names the scene");
        }
        Console.WriteLine("all checks hold");
    }
}
