#include "studies/tune/tune.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/parallel.h"
#include "base/phase_progress.h"
#include "config/reading/apply_identified.h"
#include "config/reading/load.h"
#include "config/reading/load_surgical_plan.h"
#include "session/procedure/plan_guidance.h"
#include "session/process/exit_code.h"
#include "session/summary/chart_files.h"
#include "session/summary/summary.h"
#include "studies/sharding/exact_number.h"
#include "studies/sharding/study_items.h"
#include "studies/tune/tune_cache.h"
#include "studies/tune/tune_impedance.h"
#include "studies/tune/tune_items.h"
#include "studies/tune/tune_measured.h"
#include "studies/tune/tune_page.h"
#include "studies/tune/tune_result.h"

namespace osteon::studies {
namespace {

// Virtual masses that are tried. Below 1 kg the hand's own mass dominates; above 5 kg the tool no longer
// feels light.
constexpr std::array kMasses_kg{1.0, 1.4, 1.7, 2.0, 2.4, 2.8, 3.4, 4.0, 5.0, 7.0};
constexpr int kWalls = 32;                                // number of wall stiffnesses in the map
constexpr double kMinDamping = 5.0, kMaxDamping = 500.0;  // range of dampings of boundaries and map [N s/m]
constexpr double kTie = 1.05;  // drags within this ratio count as equal; of these the lightest tool is chosen

// All inputs of the task that a result depends on, as text. The number at the beginning of the text changes
// with the method.
std::string KeyText(const TuneTask& t) {
  std::string text =
      fmt::format("2 {} {} {} {} {} {} {} {} {} {} {} {}", t.loop.arm.bandwidth_hz, t.loop.arm.damping_ratio,
                  t.loop.arm.dead_cycles, t.loop.felt_mass_kg, t.loop.sensor_delay, t.loop.period_s,
                  t.wall_N_per_m, t.plane_N_per_m, t.worst_age_s, t.margin, t.command_loss, t.command_jitter);
  if (!t.measured_only) return text;
  // The measured response depends on each of its lines and on the model that continues it.
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](const MeasuredPlant& response) {
    for (const MeasuredPlant::Point& point : response.grid())
      for (const char c : fmt::format("{} {} ", point.value.real(), point.value.imag()))
        hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  };
  add(*t.response);
  for (const HeldLoop& held : t.held) add(*held.response);
  return text + fmt::format(" measured {:016x}", hash);
}

// The part of a cache key that stands for these hands.
std::string KeyText(const std::vector<hil::GridHand>& hands) {
  std::string text;
  for (const hil::GridHand& h : hands)
    text += fmt::format(" {} {} {}", h.stiffness_N_per_m, h.damping_Ns_per_m, h.mass_kg);
  return text;
}

// The part of a cache key that stands for these gains.
std::string KeyText(const TuneGains& g) { return fmt::format(" {} {}", g.mass_kg, g.damping_Ns_per_m); }

// Numbers of the study's items. The first items lead to the recommended gains, and every shard computes them
// for itself. The others are computed for the recommended gains, and the shards divide them.
struct Items {
  static constexpr std::size_t kOwnMargin = 0, kDrags = 1, kMargins = kDrags + 2 * kMasses_kg.size(),
                               kRecommended = kMargins + kMasses_kg.size();
  static constexpr std::size_t kRecommendedMargin = kRecommended, kStiffestDrag = kRecommended + 1,
                               kClampDrag = kRecommended + 2, kBoundaries = kRecommended + 3;
  // First item of the boundaries of a set of hands. @param hands  0 firm, 1 human, 2 stiffest; @param
  // dampings  number of dampings in the map
  static std::size_t Boundaries(std::size_t hands, int dampings) {
    return kBoundaries + hands * static_cast<std::size_t>(dampings + 1);
  }
  // First item of a map's rows. @param map  0 human, 1 stiffest hands
  static std::size_t Rows(std::size_t map, int dampings) {
    return Boundaries(3, dampings) + map * static_cast<std::size_t>(kWalls);
  }
  // Item of the simulations in time. @param which  0: the check of all hands, 1: the stiff hands, 2: the
  // vibration index
  static std::size_t InTime(std::size_t which, int dampings) { return Rows(2, dampings) + which; }
  static std::size_t Count(const TuneResult& r, int dampings) {
    return r.HasRecommendation() ? InTime(3, dampings) : kRecommended;
  }
};

nlohmann::json JsonOf(const std::vector<double>& values) {
  nlohmann::json list = nlohmann::json::array();
  for (const double value : values) list.push_back(ExactNumber(value));
  return list;
}

std::vector<double> NumbersFrom(const nlohmann::json& list) {
  std::vector<double> values;
  for (const nlohmann::json& value : list) values.push_back(ExactNumberFrom(value));
  return values;
}

// Reuses earlier results if their inputs have not changed, and computes the others in parallel.
class Study {
 public:
  Study(const TuneTask& task, TuneCache& cache, StudyItems& items, int threads)
      : task_(task), cache_(cache), items_(items), threads_(threads) {}

