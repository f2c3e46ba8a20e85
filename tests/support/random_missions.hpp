// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// Random mission files, for tests only.
namespace segue::convert {

/// A mission file generated from a seed: branches, loops, hierarchies within hierarchies, barriers and
/// preemptive containers, libraries, aborts, preemptions and their handlers, data flows and variables, facts,
/// values of the world, and all operations on resources. Loops go on after aborts too, also of states that
/// cannot begin; watches read the world beside the work. Callbacks: `mix`; `shared`, which may use what the
/// action declares to touch, or anything if it declares nothing; `remember`, of pure and sensing actions,
/// which uses the global variable that an input names; and `later`, which another thread ends. One mission in
/// four has scripts with persistent variables, which a resumed run would not have.
class RandomMission {
 public:
  explicit RandomMission(std::uint64_t seed) : random_(seed), keeps_(seed % 4 == 1) {}

  std::string text() {
    const std::string root = hierarchy(0, "", {});
    const std::string world = chance(50) ? "world: [f0, f3, f4, g(1), g(4)]\n" : "";
    return "mission: random\n" + world + world_data() +
           "resources:\n  r1: {commutes: true}\n  pool: {count: 2}\n  stock: {class: task, count: 100000}\n" +
           "  cup: {class: world, count: 2}\n  tool: {count: 2}\n" + "actions:\n" + actions_ +
           (libraries_.empty() ? "" : "libraries:\n" + libraries_) +
           "inputs: {in: {type: int, default: 7}}\n" + root;
  }

 private:
  /// The position of a state. States in concurrent branches have facts of their own, since changing a fact of
  /// another branch is a race that the two runs may decide differently. Other facts they only make true, or
  /// only take away.
  struct Where {
    std::string fact;
    bool guarded =
        false;  ///< a container around it may lack what it needs, so that no state in it begins any more
    bool is_watched = false;       ///< all states beside it change nothing, so it may read the world
    bool changes_nothing = false;  ///< since a state beside it reads the world
    bool races = false;            ///< it may be preempted at any time
    [[nodiscard]] bool is_concurrent() const { return !fact.empty(); }
    [[nodiscard]] Where guarded_if(bool declares) const {
      Where inner = *this;
      inner.guarded = guarded || declares;
      return inner;
    }
    /// In a branch of its own.
    [[nodiscard]] Where branch(std::string own) const {
      return {std::move(own), guarded, false, changes_nothing, races};
    }
  };
  struct Child {
    std::string text;  ///< without its id and transitions
    std::string in = "in";
    std::string out = "out";
    std::string on;
  };

  std::uint64_t under(std::uint64_t limit) { return random_() % limit; }
  bool chance(int percent) { return under(100) < static_cast<std::uint64_t>(percent); }

  /// What concurrent branches take away from one another: a fact that none of them makes true.
  std::string contested_fact() {
    const std::uint64_t fact = 3 + under(2);
    return chance(50) ? fmt::format("    effects: [-f{}]\n", fact)
                      : fmt::format("    preconditions: [f{}]\n    effects: [+{}]\n", fact, shared_fact());
  }

  /// One that no container relies on.
  std::string shared_fact() { return fmt::format("f{}", 1 + under(2)); }

  std::string facts(const Where& where) {
    if (where.changes_nothing) return fmt::format("    preconditions: [\"!{}\"]\n", where.fact);
    if (where.is_concurrent() && chance(8)) return contested_fact();
    if (where.is_concurrent() && chance(25)) return fmt::format("    effects: [+{}]\n", shared_fact());
    const auto fact = [&] {
      if (where.is_concurrent()) return where.fact;
      return chance(40) ? std::string("g({x})") : fmt::format("f{}", under(3));
    };
    std::string text = fmt::format("    effects: [\"{}{}\"]\n", chance(60) ? "+" : "-", fact());
    if (chance(20)) text += fmt::format("    preconditions: [\"{}{}\"]\n", chance(50) ? "!" : "", fact());
    return text;
  }

  /// A value of the world. Concurrent branches have one each, for the reason for which they have facts.
  std::string value_of_world(const Where& where) {
    std::string name = where.is_concurrent() ? "v_" + where.fact : fmt::format("v{}", under(2));
    values_.insert(name);
    return name;
  }

