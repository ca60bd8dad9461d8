namespace Osteon
{
    /// <summary>
    /// Between Unity's axes (left-handed, +y up, metres) and Osteon's (right-handed, +z up, metres). Both swap y and z,
    /// which mirrors: a rotation keeps its axis with y and z swapped and turns the other way, a triangle is turned over.
    /// </summary>
    public static class Axes
    {
        /// <summary>A place or a direction, either way.</summary>
        public static void Swap(double x, double y, double z, out double x2, out double y2, out double z2)
        {
            x2 = x;
            y2 = z;
            z2 = y;
        }

        /// <summary>A quaternion, either way.</summary>
        public static void SwapRotation(double w, double x, double y, double z, out double w2, out double x2, out double y2, out double z2)
        {
            w2 = w;
            x2 = -x;
            y2 = -z;
            z2 = -y;
        }
    }
}
