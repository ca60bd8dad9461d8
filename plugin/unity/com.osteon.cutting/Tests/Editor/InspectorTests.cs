using NUnit.Framework;
using UnityEditor;
using UnityEngine;

namespace Osteon.Tests
{
    public sealed class InspectorTests
    {
        /// <summary>A field that is renamed is found by no test but this one: FindProperty would give null.</summary>
        [Test]
        public void FindsTheFieldsThatItShows()
        {
            var thing = new GameObject("bone");
            var bone = thing.AddComponent<OsteonBone>();
            var shown = new SerializedObject(bone);
            foreach (var name in new[]
                     {
                         "scene", "tool", "maxForce_N", "configFolder", "material", "toolBends", "layerYields", "mountMoves", "mountMass_kg"
                     })
                Assert.IsNotNull(shown.FindProperty(name), name);
            var tool = new SerializedObject(thing.AddComponent<OsteonTool>());
            foreach (var name in new[] { "toolName", "diameter_m", "spins" }) Assert.IsNotNull(tool.FindProperty(name), name);
            Assert.IsTrue(Editor.CreateEditor(bone) is OsteonBoneEditor);
            Object.DestroyImmediate(thing);
        }
    }
}