  /// Adds effects on a value of the world to those of an action.
  void change_value(std::string& text, const Where& where) {
    static constexpr std::string_view kChanges[] = {R"({}: "{{x}}")", R"({}.a: "{{y}}")",
                                                    R"({0}.b: "{{x}}", {0}.b.c: [1, "{{y}}"])", "{}: null"};
    const std::string change = fmt::format(fmt::runtime(kChanges[under(4)]), value_of_world(where));
    const std::string begin = "    effects: [";
    const std::size_t list = text.find(begin);
    if (list == std::string::npos)
      text += begin + "{" + change + "}]\n";
    else
      text.insert(list + begin.size(), "{" + change + "}, ");
  }

  std::string world_data() {
    std::string text;
    for (const std::string& name : values_)
      text += fmt::format("  {}: {{initial: {}}}\n", name, name == "v0" ? "4" : "{a: 2}");
    return text.empty() ? "" : "world_data:\n" + text;
  }

  std::string resources(bool pure) {
    std::vector<std::string> uses;
    if (chance(35)) uses.push_back(fmt::format("{{block: r{}}}", under(2)));
    if (chance(15)) uses.push_back(fmt::format("{{block: pool, count: {}}}", 1 + under(2)));
    static constexpr std::string_view kOperations[] = {"create", "consume", "delete", "exists", "block"};
    if (!pure && chance(15))
      uses.push_back(fmt::format("{{{}: stock, count: {}}}", kOperations[under(5)], 1 + under(3)));
    if (!pure && chance(20))
      uses.push_back(fmt::format("{{{}: cup, count: {}}}", kOperations[under(5)], 1 + under(2)));
    static constexpr std::string_view kTool[] = {"block: tool, keep: true", "release: tool", "block: tool",
                                                 "exists: tool (kept)"};
    if (!pure && chance(15)) uses.push_back(fmt::format("{{{}}}", kTool[under(4)]));
    if (!pure && chance(4)) uses.push_back("{consume: \"thing_{x}\"}");
    if (pure && chance(5)) uses.push_back(chance(50) ? "{exists: stock}" : "{exists: cup, count: 2}");
    return uses.empty() ? "" : fmt::format("    resources: [{}]\n", fmt::join(uses, ", "));
  }

  /// Loop conditions are simulated, so that loops end.
  std::string runs(bool back, bool shared, bool remembers, bool keeps) {
    if (back) {
      const std::string first = chance(30) ? "no, no" : chance(30) ? "no, ok, no" : "no";
      return fmt::format("{{simulated: {{duration: {}s, outcomes: [{}, ok], outputs: {{y: {}}}}}}}", under(4),
                         first, under(9));
    }
    if (keeps) return R"({python: {text: "self.persistent_variables"}})";
    if (remembers) return "{callback: remember}";
    return chance(10) ? "{callback: later}" : shared ? "{callback: shared}" : "{callback: mix}";
  }

  std::string_view foreseen(bool two) {
    if (chance(8)) return chance(50) ? "aborted" : "preempted";
    return two && chance(40) ? "no" : "ok";
  }

