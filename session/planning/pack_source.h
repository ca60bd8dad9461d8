#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "simulation/bone/scenes.h"
#include "simulation/packing/packing_file.h"
#include "simulation/solids/cut_zone.h"
#include "simulation/solids/mass_properties.h"

namespace osteon::session {

/// A planned tool path: a CSV file with a line "x_mm,y_mm,z_mm" for each position of the tool's centre.
struct PathChoice {
  std::filesystem::path file;
  double radius_m{0.0};  ///< radius of the tool
};

/// The options of a command line that choose the object to pack.
struct SourceOptions {
  std::string input;        ///< a mesh file, a scene's YAML file or name, or a shape ball:R or box:X,Y,Z (mm)
  bool scenes_only{false};  ///< the input can only be a scene
  std::filesystem::path config_root;         ///< folder with scenes/ and materials/
  std::string scene;                         ///< the scene whose solid a mesh replaces; empty: the acetabulum
  std::optional<double> scale{};             ///< millimetres per unit of a mesh file
  std::filesystem::path materials;           ///< file of materials; empty: those of config_root
  std::optional<simulation::CutSite> cup{};  ///< site at which a mesh or a shape is cut
  std::optional<simulation::Ball> region{};  ///< the surface within this ball is cut
  std::optional<PathChoice> path{};          ///< the bone is cut along this path
  /// true: the packing becomes coarser with the depth below the zone or, if no zone is given, below the whole
  /// surface
  bool graded{false};
};

/// The loaded object to pack: a solid, the zone in which it is cut, and its materials.
struct PackSource {
  std::string name;  ///< name of the bone
  std::shared_ptr<const simulation::Solid> solid;
  std::unique_ptr<simulation::CutZone> zone;  ///< the zone in which the bone is cut and packed finely
  std::string zone_text;                      ///< description of the zone, for users and for the provenance
  bool zone_is_uniform{true};  ///< the zone is the whole bone: the depth below it is 0 everywhere
  simulation::CutSite site{
      .center_m = {}, .axis = Vector3(Vector3::UnitZ()), .radius_m = 0.0};  ///< radius 0: none
  std::vector<simulation::Material> materials;
  std::optional<simulation::SceneParams> own;  ///< the chosen scene, with its packing and mass points
  std::size_t triangles{0};                    ///< number of triangles of a mesh
  /// Mass properties of the solid at a uniform density of 1000 kg/m³, by a closed form; absent if there is no
  /// closed form.
  std::optional<simulation::MassProperties> even;
  std::string warning;  ///< the assumptions made for a mesh that does not bound a solid; empty: none
  /// source of the bone, and the parameters that are known at this stage
  simulation::PackingProvenance provenance;
};

/// Loads the object to pack. The error names the option or file, what was found and what is accepted.
/// @throws config::ConfigError, std::invalid_argument
[[nodiscard]] tl::expected<PackSource, std::string> LoadPackSource(const SourceOptions& options);

/// Parses "X,Y,Z,R" (mm).
[[nodiscard]] tl::expected<simulation::Ball, std::string> ParseRegion(const std::string& text);

/// Parses a given number of numbers separated by commas. @param what  beginning of the error, such as
/// "--region"
[[nodiscard]] tl::expected<std::vector<double>, std::string> ParseNumbers(const std::string& text,
                                                                          std::size_t count,
                                                                          const std::string& what);

}  // namespace osteon::session
