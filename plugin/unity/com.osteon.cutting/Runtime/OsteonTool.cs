using UnityEngine;

namespace Osteon
{
    /// <summary>A tool: its object's origin is the apex. Osteon's +z, the feed, is +y here.</summary>
    public sealed class OsteonTool : MonoBehaviour
    {
        [Tooltip("A shipped tool: reamer, twist_drill, round_burr, …")] public string toolName = "reamer";
        [Tooltip("Diameter [m]; 0: the tool's usual one")] public double diameter_m;
        [Tooltip("Whether the spindle turns")] public bool spins = true;

        /// <summary>Pose in a bone's frame: position x y z [m], rotation w x y z.</summary>
        public double[] PoseIn(Transform bone)
        {
            var pose = new double[7];
            PoseIn(bone, pose);
            return pose;
        }

        /// <summary>… into an array of 7 that is used again.</summary>
        public void PoseIn(Transform bone, double[] pose)
        {
            var p = bone.InverseTransformPoint(transform.position);
            var q = Quaternion.Inverse(bone.rotation) * transform.rotation;
            pose[0] = p.x;
            pose[1] = p.y;
            pose[2] = p.z;
            pose[3] = q.w;
            pose[4] = q.x;
            pose[5] = q.y;
            pose[6] = q.z;
        }
    }
}
