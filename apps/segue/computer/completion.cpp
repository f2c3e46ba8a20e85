// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/ros2/interface_library.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "../connection.hpp"
#include "../ros2/ros2_system.hpp"

namespace segue::cli {

namespace {

/// Verbs whose first argument names a part of the running robot, or a node, a topic or an interface of ROS 2,
/// and its kind for `complete-names`.
constexpr std::array<std::pair<std::string_view, std::string_view>, 19> kVerbsWithNames = {
    {{"switch", "controllers"},
     {"plan", "controllers"},
     {"prepare", "controllers"},
     {"task", "tasks"},
     {"chain", "tasks"},
     {"hz", "ports"},
     {"bw", "ports"},
     {"delay", "ports"},
     {"restart", "tasks"},
     {"read", "ports"},
     {"plot", "ports"},
     {"set", "properties"},
     {"call", "operations"},
     {"units", "units"},
     {"ros2 describe", "ros2-nodes"},
     {"ros2 topics", "ros2-topics"},
     {"ros2 interfaces", "ros2-packages"},
     {"ros2 interface", "ros2-interfaces"},
     {"ros2 headers", "ros2-interfaces"}}};

/// The option whose value is a name of the running robot, too, and its kind.
constexpr std::string_view kOptionWithName = "--transition";
constexpr std::string_view kKindOfOption = "transitions";

std::string option_words(const Verb& verb) {
  return fmt::format("{}", fmt::join(verb.option_names(), " "));
}

std::string verb_words(const Verb& verb) {
  std::string words;
  for (const Verb* inner : verb.verbs())
    words += (words.empty() ? "" : " ") + inner->name();
  return words;
}

/// The kind of names that the verb's first argument has ("ros2 describe": that of a verb in another one);
/// empty: none.
std::string_view kind_of_names(std::string_view verb) {
  for (const auto& [name, kind] : kVerbsWithNames) {
    if (name == verb) return kind;
  }
  return {};
}

std::string single_quoted(std::string text) {
  text = text.substr(0, text.find('\n'));
  std::string result;
  for (const char c : text)
    result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return '\'' + result + '\'';
}

/// A line for each verb of the `case` that bash and zsh share.
std::string cases_of(const Verb& app, std::string_view words = "words") {
  std::string cases;
  for (const Verb* verb : app.verbs())
    cases += fmt::format("    {}) {}=\"{}\" kind=\"{}\" options=\"{}\" ;;\n", verb->name(), words,
                         verb_words(*verb), kind_of_names(verb->name()), option_words(*verb));
  return cases;
}

/// The same for verbs in other ones, which are two words.
std::string inner_cases_of(const Verb& app, std::string_view words = "words") {
  std::string cases;
  for (const Verb* outer : app.verbs()) {
    for (const Verb* verb : outer->verbs()) {
      const std::string name = outer->name() + " " + verb->name();
      cases += fmt::format("      \"{}\") kind=\"{}\" {}=\"\" options=\"{}\" ;;\n", name, kind_of_names(name),
                           words, option_words(*verb));
    }
  }
  return cases;
}

/// Names come first; options only after a "-".
std::string bash_script(const Verb& app) {
  return fmt::format(R"(# bash completion for segue; load it with: source <(segue completion bash)
_segue() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} words="" kind="" options=""
  if [ "$COMP_CWORD" -eq 1 ]; then
    words="{}" options="{}"
  else
    case "${{COMP_WORDS[1]}}" in
{}    esac
  fi
  if [ "$COMP_CWORD" -gt 2 ]; then
    case "${{COMP_WORDS[1]}} ${{COMP_WORDS[2]}}" in
{}    esac
  fi
  [ "${{COMP_WORDS[COMP_CWORD-1]}}" = {} ] && words="" kind={}
  if [[ "$current" == -* ]]; then
    words=$options
  elif [ -n "$kind" ]; then
    kind=$(segue complete-names "$kind" 2>/dev/null)
    words="$words $kind"
  fi
  COMPREPLY=( $(compgen -W "$words" -- "$current") )
}}
complete -o default -F _segue segue
)",
                     verb_words(app), option_words(app), cases_of(app), inner_cases_of(app), kOptionWithName,
                     kKindOfOption);
}

std::string zsh_script(const Verb& app) {
  std::string verbs;
  for (const Verb* verb : app.verbs())
    verbs += "    " + single_quoted(verb->name() + ':' + verb->description()) + '\n';
  return fmt::format(R"(#compdef segue
# zsh completion for segue; load it with: source <(segue completion zsh)
_segue() {{
  local -a verbs
  local words_of_verb="" kind="" options=""
  verbs=(
{}  )
  if (( CURRENT == 2 )); then
    _describe 'verb' verbs
    return
  fi
  case "$words[2]" in
{}  esac
  if (( CURRENT > 3 )); then
    case "$words[2] $words[3]" in
{}    esac
  fi
  [[ "$words[CURRENT-1]" == {} ]] && words_of_verb="" kind={}
  if [[ "$PREFIX" == -* ]]; then
    compadd -- ${{=options}}
    return
  fi
  [[ -n "$kind" ]] && words_of_verb+=" "$(segue complete-names $kind 2>/dev/null)
  compadd -- ${{=words_of_verb}} || _files
}}
compdef _segue segue
)",
                     verbs, cases_of(app, "words_of_verb"), inner_cases_of(app, "words_of_verb"),
                     kOptionWithName, kKindOfOption);
}

