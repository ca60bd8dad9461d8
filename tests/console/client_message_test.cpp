#include "console/server/client_message.h"

#include <chrono>
#include <string>

#include <gtest/gtest.h>

#include "console/server/access.h"
#include "console/server/operator_role.h"
#include "console/server/shared_live.h"
#include "console/server/surface_budget.h"
#include "console/server/surface_reader.h"
#include "console/server/surface_store.h"

// Tests parts of the console's server without a network: messages of a page, access, the operator's role, and
// how surface bricks and live windows are distributed to pages.

namespace osteon::console {
namespace {

TEST(ClientMessage, ParsesEveryRequestOfAPage) {
  EXPECT_EQ(std::get<OperatorRequest>(*ParseClientMessage(R"({"ask": "pause"})")), OperatorRequest::kPause);
  EXPECT_EQ(std::get<OperatorRequest>(*ParseClientMessage(R"({"ask": "stop"})")), OperatorRequest::kStop);
  EXPECT_EQ(std::get<OperatorRequest>(*ParseClientMessage(R"({"ask": "recover"})")),
            OperatorRequest::kRecover);
  EXPECT_EQ(std::get<RoleRequest>(*ParseClientMessage(R"({"ask": "watch"})")), RoleRequest::kGiveBack);
  EXPECT_EQ(std::get<ViewRequest>(*ParseClientMessage(R"({"ask": "seek", "value": 2.5})")).value, 2.5);
  EXPECT_EQ(std::get<ViewRequest>(*ParseClientMessage(R"({"ask": "map", "value": 1})")).kind,
            ViewRequest::Kind::kMap);
  EXPECT_EQ(std::get<GainsRequest>(*ParseClientMessage(R"({"ask": "drag", "value": 40})")).value, 40.0);
  EXPECT_EQ(std::get<GainsRequest>(*ParseClientMessage(R"({"ask": "undo_gains"})")).kind,
            GainsRequest::Kind::kUndo);
  using Procedure = ProcedureRequest::Kind;
  const auto next = std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "next_tool"})"));
  EXPECT_EQ(next.kind, Procedure::kNext);
  EXPECT_FALSE(next.confirmed);
  const auto tool =
      std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "tool", "value": 46, "confirmed": true})"));
  EXPECT_EQ(tool.kind, Procedure::kTool);
  EXPECT_EQ(tool.value, 46.0);
  EXPECT_TRUE(tool.confirmed);
  EXPECT_EQ(std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "undo_pass"})")).kind,
            Procedure::kUndo);
  EXPECT_EQ(std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "guidance", "value": 0.5})")).value,
            0.5);
  EXPECT_EQ(std::get<DrawnReport>(*ParseClientMessage(R"({"ask": "drawn", "value": 12.5})")).stamp_s, 12.5);
  const auto finish =
      std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "finish", "confirmed": true})"));
  EXPECT_EQ(finish.kind, Procedure::kFinish);
  EXPECT_TRUE(finish.confirmed);
  EXPECT_FALSE(std::get<ProcedureRequest>(*ParseClientMessage(R"({"ask": "finish"})")).confirmed);
  EXPECT_TRUE(std::holds_alternative<ResendRequest>(*ParseClientMessage(R"({"ask": "all"})")));
}

TEST(ClientMessage, RefusesEverythingElseWithWhatItAccepts) {
  const std::string deep(900, '[');
  for (const std::string& bytes : {std::string(),
                                   std::string("x"),
                                   std::string("{}"),
                                   std::string(R"({"ask": 1})"),
                                   std::string(R"({"ask": null})"),
                                   std::string(R"({"ask": "pause", "more": 1})"),
                                   std::string(R"({"ask": "raise the limit"})"),
                                   std::string(R"(["pause"])"),
                                   std::string(R"({"ask": "drag"})"),
                                   std::string(R"({"ask": "stiffness", "value": -1e999})"),
                                   std::string(R"({"ask": "pause", "value": 1})"),
                                   std::string(R"({"ask": "seek"})"),
                                   std::string(R"({"ask": "map"})"),
                                   std::string(R"({"ask": "seek", "value": 1e999})"),
                                   std::string(R"({"ask": "seek", "value": "1"})"),
                                   std::string(R"({"ask": "next_tool", "value": 1})"),
                                   std::string(R"({"ask": "finish", "value": 1})"),
                                   std::string(R"({"ask": "drawn"})"),
                                   std::string(R"({"ask": "tool"})"),
                                   std::string(R"({"ask": "undo_pass", "confirmed": true})"),
                                   std::string(R"({"ask": "next_tool", "confirmed": false})"),
                                   std::string("\0\0", 2),
                                   deep,
                                   std::string(kMaxClientMessage + 1, ' ')}) {
    const auto message = ParseClientMessage(bytes);
    ASSERT_FALSE(message) << bytes;
    EXPECT_NE(message.error().find("accepted"), std::string::npos) << message.error();
    EXPECT_LE(message.error().size(), 300u);
  }
}

TEST(Access, OnlyAPageOfThisServerMayConnect) {
  const auto check = [](std::string_view host, std::string_view origin) {
    return CheckAccess({.host = host, .origin = origin, .token = {}}, "127.0.0.1", "");
  };
  EXPECT_EQ(check("127.0.0.1:8470", "http://127.0.0.1:8470"), "");
  EXPECT_EQ(check("localhost:8470", "http://localhost:8470"), "");
  EXPECT_EQ(check("[::1]:8470", "http://[::1]:8470"), "");
  EXPECT_EQ(check("127.0.0.1:8470", ""), "") << "a program has no origin";
  EXPECT_NE(check("127.0.0.1:8470", "http://evil.example"), "");
  EXPECT_NE(check("127.0.0.1:8470", "http://127.0.0.1:9999"), "") << "another server of this machine";
  EXPECT_NE(check("127.0.0.1:8470", "null"), "") << "a file, a sandboxed frame";
  EXPECT_NE(check("evil.example:8470", "http://evil.example:8470"), "") << "a name bent to this machine";
  EXPECT_NE(check("", ""), "");
}

