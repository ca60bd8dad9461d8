#include "app/cli/files/recorded_mesh_options.h"

#include "app/cli/usage/usage.h"

namespace osteon::app {

void RecordedMeshOptions::AddTo(CLI::App& command) {
  CLI::Option* mesh =
      command
          .add_option(
              "--mesh", mesh_.file,
              "the bone's mesh file, if the run was started with --mesh: a recording does not contain it")
          ->type_name("FILE")
          ->check(CLI::ExistingFile);
  command.add_option("--cup", cup_, "the run's --cup: centre, axis out of the bone, radius; mm")
      ->type_name("X,Y,Z,NX,NY,NZ,R")
      ->needs(mesh);
  command.add_option("--scale", mesh_.scale, "mm for each unit of the mesh file")
      ->check(NumberWithin(1e-4, 1e4))
      ->needs(mesh)
      ->capture_default_str();
}

tl::expected<std::optional<session::MeshChoice>, std::string> RecordedMeshOptions::Read() const {
  if (mesh_.file.empty()) return std::nullopt;
  session::MeshChoice mesh = mesh_;
  if (!cup_.empty()) {
    const auto cup = session::ParseCup(cup_);
    if (!cup) return tl::make_unexpected(cup.error());
    mesh.cup = *cup;
  }
  return mesh;
}

}  // namespace osteon::app