/// The lines of a verb, whose names and options follow it.
std::string fish_lines(const Verb& verb, const std::string& name, const std::string& condition) {
  const std::string here = fmt::format("complete -c segue -n '{}'", condition);
  std::string script;
  if (!verb.verbs().empty()) script += fmt::format("{} -f -a '{}'\n", here, verb_words(verb));
  if (const auto kind = kind_of_names(name); !kind.empty())
    script += fmt::format("{} -f -a '(segue complete-names {} 2>/dev/null)'\n", here, kind);
  for (const std::string& option : verb.option_names()) {
    const bool is_long = option.starts_with("--");
    const std::string names =
        option == kOptionWithName
            ? fmt::format(" -x -a '(segue complete-names {} 2>/dev/null)'", kKindOfOption)
            : std::string();
    script += fmt::format("{} -{} {}{}\n", here, is_long ? "l" : "s", option.substr(is_long ? 2 : 1), names);
  }
  return script;
}

std::string fish_script(const Verb& app) {
  std::string script =
      "# fish completion for segue; load it with: segue completion fish | source\n"
      "complete -c segue -n __fish_use_subcommand -f\n";
  for (const Verb* verb : app.verbs()) {
    script += fmt::format("complete -c segue -n __fish_use_subcommand -f -a {} -d {}\n", verb->name(),
                          single_quoted(verb->description()));
    const std::string here = "__fish_seen_subcommand_from " + verb->name();
    script += fish_lines(*verb, verb->name(), here);
    for (const Verb* inner : verb->verbs())
      script += fish_lines(*inner, verb->name() + " " + inner->name(),
                           here + "; and __fish_seen_subcommand_from " + inner->name());
  }
  return script;
}

void add_members(const type::Value& task, const std::string& id, const std::string& kind,
                 std::vector<std::string>& names) {
  if (kind == "properties") {
    const type::Value* properties = task.find(kind);
    if (properties == nullptr || !properties->is_map()) return;
    for (const auto& [name, value] : properties->as_map())
      names.push_back(fmt::format("{}.{}=", id, name));
    return;
  }
  for (const type::Value& member : list_at(task, kind)) {
    if (kind == "ports" && printable_at(member, "direction") != "output") continue;
    names.push_back(id + '.' + printable_at(member, "name"));
  }
}

std::vector<std::string> unit_names(control::RobotService& robot) {
  std::vector<std::string> names;
  const auto units = robot.units();
  for (const type::Value& one : units && units->is_list() ? units->as_list() : type::Value::List())
    names.push_back(printable_at(one, "name"));
  return names;
}

/// Names of ROS 2, for which no robot is needed.
std::vector<std::string> ros2_names(std::string_view kind) {
  if (kind == "ros2-nodes") return running_ros2_names("nodes", "name");
  if (kind == "ros2-topics") return running_ros2_names("topics", "topic");
  return kind == "ros2-packages" ? ros2::standard_packages() : ros2::InterfaceLibrary().names();
}

/// For shells: one name per line, and no output at all if there is no robot.
int complete_names(const std::string& kind) {
  if (kind.starts_with("ros2-")) {
    for (const std::string& name : ros2_names(kind))
      print_line(name);
    return kDone;
  }
  const auto running = control::running_robots();
  if (running.size() != 1) return kDone;
  const auto robot = connect_to(running.front(), std::chrono::seconds(3));
  const auto status = robot ? (*robot)->status() : Result<type::Value>(robot.error());
  if (!status) return kDone;
  const bool is_listed = kind == "controllers" || kind == "transitions" || kind == "units";
  std::vector<std::string> names = kind == "units" ? unit_names(**robot)
                                   : is_listed     ? names_at(*status, kind)
                                                   : task_names(*status);
  if (!is_listed && kind != "tasks") {
    const auto tasks = std::exchange(names, {});
    for (const std::string& id : tasks) {
      if (const auto task = (*robot)->task(id)) add_members(*task, id, kind, names);
    }
  }
  for (const std::string& name : names)
    print_line(name);
  return kDone;
}

}  // namespace

void add_completion(Verb& app, Context& context) {
  const auto shell = std::make_shared<std::string>();
  Verb& verb = add_verb(
      app, context, "completion", "print a completion script for a shell",
      "  source <(segue completion bash)\n  segue completion zsh > ~/.zfunc/_segue\n"
      "  segue completion fish > ~/.config/fish/completions/segue.fish",
      [&app, &context, shell] {
        const auto script = *shell == "bash" ? bash_script : *shell == "zsh" ? zsh_script : fish_script;
        return write_or_print(context, "", script(app));
      });
  verb.option("SHELL", *shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});

  const auto kind = std::make_shared<std::string>();
  Verb& names = app.add_verb("complete-names", "for shells").hide();
  names.option("kind", *kind, "").required();
  names.on_given([&context, kind] { context.action = [kind] { return complete_names(*kind); }; });
}

}  // namespace segue::cli
