// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include <segue/base/text.hpp>

#include <map>
#include <utility>

namespace segue::cli {

CLI::App* add_verb(CLI::App& parent, Context& context, const std::string& name,
                   const std::string& description, const std::string& examples, std::function<int()> run) {
  static const std::map<std::string, Format> formats = {{"text", Format::Text}, {"json", Format::Json}};
  CLI::App* verb = parent.add_subcommand(name, description);
  verb->footer("Example:\n" + examples);
  if (!run) return verb;
  verb->add_option("--format", context.format, "text (default) or json")
      ->type_name("FORMAT")
      ->transform(CLI::CheckedTransformer(formats, CLI::ignore_case).description(""));
  verb->callback([&context, run = std::move(run)] { context.action = run; });
  return verb;
}

void add_robot_option(CLI::App& verb, Context& context) {
  verb.add_option("--robot", context.robot, "the running robot's name; needed where more than one runs")
      ->type_name("NAME");
}

CLI::Option* add_order_option(CLI::App& verb, std::string& order) {
  return verb.add_option("--order", order, "seamless (prepare, commit, retire) or paper (by kind of action)")
      ->type_name("ORDER")
      ->check(CLI::IsMember({"seamless", "paper"}).description(""));
}

CLI::Option* add_duration(CLI::App& verb, const std::string& name, Duration& target,
                          const std::string& help) {
  const auto parse = [&target, name](const std::string& text) {
    const auto duration = parse_duration(text);
    if (!duration) throw CLI::ValidationError(name, duration.error().message);
    if (*duration < Duration(0)) throw CLI::ValidationError(name, "a duration cannot be negative");
    target = *duration;
  };
  return verb.add_option_function<std::string>(name, parse, help)->type_name("DURATION");
}

}  // namespace segue::cli
