#pragma once

#include <cstddef>

#include "simulation/surface/welded_surface.h"

namespace osteon::surface {

/// Pieces of a surface that hang together.
struct PieceFigures {
  std::size_t pieces{0};   ///< separate pieces of bone, those that were dropped included
  std::size_t dropped{0};  ///< of them
  double dropped_mm3{0.0};
};

/// Drops pieces of bone below a volume, with the hollows within them: a circling burr leaves pins and chips
/// that nothing holds. The largest piece stays in any case, and so do hollows within bone that stays.
/// @param mesh  closed; becomes what is left  @param min_mm3  0: nothing is dropped
PieceFigures DropPiecesBelow(double min_mm3, WeldedSurface& mesh);

}  // namespace osteon::surface
