#pragma once

#include <cmath>
#include <limits>

#include "simulation/mesh/triangle_mesh.h"

// Oracle for tests: distances to a mesh by testing every triangle. It is slow, and independent of the code
// under test.

namespace osteon::simulation {

/// The point of a triangle nearest to p. Source: Ericson, Real-Time Collision Detection, 2005, 5.1.5.
inline Vector3 NearestOfTriangle(const Vector3& p, const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap), d3 = ab.dot(bp), d4 = ac.dot(bp), d5 = ab.dot(cp),
               d6 = ac.dot(cp);
  if (d1 <= 0.0 && d2 <= 0.0) return a;
  if (d3 >= 0.0 && d4 <= d3) return b;
  if (d6 >= 0.0 && d5 <= d6) return c;
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return a + d1 / (d1 - d3) * ab;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return a + d2 / (d2 - d6) * ac;
  if (va <= 0.0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

/// Signed distance, negative inside. The sign comes from the winding number: the solid angle of all triangles
/// seen from p, over 4 pi, is 1 inside and 0 outside. Source: Van Oosterom and Strackee, IEEE Trans. Biomed.
/// Eng. 30, 1983.
inline double BruteSignedDistance(const TriangleMesh& mesh, const Vector3& p) {
  double nearest = std::numeric_limits<double>::infinity(), angle = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices_m[t[0]], &b = mesh.vertices_m[t[1]], &c = mesh.vertices_m[t[2]];
    nearest = std::min(nearest, (NearestOfTriangle(p, a, b, c) - p).norm());
    const Vector3 u = (a - p).normalized(), v = (b - p).normalized(), w = (c - p).normalized();
    angle += 2.0 * std::atan2(u.dot(v.cross(w)), 1.0 + u.dot(v) + v.dot(w) + w.dot(u));
  }
  return angle > 2.0 * M_PI ? -nearest : nearest;
}

}  // namespace osteon::simulation
