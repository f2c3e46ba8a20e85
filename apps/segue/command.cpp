// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include <strings.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace segue::cli {

namespace {

Result<void> parse_format(const std::string& text, Format& format) {
  const bool json = strcasecmp(text.c_str(), "json") == 0;
  if (!json && strcasecmp(text.c_str(), "text") != 0)
    return fail(ErrorCode::InvalidArgument, text + " not in {text,json}");
  format = json ? Format::Json : Format::Text;
  return {};
}

constexpr std::array kLogLevels = {LogLevel::Debug, LogLevel::Info, LogLevel::Warning, LogLevel::Error};

std::vector<std::string> level_names() {
  std::vector<std::string> names;
  for (const LogLevel level : kLogLevels)
    names.emplace_back(to_string(level));
  return names;
}

}  // namespace

Verb& add_verb(Verb& parent, Context& context, const std::string& name, const std::string& description,
               const std::string& examples, std::function<int()> run) {
  Verb& verb = parent.add_verb(name, description);
  verb.footer("Example:\n" + examples);
  if (!run) return verb;
  verb.option(
      "--format FORMAT", [&context](const std::string& text) { return parse_format(text, context.format); },
      "text (default) or json");
  verb.on_given([&context, run = std::move(run)] { context.action = run; });
  return verb;
}

void add_robot_option(Verb& verb, Context& context) {
  verb.option("--robot NAME", context.robot, "the running robot's name; needed if more than one is running");
}

Option add_log_level_option(Verb& verb, LogLevel& level, const std::string& what) {
  const auto parse = [&level](const std::string& text) -> Result<void> {
    const auto found =
        std::ranges::find(kLogLevels, text, [](LogLevel each) { return std::string(to_string(each)); });
    if (found != kLogLevels.end()) level = *found;
    return {};
  };
  return verb
      .option("--log-level LEVEL", parse,
              "lowest level of " + what + ": debug, info (default), warning or error")
      .one_of(level_names());
}

Option add_order_option(Verb& verb, std::string& order) {
  return verb
      .option("--order ORDER", order, "seamless (prepare, commit, retire) or paper (by kind of action)")
      .one_of({"seamless", "paper"});
}

}  // namespace segue::cli
