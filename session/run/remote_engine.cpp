#include "session/run/remote_engine.h"

#include <csignal>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/work_folder.h"
#include "io/engine/engine_setup.h"
#include "io/engine/local_engine.h"
#include "io/engine/udp_engine.h"
#include "io/recording/recording_reader.h"
#include "session/replay/recarve.h"
#include "session/run/engine_token.h"
#include "simulation/files/carved_file.h"

namespace osteon::session {
namespace {

// Longest wait until the other process has made its engine: a driver may have to compile all shaders.
constexpr rt::Nanoseconds kEngineReady = 120 * rt::kSecond;
constexpr rt::Nanoseconds kCarvedPatience = 10 * rt::kSecond;  // longest wait for the carved state
constexpr rt::Nanoseconds kPoll = 5 * rt::kMillisecond;        // time between two checks of the process
constexpr std::chrono::seconds kEndPatience{5};                // longest wait for its end before it is killed

// Encodes what the other process needs to make its engine: bone, tool, pose of the bone, cutting parameters.
std::vector<std::uint8_t> SetupBytes(const CellSetup& setup) {
  return io::EncodeSetup({.bone = setup.bone,
                          .tool = setup.config.tool.tool,
                          .X_WG = setup.X_WG,
                          .cutting = setup.config.cutting});
}

// A child's exit code in words; above 128 it is 128 plus the number of the signal that ended the child.
std::string EndText(int code) {
  if (code > 128) return fmt::format("signal {} ({})", code - 128, strsignal(code - 128));
  return fmt::format("exit code {}", code);
}

}  // namespace

tl::expected<std::unique_ptr<RemoteEngine>, std::string> RemoteEngine::Open(
    const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml) {
  std::unique_ptr<RemoteEngine> engine(new RemoteEngine(setup, choice));
  const bool local = !setup.config.engine_process || setup.config.engine_process->host.empty();
  if (std::string wrong = local ? engine->StartLocal() : engine->Connect(cell_yaml); !wrong.empty())
    return tl::make_unexpected("simulation: " + std::move(wrong));
  return engine;
}

RemoteEngine::~RemoteEngine() {
  if (!child_) return;
  child_->Send(SIGCONT);  // continue a halted process: otherwise it could not end
  child_->Send(SIGTERM);
  child_->End(kEndPatience);
}

std::string RemoteEngine::StartLocal() {
  auto client = io::LocalEngineClient::Create(SetupBytes(setup_));
  if (!client) return client.error();
  std::vector<std::string> words{"simulate", "--local", (*client)->folder().string(), "--engine",
                                 choice_.engine};
  if (!choice_.device.empty()) words.insert(words.end(), {"--device", choice_.device});
  auto child = base::ChildProcess::Start({.words = std::move(words), .program = OsteonProgram()});
  if (!child) return child.error();
  child_ = std::move(*child);
  const rt::Nanoseconds give_up = rt::MonotonicNow() + kEngineReady;
  while ((*client)->state() == io::SharedState::kStarting) {
    if (!DescribeEnd().empty()) return "the engine's process has ended: " + ended_;
    if (rt::MonotonicNow() > give_up) return "the engine's process did not make its engine in 120 s";
    rt::SleepUntil(rt::MonotonicNow() + kPoll);
  }
  if ((*client)->state() == io::SharedState::kFailed) return (*client)->ReadError();
  (*client)->ReadNames();
  where_ = fmt::format("local, process {}", child_->pid());
  client_ = std::move(*client);
  return "";
}

std::string RemoteEngine::Connect(const std::filesystem::path& cell_yaml) {
  const config::EngineProcessConfig& process = *setup_.config.engine_process;
  io::UdpEngineParams params{.address = process.host, .port = process.port};
  if (!process.token_file.empty()) {
    auto token = ReadEngineToken(cell_yaml.parent_path() / process.token_file);
    if (!token) return "token_file: " + token.error();
    params.token = std::move(*token);
  }
  auto client = io::UdpEngineClient::Connect(params, SetupBytes(setup_));
  if (!client) return client.error();
  where_ = fmt::format("{}:{}", process.host, process.port);
  client_ = std::move(*client);
  return "";
}

simulation::ContactModel RemoteEngine::Step(const simulation::FrameInput& input) {
  client_->Send(
      {.command = {.X_WT = input.X_WT, .spindle_rad_per_s = input.spindle_rad_per_s, .stamp = input.stamp},
       .dt_s = input.dt_s});
  const rt::Nanoseconds give_up = rt::MonotonicNow() + kLockstepPatience;
  io::EngineFrame frame;
  while (client_->AwaitFrame(frame, give_up))
    if (frame.model.pose_stamp == input.stamp) return frame.model;
  simulation::ContactModel lost;
  lost.status = simulation::EngineStatus::kDeviceLost;
  lost.pose_stamp = input.stamp;
  return lost;
}

void RemoteEngine::Restore(const simulation::CarvedState& /*state*/) {
  throw std::invalid_argument("an engine in a process of its own begins with the uncut bone");
}

std::string RemoteEngine::DescribeEnd() {
  if (ended_.empty() && child_ && child_->Ended()) ended_ = EndText(child_->End(std::chrono::seconds(0)));
  return ended_;
}

std::string RemoteEngine::FetchCarved() {
  if (!DescribeEnd().empty()) return "the engine's process has ended: " + ended_;
  const auto bytes = client_->FetchCarved(rt::MonotonicNow() + kCarvedPatience);
  if (!bytes) return bytes.error();
  const base::WorkFolder folder("carved");
  if (folder.path().empty()) return "cannot make a temporary folder";
  const std::filesystem::path file = folder.path() / "carved";
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes->data()), static_cast<std::streamsize>(bytes->size()));
  stream.close();
  if (!stream) return file.string() + ": cannot write";
  auto carved = simulation::ReadCarvedState(file, setup_.bone);  // this verifies the state
  if (!carved) return carved.error().Text();
  carved_ = std::move(*carved);
  return "";
}

