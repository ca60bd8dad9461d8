#include "session/run/adaptive_resolution.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "base/percentile.h"
#include "base/realtime_thread.h"
#include "simulation/tools/tool_path.h"

namespace osteon::session {
namespace {

constexpr double kTrailShare = 0.2;          // tolerance of the thinned trail, as a fraction of the error
constexpr std::size_t kMaxPlaces = 200'000;  // largest trail; carving this many places takes minutes
constexpr std::size_t kCaughtUp = 4;         // at most this many places are left to the simulation's thread
// The carver has reached the run's tool pose if it is at most this far away.
constexpr double kArrived_m = 0.05e-3;

}  // namespace

// A packing that is being made. The thread that makes it owns it until `ready`.
struct AdaptiveResolution::Making {
  Made made;
  std::unique_ptr<simulation::CuttingEngine> carver;  // cuts along the whole trail with the immediate law
  std::size_t carved{0};                              // number of the trail's places that are carved
  std::string failed;
  std::atomic<bool> ready{false}, stop{false};
};

AdaptiveResolution::AdaptiveResolution(const CellSetup& setup, const AdaptiveResolutionParams& params)
    : setup_(setup),
      params_(params),
      X_GW_(setup.X_WG.inverse()),
      lever_m_(simulation::ToolLever(setup.config.tool.tool)),
      level_(setup.planned->plan.packed.level),
      trail_(MakeProxyTrail(setup)) {
  // Reserve the memory now. Otherwise the simulation's thread would copy megabytes whenever the trail needs
  // more memory, and the memory would grow during a long run.
  trail_.Reserve(kMaxPlaces);
}

AdaptiveResolution::~AdaptiveResolution() { End(); }

void AdaptiveResolution::End() {
  ended_ = true;
  if (!making_) return;
  making_->stop.store(true);
  if (thread_.joinable()) thread_.join();
  making_.reset();
  Say("the run ended before the coarser zones were there");
}

std::optional<double> AdaptiveResolution::SlowMedian(double took_us) {
  if (times_us_.size() < params_.window)
    times_us_.push_back(took_us);
  else
    times_us_[next_++ % params_.window] = took_us;
  if (times_us_.size() < params_.window) return std::nullopt;
  std::vector<double> sorted = times_us_;
  const double median_us = base::Median(sorted);
  return median_us > 1e6 / params_.rate_hz ? std::optional(median_us) : std::nullopt;
}

void AdaptiveResolution::ObserveFrame(const simulation::FrameRecord& record, double took_us) {
  {
    const std::scoped_lock lock(mutex_);
    if (trail_.places().size() < kMaxPlaces) trail_.Add(X_GW_ * Pose(record.model.X_WP));
  }
  if (ended_ || making_ || record.model.contact_count == 0) return;
  if (const auto slow_us = SlowMedian(took_us)) StartCoarsening(*slow_us);
}

void AdaptiveResolution::StartCoarsening(double seen_us) {
  times_us_.clear();  // the next median is to include new frames only
  next_ = 0;
  const double max_us = params_.within_ratio * 1e6 / params_.rate_hz;
  const auto zones = CoarserFor(setup_.planned->scene, setup_.planned->plan, level_, seen_us, max_us);
  const std::string slow_text = fmt::format("frames take {:.0f} us, {:.0f} us at {:g} Hz", seen_us,
                                            1e6 / params_.rate_hz, params_.rate_hz);
  if (!zones || trail_.places().size() >= kMaxPlaces) {
    ended_ = true;
    Say(slow_text + (zones ? ": the tool has gone too long a way to carve coarser zones by"
                           : ": no coarser zones would have the rate"));
    return;
  }
  Say(fmt::format("{}: coarser zones are made, {:.3f} mm apart", slow_text,
                  zones->level.fine.spacing_m * 1e3));
  making_ = std::make_unique<Making>();
  making_->made.rezoned = {.zones = *zones, .seen_us = seen_us, .bone = {}};
  if (params_.at_once) {
    PackCoarser(*making_);
    return;
  }
  if (thread_.joinable()) thread_.join();
  thread_ = std::thread([this] {
    rt::NameThread("zones");
    PackCoarser(*making_);
  });
}

void AdaptiveResolution::PackCoarser(Making& making) {
  const simulation::PackingLevel& level = making.made.rezoned.zones.level;
  simulation::Bone& bone = making.made.rezoned.bone;
  try {
    bone = session::PackCoarser(setup_, level);
    auto engines = MakeCoarserEngines(setup_, level, bone, params_.engine);
    if (!engines) {
      making.failed = engines.error();
    } else {
      making.carver = std::move(engines->carver);
      making.made.engine = std::move(engines->engine);
      // carve along the whole trail, then along the part that the run added in the meantime
      std::vector<PlainPose> places;
      do {
        {
          const std::scoped_lock lock(mutex_);
          places.assign(trail_.places().begin() + static_cast<std::ptrdiff_t>(making.carved),
                        trail_.places().begin() + static_cast<std::ptrdiff_t>(trail_.settled()));
        }
        for (const PlainPose& place : places) {
          if (making.stop.load(std::memory_order_relaxed)) return;
          if (!simulation::CarveTrail(*making.carver, {&place, 1})) {
            making.failed = "a frame of the carving was refused";
            break;
          }
        }
        making.carved += places.size();
      } while (making.failed.empty() && places.size() > kCaughtUp);
    }
  } catch (const std::exception& error) {
    making.failed = error.what();
  }
  making.ready.store(true, std::memory_order_release);
}

std::optional<AdaptiveResolution::Made> AdaptiveResolution::TakeReplacement(
    const simulation::CuttingEngine& now) {
  if (!making_ || !making_->ready.load(std::memory_order_acquire)) return std::nullopt;
  if (thread_.joinable()) thread_.join();
  const std::unique_ptr<Making> making = std::move(making_);
  const auto refuse = [&](const std::string& why) -> std::nullopt_t {
    ended_ = true;
    Say("the coarser zones can't be had: " + why);
    return std::nullopt;
  };
  if (!making->failed.empty()) return refuse(making->failed);
  try {
    const std::vector<PlainPose>& places = trail_.places();
    const auto rest = std::span(places).subspan(std::min(making->carved, places.size()));
    if (!simulation::CarveTrail(*making->carver, rest)) return refuse("a frame of the carving was refused");
    // the replacement gets the bone from the carver, and volume, mass and work from the present engine
    simulation::CarvedState carved = making->carver->Snapshot();
    const simulation::CarvedState counted = now.Snapshot();
    if (!simulation::ReachedPose(carved, Pose(counted.X_GP), lever_m_, kArrived_m))
      return refuse("bone that the tool does not cut is in its way");
    making->made.engine->Restore(simulation::MergeCarvedStates(std::move(carved), counted));
  } catch (const std::exception& error) {  // out of memory, for example: the run continues unchanged
    return refuse(error.what());
  }
  level_ = making->made.rezoned.zones.level;
  return std::move(making->made);
}

std::string AdaptiveResolution::TakeNotice() { return std::exchange(notice_, std::string()); }

void AdaptiveResolution::Say(std::string text) { notice_ += (notice_.empty() ? "" : "; ") + std::move(text); }

std::unique_ptr<AdaptiveResolution> MakeAdaptiveResolution(const CellSetup& setup,
                                                           const EngineChoice& engine) {
  if (!setup.planned || !setup.planned->request.timed) return nullptr;
  for (const UnmetDemand& demand : setup.planned->plan.unmet)
    if (demand.what == "rate") return nullptr;
  return std::make_unique<AdaptiveResolution>(
      setup, AdaptiveResolutionParams{.rate_hz = setup.planned->request.rate_hz, .engine = engine});
}

simulation::ProxyTrail MakeProxyTrail(const CellSetup& setup) {
  return {simulation::ToolLever(setup.config.tool.tool), kTrailShare * setup.planned->plan.promised_m};
}

simulation::Bone PackCoarser(const CellSetup& setup, const simulation::PackingLevel& level) {
  const PlanScene& scene = setup.planned->scene;
  simulation::Bone bone = setup.bone;
  bone.balls = simulation::PackLevel(level, *scene.work.solid, *scene.work.zone);
  return bone;
}

tl::expected<CoarserEngines, std::string> MakeCoarserEngines(const CellSetup& setup,
                                                             const simulation::PackingLevel& level,
                                                             const simulation::Bone& bone,
                                                             const EngineChoice& choice) {
  const auto make_engine = [&](const Pose& X_WG, simulation::RemovalLaw law) {
    simulation::CuttingParams cutting =
        simulation::CuttingForLevel(level, setup.planned->scene.cut, setup.config.cutting);
    cutting.law = law;
    return MakeEngine(choice, bone, setup.config.tool.tool, X_WG, cutting);
  };
  auto carver = make_engine(Pose::Identity(), simulation::RemovalLaw::kImmediate);
  if (!carver) return tl::make_unexpected(carver.error());
  auto engine = make_engine(setup.X_WG, setup.config.cutting.law);
  if (!engine) return tl::make_unexpected(engine.error());
  return CoarserEngines{.carver = std::move(*carver), .engine = std::move(*engine)};
}

std::string RezonedText(const Rezoned& rezoned) {
  return fmt::format(
      "zones coarsened: {} spheres, {:.3f} mm apart; a cut keeps {:.3f} mm; frames took {:.0f} us, {:.0f} us "
      "expected",
      rezoned.bone.balls.size(), rezoned.zones.level.fine.spacing_m * 1e3, rezoned.zones.promised_m * 1e3,
      rezoned.seen_us, rezoned.zones.frame_us);
}

}  // namespace osteon::session
