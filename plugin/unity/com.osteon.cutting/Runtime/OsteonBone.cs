using System;
using System.Collections.Generic;
using UnityEngine;
using UnityEngine.Rendering;

namespace Osteon
{
    /// <summary>A bone that a tool cuts. Its mesh follows the cut, one child object a brick; a frame makes no garbage but for
    /// bricks that are new.</summary>
    public sealed class OsteonBone : MonoBehaviour
    {
        [Tooltip("A shipped scene: acetabulum, molar, femoral_canal, …")] public string scene = "acetabulum";
        [Tooltip("The tool that cuts")] public OsteonTool tool;
        [Tooltip("Largest force of the hand [N]: above 0, at most 200")] public double maxForce_N = 200.0;
        [Tooltip("Folder of scenes/, tools/ and materials/; empty: that of the installation")] public string configFolder = "";
        [Tooltip("The tool bends as its file says")] public bool toolBends;
        [Tooltip("Soft tissue on the surface yields as the bone's materials say")] public bool layerYields;
        [Tooltip("The bone moves on a mount")] public bool mountMoves;
        [Tooltip("Mass of what moves on the mount [kg]; its stiffness is that of 10 Hz with 12 kg")] public double mountMass_kg = 12.0;
        public Material material;

        /// <summary>Something that the scene watches: "breakthrough", "wall too thin", … Its place is in this object's frame.</summary>
        public event Action<Native.Event> SceneEvent;

        const MeshUpdateFlags Unchecked = MeshUpdateFlags.DontValidateIndices | MeshUpdateFlags.DontRecalculateBounds;
        static readonly VertexAttributeDescriptor[] Layout =
        {
            new VertexAttributeDescriptor(VertexAttribute.Position, VertexAttributeFormat.Float32, 3),
            new VertexAttributeDescriptor(VertexAttribute.Normal, VertexAttributeFormat.Float32, 3),
            new VertexAttributeDescriptor(VertexAttribute.Color, VertexAttributeFormat.UNorm8, 4)
        };

        readonly Dictionary<uint, Mesh> meshes = new Dictionary<uint, Mesh>();
        readonly double[] pose = new double[7];
        GameObject bricks; // their parent, which moves on the mount
        Session session;

        /// <summary>The session, for a haptic device's own thread: SetToolPose and Evaluate are wait-free. Null: none is open.</summary>
        public Session Session => session;

        void OnEnable()
        {
            if (!Open()) enabled = false;
        }

        void OnDisable() => Close();

        void OnDestroy()
        {
            foreach (var mesh in meshes.Values) Remove(mesh);
            meshes.Clear();
        }

        void Update()
        {
            if (session == null) return;
            tool.PoseIn(transform, pose);
            session.SetToolPose(pose, tool.spins ? session.Spindle : 0.0);
            UpdateMeshes();
            if (GivesWay) FollowMount();
            Native.Event happened;
            while (session.NextEvent(out happened))
                if (SceneEvent != null) SceneEvent(happened);
        }

        /// <summary>What is wrong with the fields: the value found, the values accepted.</summary>
        public IEnumerable<string> Problems()
        {
            if (tool == null) yield return "Tool: found none, accepted an object with OsteonTool";
            if (string.IsNullOrEmpty(scene)) yield return "Scene: found an empty name, accepted acetabulum, molar, femoral_canal, …";
            if (!(maxForce_N > 0.0 && maxForce_N <= 200.0))
                yield return "Largest force: found " + maxForce_N + " N, accepted above 0, at most 200 N";
            if (mountMoves && !(mountMass_kg > 0.0)) yield return "Mass on the mount: found " + mountMass_kg + " kg, accepted above 0";
        }

        /// <summary>Opens the session by the fields; enabling the component does. What is refused goes to the log.</summary>
        public bool Open()
        {
            Close();
            try
            {
                foreach (var problem in Problems()) throw new InvalidOperationException(problem);
                session = new Session(scene, tool.toolName, tool.diameter_m, false, configFolder.Length > 0 ? configFolder : null, maxForce_N);
                if (session.BoneWarning.Length > 0) Debug.LogWarning(session.BoneWarning, this);
                if (GivesWay) session.SetCompliance(Compliance());
                return true;
            }
            catch (InvalidOperationException error)
            {
                Close();
                Debug.LogError(error.Message, this);
                return false;
            }
        }

        public void Close()
        {
            if (session != null) session.Dispose();
            session = null;
        }

        /// <summary>Brings the meshes up to date, one buffer of bricks; each frame does.</summary>
        public void UpdateMeshes()
        {
            var count = session.TakeBricks();
            for (var i = 0; i < count; ++i) Show(ref session.Surface.Ranges[i]);
        }

        /// <summary>Draws the bone where its mount has let it go by the newest Evaluate; each frame does.</summary>
        public void FollowMount()
        {
            if (bricks == null) return;
            var place = session.Deflection.bone;
            var p = place.position_m;
            bricks.transform.localPosition = new Vector3((float)p.x, (float)p.y, (float)p.z);
            bricks.transform.localRotation = new Quaternion((float)place.x, (float)place.y, (float)place.z, (float)place.w);
        }

        bool GivesWay => toolBends || layerYields || mountMoves;

        Native.ComplianceParams Compliance()
        {
            var levels = Session.DefaultCompliance();
            levels.tool = toolBends ? 1u : 0u;
            levels.layer = layerYields ? 1u : 0u;
            levels.mount = mountMoves ? 1u : 0u;
            levels.mount_mass_kg = mountMass_kg;
            return levels;
        }

        void Show(ref BrickRange brick)
        {
            var surface = session.Surface;
            var mesh = MeshOf(brick.Number);
            mesh.SetVertexBufferParams(brick.VertexCount, Layout);
            mesh.SetVertexBufferData(surface.Vertices, brick.FirstVertex, 0, brick.VertexCount, 0, Unchecked);
            mesh.SetIndexBufferParams(brick.IndexCount, IndexFormat.UInt16);
            mesh.SetIndexBufferData(surface.Indices, brick.FirstIndex, 0, brick.IndexCount, Unchecked);
            var part = new SubMeshDescriptor(0, brick.IndexCount, MeshTopology.Triangles);
            if (brick.VertexCount > 0)
            {
                var low = new Vector3(brick.MinX, brick.MinY, brick.MinZ);
                var high = new Vector3(brick.MaxX, brick.MaxY, brick.MaxZ);
                part.bounds = new Bounds(0.5f * (low + high), high - low);
                part.vertexCount = brick.VertexCount;
            }
            mesh.subMeshCount = 1;
            mesh.SetSubMesh(0, part, Unchecked);
            mesh.bounds = part.bounds;
        }

        Mesh MeshOf(uint number)
        {
            Mesh mesh;
            if (meshes.TryGetValue(number, out mesh)) return mesh;
            if (bricks == null)
            {
                bricks = new GameObject("bricks");
                bricks.transform.SetParent(transform, false);
            }
            var part = new GameObject("brick " + number);
            part.transform.SetParent(bricks.transform, false);
            mesh = new Mesh();
            mesh.MarkDynamic();
            part.AddComponent<MeshFilter>().sharedMesh = mesh;
            part.AddComponent<MeshRenderer>().sharedMaterial = material;
            meshes.Add(number, mesh);
            return mesh;
        }

        static void Remove(UnityEngine.Object thing)
        {
            if (Application.isPlaying) Destroy(thing);
            else DestroyImmediate(thing);
        }
    }
}
