#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/marker.h"
#include "tests/architecture/call_graph.h"
#include "tests/architecture/include_rules.h"
#include "tests/architecture/marked_functions.h"
#include "tests/temporary_path.h"

// A function marked OSTEON_RT uses no heap, lock, exception or system call. These tests check that by the
// calls in the machine code of both built programs.

namespace osteon::architecture {

// Marked functions that violate the promise on purpose, compiled into this test program. The check must find
// each violation in the machine code.
class Planted {
 public:
  virtual ~Planted() = default;
  void Grow() OSTEON_RT;
  void Lock() OSTEON_RT;
  [[nodiscard]] int Refuse(int value) const OSTEON_RT;
  virtual void PrintsWhereItIsOverridden() OSTEON_RT = 0;
  [[nodiscard]] double OnlyComputes(double x) const OSTEON_RT;

 private:
  [[gnu::noinline]] void Append() { numbers_.push_back(1); }

  std::vector<int> numbers_;
  std::mutex mutex_;
};
class PlantedPrinter final : public Planted {
 public:
  void PrintsWhereItIsOverridden() OSTEON_RT override;
};

[[gnu::noinline]] void Planted::Grow() OSTEON_RT { Append(); }
[[gnu::noinline]] void Planted::Lock() OSTEON_RT { const std::lock_guard lock(mutex_); }
[[gnu::noinline]] int Positive(int value) {
  if (value < 0) throw std::invalid_argument("negative");
  return value;
}
[[gnu::noinline]] int Planted::Refuse(int value) const OSTEON_RT {
  return Positive(value) + static_cast<int>(numbers_.size());
}
[[gnu::noinline]] double Planted::OnlyComputes(double x) const OSTEON_RT {
  return x * x + static_cast<double>(numbers_.size());
}
[[gnu::noinline]] void PlantedPrinter::PrintsWhereItIsOverridden() OSTEON_RT { std::puts("printed"); }

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = OSTEON_SOURCE_DIR;
const fs::path kRulesFile = kRoot / "tests/architecture/realtime_calls.txt";

std::string ReadText(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Whether this build can be checked: only an optimised build without a sanitizer, as it is shipped. A
// sanitizer calls its own library everywhere, and an unoptimised build contains code that never runs.
bool CanCheckThisBuild() {
#if defined(OSTEON_SANITIZED) || !defined(__OPTIMIZE__)
  return false;
#else
  return true;
#endif
}

// Disassembles a program and reads the references between its functions.
CallGraph GraphOf(const fs::path& program) {
  const fs::path text = TemporaryPath("osteon_disassembly_" + program.filename().string() + ".txt");
  const std::string command =
      "'" OSTEON_OBJDUMP "' -d --no-show-raw-insn '" + program.string() + "' >'" + text.string() + "'";
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  std::ifstream stream(text);
  CallGraph graph = CallGraph::Read(stream);
  fs::remove(text);
  return graph;
}

std::string Join(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

TEST(RealtimeCalls, NothingMarkedReachesHeapLockOrExceptionInTheBuiltCommands) {
  if (!CanCheckThisBuild()) GTEST_SKIP() << "skipped, this build's machine code is not what is shipped";
  std::set<std::string> marked;
  for (const std::string& file : SourceFiles(kRoot))
    if (!file.starts_with("tests/")) marked.merge(MarkedFunctions(ReadText(kRoot / file)));
  EXPECT_GT(marked.size(), 700u) << "the marks are no longer found";

  const std::vector<CallRule> rules = ReadCallRules(kRulesFile);
  CallCheck check = CheckCalls(GraphOf(OSTEON_BINARY), marked, rules);
  const CallCheck studies = CheckCalls(GraphOf(OSTEON_STUDIES_BINARY), marked, rules);
  for (const std::vector<std::string>& forbidden : {check.forbidden, studies.forbidden})
    EXPECT_TRUE(forbidden.empty()) << Join(forbidden)
                                   << "call something else, or give it a line with its reason in "
                                   << kRulesFile.string();
  // these must be checked as well: the tick's own entry points, and the implementations of virtual functions
  for (const char* name :
       {"osteon::control::ServoLoop::Tick", "osteon::control::LoopRepeat::ReplayStoredTick",
        "osteon::io::FriLink::Receive", "osteon::io::FriLink::Send", "osteon::io::RsiLink::Receive",
        "osteon::io::RsiLink::Send", "osteon::safety::GuardMonitor::OnCommand",
        "osteon::control::EvaluateCoupling"})
    EXPECT_TRUE(check.roots.contains(name)) << name << " is not found in the program";
  // each rule must apply in at least one of the programs
  check.roots.insert(studies.roots.begin(), studies.roots.end());
  check.used.insert(studies.used.begin(), studies.used.end());
  EXPECT_GT(check.roots.size(), 350u);
  EXPECT_GT(check.reached + studies.reached, 500u);
  for (const CallRule& rule : rules)
    EXPECT_TRUE(!rule.opaque || check.used.contains(rule.pattern)) << "skips nothing: " << rule.pattern;
}

// The result of the check for the violations in this test program, with the rules of the tree.
class PlantedCalls : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!CanCheckThisBuild()) return;
    check_ = CheckCalls(GraphOf(fs::read_symlink("/proc/self/exe")), MarkedFunctions(ReadText(__FILE__)),
                        ReadCallRules(kRulesFile));
  }
  void SetUp() override {
    if (!CanCheckThisBuild()) GTEST_SKIP() << "skipped, this build's machine code is not what is shipped";
    ASSERT_TRUE(check_.roots.contains("osteon::architecture::Planted::" + marked_)) << marked_;
  }
  // Whether the forbidden calls contain a chain from this function to this callee.
  static bool Finds(const std::string& function, const std::string& callee) {
    for (const std::string& chain : check_.forbidden)
      if (chain.starts_with("osteon::architecture::" + function) && chain.find(callee) != std::string::npos)
        return true;
    return false;
  }