  // Returns an item's numbers: read from the parts of the shards, found in the cache, or computed now. Empty
  // if the item belongs to another shard, or after an interrupt. @param what  the result's name and
  // parameters, as text for the cache's key
  template <typename Compute>
  std::vector<double> Get(std::size_t item, const std::string& what, const Compute& compute) const {
    const std::string from = what + ": " + KeyText(task_);
    if (items_.FromParts()) {
      std::vector<double> values = items_.Restore(item, NumbersFrom);
      cache_.Store(from, values);
      return values;
    }
    if (item >= Items::kRecommended && !items_.Computes(item)) return {};
    if (auto found = cache_.Find(from)) return *found;
    if (base::Interrupted()) return {};
    std::vector<double> values = compute();
    cache_.Store(from, values);
    items_.Store(item, JsonOf(values));
    return values;
  }
  // Gets the number of an item that has only one; 0 if the item was not computed.
  template <typename Compute>
  double One(std::size_t item, const std::string& what, const Compute& compute) const {
    const std::vector<double> values = Get(item, what, [&] { return std::vector<double>{compute()}; });
    return values.size() == 1 ? values[0] : 0.0;
  }
  // Gets the result of an item that is never cached: reads it from the parts of the shards, or computes it.
  template <typename Result, typename FromJson, typename ToJson, typename Compute>
  void Run(std::size_t item, Result& result, const FromJson& from, const ToJson& to,
           const Compute& compute) const {
    if (items_.FromParts()) {
      result = items_.Restore(item, from);
    } else if (items_.Computes(item) && !base::Interrupted()) {
      result = compute();
      items_.Store(item, to(result));
    }
  }
  // Stores an empty result for an item that this study does not need.
  void Skip(std::size_t item) const { items_.Store(item, nlohmann::json::array()); }
  // Calls each(i) for all i below count in parallel, until an interrupt.
  template <typename Each>
  void ForEach(std::size_t count, const Each& each) const {
    simulation::ParallelFor(
        count, threads_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end && !base::Interrupted(); ++i) each(i);
        },
        1);
  }

  [[nodiscard]] double Margin(std::size_t item, const TuneGains& gains,
                              const std::vector<hil::GridHand>& hands) const {
    return One(item, "margin" + KeyText(gains) + KeyText(hands),
               [&] { return GainMargin(task_, gains, hands); });
  }
  [[nodiscard]] double Drag(std::size_t item, double mass_kg, const std::vector<hil::GridHand>& hands) const {
    return One(item, fmt::format("drag {}{}", mass_kg, KeyText(hands)),
               [&] { return MinDragFor(task_, mass_kg, hands); });
  }
  // The result of BoundaryAt, stored as an item of four numbers. All are zero if the item was not computed.
  [[nodiscard]] TuneBoundary BoundaryOf(std::size_t item, const TuneGains& gains,
                                        const std::vector<hil::GridHand>& hands, double max_N_per_m) const {
    const std::vector<double> values =
        Get(item, fmt::format("boundary {}{}{}", max_N_per_m, KeyText(gains), KeyText(hands)), [&] {
          const TuneBoundary b = BoundaryAt(task_, gains, hands, max_N_per_m);
          return std::vector{b.predicted_N_per_m, b.simulated_N_per_m, b.degraded_N_per_m,
                             static_cast<double>(b.hand)};
        });
    if (values.size() != 4 || !(values[3] >= 0.0 && values[3] < static_cast<double>(hands.size())))
      return {.damping_Ns_per_m = gains.damping_Ns_per_m};
    return {gains.damping_Ns_per_m, values[0], values[1], values[2], static_cast<std::size_t>(values[3])};
  }
  // The boundaries at the recommended mass and these dampings; each boundary is one item.
  [[nodiscard]] std::vector<TuneBoundary> Boundaries(std::size_t first_item, const TuneResult& r,
                                                     const std::vector<double>& dampings,
                                                     const std::vector<hil::GridHand>& hands) const {
    std::vector<TuneBoundary> boundaries(dampings.size());
    ForEach(dampings.size(), [&](std::size_t i) {
      boundaries[i] =
          BoundaryOf(first_item + i, {r.recommended.mass_kg, dampings[i]}, hands, r.max_wall_N_per_m);
    });
    return boundaries;
  }
  // The decay rates at the recommended mass; the row of each wall is one item.
  [[nodiscard]] TuneMap Map(std::size_t first_item, const TuneResult& r, const std::string& title,
                            const std::vector<hil::GridHand>& hands, int dampings) const {
    TuneMap map{.title = title,
                .damping_from = kMinDamping,
                .damping_to = kMaxDamping,
                .wall_to = r.max_wall_N_per_m,
                .dampings = 2 * dampings,
                .walls = kWalls,
                .decay_per_s = {}};
    const auto columns = static_cast<std::size_t>(map.dampings);
    map.decay_per_s.assign(columns * static_cast<std::size_t>(map.walls), std::nan(""));
    ForEach(static_cast<std::size_t>(map.walls), [&](std::size_t row) {
      const double wall =
          map.wall_from * std::pow(map.wall_to / map.wall_from, (static_cast<double>(row) + 0.5) / map.walls);
      const auto values = Get(first_item + row,
                              fmt::format("row {} {} {} {}{}", wall, map.dampings, map.damping_from,
                                          r.recommended.mass_kg, KeyText(hands)),
                              [&] {
                                std::vector<double> decay;
                                for (int i = 0; i < map.dampings; ++i) {
                                  const double b =
                                      map.damping_from *
                                      std::pow(map.damping_to / map.damping_from, (i + 0.5) / map.dampings);
                                  decay.push_back(DecayRate(task_, {r.recommended.mass_kg, b}, hands, wall));
                                }
                                return decay;
                              });
      if (values.size() == columns)
        std::ranges::copy(values, map.decay_per_s.begin() + static_cast<std::ptrdiff_t>(row * columns));
    });
    return map;
  }

 private:
  const TuneTask& task_;
  TuneCache& cache_;
  StudyItems& items_;
  int threads_;
};

