// SPDX-License-Identifier: Apache-2.0
#include "rover_mission.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::testing {

namespace {

constexpr int kFacts = 4;

/// Where states are. A branch of a barrier has a fact and a value of its own, since changing those of another
/// branch is a race.
struct Scope {
  std::string branch{};  ///< empty: none
  std::string indent{};  ///< of what belongs to the container
};

/// The states before the one that is written, whose outputs it may take; empty: none.
struct Sources {
  std::string plan{};
  std::string thought{};
};

class RoverMissionText {
 public:
  explicit RoverMissionText(Random& random) : random_(random), is_guarded_(one_in(random, 2)) {}

  RoverMission write() {
    mission_.gets_low = is_guarded_ && one_in(random_, 3);
    for (int i = 0; i < kFacts; ++i) {
      if (one_in(random_, 2)) mission_.world.insert(fmt::format("f{}", i));
    }
    const Scope scope{"", is_guarded_ ? "        " : "    "};
    const std::string work = sequence(scope, 5 + up_to(random_, 5), mission_.gets_low);
    mission_.text = fmt::format("mission: random\nworld: [{}]\n", fmt::join(mission_.world, ", "));
    mission_.text += "outcomes: [done, low]\noutputs: {seen: any}\n";
    mission_.text += is_guarded_ ? guarded(work) : unguarded(work);
    add_last_actions();
    mission_.text += "world_data:\n";
    for (const std::string& value : values_)
      mission_.text += "  " + value + ": {initial: {x: 0.0, y: 0.0, way: 0.0}}\n";
    mission_.text += "resources: {arm: {}, base: {}, log: {}, stock: {class: task, count: 2}}\n";
    mission_.text += "actions:\n" + actions_;
    return std::move(mission_);
  }

 private:
  bool percent(int chance) { return up_to(random_, 99) < chance; }
  template <std::size_t Count>
  std::string any(const std::array<std::string_view, Count>& of) {
    return std::string(of.at(static_cast<std::size_t>(up_to(random_, static_cast<int>(Count) - 1))));
  }
  /// Metres, in steps of a half. Some places lie in obstacles, to which no route leads.
  std::string place() { return fmt::format("{:.1f}", 0.5 * (up_to(random_, 10) - 5)); }

  static std::string unguarded(const std::string& work) {
    return "start: work\nflows: [report.seen -> outputs.seen]\nstates:\n"
           "  report: {on: {success: return done}}\n"
           "  work:\n    on: {success: report}\n" +
           work;
  }

  std::string guarded(const std::string& work) {
    std::string first = "      watch: {on: {battery_low: return battery_low}}\n";
    std::string second = "      work:\n        on: {success: return done}\n" + work;
    if (one_in(random_, 2)) std::swap(first, second);
    return "start: guarded\nflows: [report.seen -> outputs.seen, report_low.seen -> outputs.seen]\nstates:\n"
           "  report: {on: {success: return done}}\n"
           "  rest: {on: {success: report_low}}\n"
           "  report_low: {action: report, on: {success: return low}}\n"
           "  guarded:\n"
           "    kind: preemptive\n    outcomes: [done, battery_low]\n"
           "    on: {done: report, battery_low: rest}\n    states:\n" +
           first + second;
  }

  void add_last_actions() {
    values_.insert("arm");
    add_action("judge", "run: {decide: [{outcome: success}]}", {});
    add_action("watch",
               "outcomes: [battery_low], expect: {duration: 1h}, run: {controller: guard, until: [{call: "
               "battery.is_low, is: true, outcome: battery_low}]}",
               {.is_irreversible = true, .controller = "guard"});
    add_action("rest", "run: {controller: hold, until: [{after: 2ms, outcome: success}]}",
               {.is_irreversible = true, .controller = "hold"});
    const Touches report{.is_irreversible = true, .sees = values_, .holds = {"log"}};
    add_action("report",
               fmt::format("outputs: {{seen: any}}, reads_world: [{}], resources: [{{block: log}}], run: "
                           "{{callback: see}}",
                           fmt::join(values_, ", ")),
               report);
    mission_.states.emplace("report_low", report);
  }

  void add_action(const std::string& name, const std::string& text, Touches touches) {
    actions_ += "  " + name + ": {" + text + "}\n";
    mission_.states.emplace(name, std::move(touches));
  }

