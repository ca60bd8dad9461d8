using System;
using UnityEditor;
using UnityEngine;

namespace Osteon
{
    /// <summary>The bone's fields with their units, what is wrong with them, and while it plays the session's figures.</summary>
    [CustomEditor(typeof(OsteonBone))]
    public sealed class OsteonBoneEditor : Editor
    {
        public override bool RequiresConstantRepaint() => Application.isPlaying;

        public override void OnInspectorGUI()
        {
            var bone = (OsteonBone)target;
            serializedObject.Update();
            Field("scene", "Scene");
            Field("tool", "Tool");
            Field("maxForce_N", "Largest force [N]");
            Field("configFolder", "Folder of scenes and tools");
            Field("material", "Material");
            EditorGUILayout.LabelField("What gives way");
            Field("toolBends", "Tool bends");
            Field("layerYields", "Soft tissue yields");
            Field("mountMoves", "Bone moves on a mount");
            if (bone.mountMoves) Field("mountMass_kg", "Mass on the mount [kg]");
            serializedObject.ApplyModifiedProperties();
            foreach (var problem in bone.Problems()) EditorGUILayout.HelpBox(problem, MessageType.Warning);
            if (bone.Session != null) ShowSession(bone);
        }

        void ShowSession(OsteonBone bone)
        {
            var figures = bone.Session.Figures;
            EditorGUILayout.LabelField("Engine", bone.Session.Engine);
            EditorGUILayout.LabelField("Frames", figures.frame.ToString());
            EditorGUILayout.LabelField("Time of a frame [ms]", (1e3 * figures.frame_time_s).ToString("F2"));
            EditorGUILayout.LabelField("Removed [mm³]", (1e9 * figures.removed_volume_m3).ToString("F1"));
            EditorGUILayout.LabelField("Torque of the cut [N·m]", figures.spindle_torque_Nm.ToString("F3"));
            try
            {
                if (GUILayout.Button("Mark the bone")) bone.Session.Mark();
                if (GUILayout.Button("Return to the mark")) bone.Session.Undo(bone.tool.PoseIn(bone.transform));
            }
            catch (InvalidOperationException error)
            {
                Debug.LogWarning(error.Message, bone); // such as a tool that stands in the bone that would come back
            }
        }

        void Field(string name, string label) => EditorGUILayout.PropertyField(serializedObject.FindProperty(name), new GUIContent(label));
    }
}
