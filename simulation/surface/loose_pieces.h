#pragma once

#include <cstddef>

#include "simulation/surface/welded_surface.h"

namespace osteon::surface {

/// Counts of a surface's connected pieces.
struct PieceFigures {
  std::size_t pieces{0};   ///< separate pieces of bone, including the dropped ones
  std::size_t dropped{0};  ///< how many of `pieces` were dropped
  double dropped_mm3{0.0};
};

/// Drops pieces of bone below a volume, with the hollows within them: a circling burr leaves loose pins and
/// chips. The largest piece stays in any case, and so do hollows within bone that stays.
/// @param mesh  closed; the dropped pieces are removed from it  @param min_mm3  0: nothing is dropped
PieceFigures DropPiecesBelow(double min_mm3, WeldedSurface& mesh);

}  // namespace osteon::surface
