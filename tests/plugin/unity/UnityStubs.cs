// The few types of UnityEngine that the package's components and tests use, so that both compile and run without Unity.
// Names, parameters and meanings are those of Unity 2020.3.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace UnityEngine
{
    public class Object
    {
        public static void Destroy(Object thing) => DestroyImmediate(thing);
        public static void DestroyImmediate(Object thing) {}
    }
    public class Component : Object
    {
        public GameObject gameObject;
        public Transform transform => gameObject.transform;
    }
    public class Behaviour : Component { public bool enabled = true; }
    public class MonoBehaviour : Behaviour {}
    public class Material : Object {}
    public class MeshFilter : Component { public Mesh sharedMesh; }
    public class MeshRenderer : Component { public Material sharedMaterial; }
    public enum MeshTopology { Triangles }
    public class Mesh : Object
    {
        byte[] vertexData = new byte[0];
        ushort[] indexData = new ushort[0];
        Rendering.SubMeshDescriptor part;
        int stride;

        public int vertexCount { get; private set; }
        public int subMeshCount;
        public Bounds bounds;

        public void MarkDynamic() {}
        public void SetVertexBufferParams(int count, params Rendering.VertexAttributeDescriptor[] layout)
        {
            stride = 0;
            foreach (var attribute in layout) stride += attribute.dimension * (attribute.format == Rendering.VertexAttributeFormat.Float32 ? 4 : 1);
            vertexCount = count;
            Array.Resize(ref vertexData, Math.Max(vertexData.Length, stride * count));
        }
        public void SetVertexBufferData<T>(T[] data, int dataStart, int meshBufferStart, int count, int stream = 0,
                                           Rendering.MeshUpdateFlags flags = 0) where T : struct
        {
            if (Marshal.SizeOf(typeof(T)) != stride) throw new ArgumentException("a vertex has another size than the layout");
            if (stream != 0 || meshBufferStart + count > vertexCount || dataStart + count > data.Length) throw new ArgumentOutOfRangeException();
        }
        public void SetIndexBufferParams(int count, Rendering.IndexFormat format)
        {
            if (format != Rendering.IndexFormat.UInt16) throw new ArgumentException();
            if (count > indexData.Length) Array.Resize(ref indexData, count);
        }
        public void SetIndexBufferData<T>(T[] data, int dataStart, int meshBufferStart, int count, Rendering.MeshUpdateFlags flags = 0)
            where T : struct
        {
            Array.Copy((ushort[])(object)data, dataStart, indexData, meshBufferStart, count);
            for (var i = meshBufferStart; i < meshBufferStart + count; ++i)
                if (indexData[i] >= vertexCount) throw new ArgumentOutOfRangeException("an index beyond the vertices");
        }
        public void SetSubMesh(int index, Rendering.SubMeshDescriptor descriptor, Rendering.MeshUpdateFlags flags = 0)
        {
            if (index >= subMeshCount || descriptor.indexStart + descriptor.indexCount > indexData.Length) throw new IndexOutOfRangeException();
            part = descriptor;
        }
        public uint GetIndexCount(int index) => (uint)part.indexCount;
    }
    public class GameObject : Object
    {
        readonly List<Component> components = new List<Component>();
        public Transform transform;
        public GameObject(string name) { transform = AddComponent<Transform>(); }
        public T AddComponent<T>() where T : Component, new()
        {
            var made = new T { gameObject = this };
            components.Add(made);
            return made;
        }
        public T[] GetComponentsInChildren<T>()
        {
            var found = new List<T>();
            foreach (var each in components)
                if (each is T) found.Add((T)(object)each);
            foreach (var child in transform.children) found.AddRange(child.gameObject.GetComponentsInChildren<T>());
            return found.ToArray();
        }
    }
    public class Transform : Component
    {
        public readonly List<Transform> children = new List<Transform>();
        public Vector3 position, localPosition;
        public Quaternion rotation = new Quaternion(0, 0, 0, 1), localRotation;
        public Vector3 InverseTransformPoint(Vector3 p) { return p; }
        public Transform GetChild(int index) { return children[index]; }
        public void SetParent(Transform parent, bool worldPositionStays) { parent.children.Add(this); }
    }
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
        public static Vector3 operator +(Vector3 a, Vector3 b) => new Vector3(a.x + b.x, a.y + b.y, a.z + b.z);
        public static Vector3 operator -(Vector3 a, Vector3 b) => new Vector3(a.x - b.x, a.y - b.y, a.z - b.z);
        public static Vector3 operator *(float s, Vector3 v) => new Vector3(s * v.x, s * v.y, s * v.z);
        public static Vector3 Min(Vector3 a, Vector3 b) => new Vector3(Math.Min(a.x, b.x), Math.Min(a.y, b.y), Math.Min(a.z, b.z));
        public static Vector3 Max(Vector3 a, Vector3 b) => new Vector3(Math.Max(a.x, b.x), Math.Max(a.y, b.y), Math.Max(a.z, b.z));
    }
    public struct Bounds
    {
        Vector3 low, high;
        public Bounds(Vector3 center, Vector3 size)
        {
            low = center - 0.5f * size;
            high = center + 0.5f * size;
        }
        public Vector3 size => high - low;
        public void Encapsulate(Bounds other)
        {
            low = Vector3.Min(low, other.low);
            high = Vector3.Max(high, other.high);
        }
    }
    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static Quaternion Inverse(Quaternion q) { return q; }
        public static Quaternion operator *(Quaternion a, Quaternion b) { return a; }
    }
    public enum LogType { Error = 0, Warning = 2, Log = 3 }
    public static class Debug
    {
        public static readonly List<string> Lines = new List<string>();
        public static void LogWarning(object text, Object context) => Lines.Add("Warning " + text);
        public static void LogError(object text, Object context) => Lines.Add("Error " + text);
    }
    public static class Application { public static bool isPlaying => false; }
    public static class Time { public static float time; }
    public class TooltipAttribute : Attribute { public TooltipAttribute(string text) {} }
    public class GUIContent { public GUIContent(string text) {} }
    public static class GUILayout { public static bool Button(string text) => false; }
}

namespace UnityEngine.Rendering
{
    [Flags]
    public enum MeshUpdateFlags { Default = 0, DontValidateIndices = 1, DontResetBoneBounds = 2, DontNotifyMeshUsers = 4, DontRecalculateBounds = 8 }
    public enum IndexFormat { UInt16, UInt32 }
    public enum VertexAttribute { Position, Normal, Tangent, Color }
    public enum VertexAttributeFormat { Float32, Float16, UNorm8 }
    public struct VertexAttributeDescriptor
    {
        public VertexAttributeFormat format;
        public int dimension;
        public VertexAttributeDescriptor(VertexAttribute attribute, VertexAttributeFormat format, int dimension, int stream = 0)
        {
            this.format = format;
            this.dimension = dimension;
        }
    }
    public struct SubMeshDescriptor
    {
        public Bounds bounds;
        public int indexStart, indexCount, baseVertex, firstVertex, vertexCount;
        public SubMeshDescriptor(int indexStart, int indexCount, MeshTopology topology = MeshTopology.Triangles) : this()
        {
            this.indexStart = indexStart;
            this.indexCount = indexCount;
        }
    }
}

namespace UnityEngine.TestTools
{
    /// Texts that the test must log, before or after the call.
    public static class LogAssert
    {
        public static readonly List<string> Expected = new List<string>();
        public static void Expect(LogType type, string text) => Expected.Add(type + " " + text);
    }
}
