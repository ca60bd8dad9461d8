#include "studies/regress/trace_diff.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace osteon::studies {
namespace {

constexpr std::size_t kShownQuantities = 4, kShownEvents = 4;  // largest numbers in an explanation

// Largest difference that the rounding of a file's values can cause. Only larger differences count.
double Rounding(QuantityKind kind) { return 0.51 * std::pow(10.0, -DecimalsOf(kind)); }

// Formats a value with the decimals of its kind.
std::string Value(double value, QuantityKind kind) { return fmt::format("{:.{}f}", value, DecimalsOf(kind)); }

// "2.340 s (tick 2339)"
std::string At(std::uint64_t tick, const ScenarioTrace& trace) {
  return fmt::format("{:.3f} s (tick {})", trace.TimeOf_s(tick), tick);
}

// Returns the first tick in which each part differs, for the ticks that both traces have, sorted by the tick.
std::vector<PartDifference> CompareDigests(const ScenarioTrace& golden, const ScenarioTrace& now) {
  std::vector<PartDifference> parts;
  const std::uint64_t begin = std::max(golden.first_tick, now.first_tick);
  const std::uint64_t end =
      std::min(golden.first_tick + golden.digests.size(), now.first_tick + now.digests.size());
  for (std::size_t part = 0; part < kTraceParts; ++part)
    for (std::uint64_t tick = begin; tick < end; ++tick)
      if (golden.digests[tick - golden.first_tick][part] != now.digests[tick - now.first_tick][part]) {
        parts.push_back({.part = static_cast<TracePart>(part), .tick = tick});
        break;
      }
  std::ranges::stable_sort(parts, {}, &PartDifference::tick);
  return parts;
}

// Stores the difference if it is the largest so far, and the first tick beyond the tolerance.
// @param between  true: the values are extremes over all ticks, so their tick is not known
void UpdateWorst(QuantityDifference& d, double golden, double now, std::uint64_t tick, bool between) {
  const double error = std::abs(now - golden);
  // a value that is not finite is beyond any tolerance
  const double worst = std::isfinite(error) ? error : std::numeric_limits<double>::infinity();
  if (worst > d.tolerance && !between && !d.left_tick) d.left_tick = tick;
  if (!(worst > d.worst)) return;
  d.worst = worst;
  d.worst_tick = tick;
  d.between_samples = between;
  d.golden = golden;
  d.now = now;
}

// Returns the quantities that differ by more than rounding. Those beyond their tolerance come first. They are
// sorted by the time at which they left the tolerance, then by size.
std::vector<QuantityDifference> CompareSamples(const ScenarioTrace& golden, const ScenarioTrace& now,
                                               const config::TraceTolerances& tolerances) {
  const auto quantities = TraceQuantities();
  std::vector<QuantityDifference> all(quantities.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] = {.quantity = i, .tolerance = ToleranceOf(quantities[i].kind, tolerances), .left_tick = {}};
  VisitCommonSamples(golden, now, [&](const TraceSample& was, const TraceSample& is) {
    for (std::size_t i = 0; i < all.size(); ++i)
      UpdateWorst(all[i], was.values[i], is.values[i], is.tick, false);
  });
  // Compare the extremes over all ticks as well, to find differences between samples.
  if (!golden.least.empty() && !now.least.empty())
    for (std::size_t i = 0; i < all.size(); ++i) {
      UpdateWorst(all[i], golden.least[i], now.least[i], 0, true);
      UpdateWorst(all[i], golden.greatest[i], now.greatest[i], 0, true);
    }
  std::erase_if(
      all, [&](const QuantityDifference& d) { return d.worst <= Rounding(quantities[d.quantity].kind); });
  constexpr auto kNever = std::numeric_limits<std::uint64_t>::max();
  std::ranges::stable_sort(all, [kNever](const QuantityDifference& a, const QuantityDifference& b) {
    if (a.beyond() != b.beyond()) return a.beyond();
    const std::uint64_t left_a = a.left_tick.value_or(kNever), left_b = b.left_tick.value_or(kNever);
    return left_a != left_b ? left_a < left_b : a.ratio() > b.ratio();
  });
  return all;
}

// Compares the events one by one, in order, and adds a line for each pair that differs.
void CompareEvents(const ScenarioTrace& golden, const ScenarioTrace& now, double tolerance_ticks,
                   std::vector<std::string>& lines) {
  const std::size_t count = std::max(golden.events.size(), now.events.size());
  for (std::size_t i = 0; i < count; ++i) {
    const TraceEvent* g = i < golden.events.size() ? &golden.events[i] : nullptr;
    const TraceEvent* n = i < now.events.size() ? &now.events[i] : nullptr;
    const bool same = g && n && g->what == n->what;
    if (same && std::abs(static_cast<double>(g->tick) - static_cast<double>(n->tick)) <= tolerance_ticks)
      continue;
    const auto shown = [&](const TraceEvent* event, const ScenarioTrace& trace) {
      return event ? fmt::format("\"{}\" at {}", event->what, At(event->tick, trace))
                   : std::string("none more");
    };
    lines.push_back(fmt::format("event: golden {}, now {}", shown(g, golden), shown(n, now)));
    if (!same) return;  // the later events no longer correspond to each other
  }
}

// "1.17", "60.9", "4030": three significant digits, and no exponent.
std::string RatioText(double ratio) {
  return ratio >= 1000.0 && ratio < 1e15 ? fmt::format("{:.0f}", ratio) : fmt::format("{:.3g}", ratio);
}

// Describes a quantity in one line: when it left its tolerance, and its largest difference.
std::string Describe(const QuantityDifference& d, const ScenarioTrace& now) {
  const TraceQuantity& quantity = TraceQuantities()[d.quantity];
  const std::string worst =
      fmt::format("at most {:.3g} ({} tolerances){}: golden {}, now {}", d.worst, RatioText(d.ratio()),
                  d.between_samples ? " between two samples" : " at " + At(d.worst_tick, now),
                  Value(d.golden, quantity.kind), Value(d.now, quantity.kind));
  if (!d.beyond()) return fmt::format("{}: {}", quantity.name, worst);
  return fmt::format(
      "{}: {}; {}", quantity.name,
      d.left_tick ? "left at " + At(*d.left_tick, now) : std::string("left between two samples"), worst);
}

}  // namespace