// Recommends the lightest mass among those whose drag is within kTie of the least. If some of them are light
// (mass and drag below the task's limits), only these are candidates.
void Recommend(const Study& study, TuneResult& r) {
  r.trade.resize(kMasses_kg.size());
  for (std::size_t i = 0; i < kMasses_kg.size(); ++i) r.trade[i].mass_kg = kMasses_kg[i];
  study.ForEach(2 * kMasses_kg.size(), [&](std::size_t i) {
    TuneTrade& trade = r.trade[i / 2];
    (i % 2 == 0 ? trade.human_Ns_per_m : trade.stiffest_Ns_per_m) =
        study.Drag(Items::kDrags + i, trade.mass_kg, i % 2 == 0 ? r.human_hands : r.stiffest_hands);
  });
  const auto least =
      std::ranges::min_element(r.trade, {}, [](const TuneTrade& t) { return t.human_Ns_per_m; });
  if (!std::isfinite(least->human_Ns_per_m)) return;
  const auto needs_least = [&](const TuneTrade& t) {
    return t.human_Ns_per_m <= kTie * least->human_Ns_per_m;
  };
  auto chosen = std::ranges::find_if(r.trade, [&](const TuneTrade& t) {
    return needs_least(t) && t.mass_kg <= r.task.max_mass_kg &&
           std::ceil(t.human_Ns_per_m) <= r.task.max_drag_Ns_per_m;
  });
  if (chosen == r.trade.end()) chosen = std::ranges::find_if(r.trade, needs_least);
  r.recommended = {chosen->mass_kg, std::ceil(chosen->human_Ns_per_m)};
}

