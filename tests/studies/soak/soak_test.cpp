#include "studies/soak/soak.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "studies/soak/soak_page.h"
#include "tests/report/report_markup.h"

// The soak in virtual time: its seeded script, the judgement of its episodes, and a short soak.

namespace osteon::studies {
namespace {

using testing::Contains, testing::HasSubstr, testing::IsEmpty;

TEST(SoakScript, DependsOnTheSeedOnlyAndHasEveryKindOfEpisode) {
  std::set<EpisodeKind> kinds;
  bool differs = false;
  for (int index = 0; index < 200; ++index) {
    const Episode episode = EpisodeAt(3, index);
    EXPECT_EQ(episode.set, EpisodeAt(3, index).set);
    EXPECT_EQ(episode.seconds, EpisodeAt(3, index).seconds);
    differs |= episode.set != EpisodeAt(4, index).set;
    kinds.insert(episode.kind);
    EXPECT_EQ(episode.kind == EpisodeKind::kReference, index % kEpisodesPerReference == 0);
    EXPECT_LT(episode.pause_s, episode.seconds);
  }
  EXPECT_EQ(kinds.size(), static_cast<std::size_t>(kEpisodeKinds));
  EXPECT_TRUE(differs);
}

// The result of an episode without any defect.
EpisodeResult FaultlessResult(EpisodeKind kind) {
  EpisodeResult result;
  result.episode.kind = kind;
  result.ended = EndsWithFault(kind) ? "fault" : "completed";
  if (!InjectedFault(kind).empty()) result.faults = {std::string(InjectedFault(kind))};
  result.hash = 17;
  result.figures.complete = true;
  result.figures.peak_rendered_N = 120.0;
  result.figures.removed_m3 = result.carved_m3 = 1e-6;
  result.figures.edge_work_J = result.figures.cutting_work_J = 100.0;
  return result;
}

TEST(Soak, FindsEachDefectOfAnEpisode) {
  for (int kind = 0; kind < kEpisodeKinds; ++kind)
    EXPECT_THAT(JudgeEpisode(FaultlessResult(static_cast<EpisodeKind>(kind)), 17), IsEmpty()) << kind;
  const auto judged = [](const std::function<void(EpisodeResult&)>& change, EpisodeKind kind) {
    EpisodeResult result = FaultlessResult(kind);
    change(result);
    return JudgeEpisode(result, 17);
  };
  using R = EpisodeResult;
  const auto reaming = EpisodeKind::kReaming, silent = EpisodeKind::kSensorSilent;
  EXPECT_THAT(judged([](R& r) { r.faults = {"tracking error"}; }, reaming),
              Contains(HasSubstr("not injected")));
  EXPECT_THAT(judged([](R& r) { r.faults.emplace_back("tracking error"); }, silent),
              Contains(HasSubstr("not injected")));
  EXPECT_THAT(judged([](R& r) { r.faults.clear(); }, silent), Contains(HasSubstr("no fault, injected")));
  EXPECT_THAT(judged([](R& r) { r.ended = "fault"; }, reaming), Contains(HasSubstr("ended: fault")));
  EXPECT_THAT(judged([](R& r) { r.figures.missing_ticks = 1; }, reaming),
              Contains(HasSubstr("misses 1 ticks")));
  EXPECT_THAT(judged([](R& r) { r.figures.complete = false; }, reaming), Contains(HasSubstr("its end")));
  EXPECT_THAT(judged([](R& r) { r.figures.peak_rendered_N = 200.1; }, reaming),
              Contains(HasSubstr("rendered")));
  EXPECT_THAT(judged([](R& r) { r.figures.rest_error_m = 1e-3; }, reaming), Contains(HasSubstr("at rest")));
  EXPECT_THAT(judged([](R& r) { r.figures.momentum_residual = 0.03; }, reaming),
              Contains(HasSubstr("momentum")));
  EXPECT_THAT(judged([](R& r) { r.figures.edge_work_J = 80.0; }, reaming), Contains(HasSubstr("energy")));
  EXPECT_THAT(judged([](R& r) { r.carved_m3 *= 1.01; }, reaming), Contains(HasSubstr("volume")));
  EXPECT_THAT(judged([](R& r) { r.carved_m3 += 10e-9; }, EpisodeKind::kArmSilent), IsEmpty())
      << "a frame that nobody saw";
  EXPECT_THAT(judged([](R& r) { r.carved_m3 -= 10e-9; }, EpisodeKind::kArmSilent),
              Contains(HasSubstr("volume")));
  EXPECT_THAT(judged([](R& r) { r.figures.removed_falls = true; }, reaming), Contains(HasSubstr("fell")));
  EXPECT_THAT(judged([](R& r) { r.hash = 18; }, EpisodeKind::kReference), Contains(HasSubstr("drifted")));
}

TEST(Soak, DistinguishesGrowingFromFlatMemory) {
  std::vector<EpisodeResult> episodes(16, FaultlessResult(EpisodeKind::kReaming));
  for (std::size_t i = 0; i < episodes.size(); ++i)
    episodes[i].memory_MB = i < 3 ? 40.0 + 30.0 * static_cast<double>(i) : 130.0;
  EXPECT_EQ(MemoryGrowth_MB(episodes), 0.0);
  for (std::size_t i = 0; i < episodes.size(); ++i)
    episodes[i].memory_MB = 100.0 + 4.0 * static_cast<double>(i);
  EXPECT_GT(MemoryGrowth_MB(episodes), kMaxMemoryGrowth_MB);
}

TEST(Soak, AShortSoakHasNoDefectsAndWritesPageAndJson) {
  SoakOptions options{.config_root = std::filesystem::path(OSTEON_SOURCE_DIR) / "config", .hours = 0.004};
  const auto episodes = RunEpisodes(options, nullptr, [](const EpisodeResult&) {});
  ASSERT_TRUE(episodes) << episodes.error();
  ASSERT_GE(episodes->size(), 2u);
  for (const EpisodeResult& result : *episodes) {
    EXPECT_THAT(result.wrong, IsEmpty()) << result.episode.text;
    EXPECT_GT(result.figures.rendered_s, 5.0);
    EXPECT_GT(result.figures.cutting_work_J, 0.0);
  }
  const nlohmann::json json = nlohmann::json::parse(SoakJson(*episodes, options));
  EXPECT_EQ(json.at("schema"), "osteon.soak/1");
  EXPECT_EQ(json.at("wrong_episodes"), 0);
  EXPECT_EQ(json.at("episodes").size(), episodes->size());
  EXPECT_EQ(report::MarkupError(SoakPage(*episodes, options)), "");
}

}  // namespace
}  // namespace osteon::studies
