#pragma once

#include <string>

#include <tl/expected.hpp>

#include "app/report/png_file.h"

namespace osteon::app {

/// An SVG document as a picture, on white.
/// @param scale  pixels to one px of the document, 0.1 … 10
/// @returns librsvg's message where it is no SVG, or one where the picture would have more than 100 million
///   pixels.
[[nodiscard]] tl::expected<Image, std::string> Rasterise(const std::string& svg, double scale = 2.0);

}  // namespace osteon::app