  std::string action(bool back, bool two, const Where& where) {
    const std::string name = fmt::format("a{}", count_++);
    std::string text = fmt::format("  {}:\n    inputs: {{x: {{type: int, default: {}}}", name, under(9));
    const bool pure = chance(45);
    const bool sensing = !pure && chance(10);
    // Changing a variable of another branch would be a race.
    const bool remembers = (pure || sensing) && !back && chance(40);
    if (remembers) {
      text += fmt::format(", variable: {{type: text, default: {}}}",
                          where.is_concurrent() ? where.fact : fmt::format("p{}", under(2)));
    }
    text += chance(30) ? ", error: {type: text, default: none}}\n" : "}\n";
    text += "    outputs: {y: {type: int, default: 0}}\n";
    text += two ? "    outcomes: [ok, no]\n" : "    outcomes: [ok]\n";
    if (pure) text += "    pure: true\n";
    if (sensing) text += "    sensing: true\n";
    // The world beside branches that change it would be a race.
    if ((!where.is_concurrent() && chance(pure ? 20 : 3)) || (where.is_watched && pure && chance(50)))
      text += "    reads_world: true\n";
    else if (chance(25))
      text += fmt::format("    reads_world: [{}]\n", value_of_world(where));
    if (chance(6)) text += "    strict: true\n";
    const bool opaque = !pure && chance(where.is_concurrent() ? 3 : 15);
    std::string touched;
    if (!opaque && (!pure || chance(60))) touched = facts(where);
    if (!opaque && !pure && !sensing && !where.changes_nothing && chance(30)) change_value(touched, where);
    text += touched;
    if (!opaque) text += resources(pure || remembers);  // what creates or removes units is irreversible
    if (chance(60))
      text += fmt::format("    expect: {{duration: {}s, outcome: {}{}}}\n", under(12), foreseen(two),
                          chance(30) ? fmt::format(", likelihood: {{ok: 0.{}}}", under(10)) : "");
    const bool keeps = keeps_ && !where.races && count_ % 3 == 0;
    text += fmt::format("    run: {}\n",
                        runs(back, !pure && !sensing && !where.is_concurrent(), remembers, keeps));
    actions_ += text;
    return name;
  }

  /// A state after the i-th, or the end of the container.
  std::string target(std::size_t i, std::size_t size) {
    if (i < size) return fmt::format("s{}", i);
    return chance(70) ? "return done" : "return other";
  }

  Child child(std::size_t i, std::size_t size, int depth, const std::string& indent, const Where& where) {
    const std::uint64_t kind = depth < 2 ? under(100) : 100;
    Child result;
    if (kind >= 24 && chance(6)) return aborting(i, size, indent, where);
    if (kind < 24) {
      const std::string declared = kind < 18 ? declarations(indent, where) : "";
      const Where inner = where.guarded_if(!declared.empty());
      result.text = kind < 10   ? declared + hierarchy(depth + 1, indent, inner)
                    : kind < 18 ? declared + barrier(depth + 1, indent, inner)
                    : kind < 21 ? preemptive(depth + 1, indent, where)
                                : library(depth + 1, indent, where);
      result.on = fmt::format("done: {}, other: {}", target(i + 1, size), target(i + 1 + under(2), size));
    } else {
      const bool back = chance(25);
      const bool two = back || chance(40);
      result.text = fmt::format("{}action: {}\n", indent, action(back, two, where));
      result.in = "x";
      result.out = "y";
      result.on = "ok: " + target(i + 1, size);
      if (back)
        result.on += fmt::format(", no: s{}", under(i + 1));
      else if (two)
        result.on += ", no: " + target(i + 1 + under(3), size);
    }
    if (chance(6)) result.text += indent + "strict: true\n";
    if (kind < 24 && chance(4)) result.text += indent + "routine: true\n";
    if (chance(25)) result.on += ", aborted: " + target(i + 1 + under(2), size);
    if (chance(2)) result.on += ", preempted: " + target(i + 1 + under(2), size);
    return result;
  }

  /// A state that never begins, or one that aborts some times until it ends its loop. The latter only where
  /// it begins: else its loop would be endless.
  Child aborting(std::size_t i, std::size_t size, const std::string& indent, const Where& where) {
    const std::string name = fmt::format("a{}", count_++);
    const bool never = where.guarded || chance(50);
    actions_ += fmt::format("  {}:\n    inputs: {{x: {{type: int, default: {}}}}}\n", name, under(9));
    actions_ += "    outputs: {y: {type: int, default: 0}}\n    outcomes: [ok]\n";
    if (never) actions_ += "    preconditions: [never]\n";
    if (chance(40)) actions_ += "    pure: true\n";
    if (!where.changes_nothing)
      actions_ += fmt::format("    effects: [+{}]\n", shared_fact());
    else if (!never)
      actions_ += facts(where);
    actions_ += fmt::format("    run: {{simulated: {{duration: {}s, outcomes: [{}ok]}}}}\n", under(3),
                            never        ? ""
                            : chance(50) ? "aborted, "
                                         : "aborted, aborted, ");
    const std::string after = never ? target(i + 1, size) : fmt::format("s{}", under(i + 1));
    return {fmt::format("{}action: {}\n", indent, name), "x", "y",
            fmt::format("ok: {}, aborted: {}", target(i + 1, size), after)};
  }

