#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "config/reading/strict/reader.h"
#include "simulation/solids/tissue_map.h"

namespace osteon::config {

/// The samples of a grey picture as stored, without gamma or colour profile.
struct GreyImage {
  int rows{0}, columns{0};
  std::vector<float> level;  ///< rows × columns, row by row from the top: 0 black … 1 white
};

/// Reads a PNG of grey samples of 16 bits or fewer, without transparency, up to 4096 × 4096.
/// @returns the image, or "found …, accepted …", without the file's name.
[[nodiscard]] tl::expected<GreyImage, std::string> ReadGreyPng(const std::filesystem::path& path);

/// Reads the name of a material in a section and returns its index.
using ReadMaterial = std::function<simulation::MaterialIndex(Reader& section, const std::string& key)>;

/// Reads the mapping `density_image` and the picture that it names.
///
///     file: ../images/profile.png          relative to this file; the image's top row lies at the surface
///     row_step_mm: 0.5                      depth from row to row
///     density_g_per_cm3: [0, 2]             densities of black and of white; linear between them
///     axis: [0, 0, 1]                       unit vector in the mesh's frame, along which the columns lie
///     column_heights_mm: [-20, 20]          positions of the first and the last column along the axis
///     classes:                              in ascending order; the last one has no bound
///       - {below_g_per_cm3: 1, material: cancellous}
///       - {material: cortical}
///
/// @throws ConfigError with file, line, key, what was found and what is accepted. Calls Finish() for this
///   section.
[[nodiscard]] simulation::DensityImage ReadDensityImage(Reader section, const ReadMaterial& read_material);

}  // namespace osteon::config
