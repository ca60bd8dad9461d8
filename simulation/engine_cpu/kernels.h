#pragma once

#include <cstdint>
#include <vector>

#include "simulation/engine_cpu/pass_data.h"

namespace osteon::simulation::cpu {

/// The passes, compiled for one instruction set. All sets give the same bits: doubles are computed in the
/// reference engine's order, with one rounding per operation, and floats only exclude pairs that cannot
/// change the result.
struct Kernels {
  const char* name;

  /// Places the tool's balls and its origin at the pose with rotation R and translation p.
  void (*place)(const double R[9], const double p[3], const ToolView& tool, Places to);
  /// Computes the places at the fraction s of the straight paths from a to b.
  void (*between)(Places a, Places b, double s, std::uint32_t count, Places to);
  /// Computes the places of a, shifted by v [m].
  void (*shifted)(Places a, const double v[3], std::uint32_t count, Places to);
  /// Returns the largest distance between the places of the same ball in `a` and `b` [m], over balls first …
  /// last - 1.
  double (*farthest)(Places a, Places b, std::uint32_t first, std::uint32_t last);
  /// Computes the vector from each place of a to the same place of b [mm].
  void (*ways)(Places a, Places b, std::uint32_t count, float* x_mm, float* y_mm, float* z_mm);

  /// Returns the smallest fraction of the path with a contact, if it is below `first`; else `first`.
  double (*first_contact)(const ContactPass& pass, double first);
  /// Does the same for one block of eight balls and one tool ball.
  double (*block_contact)(const ContactPass& pass, std::uint32_t block, std::uint32_t tool, double first);
  /// Returns the fraction of the path at which a bone ball and a tool ball touch; 2: no contact.
  double (*pair_contact)(const ContactPass& pass, std::uint32_t ball, std::uint32_t tool);

  /// Finds the nearest pair of each bin of direction, and the sums over each face's cone.
  /// @param likely_place, likely_tool  pairs that are likely to be near; read in groups of eight
  void (*near_field)(NearFieldPass& pass, const std::uint32_t* likely_place, const std::uint32_t* likely_tool,
                     std::size_t likely_count);
  // each of these passes is described at the struct of its data (pass_data.h)
  void (*engagement)(EngagementPass& pass);
  void (*removal)(RemovalPass& pass);
  void (*large_balls)(LargeBallPass& pass);
  void (*clearing)(ClearingPass& pass);

  /// ball_rows and point_rows make a row for each tool ball of `tools` within reach of the block, with the
  /// bound of its gap.
  /// @returns the number of rows made.
  std::size_t (*ball_rows)(const RowMaker& maker, const BallBlock& block, const std::uint16_t* tools,
                           std::size_t count);
  std::size_t (*point_rows)(const RowMaker& maker, const PointBlock& block, const std::uint16_t* tools,
                            std::size_t count);
  /// Returns a bit for each of eight points that is within reach of a tool ball of the list.
  unsigned (*points_near)(const RowMaker& maker, const float* x, const float* y, const float* z,
                          const std::uint16_t* tools, std::size_t count);
  /// Selects the tool balls of a list that may be within reach of a box. @returns their number
  std::size_t (*tools_near_box)(const RowMaker& maker, const float low[3], const float high[3],
                                const std::uint16_t* tools, std::size_t count, std::uint16_t* out);
  /// Returns a bit for each of eight boxes that is within `radius_mm` of the box with the corners low and
  /// high.
  unsigned (*boxes_near)(const float boxes[6][8], const float low[3], const float high[3], float radius_mm);
};

/// The instruction sets that this processor has and this program was built for, best first. Kernels::name is
/// Highway's name: "AVX3" is AVX-512, "EMU128" is plain C++.
[[nodiscard]] const std::vector<const Kernels*>& AvailableKernels();

}  // namespace osteon::simulation::cpu
