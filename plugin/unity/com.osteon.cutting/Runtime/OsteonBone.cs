using System.Collections.Generic;
using UnityEngine;

namespace Osteon
{
    /// <summary>A bone that a tool cuts. Its mesh follows the cut, one child object a brick.</summary>
    public sealed class OsteonBone : MonoBehaviour
    {
        [Tooltip("A shipped scene: acetabulum, molar, femoral_canal, …")] public string scene = "acetabulum";
        [Tooltip("The tool that cuts")] public OsteonTool tool;
        [Tooltip("Largest force of the hand [N]: above 0, at most 200")] public double maxForce_N = 200.0;
        [Tooltip("Folder of scenes/, tools/ and materials/; empty: that of the installation")] public string configFolder = "";
        public Material material;

        readonly Dictionary<uint, Mesh> meshes = new Dictionary<uint, Mesh>();
        readonly List<Brick> changed = new List<Brick>();
        Session session;

        /// <summary>The session, for a haptic device's own thread: SetToolPose and Evaluate are wait-free.</summary>
        public Session Session => session;

        void OnEnable()
        {
            session = new Session(scene, tool.toolName, tool.diameter_m, false, configFolder.Length > 0 ? configFolder : null, maxForce_N);
        }

        void OnDisable()
        {
            session.Dispose();
            session = null;
        }

        void Update()
        {
            session.SetToolPose(tool.PoseIn(transform), tool.spins ? session.Spindle : 0.0);
            changed.Clear();
            session.SurfaceChanges(changed);
            foreach (var brick in changed) Show(brick);
        }

        void Show(Brick brick)
        {
            Mesh mesh;
            if (!meshes.TryGetValue(brick.Number, out mesh))
            {
                var part = new GameObject("brick " + brick.Number);
                part.transform.SetParent(transform, false);
                mesh = new Mesh();
                part.AddComponent<MeshFilter>().sharedMesh = mesh;
                part.AddComponent<MeshRenderer>().sharedMaterial = material;
                meshes.Add(brick.Number, mesh);
            }
            mesh.Clear();
            mesh.vertices = ToVectors(brick.Positions);
            mesh.normals = ToVectors(brick.Normals);
            mesh.colors32 = ToColors(brick.Colors);
            mesh.triangles = brick.Triangles;
        }

        static Color32[] ToColors(byte[] rgb)
        {
            var colors = new Color32[rgb.Length / 3];
            for (var i = 0; i < colors.Length; ++i) colors[i] = new Color32(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2], 255);
            return colors;
        }

        static Vector3[] ToVectors(float[] values)
        {
            var vectors = new Vector3[values.Length / 3];
            for (var i = 0; i < vectors.Length; ++i) vectors[i] = new Vector3(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
            return vectors;
        }
    }
}
