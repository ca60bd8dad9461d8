#pragma once

#include <string>

#include <tl/expected.hpp>

#include "report/png_file.h"

namespace osteon::report {

/// Renders an SVG document to pixels, on white.
/// @param scale  pixels per px of the document, 0.1 … 10
/// @returns the picture, or an error: librsvg's message if the document is not SVG, or a message if the
/// picture would have more than 100 million pixels.
[[nodiscard]] tl::expected<Image, std::string> Rasterise(const std::string& svg, double scale = 2.0);

}  // namespace osteon::report
