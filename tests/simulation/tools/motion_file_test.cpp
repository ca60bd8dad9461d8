#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "simulation/tools/tool_motion.h"

namespace osteon::simulation {
namespace {

// Five samples, 10 ms apart, with all lines of the origin.
ToolMotion Example() {
  ToolMotion motion;
  motion.origin = {.made_by = "a test",
                   .scene = "none",
                   .cell = "cells/none.yaml",
                   .tool = "ball",
                   .engine = "reference",
                   .clock = "virtual time",
                   .command = "./osteon demo",
                   .error = "none"};
  for (int k = 0; k < 5; ++k)
    motion.samples.push_back({.time_s = 0.01 * k,
                              .p_GT_m = Vector3(1e-3 * k, -0.0123456789, 0.2),
                              .R_GT = Eigen::Quaterniond(Eigen::AngleAxisd(0.02 * k, Vector3(0, 0.6, 0.8))),
                              .spindle_rad_per_s = k == 0 ? 0.0 : 26.18});
  return motion;
}

std::string ExampleText() { return MotionText(Example()); }

// The parser's error message, or "accepted".
std::string ParseResult(const std::string& text) {
  const auto motion = ParseMotion(text, "file.csv");
  return motion ? "accepted" : motion.error();
}

// The example's text with its third row (line 12) replaced.
std::string WithThirdRow(const std::string& row) {
  std::string text = ExampleText();
  std::size_t begin = 0;
  for (int line = 1; line < 12; ++line) begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, row);
}

TEST(MotionFile, ReadsBackAWrittenMotionUpToRounding) {
  const ToolMotion written = Example();
  const auto read = ParseMotion(MotionText(written), "file.csv");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->origin.command, written.origin.command);
  EXPECT_EQ(read->origin.made_by, written.origin.made_by);
  ASSERT_EQ(read->samples.size(), written.samples.size());
  for (std::size_t i = 0; i < written.samples.size(); ++i) {
    const MotionSample &a = written.samples[i], &b = read->samples[i];
    EXPECT_NEAR(a.time_s, b.time_s, 0.5e-6);
    EXPECT_LE((a.p_GT_m - b.p_GT_m).cwiseAbs().maxCoeff(), 0.0501e-6);
    // each of four components is rounded by at most 0.5e-7; an angle is twice that
    EXPECT_LE(a.R_GT.angularDistance(b.R_GT), 2.0 * std::sqrt(4.0) * 0.5e-7 + 1e-8);
    EXPECT_NEAR(a.spindle_rad_per_s, b.spindle_rad_per_s, 0.0006 * 2.0 * std::numbers::pi / 60.0);
    EXPECT_EQ(Rounded(a).p_GT_m, b.p_GT_m);
    EXPECT_EQ(Rounded(a).R_GT.coeffs(), b.R_GT.coeffs());
  }
  // written again, the text is the same
  EXPECT_EQ(MotionText(*read), MotionText(written));
}

TEST(MotionFile, AcceptsBothKindsOfLineEnd) {
  std::string text;
  for (const char c : ExampleText()) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(ParseResult(text), "accepted");
}

TEST(MotionFile, LineBreaksInTheOriginBecomeSpaces) {
  ToolMotion motion = Example();
  motion.origin.command = "one\ntwo\r\nthree";
  const auto read = ParseMotion(MotionText(motion), "file.csv");
  ASSERT_TRUE(read) << read.error();
  EXPECT_EQ(read->origin.command, "one two  three");
}