// Finds the mass with the largest gain margin. All candidates count as light: the mass is at most the task's
// limit, and the drag equals the limit.
void SearchWithinBar(const Study& study, TuneResult& r) {
  std::array<double, kMasses_kg.size()> margins{};
  study.ForEach(kMasses_kg.size(), [&](std::size_t i) {
    const std::size_t item = Items::kMargins + i;
    if (kMasses_kg[i] > r.task.max_mass_kg)
      study.Skip(item);
    else
      margins[i] = study.Margin(item, {kMasses_kg[i], r.task.max_drag_Ns_per_m}, r.human_hands);
  });
  const auto best = std::ranges::max_element(margins);
  r.within_bar_margin = *best;
  r.within_bar = {kMasses_kg[static_cast<std::size_t>(best - margins.begin())], r.task.max_drag_Ns_per_m};
}

// Computes all needed results in their order.
void StudyAll(const Study& study, const TuneOptions& options, base::PhaseProgress& progress, TuneResult& r) {
  progress.BeginPhase("the cell's own gains, and the least drag by mass");
  r.own_margin =
      study.Margin(Items::kOwnMargin, {r.task.loop.mass_kg, r.task.loop.damping_Ns_per_m}, r.human_hands);
  Recommend(study, r);
  SearchWithinBar(study, r);
  if (base::Interrupted() || !r.HasRecommendation()) return;
  r.recommended_margin = study.Margin(Items::kRecommendedMargin, r.recommended, r.human_hands);
  r.stiffest_Ns_per_m = study.Drag(Items::kStiffestDrag, r.recommended.mass_kg, r.stiffest_hands);
  for (const hil::GridHand& hand : hil::NamedHands())
    if (hand.name == "clamp") r.clamp_Ns_per_m = study.Drag(Items::kClampDrag, r.recommended.mass_kg, {hand});

  if (r.task.measured_only) return;  // the following results need a model of the arm

  progress.BeginPhase("boundaries, predicted and simulated");
  std::vector<double> dampings{r.recommended.damping_Ns_per_m};
  for (int i = 0; i < options.dampings; ++i)
    dampings.push_back(kMinDamping *
                       std::pow(kMaxDamping / kMinDamping, static_cast<double>(i) / (options.dampings - 1)));
  std::ranges::sort(dampings);
  const auto boundaries = [&](std::size_t i, const std::vector<hil::GridHand>& hands) {
    return study.Boundaries(Items::Boundaries(i, options.dampings), r, dampings, hands);
  };
  r.firm = boundaries(0, {hil::NamedHands()[1]});
  r.human = boundaries(1, r.human_hands);
  r.stiffest = boundaries(2, r.stiffest_hands);

  progress.BeginPhase("the map");
  for (const auto& [hands, grip] : {std::pair{&r.human_hands, r.task.human_grip_N_per_m},
                                    {&r.stiffest_hands, r.task.stiffest_grip_N_per_m}})
    r.maps.push_back(study.Map(Items::Rows(r.maps.size(), options.dampings), r,
                               fmt::format("Grips up to {:g} N/m", grip), *hands, options.dampings));

  progress.BeginPhase("the recommended gains, run in time");
  const auto in_time = [&](std::size_t which) { return Items::InTime(which, options.dampings); };
  study.Run(in_time(0), r.check, CheckFrom, CheckItem,
            [&] { return CheckInTime(r.task, r.recommended, r.human_hands); });
  study.Run(in_time(1), r.stiff_hands, StiffHandsFrom, StiffHandsItem,
            [&] { return RunStiffHands(r.task, r.recommended); });
  study.Run(in_time(2), r.human_index, ExactNumberFrom, ExactNumber,
            [&] { return IndexWith(r.task, r.recommended, r.human_hands); });
}