TEST(Access, AnAddressBeyondTheLoopbackNeedsTheToken) {
  const std::string token = NewToken();
  EXPECT_EQ(token.size(), 32u);
  EXPECT_NE(token, NewToken());
  const auto check = [&](std::string_view given) {
    return CheckAccess({.host = "10.0.0.5:8470", .origin = "http://10.0.0.5:8470", .token = given},
                       "10.0.0.5", token);
  };
  EXPECT_EQ(check(token), "");
  EXPECT_NE(check(""), "");
  EXPECT_NE(check(token.substr(1)), "");
  EXPECT_NE(check(std::string(32, '0')), "");
}

TEST(OperatorRole, OnePageHoldsTheRoleUntilItGivesItBack) {
  OperatorRole role;
  EXPECT_TRUE(role.Take(1));
  EXPECT_TRUE(role.Take(1));
  EXPECT_FALSE(role.Take(2));
  role.GiveBack(2);
  EXPECT_EQ(role.holder(), 1u);
  role.GiveBack(1);
  EXPECT_TRUE(role.Take(2));
}

TEST(SurfaceReader, GetsTheNewestVersionOfEachBrickInParts) {
  SurfaceStore store;
  for (std::uint64_t brick = 0; brick < 5; ++brick) store.Put({{brick, "old"}});
  store.Put({{2, "new"}});
  SurfaceReader reader;
  const auto first = reader.Next(store, 10), last = reader.Next(store, 10);
  EXPECT_EQ(first.bricks + "|" + last.bricks, "oldoldold|oldnew");
  EXPECT_TRUE(first.begins && !first.ends && !last.begins && last.ends);
  EXPECT_TRUE(reader.Next(store, 10).bricks.empty());
  store.Put({{0, "again"}});
  EXPECT_EQ(reader.Next(store, 1).bricks, "again") << "a brick is larger than a part";
}

// Three bricks change in every turn, but only one of them is sent per turn. So three turns transmit a whole
// change, and its bricks must all be from the same time.
TEST(SurfaceReader, AllBricksOfAChangeAreSentWhileBricksKeepChanging) {
  SurfaceStore store;
  SurfaceReader reader;
  int whole_changes = 0;
  std::string bricks;
  for (int turn = 0; turn < 30; ++turn) {
    const std::string time(1, static_cast<char>('a' + turn));
    store.Put({{1, "1" + time}, {2, "2" + time}, {3, "3" + time}});
    const auto part = reader.Next(store, 2);
    bricks += part.bricks;
    if (!part.ends) continue;
    ++whole_changes;
    ASSERT_EQ(bricks.size(), 6u) << bricks;
    EXPECT_EQ(bricks[1], bricks[3]) << "bricks of two times: " << bricks;
    EXPECT_EQ(bricks[1], bricks[5]) << "bricks of two times: " << bricks;
    bricks.clear();
  }
  EXPECT_EQ(whole_changes, 10);
}

TEST(SurfaceReader, ANewGridDiscardsTheBricksThatWait) {
  SurfaceStore store;
  store.Begin({}, "grid one");
  store.Put({{1, "1"}, {2, "2"}});
  SurfaceReader reader;
  EXPECT_EQ(*reader.Next(store, 1).layout, "grid one");
  store.Begin({}, "grid two");
  store.Put({{7, "7"}});
  const auto part = reader.Next(store, 100);
  ASSERT_NE(part.layout, nullptr);
  EXPECT_EQ(*part.layout + ":" + part.bricks, "grid two:7");
  EXPECT_TRUE(part.ends);
  reader.Restart();
  EXPECT_EQ(*reader.Next(store, 100).layout, "grid two");
}

TEST(SurfaceBudget, IsLargestOnAFastLinkAndSmallestOnASlowOne) {
  using std::chrono::milliseconds;
  SurfaceBudget budget;
  for (int i = 0; i < 20; ++i) budget.AfterMessage(milliseconds(1));
  EXPECT_EQ(budget.bytes(), SurfaceBudget::kMax_bytes);
  for (int i = 0; i < 20; ++i) budget.AfterMessage(milliseconds(20));
  EXPECT_EQ(budget.bytes(), SurfaceBudget::kMax_bytes);
  for (int i = 0; i < 20; ++i) budget.AfterMessage(milliseconds(100));
  EXPECT_EQ(budget.bytes(), SurfaceBudget::kMin_bytes);
}

TEST(SharedLive, PagesThatNeedTheSameWindowsShareOneMessage) {
  SharedLive live;
  int made = 0;
  const auto get = [&](std::uint64_t epoch, std::uint64_t from, std::uint64_t to) {
    return *live.Get({.epoch = epoch, .from = from, .to = to}, [&] { return std::to_string(++made); });
  };
  EXPECT_EQ(get(0, 4, 5), "1");
  EXPECT_EQ(get(0, 4, 5), "1");
  EXPECT_EQ(get(0, 3, 5), "2") << "a page that is behind";
  EXPECT_EQ(get(1, 3, 5), "3") << "the same numbers in another epoch";
  EXPECT_EQ(made, 3);
}

}  // namespace
}  // namespace osteon::console
