// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <csignal>
#include <exception>
#include <string>
#include <vector>

#include "command.hpp"
#include "output.hpp"

namespace {

using segue::cli::Context;

void add_verbs(CLI::App& app, Context& context) {
  using namespace segue::cli;
  for (const auto add : {add_init,      add_check,   add_diff,  add_apply,     add_run,          add_switch,
                         add_status,    add_top,     add_task,  add_read,      add_set,          add_call,
                         add_events,    add_history, add_log,   add_prepare,   add_reset_belief, add_host,
                         add_component, add_mission, add_bench, add_completion}) {
    add(app, context);
  }
}

std::vector<std::string> verbs_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!verb->get_group().empty()) names.push_back(verb->get_name());
  }
  return names;
}

const CLI::App* find_verb(const CLI::App& app, const std::string& name) {
  const auto found = app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

/// The deepest verb that the words name.
const CLI::App* verb_of(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* verb = &app;
  for (const std::string& word : words) {
    const CLI::App* next = find_verb(*verb, word);
    if (next == nullptr) break;
    verb = next;
  }
  return verb;
}

std::string full_name(const CLI::App* verb) {
  return verb->get_parent() == nullptr ? verb->get_name()
                                       : full_name(verb->get_parent()) + ' ' + verb->get_name();
}

/// What is wrong with a word that should be a verb or an option; empty where it is neither's fault.
std::string explain_word(const CLI::App* verb, const std::vector<std::string>& words) {
  std::vector<std::string> options;
  for (const CLI::Option* option : verb->get_options()) {
    for (const std::string& name : option->get_lnames())
      options.push_back("--" + name);
  }
  for (const std::string& word : words) {
    if (word.rfind("--", 0) != 0) continue;
    const std::string name = word.substr(0, word.find('='));
    if (std::find(options.begin(), options.end(), name) != options.end()) continue;
    return fmt::format("there is no option {}{}", segue::quote(name), segue::did_you_mean(name, options));
  }
  const auto verbs = verbs_of(*verb);
  if (verbs.empty()) return {};
  for (const std::string& word : words) {
    if (word.empty() || word[0] == '-' || find_verb(*verb, word) != nullptr) continue;
    if (word == verb->get_name()) continue;
    return fmt::format("there is no verb {}{}", segue::quote(word), segue::did_you_mean(word, verbs));
  }
  return fmt::format("a verb is missing: {}", segue::listed(verbs));
}

int usage_error(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  const CLI::App* verb = verb_of(app, words);
  std::string message = explain_word(verb, words);
  if (message.empty()) message = error.what();
  const std::string name = full_name(verb);
  fmt::print(stderr, "{}: {}\n`{} --help` tells how it is used.\n", name, message, name);
  return segue::cli::kUsage;
}

int run(int count, char** arguments) {
  CLI::App app(
      "Segue runs robots that must do many different things: controllers are networks of components,\n"
      "and it switches between any two of them without a stop.",
      "segue");
  app.set_version_flag("--version", "segue " SEGUE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "`segue VERB --help` explains a verb with an example. Start with: segue init my_robot\n"
      "Exit status: 0 done; 1 failed or refused; 2 wrong usage; 3 no runtime reached.");
  app.get_formatter()->column_width(34);
  Context context;
  add_verbs(app, context);
  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);
    return usage_error(app, error, std::vector<std::string>(arguments + 1, arguments + count));
  }
  return context.action ? context.action() : static_cast<int>(segue::cli::kUsage);
}

}  // namespace

int main(int count, char** arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  try {
    return run(count, arguments);
  } catch (const std::exception& exception) {
    fmt::print(stderr, "segue: error: {} (this is a defect of segue)\n", exception.what());
    return segue::cli::kFailed;
  }
}