// Maps the guidance of the first reamer in the plan (--plan) at full gain: all reamers of a plan have the
// same gains.
// @returns no map without --plan; an error if the plan has no guidance
tl::expected<std::optional<GuidanceMap>, std::string> MapPlan(const TuneOptions& options,
                                                              const TuneTask& task,
                                                              const config::CellConfig& cell) {
  if (options.plan.empty()) return std::optional<GuidanceMap>();
  const config::SurgicalPlanConfig plan = config::LoadSurgicalPlan(options.plan);
  const auto guidance = session::GuidanceOf(plan.plan, plan.plan.tools.front(), Pose::Identity());
  if (!guidance)
    return tl::unexpected(
        fmt::format("--plan {}: found no guidance, accepted a plan with `guidance`", options.plan.string()));
  return std::optional(
      MapGuidance(task, cell.servo.admittance, *guidance, [] { return base::Interrupted().load(); }));
}

// Converts a time to whole ticks. If that is not possible, the error names the option.
tl::expected<int, std::string> Ticks(const char* option, double ms, double period_s) {
  const double ticks = 1e-3 * ms / period_s;
  if (std::abs(ticks - std::round(ticks)) > 1e-6)
    return tl::unexpected(fmt::format("{}: found {:g}, accepted a multiple of the cell's period, {:g} ms",
                                      option, ms, 1e3 * period_s));
  return static_cast<int>(std::lround(ticks));
}

// Sets the delays that the user gave, of commands and sensor. Delays that the user did not give stay as in
// the task.
tl::expected<void, std::string> SetDelays(const TuneOptions& options, TuneTask& task) {
  const double period_s = task.loop.period_s;
  if (options.jitter_ms) {
    const auto jitter = Ticks("--jitter-ms", *options.jitter_ms, period_s);
    if (!jitter) return tl::unexpected(jitter.error());
    task.command_jitter = *jitter;
  }
  if (options.sensor_delay_ms) {
    const auto sensor = Ticks("--sensor-delay-ms", *options.sensor_delay_ms, period_s);
    if (!sensor) return tl::unexpected(sensor.error());
    task.loop.sensor_delay = *sensor;
    task.response_delay_s = 1e-3 * *options.sensor_delay_ms;
  }
  const double max_jitter = hil::ServoArm::kMaxDeadCycles - task.loop.arm.dead_cycles;
  if (max_jitter < 0.0)
    return tl::unexpected(fmt::format(
        "the arm's dead time with the sensor's: found {:g} ms, accepted at most {:g} ms at this cell's "
        "period",
        1e3 * task.loop.arm.dead_cycles * period_s, 1e3 * hil::ServoArm::kMaxDeadCycles * period_s));
  if (task.command_jitter > max_jitter)
    return tl::unexpected(fmt::format(
        "{}: found {:g}, accepted at most {:g} with the arm's dead time",
        options.jitter_ms ? "--jitter-ms" : "the measured jitter (jitter_p99_ms less jitter_mean_ms)",
        1e3 * task.command_jitter * period_s, 1e3 * period_s * std::floor(max_jitter)));
  return {};
}

// The cell's task, changed by the options. @returns an error that names the option
tl::expected<TuneTask, std::string> TaskOf(const config::CellConfig& cell, const TuneOptions& options) {
  TuneTask task = MeasuredTaskOf(cell);
  if (const auto set = SetDelays(options, task); !set) return tl::unexpected(set.error());
  if (options.human_grip_N_per_m > options.stiffest_grip_N_per_m)
    return tl::unexpected(fmt::format("--grip: found {:g}, accepted at most --stiffest-grip ({:g})",
                                      options.human_grip_N_per_m, options.stiffest_grip_N_per_m));
  if (task.measured_only && !task.response)
    return tl::unexpected(
        std::string("identified: found a structure without a response by the force sensor, "
                    "accepted one: the arm's model alone does not have it"));
  task.worst_age_s = 1e-3 * options.worst_age_ms;
  task.margin = options.margin;
  if (options.loss) task.command_loss = *options.loss;
  task.human_grip_N_per_m = options.human_grip_N_per_m;
  task.stiffest_grip_N_per_m = options.stiffest_grip_N_per_m;
  return task;
}

// Judges the cell's own gains and the recommended gains by the measured response.
void AddMargins(TuneResult& r) {
  const TuneGains own{r.task.loop.mass_kg, r.task.loop.damping_Ns_per_m};
  r.margins = MeasuredMargins(r.task, "own", own, r.human_hands);
  if (!r.HasRecommendation()) return;
  const std::vector<TuneMargin> recommended =
      MeasuredMargins(r.task, "recommended", r.recommended, r.human_hands);
  r.margins.insert(r.margins.end(), recommended.begin(), recommended.end());
}

