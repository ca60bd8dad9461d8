#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/contact/contact_memory.h"
#include "simulation/contact/contact_model.h"

namespace osteon::simulation {

/// A tool pose that the servo loop sends to the simulation through rt::LatestValue.
struct ToolCommand {
  PlainPose X_WT;  ///< the commanded tool pose (admittance) or the measured one (impedance)
  double spindle_rad_per_s{0.0};
  rt::Nanoseconds stamp{0};
  std::uint8_t tool_index{0};  ///< index of the tool in the servo loop's table of tools
  bool paused{false};          ///< the loop is paused: at rest, under power
};

/// Input of one frame. Its path runs from the previous frame's proxy to X_WT.
struct FrameInput {
  PlainPose X_WT;
  double spindle_rad_per_s{0.0};
  double dt_s{0.001};        ///< time in which the bone can give way in this frame
  rt::Nanoseconds stamp{0};  ///< stamp of X_WT
};

/// The cutting law: how bone gives way.
enum class RemovalLaw : std::uint8_t {
  kRate,       ///< by the energy balance: power of the edge over specific cutting energy
  kImmediate,  ///< up to the tool's pose in every frame, at any distance (the paper)
};

/// The cutting balls of the tool that remove bone in a frame.
enum class Cutters : std::uint8_t {
  kAll,            ///< all cutting balls, along the proxy's whole path
  kContactSphere,  ///< only the ball that touched first, at a tie the lowest index (the paper): leaves bone
                   ///< in the other balls' path
};

/// How balls that are too large for a cut are replaced by children (ball_removal.h, split_template.h).
struct SplitParams {
  bool on{false};
  double min_radius_m{0.4e-3};      ///< balls that are smaller at the first touch are not split
  int children{24};                 ///< number of children of a ball: 8 … 1024
  double min_child_share{0.12};     ///< smallest radius of a child over the uncut ball's radius: 0 … 0.5
  std::size_t pool_blocks{4096};    ///< number of balls that can be split at the same time: 1 … 1 000 000
  std::size_t blocks_per_frame{0};  ///< largest number of balls split in a frame; others wait; 0: no limit
};

/// Parameters of the cutting model.
struct CuttingParams {
  double stiffness_N_per_m{20e3};  ///< stiffness of the virtual coupling
  double max_force_N{200.0};       ///< largest coupling force that the rate law assumes
  /// The tool is enlarged by this length for the lens-weighted normals. Planes are reported up to this gap.
  double normal_enlargement_m{0.24e-3};
  double contact_tolerance_m{0.02e-3};  ///< overlap that may remain when the tool slides over balls
  /// Longest travel of the proxy in one frame, by slide and, with the rate law, advance together. While the
  /// tool cuts with the rate law, a fifth of it is reserved for the advance (kSlideShare).
  double max_slide_m{0.25e-3};
  double engaged_layer_m{0.5e-3};  ///< depth of the layer in which the engaged area is measured
  RemovalLaw law{RemovalLaw::kRate};
  Cutters cutters{Cutters::kAll};
  /// Rate law, true: the edges' own force must be overcome before bone gives way
  /// (Material::edge_force_N_per_m, ToolBall::edges). False: only the cutting energy matters.
  bool edge_force{false};
  SplitParams split{};
};

/// The carved state: everything that a frame changes.
struct CarvedState {
  std::vector<float> balls;           ///< x y z r [mm] in G for each ball; r = 0: the ball is gone
  std::vector<std::uint8_t> cleared;  ///< 1 for each mass point that is gone
  /// Indices of split balls, ascending.
  std::vector<std::uint32_t> split_balls;
  /// For each split ball: 0 if its block holds children; 1 + n if the ball still waits for its children, and
  /// its block holds the n capsules by which they will be cut.
  std::vector<std::uint32_t> split_cuts;
  /// Blocks of SplitParams::children × 4 floats [mm] in G, one for each split ball. A block of children: x y
  /// z r of each child; r = 0: the child is gone. A block of a waiting ball: x y z r of the ball from which
  /// children will be made; then for each capsule its ends a and b and its radius R, as a_x a_y a_z R, b_x
  /// b_y b_z 0; then zeros.
  std::vector<float> split_slots;
  PlainPose X_GP;  ///< proxy in G
  bool has_proxy{false};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0};
  double cutting_debt_J{0.0};  ///< work of cleared mass points that the edge has not done yet
  ContactMemory contact;       ///< memory of the contact law
  std::uint64_t frame{0};
};

/// The cutting model: collision, contact, removal. Use it from one thread at a time.
class CuttingEngine {
 public:
  virtual ~CuttingEngine() = default;

  /// Computes one frame; never throws. The first frame assumes that X_WT is free of contact.
  virtual ContactModel Step(const FrameInput& input) = 0;

  /// Copies the carved state.
  [[nodiscard]] virtual CarvedState Snapshot() const = 0;
  /// Continues from a carved state.
  /// @throws std::invalid_argument if the state belongs to another bone or tool; the engine is then
  /// unchanged.
  virtual void Restore(const CarvedState& state) = 0;

  /// "reference", "vulkan" or "cpu".
  [[nodiscard]] virtual std::string name() const = 0;
  /// The hardware or driver that the engine runs on, for example "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] virtual std::string device() const = 0;
};

/// Computes the FNV-1a hash of balls, split balls in the order of their parents, and cleared points. Equal
/// carved states have equal hashes on any machine.
[[nodiscard]] std::uint64_t HashState(const CarvedState& state);

}  // namespace osteon::simulation