double QuantityDifference::ratio() const {
  return tolerance > 0.0 ? worst / tolerance : worst > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

std::size_t TraceDifference::Beyond() const {
  return static_cast<std::size_t>(std::ranges::count_if(quantities, &QuantityDifference::beyond));
}

TraceDifference Compare(const ScenarioTrace& golden, const ScenarioTrace& now,
                        const config::TraceTolerances& tolerances) {
  TraceDifference difference;
  difference.parts = CompareDigests(golden, now);
  difference.first_tick = golden.first_tick;
  difference.quantities = CompareSamples(golden, now, tolerances);
  const double event_ticks = tolerances.event_s / now.period_s + 1e-6;
  std::vector<std::string>& others = difference.others;
  if (golden.period_s != now.period_s)
    others.push_back(fmt::format("period: golden {} s, now {} s", golden.period_s, now.period_s));
  if (golden.ended != now.ended)
    others.push_back(fmt::format("ended: golden \"{}\", now \"{}\"", golden.ended, now.ended));
  if (std::abs(static_cast<double>(golden.active) - static_cast<double>(now.active)) > event_ticks)
    others.push_back(fmt::format("rendering: golden {} ticks, now {}", golden.active, now.active));
  CompareEvents(golden, now, event_ticks, others);
  difference.passed = others.empty() && difference.Beyond() == 0;
  difference.identical = golden.hash == now.hash && golden.ticks == now.ticks && difference.parts.empty() &&
                         difference.quantities.empty() && others.empty();
  return difference;
}

std::vector<QuantityDifference> Telling(const TraceDifference& difference, std::size_t most) {
  const auto quantities = TraceQuantities();
  const bool any_beyond = difference.Beyond() > 0;
  std::vector<QuantityDifference> telling;
  for (const QuantityDifference& d : difference.quantities) {
    const TraceQuantity& q = quantities[d.quantity];
    const bool known = std::ranges::any_of(telling, [&](const QuantityDifference& other) {
      const TraceQuantity& o = quantities[other.quantity];
      return o.family == q.family && o.kind == q.kind;
    });
    if (!known && d.beyond() == any_beyond && telling.size() < most) telling.push_back(d);
  }
  return telling;
}

std::vector<std::string> Explain(const TraceDifference& difference, const ScenarioTrace& now) {
  std::vector<std::string> lines;
  if (difference.identical) return lines;
  if (difference.parts.empty()) {
    lines.emplace_back(difference.passed
                           ? "the first bit differs before the arm moves, or after the run's end"
                           : "no tick's digest differs: the golden file itself was changed");
  } else {
    // Describe the first tick that differs, and the parts that differ later.
    const std::uint64_t tick = difference.parts.front().tick;
    std::string first, later;
    bool input_differs = false;
    for (const PartDifference& part : difference.parts) {
      std::string& text = part.tick == tick ? first : later;
      text += (text.empty() ? "" : ", ") + std::string(NameOf(part.part));
      if (part.tick == tick)
        input_differs |= static_cast<int>(part.part) < kTraceInputs;
      else
        text += fmt::format(" +{}", part.tick - tick);
    }
    const bool loop_differs = !input_differs && tick > difference.first_tick;
    lines.push_back(fmt::format("the first bit differs at {}: {}{}{}", At(tick, now), first,
                                loop_differs ? " (of equal inputs: the loop itself does otherwise)" : "",
                                later.empty() ? "" : "; ticks later: " + later));
  }
  for (std::size_t i = 0; i < difference.others.size() && i < kShownEvents; ++i)
    lines.push_back(difference.others[i]);
  const std::vector<QuantityDifference> telling = Telling(difference, kShownQuantities);
  for (const QuantityDifference& d : telling) lines.push_back(Describe(d, now));
  if (const std::size_t beyond = difference.Beyond(); beyond > telling.size())
    lines.push_back(fmt::format("and {} quantities more beyond their tolerances", beyond - telling.size()));
  return lines;
}

}  // namespace osteon::studies