  /// A state of a preemptive container that looks at the world when the container begins.
  std::string watch() {
    const std::string name = fmt::format("a{}", count_++);
    actions_ += fmt::format("  {}:\n    inputs: {{x: {{type: int, default: {}}}}}\n", name, under(9));
    actions_ += "    outputs: {y: {type: int, default: 0}}\n    outcomes: [ok]\n    reads_world: true\n";
    actions_ += fmt::format("    {}: true\n    run: {{callback: mix}}\n", chance(50) ? "pure" : "sensing");
    return name;
  }

  /// What a container needs. Its actions use the same resources.
  std::string declarations(const std::string& indent, const Where& where) {
    std::string text;
    if (chance(8)) {
      const std::string fact = where.is_concurrent() ? where.fact : chance(30) ? "g({in})" : "f0";
      text += fmt::format("{}preconditions: [\"{}{}\"]\n", indent, chance(60) ? "!" : "", fact);
    }
    std::vector<std::string> uses;
    if (chance(20)) uses.push_back(fmt::format("{{block: r{}}}", under(2)));
    if (chance(12)) uses.push_back(fmt::format("{{block: pool, count: {}}}", 1 + under(2)));
    if (chance(4)) uses.push_back("{block: \"thing_{in}\"}");
    if (chance(4)) uses.push_back(chance(50) ? "{block: tool}" : "{exists: cup}");
    if (!uses.empty()) text += fmt::format("{}resources: [{}]\n", indent, fmt::join(uses, ", "));
    return text;
  }

  std::string hierarchy(int depth, const std::string& indent, const Where& where) {
    const std::size_t size = 2 + under(4);
    std::vector<Child> children;
    std::string states;
    for (std::size_t i = 0; i < size; ++i) {
      children.push_back(child(i, size, depth, indent + "    ", where));
      states +=
          fmt::format("{0}  s{1}:\n{2}{0}    on: {{{3}}}\n", indent, i, children[i].text, children[i].on);
    }
    std::string text = ports(depth > 0, indent) + indent + "variables: {v: {type: int, default: 5}}\n";
    text += indent + "outcomes: [done, other]\n" + indent + "start: s0\n" + indent + "flows:\n";
    for (std::size_t i = 0; i < size; ++i)
      text += flows(children, i, indent);
    return text + indent + "states:\n" + states;
  }

  std::string ports(bool with_input, const std::string& indent) {
    const std::string input = with_input ? indent + "inputs: {in: {type: int, default: 3}}\n" : "";
    return input + indent +
           (chance(70) ? "outputs: {out: {type: int, default: 1}}\n" : "outputs: {out: int}\n");
  }

  std::string flows(const std::vector<Child>& children, std::size_t i, const std::string& indent) {
    std::string text;
    const auto line = [&](const std::string& from, const std::string& to) {
      text += fmt::format("{}  - {} -> {}\n", indent, from, to);
    };
    const std::string in = fmt::format("s{}.{}", i, children[i].in);
    const std::string out = fmt::format("s{}.{}", i, children[i].out);
    if (chance(40)) line(out, "variables.v");
    if (chance(40)) line("variables.v", in);
    if (chance(30)) line("inputs.in", in);
    if (i > 0 && chance(50)) {
      const std::size_t from = under(i);
      line(fmt::format("s{}.{}", from, children[from].out), in);
    }
    if (i == 0 || chance(30)) line(out, "outputs.out");
    return text;
  }

