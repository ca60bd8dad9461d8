#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/contact_memory.h"
#include "simulation/contact_model.h"

namespace osteon::simulation {

/// What the servo loop asks of the simulation; handed over through rt::LatestValue.
struct ToolCommand {
  PlainPose X_WT;  ///< the commanded tool pose (admittance) or the measured one (impedance)
  double spindle_rad_per_s{0.0};
  rt::Nanoseconds stamp{0};
};

/// One frame. Its path runs from the proxy of the frame before to X_WT.
struct FrameInput {
  PlainPose X_WT;
  double spindle_rad_per_s{0.0};
  double dt_s{0.001};        ///< time that the cut has to give way in this frame
  rt::Nanoseconds stamp{0};  ///< of X_WT
};

/// How bone gives way.
enum class RemovalLaw : std::uint8_t {
  kRate,       ///< by energy balance: power of the edge over specific cutting energy
  kImmediate,  ///< all the way to the tool's pose in every frame (the paper), however long that is
};

/// Which of the tool's cutting balls take bone away.
enum class Cutters : std::uint8_t {
  kAll,            ///< all, over the whole of the proxy's way
  kContactSphere,  ///< the (tool's first) one that touched first alone (the paper): leaves bone in its way
};

/// How balls that are too large for a cut are replaced by children (ball_removal.h, split_template.h).
struct SplitParams {
  bool on{false};
  double least_radius_m{0.4e-3};    ///< balls that are smaller when first touched shrink whole
  int children{24};                 ///< of a ball: 8 … 1024
  double least_child_share{0.12};   ///< of the ball's first radius; smaller children are dropped: 0 … 0.5
  std::size_t pool_blocks{4096};    ///< balls that can be split at a time: 1 … 1 000 000
  std::size_t blocks_per_frame{0};  ///< balls split in a frame at most, the others wait; 0: any number
};

struct CuttingParams {
  double stiffness_N_per_m{20e3};  ///< of the virtual coupling
  double max_force_N{200.0};       ///< the coupling force that the rate law may count on
  double normal_enlargement_m{
      0.24e-3};                         ///< e of the lens-weighted normal; planes are reported up to this gap
  double contact_tolerance_m{0.02e-3};  ///< overlap that sliding over balls may leave
  /// The longest way of the proxy's slide and, with the rate law, its advance in one frame; a fifth of it is
  /// the advance's alone while it cuts (kSlideShare).
  double max_slide_m{0.25e-3};
  double engaged_layer_m{0.5e-3};  ///< depth of the layer that measures the engaged area
  RemovalLaw law{RemovalLaw::kRate};
  Cutters cutters{Cutters::kAll};
  SplitParams split{};
};

/// The carved state: everything that a frame changes.
struct CarvedState {
  std::vector<float> balls;           ///< x y z r [mm] in G for each ball; r = 0 where it is gone
  std::vector<std::uint8_t> cleared;  ///< 1 for each mass point that is gone
  /// Balls that were split, ascending: for each what its block holds. Empty where none is.
  std::vector<std::uint32_t> split_balls;
  /// For each of them 0 where its block holds children, 1 + n where the ball waits for them and its block
  /// holds n capsules that they will be cut by.
  std::vector<std::uint32_t> split_cuts;
  /// Blocks of SplitParams::children × 4 floats [mm] in G. Children: x y z r of each, r = 0 where it is gone.
  /// Waiting: x y z r of the ball that the children will be made from, then a x y z R, b x y z 0 of each
  /// capsule, then zeros.
  std::vector<float> split_slots;
  PlainPose X_GP;  ///< proxy in G
  bool has_proxy{false};
  double removed_volume_m3{0.0}, removed_mass_kg{0.0}, cutting_work_J{0.0};
  double cutting_debt_J{0.0};  ///< work of cleared points that the edge has not yet done
  ContactMemory contact;       ///< what held the tool
  std::uint64_t frame{0};
};

/// The cutting model: collision, contact, removal. One thread at a time.
class CuttingEngine {
 public:
  virtual ~CuttingEngine() = default;

  /// One frame; never throws. The first frame takes X_WT as free.
  virtual ContactModel Step(const FrameInput& input) = 0;

  [[nodiscard]] virtual CarvedState Snapshot() const = 0;
  /// @throws std::invalid_argument where the state is not of this bone and tool; nothing has changed then.
  virtual void Restore(const CarvedState& state) = 0;

  /// "reference" or "vulkan".
  [[nodiscard]] virtual std::string name() const = 0;
  /// What it runs on, e.g. "llvmpipe (LLVM 15.0.6, 256 bits)".
  [[nodiscard]] virtual std::string device() const = 0;
};

/// FNV-1a over balls, split ones in the order of their parents, and cleared points: equal for equal carved
/// states, on any machine.
[[nodiscard]] std::uint64_t HashState(const CarvedState& state);

}  // namespace osteon::simulation