TEST(MotionFile, RefusesRowsThatAreNoSampleOfAMotion) {
  ASSERT_TRUE(ParseResult(WithThirdRow("0.011,1,2,3,1,0,0,0,250"))
                  .starts_with("file.csv:12: x_mm … z_mm: found"));  // a jump that is too long
  ASSERT_EQ(ParseResult(WithThirdRow("0.011,1,-12.3457,200,1,0,0,0,250")), "accepted");
  struct Case {
    const char *row, *answer;
  };
  for (const Case& c : {
           Case{"0.011,nan,-12.3457,200,1,0,0,0,250", "x_mm: found \"nan\", accepted a finite number"},
           Case{"0.011,1,inf,200,1,0,0,0,250", "y_mm: found \"inf\", accepted a finite number"},
           Case{"0.011,1,-12.3457,2e400,1,0,0,0,250", "z_mm: found \"2e400\""},
           Case{"0.011,1,-12.3457, 200,1,0,0,0,250", "z_mm: found \" 200\""},
           Case{"0.011,1,-12.3457,200 ,1,0,0,0,250", "z_mm: found \"200 \""},
           Case{"0.011,0x1,-12.3457,200,1,0,0,0,250", "x_mm: found \"0x1\""},
           Case{"0.011,,-12.3457,200,1,0,0,0,250", "x_mm: found \"\""},
           Case{"0.011,1,-12.3457,200,1,0,0,0", "found 8 values, accepted 9: time_s,"},
           Case{"0.011,1,-12.3457,200,1,0,0,0,250,", "found 10 values, accepted 9"},
           Case{"", "found 1 values, accepted 9"},
           Case{"# a comment", "found 1 values, accepted 9"},
           Case{"0.0,1,-12.3457,200,1,0,0,0,250",
                "time_s: found 0, accepted more than the 0 of the row before"},
           Case{"-1,1,-12.3457,200,1,0,0,0,250", "time_s: found -1, accepted 0 … 36000"},
           Case{"36001,1,-12.3457,200,1,0,0,0,250", "time_s: found 36001"},
           Case{"0.011,10001,-12.3457,200,1,0,0,0,250", "x_mm: found 10001, accepted -10000 … 10000"},
           Case{"0.011,1,-12.3457,200,0,0,0,0,250", "found a quaternion of length 0, accepted 1 ± 1e-05"},
           Case{"0.011,1,-12.3457,200,1.001,0,0,0,250", "found a quaternion of length 1.001"},
           Case{"0.011,1,-12.3457,200,1e308,1e308,1e308,1e308,250", "found a quaternion of length inf"},
           Case{"0.011,1,-12.3457,200,0,1,0,0,250", "found a turn of 180 deg from the row before"},
           Case{"0.011,1,-12.3457,200,1,0,0,0,-1", "spindle_rpm: found -1, accepted 0 … 500000"},
       }) {
    const std::string answer = ParseResult(WithThirdRow(c.row));
    EXPECT_TRUE(answer.starts_with("file.csv:12: ")) << answer;
    EXPECT_NE(answer.find(c.answer), std::string::npos) << c.row << " → " << answer;
  }
}

TEST(MotionFile, RefusesAnotherHeader) {
  const std::string text = ExampleText();
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    return at == std::string::npos ? "not in the text: " + from : changed.replace(at, from.size(), to);
  };
  EXPECT_NE(ParseResult("").find("found an empty file"), std::string::npos);
  EXPECT_EQ(ParseResult(with("motion 1", "motion 2")),
            "file.csv:1: found \"# osteon motion 2\", accepted \"# osteon motion 1\"");
  EXPECT_EQ(ParseResult(with("# scene: ", "# scen: ")),
            "file.csv:3: found \"# scen: none\", accepted \"# scene: \" and its text");
  EXPECT_EQ(ParseResult(with("# clock: virtual time\n", "")).substr(0, 11), "file.csv:7:");
  EXPECT_EQ(ParseResult(with("# tool: ball", "# tool: ")).substr(0, 11), "file.csv:5:");
  EXPECT_NE(ParseResult(with("x_mm,y_mm", "y_mm,x_mm")).find("file.csv:10: found"), std::string::npos);
  EXPECT_NE(ParseResult(with("time_s,", "t,")).find("accepted the columns time_s,x_mm"), std::string::npos);
  // control characters do not reach the terminal
  EXPECT_EQ(ParseResult(with("# osteon", "\x1b[2J")).find('\x1b'), std::string::npos);
}

TEST(MotionFile, RefusesATornOrShortFile) {
  const std::string text = ExampleText();
  // truncated anywhere: an error, except after two or more whole rows
  int accepted = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    const std::string torn = text.substr(0, length);
    const auto motion = ParseMotion(torn, "file.csv");
    if (!motion) continue;
    ++accepted;
    EXPECT_EQ(torn.back(), '\n');
  }
  EXPECT_EQ(accepted, 3);  // the texts with two, three and four of the five rows
  std::string zeros = text;
  zeros[zeros.size() / 2] = '\0';
  EXPECT_NE(ParseResult(zeros), "accepted");
}

TEST(MotionFile, RefusesTooManyBytesOrRowsAndATimeThatDoesNotBeginAt0) {
  const std::string head = ExampleText().substr(0, ExampleText().find("\n0,") + 1);
  EXPECT_NE(ParseResult(head + std::string(17u << 20, 'x')).find("bytes, accepted at most 16777216"),
            std::string::npos);
  std::string rows;
  for (int k = 0; k <= 200'000; ++k) rows += std::to_string(1e-3 * k) + ",0,0,0,1,0,0,0,0\n";
  EXPECT_NE(ParseResult(head + rows).find("file.csv:200011: found more rows, accepted at most 200000"),
            std::string::npos)
      << ParseResult(head + rows);
  EXPECT_NE(
      ParseResult(head + "0.5,0,0,0,1,0,0,0,0\n").find("time_s: found 0.5 in the first row, accepted 0"),
      std::string::npos);
}

TEST(MotionFile, NamesAMissingFile) {
  const auto motion = LoadMotion("no/such/motion.csv");
  ASSERT_FALSE(motion);
  EXPECT_EQ(motion.error(), "no/such/motion.csv: found no file, accepted a motion");
  EXPECT_FALSE(LoadMotion(testing::TempDir()));  // a folder
}

}  // namespace
}  // namespace osteon::simulation