  static inline CallCheck check_;
  const std::string marked_ = "Grow";
};

TEST_F(PlantedCalls, ToTheHeapAreFoundThroughAnUnmarkedFunction) {
  EXPECT_TRUE(Finds("Planted::Grow() > osteon::architecture::Planted::Append()", "operator new"))
      << Join(check_.forbidden);
}

TEST_F(PlantedCalls, ToAMutexAreFound) {
  EXPECT_TRUE(Finds("Planted::Lock()", "pthread_mutex_lock")) << Join(check_.forbidden);
}

TEST_F(PlantedCalls, ToAThrowingFunctionAreFound) {
  EXPECT_TRUE(Finds("Planted::Refuse(int)", "__cxa_throw")) << Join(check_.forbidden);
}

TEST_F(PlantedCalls, OfAnOverrideAreFoundByItsOwnMark) {
  EXPECT_TRUE(Finds("PlantedPrinter::PrintsWhereItIsOverridden()", "puts")) << Join(check_.forbidden);
}

TEST_F(PlantedCalls, ThatAreAllowedAreNotReported) {
  EXPECT_FALSE(Finds("Planted::OnlyComputes(double)", "")) << Join(check_.forbidden);
}

TEST(MarkedFunctions, AreFoundInEveryFormThatTheTreeHas) {
  const std::set<std::string> found = MarkedFunctions(R"(
#define NOT_ME() OSTEON_RT
namespace osteon::a {
/* void Comment() OSTEON_RT; */  // void Line() OSTEON_RT;
const char* text = "void Text() OSTEON_RT;";
template <int N>
class Law final : public Base<N> {
 public:
  explicit Law(double gain = 1'000.0) OSTEON_RT : gain_(gain) {}
  [[nodiscard]] virtual double Step(const Input& in, std::span<const double> more = {}) const OSTEON_RT = 0;
  void Override() OSTEON_RT override { auto f = [](int x) OSTEON_RT { return x; }; f(1); }
  [[nodiscard]] bool operator==(const Law& other) const OSTEON_RT;
  struct Inner { void Clear() OSTEON_RT; };
  void NotMarked() noexcept;
};
enum class Kind { kOne };
namespace { Kind Of(int i) OSTEON_RT { return i > 0 ? Kind::kOne : Kind{}; } }
template <int N>
auto Law<N>::Later(int a) const -> int;
template <int N>
double Law<N>::Share(const Joints& q) const OSTEON_RT { return q.sum(); }
}  // namespace osteon::a
void Global() OSTEON_RT;
)");
  EXPECT_EQ(found,
            (std::set<std::string>{"osteon::a::Law::Law", "osteon::a::Law::Step", "osteon::a::Law::Override",
                                   "osteon::a::Law::operator==", "osteon::a::Law::Inner::Clear",
                                   "osteon::a::Of", "osteon::a::Law::Share", "Global"}));
}

TEST(MarkedFunctions, HaveTheQualifiedNamesOfTheirSymbols) {
  EXPECT_EQ(QualifiedName("void osteon::rt::Prefetch<int>(int const&)"), "osteon::rt::Prefetch");
  EXPECT_EQ(QualifiedName("osteon::a::(anonymous namespace)::Same<double>(double const&) [clone .part.0]"),
            "osteon::a::Same");
  EXPECT_EQ(QualifiedName("osteon::a::Law<7>::Share(Eigen::Matrix<double, 7, 1, 0, 7, 1> const&) const"),
            "osteon::a::Law::Share");
  EXPECT_EQ(QualifiedName("osteon::a::operator+(osteon::Wrench const&, osteon::Wrench const&)"),
            "osteon::a::operator+");
  EXPECT_EQ(QualifiedName("malloc"), "malloc");
}

TEST(CallGraph, IsReadFromADisassembly) {
  std::istringstream text(R"(
t.so:     file format elf64-x86-64

Disassembly of section .plt:

0000000000001000 <malloc@plt>:
    1000:	jmp    *0x2fe2(%rip)        # 4000 <malloc@GLIBC_2.2.5>

Disassembly of section .text:

0000000000001100 <_ZN1a1fEv>:
    1100:	call   1200 <_ZN1a1gEv.part.0>
    1105:	jne    1110 <_ZN1a1fEv+0x10>
    1107:	lea    0x2000(%rip),%rax        # 3200 <_ZTVN1a1AE+0x10>
    110e:	jmp    1100 <_ZN1a1fEv>

0000000000001200 <_ZN1a1gEv.part.0>:
    1200:	jmp    1000 <malloc@plt>
)");
  const CallGraph graph = CallGraph::Read(text);
  ASSERT_NE(graph.Callees("_ZN1a1fEv"), nullptr);
  EXPECT_EQ(*graph.Callees("_ZN1a1fEv"), std::set<std::string>{"_ZN1a1gEv.part.0"});
  EXPECT_EQ(*graph.Callees("_ZN1a1gEv.part.0"), std::set<std::string>{"malloc"});
  EXPECT_EQ(graph.Callees("malloc"), nullptr) << "of a library";
  EXPECT_EQ(CheckCalls(graph, {"a::f"}, {}).forbidden, std::vector<std::string>{"a::f() > a::g() > malloc"});
  EXPECT_TRUE(CheckCalls(graph, {"a::f"}, {{.pattern = "mal*", .reason = "a test"}}).forbidden.empty());
  EXPECT_TRUE(CheckCalls(graph, {"a::f"}, {{.pattern = "a::g", .reason = "a test", .opaque = true}})
                  .forbidden.empty());
}

TEST(CallRules, RejectALineWithoutAReason) {
  const fs::path file = TemporaryPath("osteon_calls_without_reason.txt");
  std::ofstream(file) << "# comment\n\nallow malloc |\n";
  try {
    ReadCallRules(file);
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find(".txt:3: found 'allow malloc |'"), std::string::npos)
        << error.what();
  }
  fs::remove(file);
}

}  // namespace
}  // namespace osteon::architecture
