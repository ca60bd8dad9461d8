// The few types of UnityEngine that the package's components use, so that they are compiled where there is no Unity.
using System;

namespace UnityEngine
{
    public class Object {}
    public class Component : Object { public Transform transform; }
    public class MonoBehaviour : Component {}
    public class Material : Object {}
    public class MeshFilter : Component { public Mesh sharedMesh; }
    public class MeshRenderer : Component { public Material sharedMaterial; }
    public class Mesh : Object
    {
        public Vector3[] vertices, normals;
        public int[] triangles;
        public Color32[] colors32;
        public void Clear() {}
    }
    public class GameObject : Object
    {
        public Transform transform;
        public GameObject(string name) {}
        public T AddComponent<T>() where T : new() { return new T(); }
    }
    public class Transform : Component
    {
        public Vector3 position, localPosition;
        public Quaternion rotation, localRotation;
        public Vector3 InverseTransformPoint(Vector3 p) { return p; }
        public void SetParent(Transform parent, bool worldPositionStays) {}
    }
    public struct Vector3
    {
        public float x, y, z;
        public Vector3(float x, float y, float z) { this.x = x; this.y = y; this.z = z; }
    }
    public struct Color32
    {
        public byte r, g, b, a;
        public Color32(byte r, byte g, byte b, byte a) { this.r = r; this.g = g; this.b = b; this.a = a; }
    }
    public struct Quaternion
    {
        public float x, y, z, w;
        public Quaternion(float x, float y, float z, float w) { this.x = x; this.y = y; this.z = z; this.w = w; }
        public static Quaternion Inverse(Quaternion q) { return q; }
        public static Quaternion operator *(Quaternion a, Quaternion b) { return a; }
    }
    public static class Time { public static float time; }
    public class TooltipAttribute : Attribute { public TooltipAttribute(string text) {} }
}
