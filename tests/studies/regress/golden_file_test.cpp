#include "studies/regress/golden_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/io/temporary_folder.h"
#include "tests/studies/regress/sample_trace.h"

namespace osteon::studies {
namespace {

/// A golden file of the sample trace, with two reasons.
Golden SampleGolden() {
  return {.head = {.scenario = "wall",
                   .reasons = {"2026-01-02 commit abc: first", "2026-02-03 commit def: mass\nweighed anew"},
                   .build = "commit abc, gcc 12",
                   .machine = "a machine",
                   .engine = "plane on CPU",
                   .sources = {{.path = "cells/demo.yaml", .checksum = "0123456789abcdef"}}},
          .trace = SampleTrace()};
}

TEST(GoldenFile, IsReadBackAsWrittenUpToRounding) {
  const Golden golden = SampleGolden();
  const auto read = ParseGolden(GoldenText(golden), "g.txt");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->head.scenario, "wall");
  EXPECT_EQ(read->head.reasons, (std::vector<std::string>{"2026-01-02 commit abc: first",
                                                          "2026-02-03 commit def: mass weighed anew"}))
      << "a line each, whatever a user writes";
  ASSERT_EQ(read->head.sources.size(), 1u);
  EXPECT_EQ(read->head.sources[0].path, "cells/demo.yaml");
  EXPECT_EQ(read->head.sources[0].checksum, "0123456789abcdef");
  const ScenarioTrace &a = golden.trace, &b = read->trace;
  EXPECT_EQ(a.hash, b.hash);
  EXPECT_EQ(a.ticks, b.ticks);
  EXPECT_EQ(a.active, b.active);
  EXPECT_EQ(a.period_s, b.period_s);
  EXPECT_EQ(a.ended, b.ended);
  EXPECT_EQ(a.first_tick, b.first_tick);
  EXPECT_EQ(a.digests, b.digests);
  ASSERT_EQ(a.events.size(), b.events.size());
  EXPECT_EQ(a.events[1].what, b.events[1].what);
  EXPECT_EQ(a.events[1].tick, b.events[1].tick);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i)
    for (std::size_t j = 0; j < a.samples[i].values.size(); ++j)
      EXPECT_NEAR(a.samples[i].values[j], b.samples[i].values[j],
                  0.5 * std::pow(10.0, -DecimalsOf(TraceQuantities()[j].kind)));
}

// A text that is cut off anywhere is refused. With any byte changed, it is refused or read with consistent
// sizes.
TEST(GoldenFile, DamagedTextIsRefusedOrReadConsistently) {
  const std::string text = GoldenText(SampleGolden());
  for (std::size_t size = 0; size + 1 < text.size(); ++size) {
    const auto read = ParseGolden(text.substr(0, size), "g.txt");
    ASSERT_FALSE(read) << "cut off after " << size << " of " << text.size();
    EXPECT_TRUE(read.error().starts_with("g.txt:")) << read.error();
  }
  std::size_t refused = 0;
  for (std::size_t at = 0; at < text.size(); ++at)
    for (const char byte : {'\0', '\n', ' ', '9', '-', '\xff'}) {
      std::string changed = text;
      changed[at] = byte;
      const auto read = ParseGolden(changed, "g.txt");
      refused += read ? 0 : 1;
      if (!read) continue;
      for (const TraceSample& sample : read->trace.samples)
        ASSERT_EQ(sample.values.size(), TraceQuantities().size());
      ASSERT_EQ(read->trace.least.size(), read->trace.greatest.size());
    }
  EXPECT_GT(refused, text.size());
}

TEST(GoldenFile, RefusalNamesTheLineAndWhatIsAccepted) {
  const std::string text = GoldenText(SampleGolden());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    changed.replace(changed.find(from), from.size(), to);
    const auto read = ParseGolden(changed, "g.txt");
    return read ? std::string("taken") : read.error();
  };
  EXPECT_NE(with("osteon golden trace 1", "osteon golden trace 2").find("g.txt:1: found no golden trace"),
            std::string::npos);
  EXPECT_NE(with("\nticks 40", "\nticks -4").find("ticks: found \"-4\", accepted 0 … 10000000"),
            std::string::npos);
  EXPECT_NE(with("\nticks 40", "\nticks 39").find("do not fit"), std::string::npos);
  EXPECT_NE(with("\nhash ", "\nhash 1").find("16 hexadecimal digits"), std::string::npos);
  EXPECT_NE(with("q_cmd_1_rad", "q_cmd_9_rad").find("--update"), std::string::npos);
  EXPECT_NE(with("\nsample 20", "\nsample 10").find("a tick after the one before"), std::string::npos);
  EXPECT_NE(with("\nsample 20 ", "\nsample 20 nan ").find("finite numbers"), std::string::npos);
  EXPECT_NE(with("\nended", "\nend").find("found \"end\""), std::string::npos);
  EXPECT_NE(with("period_s 0.001", "period_s 0").find("period_s: found \"0\""), std::string::npos);
}

TEST(GoldenFile, RefusesFoldersAndLargeFilesAndReadsReasonsOfAny) {
  const io::test::TemporaryFolder folder;
  EXPECT_NE(ReadGolden(folder.path()).error().find("found a folder, accepted a file"), std::string::npos);
  io::test::WriteAll(folder.path() / "large", std::string(9u << 20u, 'a'));
  EXPECT_NE(ReadGolden(folder.path() / "large").error().find("8 MiB"), std::string::npos);
  io::test::WriteAll(folder.path() / "other",
                     "reason 1: why\nreason 2: why not\nscenario x\ncolumns\nreason 3: a sample\n");
  EXPECT_EQ(ReadReasons(folder.path() / "other"), (std::vector<std::string>{"1: why", "2: why not"}));
  EXPECT_TRUE(ReadReasons(folder.path() / "nowhere").empty());
}

}  // namespace
}  // namespace osteon::studies
