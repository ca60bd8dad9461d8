using System.Collections.Generic;
using NUnit.Framework;
using UnityEngine;
using UnityEngine.TestTools;

namespace Osteon.Tests
{
    /// <summary>The components without play: what enabling and a frame do is called by hand.</summary>
    public sealed class OsteonBoneTests
    {
        GameObject boneObject, toolObject;
        OsteonBone bone;

        [SetUp]
        public void MakeObjects()
        {
            boneObject = new GameObject("bone");
            toolObject = new GameObject("tool");
            bone = boneObject.AddComponent<OsteonBone>();
            bone.tool = toolObject.AddComponent<OsteonTool>();
            bone.Close(); // an editor may have enabled it
        }

        [TearDown]
        public void RemoveObjects()
        {
            bone.Close();
            Object.DestroyImmediate(toolObject);
            Object.DestroyImmediate(boneObject);
        }

        [Test]
        public void ShowsTheBoneBrickByBrick()
        {
            Assert.IsTrue(bone.Open());
            bone.Session.WaitForSurface();
            bone.UpdateMeshes();
            var filters = boneObject.GetComponentsInChildren<MeshFilter>();
            Assert.Greater(filters.Length, 10);
            long triangles = 0;
            var box = filters[0].sharedMesh.bounds;
            foreach (var filter in filters)
            {
                var mesh = filter.sharedMesh;
                triangles += mesh.GetIndexCount(0) / 3;
                box.Encapsulate(mesh.bounds);
            }
            Assert.Greater(triangles, 1000);
            Assert.Greater(box.size.x, 0.03f);
            Assert.Less(box.size.x, 0.3f);
        }

        [Test]
        public void SaysWhatIsWrongWithItsFields()
        {
            Assert.AreEqual(0, new List<string>(bone.Problems()).Count);
            bone.tool = null;
            bone.scene = "";
            bone.maxForce_N = 300.0;
            bone.mountMoves = true;
            bone.mountMass_kg = -1.0;
            var problems = new List<string>(bone.Problems());
            Assert.AreEqual(4, problems.Count);
            Assert.IsTrue(problems[2].Contains("found 300 N, accepted above 0, at most 200"));
            LogAssert.Expect(LogType.Error, "Tool: found none, accepted an object with OsteonTool");
            Assert.IsFalse(bone.Open());
            Assert.IsNull(bone.Session);
        }

        [Test]
        public void GivesWayWhereItIsAsked()
        {
            bone.mountMoves = true;
            Assert.IsTrue(bone.Open());
            var session = bone.Session;
            Assert.AreEqual(0u, session.Deflection.gives_way);
            double[] force = new double[3], torque = new double[3];
            session.SetToolPose(session.Approach(0.1), 0.0);
            session.Evaluate(session.Approach(0.1), force, torque);
            Assert.AreEqual(1u, session.Deflection.gives_way);
            session.WaitForSurface();
            bone.UpdateMeshes();
            var pressed = session.Approach(-0.0195);
            for (var i = 0; i < 400; ++i)
            {
                session.SetToolPose(pressed, 0.0);
                session.Evaluate(pressed, force, torque);
                System.Threading.Thread.Sleep(1);
            }
            bone.FollowMount();
            var drawn = boneObject.transform.GetChild(0).localPosition;
            Assert.Less(drawn.y, -2e-5f);
        }
    }
}
