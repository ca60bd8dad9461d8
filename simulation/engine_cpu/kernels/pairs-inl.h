// Loads eight pairs of a list as doubles.
#if defined(OSTEON_CPU_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_PAIRS_INL_H
#undef OSTEON_CPU_PAIRS_INL_H
#else
#define OSTEON_CPU_PAIRS_INL_H
#endif

#include "simulation/engine_cpu/kernels/rows-inl.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Eight pairs of a list; lanes beyond the list's end are undefined.
struct Pairs {
  D3 from_bone;  // vector from the bone ball's centre to the tool ball's centre [m]
  D8 r, R;       // radii of bone and tool ball [m]
  D3 center_T;
};
// Loads eight pairs. @param place, tool  the list, beginning at the first of these pairs; @param valid  a bit
// for each lane that holds a pair of the list
HWY_INLINE Pairs LoadPairs(const NearFieldPass& p, const std::uint32_t* place, const std::uint32_t* tool,
                           unsigned valid) {
  const float* base = p.balls->x;  // y, z and r of a ball lie 8, 16 and 24 floats behind x
  std::uint32_t places[8], tools[8];
  bool one_tool = true;
  for (unsigned k = 0; k < 8; ++k) {
    const bool is_pair = (valid >> k & 1u) != 0;
    places[k] = place[is_pair ? k : 0], tools[k] = tool[is_pair ? k : 0];
    one_tool = one_tool && tools[k] == tools[0];
  }
  const D3 c = Metres({Gather(base, places), Gather(base + 8, places), Gather(base + 16, places)});
  Pairs pairs;
  pairs.r = D(1e-3) * ToD(Gather(base + 24, places));
  if (one_tool) {
    const unsigned t = tools[0];
    pairs.R = D(p.tool.r[t]);
    pairs.from_bone = ExactlyAt(p.at, t) - c;
    pairs.center_T = {D(p.tool.tx[t]), D(p.tool.ty[t]), D(p.tool.tz[t])};
    return pairs;
  }
  pairs.R = Gather(p.tool.r, tools);
  pairs.from_bone = D3{Gather(p.at.x, tools), Gather(p.at.y, tools), Gather(p.at.z, tools)} - c;
  pairs.center_T = {Gather(p.tool.tx, tools), Gather(p.tool.ty, tools), Gather(p.tool.tz, tools)};
  return pairs;
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
