// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/gantt.hpp>
#include <segue/mission/action.hpp>
#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/priority.hpp>
#include <segue/task_network/sequential.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>

#include <array>

namespace segue::draw {
namespace {

using namespace task_network;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// A network with its order and a run of it.
struct Ran {
  explicit Ran(const std::string& nodes, ConcurrentEngineOptions options = {}) : flat(read(nodes)) {
    SimulatedEnvironment environment(flat.network, flat.trials);
    result = ConcurrentEngine(flat.network, order, environment, std::move(options)).run();
  }
  static FlatNetwork read(const std::string& nodes) {
    Diagnostics diagnostics;
    auto flat = read_flat_network("{\"nodes\": [" + nodes + "]}", "test.json", diagnostics);
    EXPECT_TRUE(flat) << to_string(diagnostics);
    return flat ? std::move(*flat) : FlatNetwork{};
  }
  [[nodiscard]] Gantt gantt() const {
    return gantt_of(flat.network, result, WaitFinder(flat.network, order, result),
                    listed_nodes(flat.network, result, ListedNodes::All), {});
  }
  [[nodiscard]] std::vector<Wait> waits(std::uint32_t node) const {
    return WaitFinder(flat.network, order, result).of(NodeId{node});
  }

  FlatNetwork flat;
  Order order = derive_order(flat.network);
  RunResult result;
};

constexpr const char* kTwo = R"j({"name": "a<b", "duration_s": 2, "pia": true, "effects": ["+p()"]},
  {"name": "c", "duration_s": 1, "pia": true, "preconditions": ["p()"], "effects": []})j";

TEST(Waits, TellWhoWaitedForWhat) {
  const Ran ran(kTwo);
  const auto waits = ran.waits(1);
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(waits[0].kind, Wait::Kind::World);
  EXPECT_EQ(waits[0].subject, "p()");
  EXPECT_EQ(to_string(waits[0], "a<b"), "world p() of a<b");
  EXPECT_THAT(WaitFinder(ran.flat.network, ran.order, ran.result).critical_chain(),
              ElementsAre(NodeId{0}, NodeId{1}));
  EXPECT_TRUE(choose_priorities(ran.flat.network, ran.order, ran.flat.trials, {}).empty())
      << "a tie is program order";
}

constexpr const char* kShared = R"j(
  {"name": "a", "duration_s": 2, "pia": false, "effects": [], "resources": [{"name": "left", "op": "block"}]},
  {"name": "b", "duration_s": 3, "pia": false, "effects": [], "resources": [{"name": "right", "op": "block"}]},
  {"name": "both", "duration_s": 1, "pia": false, "effects": [],
   "resources": [{"name": "left", "op": "block"}, {"name": "right", "op": "block"}]})j";

TEST(Waits, AreForTheResourceThatWasGivenBackLast) {
  const auto waits = Ran(kShared).waits(2);
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(waits[0].kind, Wait::Kind::Resource);
  EXPECT_EQ(waits[0].subject, "right");
  EXPECT_EQ(waits[0].node, NodeId{1});
  EXPECT_EQ(waits[0].until, TimePoint{seconds(3)});
}

TEST(Waits, WhoLacksNothingWaitsForAWorker) {
  const Ran ran(R"j({"name": "a", "duration_s": 2, "pia": false, "effects": [], "resources": []},
    {"name": "b", "duration_s": 3, "pia": false, "effects": [], "resources": []})j",
                {.workers = 1});
  const auto waits = ran.waits(1);
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(waits[0].kind, Wait::Kind::Turn);
  EXPECT_EQ(waits[0].node, NodeId{0});
  EXPECT_EQ(to_string(waits[0], "a"), "turn after a");
}

TEST(Waits, OneAfterTheOtherIsAMatterOfTurns) {
  Ran ran(kShared);
  SimulatedEnvironment environment(ran.flat.network);
  ran.result = run_sequential(ran.flat.network, environment);
  const auto waits = ran.waits(1);
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(waits[0].kind, Wait::Kind::Turn);
}

constexpr const char* kGuess = R"j(
  {"name": "ask", "duration_s": 4, "pia": false, "outcome": "no", "resources": []},
  {"name": "yes", "duration_s": 1, "pia": false, "condition_deps": ["ask"], "resources": []},
  {"name": "no", "duration_s": 2, "pia": false, "resources": [],
   "condition_deps": [{"node": "ask", "outcome": "no"}]})j";

