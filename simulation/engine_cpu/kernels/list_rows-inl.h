// Makes the rows of lists: finds the tool balls that come near a block, a point or a box.
#if defined(OSTEON_CPU_LIST_ROWS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OSTEON_CPU_LIST_ROWS_INL_H
#undef OSTEON_CPU_LIST_ROWS_INL_H
#else
#define OSTEON_CPU_LIST_ROWS_INL_H
#endif

#include "simulation/engine_cpu/kernels/rows-inl.h"
#include "simulation/engine_cpu/rounding.h"

HWY_BEFORE_NAMESPACE();
namespace osteon::simulation::cpu {
namespace HWY_NAMESPACE {

// Distance from tool ball t up to which the list holds bone [mm].
HWY_INLINE float ReachTo(const RowMaker& m, unsigned t) {
  return m.tool.cutting[t] != 0 ? m.cutting_reach_mm : m.shaft_reach_mm;
}

// Makes a row for each of the tool balls within reach of a live ball of the block. @returns their number
inline std::size_t MakeBallRows(const RowMaker& m, const BallBlock& block, const std::uint16_t* tools,
                                std::size_t count) {
  const F3 c = CentersOf(block);
  const F8 r = Load(block.r);
  const MF live = r > F(0.0f);
  if (Bits(live) == 0) return 0;
  std::size_t made = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned t = tools[i];
    const F3 from = At(m.at, t) - c;
    const F8 reach = r + F(m.tool.r_mm[t] + ReachTo(m, t)), square = Dot(from, from);
    if (Bits(live & (square <= reach * reach)) == 0) continue;
    m.out_tool[made] = static_cast<std::uint16_t>(t);
    const F8 gap = Sqrt(square) - F(m.tool.r_mm[t]) - r;
    m.out_bound[made++] = Least(Select(live, gap, F(kNever))) - kListSlack_mm;
  }
  return made;
}

// Makes a row for each of the tool balls within reach of a point of the block. @returns their number
inline std::size_t MakePointRows(const RowMaker& m, const PointBlock& block, const std::uint16_t* tools,
                                 std::size_t count) {
  const F3 c = CentersOf(block);
  std::size_t made = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned t = tools[i];
    const F3 from = At(m.at, t) - c;
    const float reach = m.tool.r_mm[t] + ReachTo(m, t);
    const F8 square = Dot(from, from);
    if (Bits(square <= F(reach * reach)) == 0) continue;
    m.out_tool[made] = static_cast<std::uint16_t>(t);
    m.out_bound[made++] = Least(Sqrt(square)) - m.tool.r_mm[t] - kListSlack_mm;
  }
  return made;
}

// Returns a bit for each of eight points that is within reach of one of the tool balls.
inline unsigned PointsNear(const RowMaker& m, const float* x, const float* y, const float* z,
                           const std::uint16_t* tools, std::size_t count) {
  const F3 c{Load(x), Load(y), Load(z)};
  unsigned bits = 0;
  for (std::size_t i = 0; i < count && bits != 0xffu; ++i) {
    const F3 from = At(m.at, tools[i]) - c;
    const float reach = m.tool.r_mm[tools[i]] + ReachTo(m, tools[i]);
    bits |= Bits(Dot(from, from) <= F(reach * reach));
  }
  return bits;
}

// Selects the tool balls whose centre is within radius plus reach of the box. @returns their number
inline std::size_t ToolsNearBox(const RowMaker& m, const float low[3], const float high[3],
                                const std::uint16_t* tools, std::size_t count, std::uint16_t* out) {
  std::size_t made = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const unsigned t = tools[i];
    const float at[3] = {m.at.x_mm[t], m.at.y_mm[t], m.at.z_mm[t]}, reach = m.tool.r_mm[t] + ReachTo(m, t);
    float square = 0.0f;
    for (int a = 0; a < 3; ++a) {
      const float below = low[a] - at[a], above = at[a] - high[a], out_of = below > above ? below : above;
      if (out_of > 0.0f) square += out_of * out_of;
    }
    if (square <= reach * reach) out[made++] = tools[i];
  }
  return made;
}

// Returns a bit for each of eight boxes that is within the radius of the box with the corners low and high.
inline unsigned BoxesNear(const float boxes[6][8], const float low[3], const float high[3], float radius_mm) {
  F8 square = F(0.0f);
  for (int a = 0; a < 3; ++a) {
    const F8 out_of = Max(F(0.0f), Max(Load(boxes[a]) - F(high[a]), F(low[a]) - Load(boxes[a + 3])));
    square = MulAdd(out_of, out_of, square);
  }
  return Bits(square <= F(radius_mm * radius_mm));
}

}  // namespace HWY_NAMESPACE
}  // namespace osteon::simulation::cpu
HWY_AFTER_NAMESPACE();
#endif
