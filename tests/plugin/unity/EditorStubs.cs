// The few types of UnityEditor and NUnit that the package's inspectors and EditMode tests use, and a runner of those tests
// without Unity: it calls every method with [Test] by reflection. Exit code 1: a test failed.
using System;
using System.Collections.Generic;
using System.Reflection;
using UnityEngine;
using UnityEngine.TestTools;

namespace UnityEditor
{
    public enum MessageType { None, Info, Warning, Error }
    public class CustomEditor : Attribute
    {
        public readonly Type Of;
        public CustomEditor(Type type) { Of = type; }
    }
    public class SerializedProperty
    {
        readonly object thing;
        readonly FieldInfo field;
        public SerializedProperty(object thing, FieldInfo field)
        {
            this.thing = thing;
            this.field = field;
        }
        public double doubleValue
        {
            get { return (double)field.GetValue(thing); }
            set { field.SetValue(thing, value); }
        }
    }
    public class SerializedObject
    {
        readonly UnityEngine.Object thing;
        public SerializedObject(UnityEngine.Object thing) { this.thing = thing; }
        public void Update() {}
        public bool ApplyModifiedProperties() => false;
        /// Null if there is no public field of this name.
        public SerializedProperty FindProperty(string name)
        {
            var field = thing.GetType().GetField(name);
            return field == null ? null : new SerializedProperty(thing, field);
        }
    }
    public class Editor : UnityEngine.Object
    {
        public UnityEngine.Object target;
        public SerializedObject serializedObject;
        public virtual void OnInspectorGUI() {}
        public virtual bool RequiresConstantRepaint() => false;
        public static Editor CreateEditor(UnityEngine.Object target)
        {
            foreach (var assembly in AppDomain.CurrentDomain.GetAssemblies())
                foreach (var type in assembly.GetTypes())
                {
                    var of = (CustomEditor)Attribute.GetCustomAttribute(type, typeof(CustomEditor));
                    if (of == null || of.Of != target.GetType()) continue;
                    var made = (Editor)Activator.CreateInstance(type);
                    made.target = target;
                    made.serializedObject = new SerializedObject(target);
                    return made;
                }
            return null;
        }
    }
    public static class EditorGUILayout
    {
        public static readonly List<string> Shown = new List<string>();
        public static bool PropertyField(SerializedProperty property, GUIContent label)
        {
            if (property == null) throw new NullReferenceException("a property that is not there");
            return true;
        }
        public static double DoubleField(string label, double value) => value;
        public static void LabelField(string label) => Shown.Add(label);
        public static void LabelField(string label, string text) => Shown.Add(label + ": " + text);
        public static void HelpBox(string text, MessageType type) => Shown.Add(text);
    }
}

namespace NUnit.Framework
{
    public class TestAttribute : Attribute {}
    public class SetUpAttribute : Attribute {}
    public class TearDownAttribute : Attribute {}
    public class AssertionException : Exception { public AssertionException(string text) : base(text) {} }
    public static class Assert
    {
        static void Expect(bool good, string text) { if (!good) throw new AssertionException(text); }
        public static void AreEqual(object expected, object found, string text = "") => Expect(Equals(expected, found), "found " + found + ", expected " + expected + " " + text);
        public static void Greater(double a, double b) => Expect(a > b, "found " + a + ", expected above " + b);
        public static void Less(double a, double b) => Expect(a < b, "found " + a + ", expected below " + b);
        public static void IsTrue(bool value, string text = "") => Expect(value, "found false " + text);
        public static void IsFalse(bool value, string text = "") => Expect(!value, "found true " + text);
        public static void IsNull(object value) => Expect(value == null, "found " + value + ", expected null");
        public static void IsNotNull(object value, string text = "") => Expect(value != null, "found null " + text);
        public static T Throws<T>(Action code) where T : Exception
        {
            try { code(); }
            catch (T error) { return error; }
            throw new AssertionException("nothing was thrown");
        }
    }

    static class Runner
    {
        static int Main()
        {
            int run = 0, failed = 0;
            foreach (var type in Assembly.GetExecutingAssembly().GetTypes())
                foreach (var method in type.GetMethods())
                {
                    if (!method.IsDefined(typeof(TestAttribute), false)) continue;
                    ++run;
                    var wrong = Run(type, method);
                    if (wrong.Length > 0) ++failed;
                    Console.WriteLine("{0} {1}.{2} {3}", wrong.Length > 0 ? "failed" : "held  ", type.Name, method.Name, wrong);
                }
            Console.WriteLine("{0} EditMode tests, {1} failed", run, failed);
            return failed > 0 || run == 0 ? 1 : 0;
        }

        /// Runs one test. Returns why it failed; empty: it passed.
        static string Run(Type type, MethodInfo test)
        {
            Debug.Lines.Clear();
            LogAssert.Expected.Clear();
            var thing = Activator.CreateInstance(type);
            try
            {
                Call(thing, type, typeof(SetUpAttribute));
                test.Invoke(thing, null);
                foreach (var line in LogAssert.Expected)
                    if (!Debug.Lines.Remove(line)) return "logs nothing of: " + line;
                return Debug.Lines.Count > 0 ? "logs: " + Debug.Lines[0] : "";
            }
            catch (TargetInvocationException error)
            {
                return error.InnerException.GetType().Name + ": " + error.InnerException.Message;
            }
            finally
            {
                Call(thing, type, typeof(TearDownAttribute));
            }
        }

        /// Calls all methods that have this attribute.
        static void Call(object thing, Type type, Type attribute)
        {
            foreach (var method in type.GetMethods())
                if (method.IsDefined(attribute, false)) method.Invoke(thing, null);
        }
    }
}
