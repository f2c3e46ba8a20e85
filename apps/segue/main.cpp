// SPDX-License-Identifier: Apache-2.0
#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>
#include <segue/base/time_slice.hpp>

#include <algorithm>
#include <csignal>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "command.hpp"

namespace {

using segue::cli::Context;
using segue::cli::Verb;

void add_verbs(Verb& app, Context& context) {
  using namespace segue::cli;
  for (const auto add :
       {add_init,      add_check,  add_diff,    add_predict,      add_run,    add_plan,      add_apply,
        add_switch,    add_repair, add_restart, add_cancel,       add_stop,   add_status,    add_top,
        add_task,      add_chain,  add_graph,   add_hz,           add_bw,     add_delay,     add_read,
        add_plot,      add_set,    add_write,   add_ros2,         add_import, add_call,      add_events,
        add_history,   add_log,    add_prepare, add_reset_belief, add_units,  add_doctor,    add_host,
        add_component, add_types,  add_mission, add_studio,       add_bench,  add_completion}) {
    add(app, context);
  }
}

/// The deepest verb that the words name.
const Verb& verb_of(const Verb& app, const std::vector<std::string>& words) {
  const Verb* verb = &app;
  for (const std::string& word : words) {
    const Verb* next = verb->find(word);
    if (next == nullptr) break;
    verb = next;
  }
  return *verb;
}

/// The message for a word that is neither a verb nor an option; empty where the words are not at fault.
std::string explain_word(const Verb& verb, const std::vector<std::string>& words) {
  std::vector<std::string> options = verb.option_names();
  std::erase_if(options, [](const std::string& name) { return !name.starts_with("--"); });
  for (const std::string& word : words) {
    if (!word.starts_with("--")) continue;
    const std::string name = word.substr(0, word.find('='));
    if (std::ranges::find(options, name) != options.end()) continue;
    return "there is no option " + segue::quote(name) + segue::did_you_mean(name, options);
  }
  std::vector<std::string> verbs;
  for (const Verb* inner : verb.verbs())
    verbs.push_back(inner->name());
  if (verbs.empty() || verb.takes_arguments()) return {};
  for (const std::string& word : words) {
    if (word.empty() || word[0] == '-' || verb.find(word) != nullptr || word == verb.name()) continue;
    return "there is no verb " + segue::quote(word) + segue::did_you_mean(word, verbs);
  }
  return "a verb is missing: " + segue::listed(verbs);
}

int usage_error(const Verb& app, const segue::Error& error, const std::vector<std::string>& words) {
  const Verb& verb = verb_of(app, words);
  std::string message = explain_word(verb, words);
  if (message.empty()) message = error.message;
  const std::string name = verb.full_name();
  std::cerr << name << ": " << segue::printable(message) << "\n`" << name << " --help` shows its usage.\n";
  return segue::cli::kUsage;
}

/// `segue help VERB` is `segue VERB --help`.
std::vector<char*> words_of(int count, char** arguments) {
  static char help[] = "--help";
  std::vector<char*> words(arguments, arguments + count);
  if (count < 2 || words[1] != std::string_view("help")) return words;
  words.erase(words.begin() + 1);
  words.push_back(help);
  return words;
}

int run(std::vector<char*> arguments) {
  Verb app("segue",
           "Segue runs robots that must do many different things: controllers are networks of components,\n"
           "and it switches between any two of them without a stop.");
  app.version("segue " SEGUE_VERSION);
  app.require_verb();
  app.footer(
      "`segue help VERB` explains a verb with an example. Start with: segue init my_robot\n"
      "Exit status: 0 done; 1 failed or refused; 2 wrong usage; 3 cannot connect to the runtime; 4 changes\n"
      "(`plan --exit-code`); 5 the robot is in trouble (`status --exit-code`).");
  Context context;
  add_verbs(app, context);
  const auto parsed = app.parse(static_cast<int>(arguments.size()), arguments.data());
  if (!parsed) return usage_error(app, parsed.error(), {arguments.begin() + 1, arguments.end()});
  if (!*parsed) return segue::cli::kDone;
  return context.action ? context.action() : static_cast<int>(segue::cli::kUsage);
}

}  // namespace

int main(int count, char** arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  segue::ask_for_short_time_slices();
  try {
    return run(words_of(count, arguments));
  } catch (const std::exception& exception) {
    std::cerr << "segue: error: " << segue::printable(exception.what()) << " (this is a defect of segue)\n";
    return segue::cli::kFailed;
  }
}