  /// Start, flows and states of a container, which each lead to a later one. `drains`: before one of them the
  /// battery gets low.
  std::string sequence(const Scope& scope, int count, bool drains = false) {
    std::vector<std::string> names;
    for (int i = 0; i < count; ++i)
      names.push_back(fmt::format("s{}", number_++));
    const int drain = drains ? 1 + up_to(random_, count - 2) : count;
    if (drains) names.at(static_cast<std::size_t>(drain)) = "drain";
    names.emplace_back("return success");
    std::string states;
    std::vector<std::string> flows;
    Sources sources;
    for (int i = 0; i < count; ++i) {
      const auto later = [&] {
        const int next = std::min(i + (percent(20) ? 2 : 1), i < drain ? drain : count);
        return names.at(static_cast<std::size_t>(next));
      };
      const std::string& name = names.at(static_cast<std::size_t>(i));
      states += scope.indent + "  " + name + ":\n";
      states += i == drain ? drained(scope, later()) : step(scope, name, sources, flows, later);
    }
    return fmt::format("{0}start: {1}\n{0}flows: [{2}]\n{0}states:\n{3}", scope.indent, names.front(),
                       fmt::join(flows, ", "), states);
  }

  /// Begins when all that acts before it has ended, since it needs all of which each holds something. It ends
  /// only as it is preempted.
  std::string drained(const Scope& scope, const std::string& next) {
    add_action("drain", "resources: [{block: arm}, {block: base}, {block: log}], run: {callback: drain}",
               {.is_irreversible = true, .holds = {"arm", "base", "log"}});
    return scope.indent + "    on: {success: " + next + "}\n";
  }

  template <class Later>
  std::string step(const Scope& scope, const std::string& name, Sources& sources,
                   std::vector<std::string>& flows, const Later& later) {
    const int kind = up_to(random_, 99);
    std::string on;
    const std::string next = later();
    const auto other = [&] { return percent(15) ? later() : next; };
    if (kind < 12 && scope.branch.empty()) return barrier(scope, next);
    if (kind < 45) {
      plan(name, scope);
      sources.plan = name;
      on = "found: " + next + ", no_route: " + other();
    } else if (kind < 75) {
      move(name, scope);
      if (!sources.plan.empty()) flows.push_back(sources.plan + ".length -> " + name + ".length");
      on = "there: " + next + ", blocked: " + other() + ", aborted: " + other();
    } else if (kind < 87) {
      think(name, scope);
      if (!sources.thought.empty()) flows.push_back(sources.thought + ".n -> " + name + ".n");
      sources.thought = name;
      on = "ok: " + next + ", no: " + other();
    } else {
      note(name, scope);
      if (!sources.thought.empty()) flows.push_back(sources.thought + ".n -> " + name + ".n");
      on = "ok: " + next + ", aborted: " + other();
    }
    return scope.indent + "    on: {" + on + "}\n";
  }

  std::string value_in(const Scope& scope) {
    static constexpr std::array<std::string_view, 3> kValues = {"arm", "base", "box"};
    return *values_.insert(scope.branch.empty() ? any(kValues) : "v_" + scope.branch).first;
  }
  /// Mostly the one that was changed last, which may be predicted wrongly.
  std::string value_read_in(const Scope& scope) {
    return scope.branch.empty() && !changed_.empty() && percent(60) ? changed_ : value_in(scope);
  }
  std::string fact_in(const Scope& scope) {
    return scope.branch.empty() ? fmt::format("f{}", up_to(random_, kFacts - 1)) : "f_" + scope.branch;
  }

  /// From where a value says that something is, or will be.
  void plan(const std::string& name, const Scope& scope) {
    const std::string from = value_read_in(scope);
    const std::string pool = one_in(random_, 3) ? "scout" : "planner";
    const std::string more = one_in(random_, 2) ? "reads_world: [" + from + "], " : "";
    add_action(
        name,
        "inputs: {x: {type: float, default: " + place() + "}, y: {type: float, default: " + place() +
            "}}, outputs: {length: {type: float, default: 0.0}}, outcomes: [found, no_route], pure: true, " +
            more + "expect: {duration: 10ms, outcome: found}, run: {pool: " + pool +
            ", call: {plan: {from: {x: \"{world." + from + ".x}\", y: \"{world." + from +
            ".y}\"}, to: {x: \"{x}\", y: \"{y}\"}}}, outcome_from: outcome, outputs: {length: length}, "
            "timeout: 5min}",
        {.sees = {from}});
  }

