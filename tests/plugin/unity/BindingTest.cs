// Drives the package's binding by P/Invoke: reams the cup, follows the mesh, tries the axes. Exit code 1: a check failed.
using System;
using System.Collections.Generic;
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
    static double[] Turn(double w, double x, double y, double z, double[] v)
    {
        var t = new[] { 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0]) };
        return new[]
        {
            v[0] + w * t[0] + y * t[2] - z * t[1], v[1] + w * t[1] + z * t[0] - x * t[2], v[2] + w * t[2] + x * t[1] - y * t[0]
        };
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
            var turned = Turn(q[0], q[1], q[2], q[3], v);
            double w2, x2, y2, z2;
            Axes.SwapRotation(q[0], q[1], q[2], q[3], out w2, out x2, out y2, out z2);
            var other = Turn(w2, x2, y2, z2, new[] { v[0], v[2], v[1] });
            Expect(Math.Abs(other[0] - turned[0]) + Math.Abs(other[1] - turned[2]) + Math.Abs(other[2] - turned[1]) < 1e-12,
                   "a turned vector, swapped, is the swapped vector turned");
            double w, x, y, z;
            Axes.SwapRotation(w2, x2, y2, z2, out w, out x, out y, out z);
            Expect(w == q[0] && x == q[1] && y == q[2] && z == q[3], "a rotation there and back is the same");
            Axes.Swap(v[0], v[1], v[2], out x2, out y2, out z2);
            Axes.Swap(x2, y2, z2, out x, out y, out z);
            Expect(x == v[0] && y == v[1] && z == v[2], "a place there and back is the same");
        }
    }

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

    static void Main(string[] arguments)
    {
        Console.WriteLine("osteon " + Native.Version);
        Expect(Native.osteon_abi() == Native.Abi, "the binding is of this ABI");
        AxesMirrorRotations();
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
            // each axis: the tool that moves along it is found there
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
