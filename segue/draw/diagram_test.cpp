// SPDX-License-Identifier: Apache-2.0
#include <segue/draw/diagram.hpp>
#include <segue/task_network/flat_file.hpp>
#include <segue/task_network/implied.hpp>
#include <segue/type/json.hpp>

#include <gmock/gmock.h>

#include <algorithm>

#include <segue/draw/layout.hpp>
#include "support/random_task_networks.hpp"

namespace segue::draw {
namespace {

using namespace task_network;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

FlatNetwork read(const std::string& nodes, const std::string& head = "") {
  Diagnostics diagnostics;
  auto flat = read_flat_network("{" + head + "\"nodes\": [" + nodes + "]}", "test.json", diagnostics);
  EXPECT_TRUE(flat) << to_string(diagnostics);
  return flat ? std::move(*flat) : FlatNetwork{};
}

Diagram diagram_of(const TaskNetwork& network, OrderRule rule = OrderRule::Epoch) {
  std::vector<Dependency> further;
  const Order order = derive_order(network, rule, &further);
  return draw::diagram_of(network, order, further);
}

/// Why one node comes after another, in words.
std::vector<std::string> causes(const Diagram& diagram, std::uint32_t from, std::uint32_t to) {
  std::vector<std::string> texts;
  for (const Diagram::Dependency& dependency : diagram.nodes.at(to).before) {
    if (dependency.from != from) continue;
    for (const Diagram::Cause& cause : dependency.causes)
      texts.push_back(to_string(cause));
  }
  return texts;
}

const Diagram::Dependency& only(const Diagram& diagram, std::uint32_t to) {
  EXPECT_EQ(diagram.nodes.at(to).before.size(), 1U);
  return diagram.nodes.at(to).before.at(0);
}

TEST(Diagram, OfManyThatMayHappenAheadAPersonReadsTheFirst) {
  std::vector<NamedActsAhead> ahead;
  NamedActsAhead next{"s0", {}};
  for (int i = 1; i <= 1000; ++i) {
    next.fails.push_back(next.acts);
    next.acts = "s" + std::to_string(i);
    ahead.push_back(next);
  }
  const std::string text = ahead_text(ahead, true);
  EXPECT_THAT(text, HasSubstr("\n    s1, although s0 fails\n"));
  EXPECT_THAT(text, HasSubstr("\n    s6, although one of s0, s1, s2, s3, s4, s5 fails\n"));
  EXPECT_THAT(text, HasSubstr("\n    s12, although one of s0, s1, s2, s3, s4, s5 or 6 more fails\n"
                              "    and 988 more (--json lists all)\n"));
  EXPECT_THAT(text, Not(HasSubstr("s13,")));
}

TEST(Diagram, TellsWhichOutputBecomesWhichInput) {
  const auto flat = read(R"j({"name": "look", "pia": false},
    {"name": "grasp", "pia": true, "effects": ["+held()"], "data_flows": [["look", "pose", "grasp", "goal"]]})j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_THAT(causes(diagram, 0, 1), ElementsAre("data pose -> goal"));
  EXPECT_EQ(diagram.nodes[0].role, Diagram::Role::Pure);
  EXPECT_TRUE(only(diagram, 1).holds_start);
}

TEST(Diagram, TellsWhichOutcomeOfWhomDecides) {
  const auto flat = read(R"j({"name": "ask", "pia": false, "outcome": "no"},
    {"name": "go", "pia": true, "effects": ["+gone()"], "condition_deps": [{"node": "ask", "outcome": "no"}]},
    {"name": "plan", "pia": false, "condition_deps": [{"node": "ask", "outcome": "no"}]})j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_THAT(causes(diagram, 0, 1), ElementsAre("condition no"));
  EXPECT_TRUE(only(diagram, 1).holds_start);
  EXPECT_FALSE(only(diagram, 2).holds_start) << "a pure node runs ahead of decisions";
}

TEST(Diagram, TellsAllFactsAndWhatBothDoWithThem) {
  const auto flat = read(R"j(
    {"name": "go", "pia": true, "preconditions": ["at(a)"], "effects": ["-at(a)", "+at(b)"]},
    {"name": "dig", "pia": true, "preconditions": ["at(b)", "!at(a)"], "effects": ["+hole()"]},
    {"name": "back", "pia": true, "preconditions": ["at(b)"], "effects": ["+at(a)", "-at(b)"]})j",
                         R"j("initial_world": ["at(a)"],)j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_THAT(causes(diagram, 0, 1),
              ElementsAre("world at(b): made true there, relied on here",
                          "world at(a): relied on and made false there, relied on as false here"));
  EXPECT_THAT(causes(diagram, 1, 2),
              ElementsAre("world at(b): relied on there, relied on and made false here",
                          "world at(a): relied on as false there, made true here"));
}

TEST(Diagram, TellsWhetherUnitsOrTheProgramOrderAreTheMatter) {
  const auto flat = read(R"j(
    {"name": "a", "pia": true, "effects": [], "resources": [{"name": "system:arm", "op": "block"}]},
    {"name": "b", "pia": true, "effects": [], "resources": [{"name": "system:arm", "op": "block"}]},
    {"name": "c", "pia": true, "effects": [], "resources": [{"name": "fuel", "op": "consume"}]},
    {"name": "d", "pia": true, "effects": [], "resources": [{"name": "fuel", "op": "create"}]})j",
                         R"j("resources": {"fuel": {"class": "world", "count": 3}},)j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_THAT(causes(diagram, 0, 1),
              ElementsAre("resource system:arm: what is irreversible uses it in the program's order"));
  EXPECT_THAT(causes(diagram, 2, 3),
              ElementsAre("resource fuel: units come and go, so starts keep the program's order"));
}