  /// Moves arm or base by a controller, in a few milliseconds.
  void move(const std::string& name, const Scope& scope) {
    static constexpr std::array<std::string_view, 4> kOfArm = {"move_arm", "reach", "grasp", "teleop"};
    static constexpr std::array<std::string_view, 3> kOfBase = {"go_to", "explore", "teleop"};
    static constexpr std::array<std::string_view, 2> kSimple = {"drive", "look"};  // not beside `guard`
    const bool moves_arm = moved_arm_ = percent(moved_arm_ ? 25 : 75);
    Touches touches{.is_irreversible = true, .expected = "there"};
    touches.controller = !is_guarded_ && one_in(random_, 5) ? any(kSimple)
                         : moves_arm                        ? any(kOfArm)
                                                            : any(kOfBase);
    touches.holds = {moves_arm ? "arm" : "base"};
    const bool is_apart = scope.branch.empty() && percent(70);  // arm and base move at once
    const std::string part = moves_arm ? "arm" : "base";
    const std::string value = is_apart ? *values_.insert(part).first : value_in(scope);
    touches.changes = {value};
    if (scope.branch.empty()) changed_ = value;
    const std::string fact = is_apart ? "f_" + part : fact_in(scope);
    touches.makes[fact] = percent(60);
    if (percent(35))
      touches.relies_on[is_apart ? moves_arm ? "f_base" : "f_arm" : fact_in(scope)] = one_in(random_, 2);
    std::string needs;
    for (const auto& [needed, holds] : touches.relies_on)
      needs = std::string("preconditions: [\"") + (holds ? "" : "!") + needed + "\"], ";
    add_action(name,
               "inputs: {x: {type: float, default: " + place() + "}, y: {type: float, default: " + place() +
                   "}, length: {type: float, default: 0.0}}, outcomes: [there, blocked], " + needs +
                   "effects: [\"" + (touches.makes[fact] ? "+" : "-") + fact + "\", {" + value +
                   ".x: \"{x}\"}, {" + value + ".y: \"{y}\"}, {" + value +
                   ".way: \"{length}\"}], resources: [{block: " + *touches.holds.begin() +
                   "}], expect: {duration: 10ms, outcome: there}, run: {controller: " + touches.controller +
                   ", afterwards: " + (one_in(random_, 3) ? "stop" : "keep") + ", until: [{after: " +
                   std::to_string(1 + up_to(random_, 5)) + "ms, outcome: " + any(kEnds) + "}]}",
               touches);
  }
  static constexpr std::array<std::string_view, 5> kEnds = {"there", "there", "blocked", "blocked",
                                                            "aborted"};

  /// Decides by what it sees of the world.
  void think(const std::string& name, const Scope& scope) {
    const bool sees_all = scope.branch.empty() && one_in(random_, 2);
    add_action(
        name,
        "inputs: {n: {type: int, default: " + std::to_string(up_to(random_, 9)) +
            "}}, outputs: {n: {type: int, default: 0}}, outcomes: [ok, no], pure: true, reads_world: " +
            (sees_all ? std::string("true") : "[" + value_read_in(scope) + "]") +
            ", expect: {duration: 2ms, outcome: ok}, run: {callback: think}",
        {});
  }

  /// Makes a fact, of which an input may say which.
  void note(const std::string& name, const Scope& scope) {
    static constexpr std::array<std::string_view, 3> kUnits = {"", ", {consume: stock}", ", {create: stock}"};
    const bool is_apart = !scope.branch.empty();
    Touches touches{.is_irreversible = true, .expected = "ok", .holds = {"log"}};
    std::string effect = "noted({n})";
    if (is_apart || one_in(random_, 2)) {
      effect = fact_in(scope);
      touches.makes[effect] = true;
    }
    add_action(name,
               "inputs: {n: {type: int, default: 0}}, outcomes: [ok], effects: [\"+" + effect +
                   "\"], resources: [{block: log}" + (is_apart ? "" : any(kUnits)) +
                   "], run: {callback: note}",
               touches);
  }

  std::string barrier(const Scope& scope, const std::string& next) {
    std::string text = scope.indent + "    kind: barrier\n" + scope.indent + "    on: {success: " + next +
                       "}\n" + scope.indent + "    states:\n";
    for (int i = 1 + up_to(random_, 2); i >= 0; --i) {
      const Scope inner{fmt::format("b{}", number_++), scope.indent + "        "};
      text += scope.indent + "      " + inner.branch + ":\n" + sequence(inner, 1 + up_to(random_, 1));
    }
    return text + scope.indent + "      all: {kind: decider, action: judge, on: {success: return success}}\n";
  }

  Random& random_;
  const bool is_guarded_;
  RoverMission mission_;
  std::set<std::string> values_;
  std::string changed_;  ///< the value that a motion outside of barriers has changed last; empty: none
  std::string actions_;
  bool moved_arm_ = false;  ///< the last motion did
  int number_ = 0;
};

}  // namespace

RoverMission random_rover_mission(Random& random) {
  return RoverMissionText(random).write();
}

}  // namespace segue::testing
