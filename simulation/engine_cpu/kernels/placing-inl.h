// Places the tool's balls at a pose and on straight paths.
#if defined(OSTEON_CPU_PLACING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_PLACING_INL_H
#undef OSTEON_CPU_PLACING_INL_H
#else
#define OSTEON_CPU_PLACING_INL_H
#endif

#include <cmath>

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

HWY_INLINE void StorePlaces(const Places& to, std::uint32_t i, const D3& p) {
  Store(to.x + i, p.x), Store(to.y + i, p.y), Store(to.z + i, p.z);
  Store(to.x_mm + i, ToF(p.x * D(1e3)));
  Store(to.y_mm + i, ToF(p.y * D(1e3)));
  Store(to.z_mm + i, ToF(p.z * D(1e3)));
}
HWY_INLINE D3 LoadPlaces(const Places& a, std::uint32_t i) {
  return {Load(a.x + i), Load(a.y + i), Load(a.z + i)};
}

// Does PlaceTool of tool_path.h: computes R c + p for each centre c, with the same bits as Eigen.
inline void Place(const double R[9], const double p[3], const ToolView& tool, Places to) {
  for (std::uint32_t i = 0; i <= tool.count; i += 8) {
    const D3 c{Load(tool.tx + i), Load(tool.ty + i), Load(tool.tz + i)};
    D8 row[3];
    for (int k = 0; k < 3; ++k)
      row[k] = ((D(R[3 * k]) * c.x + D(R[3 * k + 1]) * c.y) + D(R[3 * k + 2]) * c.z) + D(p[k]);
    StorePlaces(to, i, {row[0], row[1], row[2]});
  }
  const std::uint32_t origin = tool.count;
  to.x[origin] = p[0], to.y[origin] = p[1], to.z[origin] = p[2];
}

// Computes the places at the fraction s of the straight paths from a to b.
inline void Between(Places a, Places b, double s, std::uint32_t count, Places to) {
  for (std::uint32_t i = 0; i <= count; i += 8) {
    const D3 p = LoadPlaces(a, i), way = LoadPlaces(b, i) - p;
    StorePlaces(to, i, {p.x + D(s) * way.x, p.y + D(s) * way.y, p.z + D(s) * way.z});
  }
}

// Computes the places of a, shifted by v [m].
inline void Shifted(Places a, const double v[3], std::uint32_t count, Places to) {
  for (std::uint32_t i = 0; i <= count; i += 8) {
    const D3 p = LoadPlaces(a, i);
    StorePlaces(to, i, {p.x + D(v[0]), p.y + D(v[1]), p.z + D(v[2])});
  }
}

// Returns the largest distance [m] between a place of a and the same place of b. It is the root of the
// largest squared distance, so only one root is needed.
inline double Farthest(Places a, Places b, std::uint32_t first, std::uint32_t last) {
  D8 largest = D(0.0);
  for (std::uint32_t i = first & ~7u; i < last; i += 8) {
    const D3 d = LoadPlaces(b, i) - LoadPlaces(a, i);
    unsigned bits = FirstBits(last - i);
    if (i < first) bits &= ~FirstBits(first - i);
    largest = Max(largest, Select(MaskD(bits), Dot(d, d), D(0.0)));
  }
  double each[8], square = 0.0;
  Store(each, largest);
  for (const double e : each) square = e > square ? e : square;
  return std::sqrt(square);
}

// Computes the vectors from the places of a to the same places of b [mm].
inline void Ways(Places a, Places b, std::uint32_t count, float* x_mm, float* y_mm, float* z_mm) {
  for (std::uint32_t i = 0; i <= count; i += 8) {
    const D3 d = LoadPlaces(b, i) - LoadPlaces(a, i);
    Store(x_mm + i, ToF(d.x * D(1e3))), Store(y_mm + i, ToF(d.y * D(1e3))),
        Store(z_mm + i, ToF(d.z * D(1e3)));
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