TEST(Diagram, TellsOfResourcesThatAreHeldOverSeveralNodes) {
  TaskNetwork network;
  const ResourceId arm = network.resources.intern("system:arm");
  const std::uint32_t group = network.add_group(arm);
  NodeSpec spec;
  spec.kind = ActionClass::Pure;
  spec.claims = {{arm, ResourceOp::Block, 1, group}};
  for (const char* name : {"open", "close"}) {
    spec.name = name;
    network.append(spec);
  }
  EXPECT_THAT(
      causes(diagram_of(network), 0, 1),
      ElementsAre("group system:arm: held over several nodes, whose starts keep the program's order"));
}

TEST(Diagram, TellsWhoMayTouchAnything) {
  const auto flat = read(R"j({"name": "a", "pia": true, "effects": ["+p()"]},
    {"name": "say", "pia": true}, {"name": "b", "pia": true, "effects": ["+q()"]},
    {"name": "odd", "pia": true, "opaque": true, "effects": ["+p()"]})j");
  const Diagram diagram = diagram_of(flat.network);
  const std::string silent = "opaque say: it declares no facts and no resources, so it may touch anything";
  EXPECT_THAT(causes(diagram, 0, 1), ElementsAre(silent));
  EXPECT_THAT(causes(diagram, 1, 2), ElementsAre(silent));
  EXPECT_THAT(causes(diagram, 2, 3), ElementsAre("opaque odd: it may touch what it does not declare"));
  EXPECT_EQ(diagram.nodes[1].note, "opaque");
}

TEST(Diagram, MarksWhatOthersImply) {
  // p is changed by three nodes in turn; all rely on the arm, too, which only tells of starts.
  const auto flat = read(R"j({"name": "a", "pia": true, "effects": ["+p()", "+q()"]},
    {"name": "b", "pia": true, "preconditions": ["p()"], "effects": ["-p()"]},
    {"name": "c", "pia": true, "preconditions": ["q()", "!p()"], "effects": ["-q()"]},
    {"name": "d", "pia": false, "preconditions": ["q()"], "effects": [], "data_flows": [["a", "x", "d", "x"]]})j");
  const Diagram diagram = diagram_of(flat.network);
  ASSERT_EQ(diagram.nodes[2].before.size(), 2U);
  EXPECT_TRUE(diagram.nodes[2].before[0].implied) << "a before b before c";
  EXPECT_FALSE(diagram.nodes[2].before[1].implied);
  EXPECT_EQ(diagram.counts().implied, 1U);
  EXPECT_THAT(to_text(diagram), HasSubstr("after 0 a: world q(): made true there"));
  EXPECT_THAT(to_text(diagram), HasSubstr("[implied]\n"));
  EXPECT_THAT(to_dot(diagram), Not(HasSubstr("0 -> 2")));
  EXPECT_THAT(to_dot(diagram), HasSubstr("without 1 dependencies that others imply"));
}

