#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "config/reading/bone_config.h"
#include "config/reading/identified_cell.h"
#include "config/reading/tool_config.h"
#include "control/laws/gains.h"
#include "control/setup/servo_params.h"
#include "hil/can/simulated_devices.h"
#include "hil/injection/wire_faults.h"
#include "hil/operator/scripts.h"
#include "hil/plc/plc_server.h"
#include "hil/simulated_cell.h"
#include "io/devices/device_params.h"
#include "io/fri/fri_session.h"
#include "io/rsi/rsi_session.h"
#include "kinematics/chain_params.h"
#include "kinematics/lbr_params.h"
#include "kinematics/ortho_parallel_params.h"
#include "simulation/bone/scenes.h"
#include "simulation/engine/cutting_engine.h"

// Content of the files under config/, in SI. Values that a library takes are kept in the library's own
// parameter types; the other types are defined here. Plain data; the accepted ranges are in the loaders
// (load.h).

namespace osteon::config {

/// Where the arm begins: the tool points into the cup along its axis.
struct StartConfig {
  double height_m{0.0};         ///< distance of the head's centre from the cup's centre, along the cup's axis
  double tool_yaw_rad{0.0};     ///< turns the tool about its axis: R_CT = Rx(pi) Rz(yaw)
  Pose X_WT{Pose::Identity()};  ///< tool pose at the start, computed from height_m and tool_yaw_rad
  double arm_angle_rad{0.0};    ///< arm angle at the start; only for an LBR
  control::JointPathParams path;  ///< the path to the start from the posture in which the arm is handed over
  double pause_force_N{40.0};     ///< a hand that pushes harder than this pauses the path
  /// Joint positions at the start [rad]. Of several solutions, the nearest to zero is used for an LBR, and
  /// the nearest to the usual posture, 0 -90 90 0 90 0 deg, for a six-axis arm. The seventh joint of a
  /// six-axis arm is 0.
  kinematics::JointVector q{kinematics::JointVector::Zero()};
};

/// An arm of seven joints.
struct LbrConfig {
  kinematics::LbrParams params;
  /// The same arm joint by joint. The last link includes the load on the flange: force sensor and tool.
  kinematics::ChainParams<7> chain;
};

/// An arm of six axes; their masses are not published.
struct SixAxisConfig {
  kinematics::OrthoParallelParams params;
  kinematics::ChainParams<6> chain;  ///< the same arm joint by joint
};

struct RobotConfig {
  std::string name;
  std::variant<LbrConfig, SixAxisConfig> arm;

  /// Each returns null if the arm is of the other kind.
  [[nodiscard]] const LbrConfig* lbr() const { return std::get_if<LbrConfig>(&arm); }
  [[nodiscard]] const SixAxisConfig* six_axis() const { return std::get_if<SixAxisConfig>(&arm); }
};

/// Address at which the arm's messages arrive, and their protocol. The simulated arm sends to the same
/// address. An LBR uses FRI, an arm of six axes RSI.
struct ArmLinkConfig {
  std::string host;  ///< dotted IPv4, of this machine
  /// Address of the arm, dotted IPv4. Datagrams from other addresses are ignored. Empty: the first sender is
  /// taken for the arm.
  std::string arm_host{};
  std::uint16_t port{0};
  std::variant<io::FriSessionParams, io::RsiSessionParams> session;

  /// Each returns null if the arm uses the other protocol.
  [[nodiscard]] const io::FriSessionParams* fri() const {
    return std::get_if<io::FriSessionParams>(&session);
  }
  [[nodiscard]] const io::RsiSessionParams* rsi() const {
    return std::get_if<io::RsiSessionParams>(&session);
  }
};

/// The guard: an independent process between arm and controller. The arm sends to the guard, which relays to
/// the address of ArmLinkConfig.
struct GuardConfig {
  std::string host;  ///< IPv4 address of this machine at which the guard receives the arm's messages
  std::uint16_t port{0};
  double margin{0.25};     ///< the guard's limits exceed the controller's own by this share
  double silence_s{0.05};  ///< longest time without an answer of the controller
};

/// The process that runs the cutting engine.
struct EngineProcessConfig {
  std::string host{};     ///< IPv4 address at which `osteon simulate` listens; empty: the run starts `osteon
                          ///< simulate` itself
  std::uint16_t port{0};  ///< UDP port; 0 if host is empty
  /// File with the token that an engine on another machine requires; relative to the cell's folder. Empty: no
  /// token.
  std::filesystem::path token_file{};
};

/// Whether a part of the cell is simulated as compliant.
enum class GivesWay : std::uint8_t {
  kOff,
  kOn,
  kAuto,  ///< compliant only if that changes force or depth noticeably
          ///< (simulation/fidelity/compliance_level.h)
};

/// The parts of the cell that may be compliant, as the cell's file states them.
struct ComplianceConfig {
  GivesWay layer{GivesWay::kOff}, tool{GivesWay::kOff}, mount{GivesWay::kOff};
  double error_m{0.1e-3};  ///< accepted error E of depth, from the cell's file or else the scene's `fidelity`
  std::optional<control::BoneMountParams> bone_mount{};
  std::string mount_source{};          ///< source of the mount's figures, or "assumed"
  double lateral_N{0.0}, push_N{0.0};  ///< expected forces: lateral on the tool; push on tissue and mount
};

/// A cell, with the contents of the files that it names.
struct CellConfig {
  RobotConfig robot;
  ToolConfig tool;
  std::filesystem::path tool_file;  ///< the file that `tool` was read from
  simulation::SceneParams scene;    ///< the scene, with the materials that it needs
  std::optional<BoneConfig> bone;   ///< absent: the scene's own solid
  Pose X_WB{Pose::Identity()};      ///< robot base in world
  Pose X_WG{Pose::Identity()};      ///< pose in the world of the frame C of the bone's site
  StartConfig start;
  /// the loop's parameters, including the robot's limits and the tool's spindle speed
  control::ServoParams servo;
  ComplianceConfig compliance;  ///< as the file states it; the loop's parameters are servo.compliance
  control::Gains own_gains;     ///< gains of the cell's file, before a gains file overrides them
  /// the engine's parameters, including the coupling's stiffness and the cell's force limit
  simulation::CuttingParams cutting;
  ArmLinkConfig link;
  std::optional<GuardConfig> guard;  ///< absent: the arm sends directly to the address of `link`
  /// Pauses the cell if the console page with the operator's role vanishes.
  bool pause_when_operator_leaves{false};
  std::optional<EngineProcessConfig> engine_process;  ///< absent: the engine is a thread of the run
  io::DeviceParams devices;                           ///< addresses of force sensor, reamer drive and PLC
  /// Whether the file has the sections `operator`, `script` and `simulated_arm`. A cell that is used only
  /// with a real arm needs none of them. Commands that simulate a cell refuse a cell without them
  /// (RequireSimulation).
  bool has_simulation{true};
  hil::SimulatedCellParams simulated;  ///< arm, operator and force sensor that replace the real ones
  hil::SimulatedDeviceParams simulated_devices;  ///< simulated force sensor and drive
  std::optional<hil::PlcServerParams> simulated_plc;
  hil::InjectionParams injections;  ///< faults on the simulated cell's wires
  hil::ScriptParams script;         ///< the operator's script
  /// The measured figures of this cell (apply_identified.h). Absent: the figures of the simulated arm are
  /// assumptions.
  std::optional<IdentifiedCell> identified{};
};

}  // namespace osteon::config
