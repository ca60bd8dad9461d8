#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

#include "io/engine/engine_ports.h"
#include "io/engine/shared_memory.h"

// Connection of a run and its engine on one machine, by a folder in the system's shared memory that only the
// run's user may enter. The run creates the folder, passes its name to the engine's process, and removes it
// at the end.
//
//     FOLDER/segment   SharedEngine, mapped by both processes; the run holds a lock on it as long as its process exists
//     FOLDER/setup     EngineSetup, written before the engine starts
//     FOLDER/carved    the carved state, written by the engine at the end

namespace osteon::io {

/// The run's side of the connection.
class LocalEngineClient final : public EngineClient {
 public:
  /// Creates the folder. Also removes the folders of runs that ended without removing theirs.
  [[nodiscard]] static tl::expected<std::unique_ptr<LocalEngineClient>, std::string> Create(
      std::span<const std::uint8_t> setup);
  ~LocalEngineClient() override;
  LocalEngineClient(const LocalEngineClient&) = delete;
  LocalEngineClient& operator=(const LocalEngineClient&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }
  /// The state that the engine reports.
  [[nodiscard]] SharedState state() const { return shared_->engine.load(std::memory_order_acquire); }
  /// Reads the engine's name and device. Call after state() has become kRunning.
  void ReadNames();
  /// Returns why the engine failed. Call after state() has become kFailed.
  [[nodiscard]] std::string ReadError() const;

  [[nodiscard]] const simulation::ContactModel& Load() OSTEON_RT override;
  void Store(const simulation::ToolCommand& command) OSTEON_RT override;
  [[nodiscard]] bool AwaitFrame(EngineFrame& frame, rt::Nanoseconds deadline) override;
  void Send(const EngineCommand& command) override;
  [[nodiscard]] tl::expected<std::vector<std::uint8_t>, std::string> FetchCarved(
      rt::Nanoseconds deadline) override;
  [[nodiscard]] EngineCounters counters() const override;
  [[nodiscard]] const std::string& engine() const override { return engine_; }
  [[nodiscard]] const std::string& device() const override { return device_; }

 private:
  LocalEngineClient(std::filesystem::path folder, int file, SharedEngine* shared);
  void StoreCommand(const EngineCommand& command) OSTEON_RT;

  std::filesystem::path folder_;
  int file_;
  SharedEngine* shared_;
  SlotWriter commands_;
  SlotReader models_;
  // number of commands sent; sequence number of the frame expected next
  std::uint64_t session_, sent_{0}, next_frame_{1};
  EngineBytes command_bytes_, model_bytes_, frame_bytes_;
  EngineFrame newest_;
  std::atomic<std::uint64_t> rejected_{0};
  EngineCounters counters_;
  std::string engine_, device_;
};

/// The engine's side of the connection.
class LocalEngineServer final : public EngineServer {
 public:
  /// Opens a folder that a run has created. The error says what is wrong with it.
  [[nodiscard]] static tl::expected<std::unique_ptr<LocalEngineServer>, std::string> Open(
      const std::filesystem::path& folder);
  ~LocalEngineServer() override;
  LocalEngineServer(const LocalEngineServer&) = delete;
  LocalEngineServer& operator=(const LocalEngineServer&) = delete;

  [[nodiscard]] tl::expected<std::vector<std::uint8_t>, std::string> ReadSetup() const;
  /// Reports to the run that the engine is running, with the engine's name and device.
  void SetRunning(const std::string& engine, const std::string& device);
  /// Reports to the run why the engine could not start.
  void SetFailed(const std::string& why);

  [[nodiscard]] EngineEvent Await(EngineCommand& command, rt::Nanoseconds deadline) override;
  void Publish(const EngineFrame& frame) override;
  void PutCarved(std::vector<std::uint8_t> bytes) override;

 private:
  LocalEngineServer(std::filesystem::path folder, int file, SharedEngine* shared);
  // Whether the run has ended, or its process no longer exists.
  [[nodiscard]] bool IsRunGone() const;

  std::filesystem::path folder_;
  int file_;
  SharedEngine* shared_;
  SlotReader commands_;
  SlotWriter models_;
  std::uint64_t session_, made_{0};  // number of frames made
  EngineBytes command_bytes_, frame_bytes_;
  rt::Nanoseconds run_checked_at_{0};
};

}  // namespace osteon::io
