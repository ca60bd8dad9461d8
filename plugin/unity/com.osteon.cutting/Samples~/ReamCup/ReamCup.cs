using UnityEngine;

namespace Osteon.Samples
{
    /// <summary>Moves a tool into the bone's cup and out again, 2 mm/s. On the tool's object, which is a child of the bone's.</summary>
    public sealed class ReamCup : MonoBehaviour
    {
        public OsteonBone bone;

        void Update()
        {
            var seconds = Time.time % 10.0f;
            var height_m = -0.016 - 0.002 * (seconds < 5.0f ? seconds : 10.0f - seconds);
            var pose = bone.Session.Approach(height_m);
            transform.localPosition = new Vector3((float)pose[0], (float)pose[1], (float)pose[2]);
            transform.localRotation = new Quaternion((float)pose[4], (float)pose[5], (float)pose[6], (float)pose[3]);
        }
    }
}
