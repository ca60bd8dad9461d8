using UnityEditor;
using UnityEngine;

namespace Osteon
{
    /// <summary>The tool's fields; its diameter in millimetres.</summary>
    [CustomEditor(typeof(OsteonTool))]
    public sealed class OsteonToolEditor : Editor
    {
        public override void OnInspectorGUI()
        {
            serializedObject.Update();
            EditorGUILayout.PropertyField(serializedObject.FindProperty("toolName"), new GUIContent("Tool"));
            var diameter = serializedObject.FindProperty("diameter_m");
            diameter.doubleValue = 1e-3 * EditorGUILayout.DoubleField("Diameter [mm], 0: its usual one", 1e3 * diameter.doubleValue);
            EditorGUILayout.PropertyField(serializedObject.FindProperty("spins"), new GUIContent("Spindle turns"));
            serializedObject.ApplyModifiedProperties();
            if (diameter.doubleValue < 0.0)
                EditorGUILayout.HelpBox("Diameter: found " + 1e3 * diameter.doubleValue + " mm, accepted 0 or above", MessageType.Warning);
        }
    }
}
