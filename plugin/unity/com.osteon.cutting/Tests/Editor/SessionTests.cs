using System;
using NUnit.Framework;

namespace Osteon.Tests
{
    public sealed class SessionTests
    {
        [Test]
        public void LibraryIsOfTheBindingsAbi() => Assert.AreEqual(Native.Abi, Native.osteon_abi());

        [Test]
        public void BonePushesTheReamerOutAlongPlusY()
        {
            using (var session = new Session("acetabulum", "reamer", 0.0, true, null))
            {
                double[] force = new double[3], torque = new double[3];
                session.Step(session.Approach(0.0), 0.0, 0.001);
                var pose = session.Approach(-0.0195);
                for (var ms = 0; ms < 200; ++ms)
                {
                    session.Step(pose, 0.0, 0.001);
                    session.Evaluate(pose, force, torque);
                }
                Assert.Greater(force[1], 5.0);
                double rest = force[1];
                session.Evaluate(pose, new[] { 0.0, -0.05, 0.0, 0.0, 0.0, 0.0 }, force, torque);
                Assert.Greater(force[1], rest + 1.0);
            }
        }

        [Test]
        public void RefusalNamesWhatWasFound()
        {
            var error = Assert.Throws<InvalidOperationException>(() => new Session("no_such_scene", "reamer", 0.0, true, null));
            Assert.IsTrue(error.Message.Contains("no_such_scene"));
        }
    }
}