  std::string barrier(int depth, const std::string& indent, const Where& around) {
    const std::size_t size = 2 + under(2);
    const std::string inner = indent + "    ";
    std::vector<bool> leaves;
    std::string states;
    std::string lines;
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint64_t kind = depth < 2 ? under(100) : 100;
      const bool leaf = kind >= 30;
      Where where = around.branch(fmt::format("b{}", count_++));
      const std::string declared = leaf ? "" : declarations(inner, where);
      where = where.guarded_if(!declared.empty());
      leaves.push_back(leaf);
      states += fmt::format("{}  s{}:\n", indent, i);
      states += leaf        ? fmt::format("{}action: {}\n", inner, action(false, chance(40), where))
                : kind < 20 ? declared + hierarchy(depth + 1, inner, where)
                            : declared + barrier(depth + 1, inner, where);
      if (chance(60)) lines += fmt::format("{}  - inputs.in -> s{}.{}\n", indent, i, leaf ? "x" : "in");
      if (chance(60)) lines += fmt::format("{}  - s{}.{} -> outputs.out\n", indent, i, leaf ? "y" : "out");
    }
    const std::string decider = fmt::format("d{}", count_++);
    const std::size_t asked = under(size);
    const std::string_view end = chance(30) ? "aborted" : leaves[asked] ? "ok" : "done";
    actions_ += fmt::format(
        "  {}:\n    outcomes: [ok, no]\n    run: {{decide: [{{when: {{s{}: {}}}, outcome: ok}}, "
        "{{outcome: no}}]}}\n",
        decider, asked, end);
    states += fmt::format(
        "{0}  decider:\n{0}    kind: decider\n{0}    action: {1}\n"
        "{0}    on: {{ok: return done, no: return other}}\n",
        indent, decider);
    return indent + "kind: barrier\n" + ports(true, indent) + indent + "outcomes: [done, other]\n" +
           (lines.empty() ? "" : indent + "flows:\n" + lines) + indent + "states:\n" + states;
  }

  std::string preemptive(int depth, const std::string& indent, const Where& around) {
    const std::string inner = indent + "    ";
    std::string states;
    std::string lines;
    const std::size_t size = 2 + under(2);
    const std::size_t reader = !around.is_concurrent() && chance(40) ? under(size) : size;
    for (std::size_t i = 0; i < size; ++i) {
      const std::uint64_t kind = depth < 2 ? under(100) : 100;
      const bool leaf = kind >= (i == reader ? 80 : 35);
      Where where = around.branch(fmt::format("b{}", count_++));
      where.is_watched = i == reader;
      where.races = true;
      where.changes_nothing = where.changes_nothing || (reader < size && i != reader);
      const std::string declared = kind < 25 && chance(10) ? declarations(inner, where) : "";
      where = where.guarded_if(!declared.empty());
      const bool watches = leaf && !around.is_concurrent() && chance(15);
      const std::string_view end = chance(70) ? "done" : "other";
      states += fmt::format("{}  s{}:\n", indent, i);
      states += leaf ? fmt::format("{}action: {}\n", inner, watches ? watch() : action(false, false, where))
                : kind < (i == reader ? 70 : 25) ? declared + hierarchy(depth + 1, inner, where)
                                                 : preemptive(depth + 1, inner, where);
      states += leaf ? fmt::format("{}on: {{ok: return {}", inner, end)
                     : fmt::format("{}on: {{done: return {}, other: return other", inner, end);
      states += chance(20) ? ", aborted: return other}\n" : "}\n";
      if (chance(60)) lines += fmt::format("{}  - inputs.in -> s{}.{}\n", indent, i, leaf ? "x" : "in");
      if (chance(leaf ? 60 : 5))
        lines += fmt::format("{}  - s{}.{} -> outputs.out\n", indent, i, leaf ? "y" : "out");
    }
    return indent + "kind: preemptive\n" + ports(true, indent) + indent + "outcomes: [done, other]\n" +
           (lines.empty() ? "" : indent + "flows:\n" + lines) + indent + "states:\n" + states;
  }

  std::string library(int depth, const std::string& indent, const Where& where) {
    const std::string text = hierarchy(depth, "    ", where);
    const std::string name = fmt::format("l{}", count_++);
    libraries_ += fmt::format("  {}:\n{}", name, text);
    return fmt::format("{}library: {}\n", indent, name) +
           (chance(30) ? fmt::format("{}inputs: {{in: {}}}\n", indent, under(9)) : "") +
           (chance(50) ? fmt::format("{}outputs: {{out: {}}}\n", indent, under(9)) : "");
  }

  std::mt19937_64 random_;
  const bool keeps_;
  std::string actions_;
  std::string libraries_;
  std::set<std::string> values_;  ///< of the world
  int count_ = 0;
};

}  // namespace segue::convert