// Everything that the results depend on, as text. Shards of one study must have the same text.
std::string InputsOf(const TuneResult& r, const TuneOptions& options) {
  return fmt::format("{} {}{}{}", KeyText(r.task), options.dampings, KeyText(r.human_hands),
                     KeyText(r.stiffest_hands));
}

// RunTune without its handling of errors: throws if the cell's file or a parameter is wrong.
int Run(const TuneOptions& options) {
  if (const std::string wrong = ValidateSharding(options.sharding, options.json); !wrong.empty())
    return session::Fail("tune", wrong);
  if (const std::string wrong = session::ValidateOutputFolder("--out", options.out); !wrong.empty())
    return session::Fail("tune", wrong);
  config::CellConfig cell = config::LoadCell(options.cell);
  config::RequireSimulation(cell, options.cell);
  if (!options.identified.empty()) config::ApplyIdentified(options.identified, cell);
  if (cell.servo.law == control::Law::kImpedance) return RunTuneImpedance(options, cell);
  const auto task = TaskOf(cell, options);
  if (!task) return session::Fail("tune", task.error());
  if (task->measured_only && (options.sharding.shard || options.sharding.parts != nullptr))
    return session::Fail(
        "tune", "--shard: found with an identified structure, accepted without: it is judged in one piece");

  TuneResult result;
  result.cell = options.cell.stem().string();
  result.task = *task;
  result.human_hands = HandsUpTo(*task, task->human_grip_N_per_m);
  result.stiffest_hands = HandsUpTo(*task, task->stiffest_grip_N_per_m);
  result.age_bound_Ns_per_m = task->worst_age_s * task->plane_N_per_m;

  StudyItems items(options.sharding, InputsOf(result, options));
  // Check that the shards' parts belong to this study before their items are used.
  if (const std::string wrong = items.ValidateInputs(); !wrong.empty()) return session::Fail("tune", wrong);
  if (!items.IsShard()) {
    std::error_code error;
    std::filesystem::create_directories(options.out, error);
    if (error) return session::Fail("tune", options.out.string() + ": " + error.message(), session::kFailed);
  }

  base::InstallInterrupt();
  // shards may share the folder, so a shard writes no cache into it
  TuneCache cache(items.IsShard() ? std::filesystem::path() : options.out / "results.json");
  base::PhaseProgress progress("osteon tune", 4);
  StudyAll(Study(result.task, cache, items, options.threads), options, progress, result);
  progress.Done();
  if (items.IsShard()) {
    if (base::Interrupted()) return base::kExitInterrupted;
    const auto written = items.WritePart(options.json, Items::Count(result, options.dampings));
    return written ? 0 : session::Fail("tune", written.error(), session::kFailed);
  }
  auto guidance = MapPlan(options, result.task, cell);
  if (!guidance) return session::Fail("tune", guidance.error());
  result.guidance = std::move(*guidance);
  // Keep the computed numbers, even if the user interrupted the study.
  if (const auto saved = cache.Save(); !saved) return session::Fail("tune", saved.error(), session::kFailed);
  if (base::Interrupted()) return base::kExitInterrupted;
  result.found = cache.found();
  result.computed = cache.computed();
  AddMargins(result);

  if (const auto written = WriteTuning(result, options); !written)
    return session::Fail("tune", written.error(), session::kFailed);
  const session::Verdict verdict = Judge(result);
  session::PrintVerdict(verdict, 26);
  for (const report::SummaryRow& row : Rows(result)) fmt::print("  {:<26} {}\n", row.key, row.value);
  fmt::print("  {:<26} {}\n", "Report", (options.out / "tune.html").string());
  if (result.MayBeUsed())
    fmt::print("  {:<26} {}\n", "For osteon run --gains", (options.out / "gains.yaml").string());
  return verdict.level == session::VerdictLevel::kBad ? session::kFailed : 0;
}

}  // namespace

int RunTune(const TuneOptions& options) {
  try {
    return Run(options);
  } catch (const config::ConfigError& error) {
    return session::Fail("tune", error.what());
  } catch (const std::invalid_argument& error) {
    return session::Fail("tune", error.what());
  }
}

}  // namespace osteon::studies