TEST(Gantt, TellsWhatRanAheadForSomethingAndForNothing) {
  const Gantt gantt = Ran(kGuess).gantt();
  ASSERT_EQ(gantt.nodes.size(), 3U);
  EXPECT_FALSE(gantt.nodes[0].speculative);
  EXPECT_FALSE(gantt.nodes[1].speculative) << "it is skipped";
  ASSERT_EQ(gantt.nodes[1].bars.size(), 1U);
  EXPECT_TRUE(gantt.bars[gantt.nodes[1].bars[0]].wasted);
  EXPECT_TRUE(gantt.nodes[2].speculative) << "it began before ask had ended, and counts";
  EXPECT_FALSE(gantt.bars[gantt.nodes[2].bars[0]].wasted);
}

TEST(Gantt, BarsThatOverlapHaveLanesOfTheirOwn) {
  Gantt gantt;
  gantt.nodes = {{"a"}, {"b"}, {"c"}};
  gantt.nodes[0].resources = gantt.nodes[2].resources = {0};
  gantt.resources = {{"arm"}};
  const auto at = [](int second) { return TimePoint{seconds(second)}; };
  gantt.bars = {{2, at(2), at(3)}, {0, at(0), at(2)}, {1, at(1), at(4)}};
  gantt.arrange();
  std::vector<std::uint32_t> order;
  std::vector<std::size_t> lanes;
  for (const Gantt::Bar& bar : gantt.bars) {
    order.push_back(bar.node);
    lanes.push_back(bar.lane);
  }
  EXPECT_THAT(order, ElementsAre(0U, 1U, 2U));
  EXPECT_THAT(lanes, ElementsAre(0U, 1U, 0U));
  EXPECT_THAT(gantt.resources[0].bars, ElementsAre(0U, 2U));
}

TEST(Gantt, IsADrawing) {
  const std::string drawing = to_svg(Ran(kTwo).gantt());
  EXPECT_THAT(drawing, HasSubstr("waits for world p() of a&lt;b, until 2.00 s"));
}

TEST(Gantt, IsADrawingWithoutWhatWasNeitherWantedNorRun) {
  Gantt gantt;
  gantt.nodes = {{"a"}, {"b"}, {"c"}, {"d"}};
  gantt.nodes[0].status = NodeStatus::Done;
  for (const std::size_t skipped : {1U, 2U, 3U})
    gantt.nodes[skipped].status = NodeStatus::Skipped;
  gantt.bars = {{2, TimePoint{}, TimePoint{seconds(1)}, 0, true}};
  gantt.arrange();
  const std::string drawing = to_svg(gantt);
  EXPECT_THAT(drawing, HasSubstr(">a</text>"));
  EXPECT_THAT(drawing, HasSubstr(">c</text>")) << "it ran for nothing";
  EXPECT_THAT(drawing, Not(HasSubstr(">b</text>")));
  EXPECT_THAT(drawing, HasSubstr(">and 2 not on the path taken</text>"));
}

constexpr const char* kSilent = R"j({"name": "a", "duration_s": 2, "effects": ["+p()"]},
  {"name": "b", "duration_s": 1})j";

TEST(Gantt, WhoDoesNotSayWhatItTouchesWaitsForItsTurn) {
  const auto waits = Ran(kSilent).waits(1);
  ASSERT_EQ(waits.size(), 1U);
  EXPECT_EQ(to_string(waits[0], "a"), "turn after a");
}

TEST(Gantt, NamesAreCutInFrontAndBetweenCharacters) {
  Gantt gantt;
  std::string name;
  for (int i = 0; i < 20; ++i)
    name += "\u00fc";
  gantt.nodes = {{name + "xy"}};
  EXPECT_THAT(to_svg(gantt), HasSubstr(">\u2026" + name.substr(0, 22) + "xy</text>"));
}

TEST(Gantt, IsATrace) {
  const auto trace = type::parse_json(to_trace(Ran(kShared).gantt()));
  ASSERT_TRUE(trace);
  EXPECT_EQ(trace->find("traceEvents")->as_list().size(), 2U + 3U + 2U + 4U) << "names, bars, rows, uses";
}