std::string RemoteEngine::CarveAgain(const std::filesystem::path& recording) {
  auto engine = MakeEngine(setup_, {.engine = "cpu"});
  if (!engine) return engine.error();
  carved_ = (*engine)->Snapshot();
  auto stream = io::RecordingStream::Open(recording);
  if (!stream) return stream.error();
  Recarve recarve(**engine, setup_.config.servo.law);
  for (auto topic = stream->Next(); topic && *topic != io::RecordedTopic::kOther; topic = stream->Next()) {
    if (*topic == io::RecordedTopic::kTick) recarve.Add(stream->tick);
    if (*topic == io::RecordedTopic::kFrame) recarve.Wait(stream->frame);
    while (const auto frame = recarve.NextDue()) recarve.Add(*frame);
  }
  while (const auto frame = recarve.NextDue(true)) recarve.Add(*frame);
  carved_ = (*engine)->Snapshot();
  return "";
}

EngineProcessResult RemoteEngine::Finish(const std::filesystem::path& recording) {
  EngineProcessResult result;
  result.where = where_;
  result.ended = DescribeEnd();
  result.unfetched = FetchCarved();
  result.counters = client_->counters();
  if (!result.unfetched.empty())
    if (const std::string wrong = CarveAgain(recording); !wrong.empty()) result.unfetched += "; " + wrong;
  if (child_) {
    child_->Send(SIGCONT);
    child_->Send(SIGTERM);
    child_->End(kEndPatience);
    child_.reset();
  }
  return result;
}

std::filesystem::path OsteonProgram() {
  std::error_code ignored;
  const std::filesystem::path beside = base::ProgramBeside("osteon");
  return std::filesystem::is_regular_file(beside, ignored) ? beside : std::filesystem::path();
}

tl::expected<std::unique_ptr<simulation::CuttingEngine>, std::string> MakeRunEngine(
    const CellSetup& setup, const EngineChoice& choice, const std::filesystem::path& cell_yaml,
    RemoteEngine*& remote) {
  remote = nullptr;
  if (!setup.config.engine_process) return MakeEngine(setup, choice);
  auto engine = RemoteEngine::Open(setup, choice, cell_yaml);
  if (!engine) return tl::make_unexpected(engine.error());
  remote = engine->get();
  return std::move(*engine);
}

}  // namespace osteon::session