TEST(Diagram, ARunAheadIsNotImpliedByWhatOnlyHoldsResultsBack) {
  // `see` must find reality as `a` leaves it; that `b` comes first only holds its result back.
  TaskNetwork network;
  NodeSpec a;
  a.name = "a";
  a.effects = {{*network.facts.intern("p()"), true}};
  NodeSpec b;
  b.name = "b";
  b.kind = ActionClass::Pure;
  b.branches = true;
  b.inputs = {{NodeId{0}, network.names.intern("x"), network.names.intern("x")}};
  NodeSpec see;
  see.name = "see";
  see.kind = ActionClass::Sensing;
  see.preconditions = {{*network.facts.intern("p()"), true}};
  see.conditions = {{NodeId{1}, kSuccess}};
  network.append(a);
  network.append(b);
  network.append(see);
  const Diagram diagram = diagram_of(network);
  ASSERT_EQ(diagram.nodes[2].before.size(), 2U);
  EXPECT_FALSE(diagram.nodes[2].before[0].implied);
}

TEST(Diagram, ConditionsAreImpliedByConditionsOnly) {
  const auto flat = read(R"j({"name": "a", "pia": false},
    {"name": "b", "pia": false, "condition_deps": ["a"]},
    {"name": "c", "pia": true, "effects": ["+p()"], "condition_deps": ["a", "b"]},
    {"name": "d", "pia": true, "effects": ["+q()"], "condition_deps": ["a"], "data_flows": [["b", "x", "d", "x"]]})j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_TRUE(diagram.nodes[2].before[0].implied);
  EXPECT_FALSE(diagram.nodes[3].before[0].implied) << "data does not take a node off the path";
}

/// For each node, the nodes that must have passed before, by dependencies that are not left out.
std::vector<std::vector<bool>> reachable(const Diagram& diagram, bool all) {
  std::vector<std::vector<bool>> before(diagram.nodes.size(), std::vector<bool>(diagram.nodes.size()));
  for (std::size_t to = 0; to < diagram.nodes.size(); ++to) {
    for (const Diagram::Dependency& dependency : diagram.nodes[to].before) {
      if (dependency.implied && !all) continue;
      before[to][dependency.from] = true;
      for (std::size_t i = 0; i < dependency.from; ++i)
        before[to][i] = before[to][i] || before[dependency.from][i];
    }
  }
  return before;
}

TEST(Diagram, ShowsTheOrderThatTheEngineUsesAndLeavesNothingOutThatMatters) {
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    const RandomNetwork random(seed, {true, true});
    for (const OrderRule rule : {OrderRule::Epoch, OrderRule::Goal}) {
      std::vector<Dependency> further;
      const Order plain = derive_order(random.network, rule);
      const Order order = derive_order(random.network, rule, &further);
      ASSERT_EQ(plain.dependency_count(), order.dependency_count()) << "telling more changed the order";
      const Diagram diagram = draw::diagram_of(random.network, order, further);
      for (std::uint32_t i = 0; i < order.size(); ++i) {
        std::vector<std::uint32_t> kept;
        for (const Dependency& dependency : order.before(NodeId{i}))
          kept.push_back(index(dependency.from));
        std::ranges::sort(kept);
        kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
        std::vector<std::uint32_t> shown;
        for (const Diagram::Dependency& dependency : diagram.nodes[i].before)
          shown.push_back(dependency.from);
        ASSERT_EQ(kept, shown) << "seed " << seed << " node " << i;
      }
      ASSERT_EQ(reachable(diagram, true), reachable(diagram, false)) << "seed " << seed;
    }
  }
}

TEST(Diagram, LinesThatWouldBeTooLongAreCut) {
  TaskNetwork network;
  NodeSpec spec;
  spec.effects.resize(1);
  const std::uint32_t port = network.names.intern("value");
  for (std::uint32_t i = 0; i < 20; ++i) {
    spec.name = "step " + std::to_string(i);
    spec.effects[0] = {*network.facts.intern("p()"), i % 2 == 0};
    spec.inputs.clear();
    if (i == 19) spec.inputs.push_back({NodeId{0}, port, port});
    network.append(spec);
  }
  EXPECT_THAT(to_svg(diagram_of(network)),
              AllOf(HasSubstr(">0: value</tspan>"), HasSubstr("dot: from the node with that number")));
}

TEST(Diagram, LongNamesAreCutInFront) {
  TaskNetwork network;
  NodeSpec spec;
  spec.name = "serve/at the table/fetch/grasp the cup";
  network.append(spec);
  EXPECT_THAT(to_svg(diagram_of(network)), HasSubstr(">0 \u2026fetch/grasp the cup</text>"));
}