/// The JSON in a page.
type::Value run_in(const std::string& page) {
  const std::string open = "id=\"run\">";
  const auto begin = page.find(open);
  EXPECT_NE(begin, std::string::npos);
  const auto end = page.find("</script>", begin);
  const auto value = type::parse_json(page.substr(begin + open.size(), end - begin - open.size()));
  EXPECT_TRUE(value);
  return value.value_or(type::Value());
}

std::size_t count(const std::string& text, std::string_view part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

TEST(GanttPage, HoldsTheRun) {
  Gantt gantt = Ran(kTwo).gantt();
  gantt.name = "two";
  gantt.summary.sequential = seconds(3);
  const std::string page = to_html(gantt);
  EXPECT_THAT(page, HasSubstr("<title>two</title>"));
  const type::Value run = run_in(page);
  EXPECT_EQ(run.find("sequential")->as_double(), 3);
  const auto& node = run.find("nodes")->as_list().at(1).as_list();
  EXPECT_EQ(node.at(0).as_string(), "c");
  EXPECT_TRUE(node.at(4).as_bool()) << "critical";
  const auto& wait = node.at(6).as_list().at(0).as_list();
  EXPECT_EQ(wait.at(1).as_int(), 0);
  EXPECT_EQ(wait.at(2).as_string(), "p()");
}

TEST(GanttPage, NeedsNothingFromElsewhere) {
  const std::string page = to_html(Ran(kTwo).gantt());
  for (const char* part : {"http:", "https:", " src=", " href=", "@import", "url(", "fetch(", "import("})
    EXPECT_THAT(page, Not(HasSubstr(part)));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
}

TEST(GanttPage, NoNameIsTakenForMarkupOrScript) {
  const std::array<std::string, 9> names = {"</script><script>alert(1)</script>",
                                            "<!-- <script>",
                                            "<img src=x onerror=alert(1)>",
                                            "a & b \"c\" 'd' `e` ${f}",
                                            "@script@ @run@ @title@",
                                            "\u6f22\u5b57 \U0001F600 \u2028",
                                            "]]>",
                                            "back\\slash\\u003c",
                                            ""};
  const std::string plain = to_html(Gantt{});
  Gantt gantt;
  for (const std::string& name : names) {
    Wait wait{Wait::Kind::Data, NodeId{0}, name, {}, {}};
    Gantt::Node node{name};
    node.outcome = name;
    node.waits.push_back(std::move(wait));
    gantt.nodes.push_back(std::move(node));
    gantt.resources.push_back({name});
  }
  gantt.name = names[0] + "</title>" + names[4];
  gantt.outcome = names[1];
  const std::string page = to_html(gantt);
  for (const std::string_view part : {"<script", "</script", "<!--", "<img", "</title>", "JSON.parse("})
    EXPECT_EQ(count(page, part), count(plain, part)) << part;
  const type::Value run = run_in(page);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto& node = run.find("nodes")->as_list().at(i).as_list();
    EXPECT_EQ(node.at(0).as_string(), names.at(i));
    EXPECT_EQ(node.at(6).as_list().at(0).as_list().at(2).as_string(), names.at(i));
    EXPECT_EQ(run.find("resources")->as_list().at(i).as_string(), names.at(i));
  }
  EXPECT_EQ(run.find("name")->as_string(), gantt.name);
}

TEST(GanttPage, AnEmptyRunIsAPageToo) {
  const TaskNetwork network;
  const Order order;
  const RunResult result;
  const type::Value run =
      run_in(to_html(gantt_of(network, result, WaitFinder(network, order, result), {}, {})));
  EXPECT_TRUE(run.find("nodes")->as_list().empty());
}

TEST(ActionClass, FollowsFromWhatAnActionDeclares) {
  mission::Action action;
  EXPECT_EQ(action.action_class(), ActionClass::Irreversible);
  action.pure = true;
  EXPECT_EQ(action.action_class(), ActionClass::Pure);
  action.sensing = true;
  EXPECT_EQ(action.action_class(), ActionClass::Sensing);
  action = {};
  action.run = mission::Decision{};
  EXPECT_EQ(action.action_class(), ActionClass::Pure) << "a decision changes nothing";
}

}  // namespace
}  // namespace segue::draw