TEST(Diagram, HostileNamesStayText) {
  const std::string name = R"(a\"b</text><script>\n\\N&)";
  const auto flat = read(R"j({"name": ")j" + name + R"j(", "pia": true, "effects": ["+p()"]})j");
  const Diagram diagram = diagram_of(flat.network);
  EXPECT_THAT(to_svg(diagram), AllOf(Not(HasSubstr("<script>")), HasSubstr("&lt;script&gt;")));
  EXPECT_THAT(to_dot(diagram), HasSubstr(R"(label="a\"b</text><script>\n\\N&")"));
  const auto value = type::parse_json(type::to_json(to_value(diagram)));
  ASSERT_TRUE(value);
  EXPECT_EQ(value->find("nodes")->as_list()[0].find("name")->as_string(), "a\"b</text><script>\n\\N&");
}

TEST(Diagram, AnEmptyNetworkIsAPictureToo) {
  const Diagram diagram = diagram_of(TaskNetwork());
  EXPECT_THAT(diagram.nodes, IsEmpty());
  EXPECT_THAT(to_svg(diagram), HasSubstr("</svg>"));
  EXPECT_THAT(to_dot(diagram), HasSubstr("digraph"));
  EXPECT_THAT(to_text(diagram), HasSubstr("0 nodes; 0 dependencies"));
}

TEST(Diagram, LargePlansAreCutInPicturesAndSaySo) {
  TaskNetwork network;
  NodeSpec spec;
  spec.name = "step";
  spec.effects = {{*network.facts.intern("p()"), true}};
  for (int i = 0; i < 20'000; ++i) {
    spec.iteration = static_cast<std::uint32_t>(i);
    spec.effects[0].value = i % 2 == 0;
    network.append(spec);
  }
  const Diagram diagram = diagram_of(network);
  EXPECT_EQ(diagram.counts().dependencies, 19'999U);
  EXPECT_THAT(to_svg(diagram), HasSubstr("the first 1000 of 20000 nodes"));
  EXPECT_THAT(to_dot(diagram), HasSubstr("the first 1000 of 20000 nodes"));
}

TEST(Diagram, OfALongPlanIsAboutAsWideAsAPage) {
  for (const int nodes : {26, 200}) {
    TaskNetwork network;
    NodeSpec spec;
    spec.name = "step";
    spec.effects = {{*network.facts.intern("p()"), true}};
    for (int i = 0; i < nodes; ++i) {
      spec.effects[0].value = i % 2 == 0;
      network.append(spec);
    }
    double width = 0;
    double height = 0;
    const std::string drawing = to_svg(diagram_of(network));
    ASSERT_EQ(
        std::sscanf(drawing.c_str(), "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%lf\" height=\"%lf\"",
                    &width, &height),
        2);
    EXPECT_GT(width / height, 0.9) << nodes;
    EXPECT_LT(width / height, 2.2) << nodes;
  }
}

TEST(Layout, PutsBoxesBehindThoseThatTheyComeAfterAndApart) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    std::mt19937_64 random(seed);
    const std::uint32_t boxes = 2 + static_cast<std::uint32_t>(random() % 40);
    std::vector<LayoutLine> lines;
    for (std::uint32_t to = 1; to < boxes; ++to) {
      for (std::uint64_t k = random() % 4; k > 0; --k)
        lines.push_back({static_cast<std::uint32_t>(random() % to), to});
    }
    const std::uint32_t per_row = seed % 2 == 0 ? kOneRow : 1 + static_cast<std::uint32_t>(random() % 5);
    const Layout layout = lay_out(boxes, lines, 30, 10, per_row);
    EXPECT_LE(layout.columns(), per_row);
    for (const LayoutLine& line : lines) {
      EXPECT_LT(layout.layer[line.from], layout.layer[line.to]);
      EXPECT_GE(line.arrives, layout.top[line.to]);
      EXPECT_LE(line.arrives, layout.top[line.to] + layout.height[line.to]);
      const bool same_row = layout.layer[line.from] / per_row == layout.layer[line.to] / per_row;
      EXPECT_TRUE(same_row || line.cut);
      if (!line.cut) {
        EXPECT_EQ(line.via.size(), layout.layer[line.to] - layout.layer[line.from] - 1);
      }
    }
    for (std::uint32_t a = 0; a < boxes; ++a) {
      EXPECT_GE(layout.top[a], 0);
      for (std::uint32_t b = 0; b < a; ++b) {
        const bool apart = layout.column(a) != layout.column(b) ||
                           layout.top[a] + layout.height[a] <= layout.top[b] + 0.001 ||
                           layout.top[b] + layout.height[b] <= layout.top[a] + 0.001;
        EXPECT_TRUE(apart) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace segue::draw
