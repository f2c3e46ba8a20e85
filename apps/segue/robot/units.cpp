// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <cstdint>
#include <memory>
#include <string>

#include "../connection.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct Stock {
  std::string name;
  std::uint32_t count = 0;
};

int show_units(control::RobotService& robot, const Context& context) {
  const auto units = robot.units();
  if (!units) return failed(context, units.error());
  if (context.json()) {
    print_json(Value::map({{"units", *units}}));
    return kDone;
  }
  Table table({{"UNITS"}, {"COUNT", Table::Align::Right}});
  const auto& list = units->is_list() ? units->as_list() : Value::List();
  for (const Value& one : list)
    table.add({printable_at(one, "name"), one_line(*one.find("count"))});
  list.empty() ? print_line("the robot keeps no units; its file declares them (`units: {screws: 40}`)")
               : print(table.text());
  return kDone;
}

int set_units(control::RobotService& robot, const Stock& stock, const Context& context) {
  const auto before = robot.set_units(stock.name, stock.count, sender("units set"));
  if (!before) return failed(context, before.error());
  if (context.json()) {
    print_json(Value::map({{"name", stock.name},
                           {"count", static_cast<std::uint64_t>(stock.count)},
                           {"before", static_cast<std::uint64_t>(*before)}}));
  } else {
    print_line(fmt::format("{}: {} (was {})", printable(stock.name), stock.count, *before));
  }
  return kDone;
}

}  // namespace

void add_units(Verb& app, Context& context) {
  Verb& units = add_verb(
      app, context, "units", "show or correct the units that the robot keeps",
      "  segue units\n  segue units set screws 40   # the feeder was filled", [&context] {
        return with_robot(context, [&](control::RobotService& robot) { return show_units(robot, context); });
      });
  add_robot_option(units, context);
  const auto stock = std::make_shared<Stock>();
  Verb& set = add_verb(
      units, context, "set", "say how many units there are, while no mission commands the robot",
      "  segue units set screws 40", [stock, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return set_units(robot, *stock, context); });
      });
  set.option("NAME", stock->name, "a name of `units` in the robot file").required();
  set.option("COUNT", stock->count, "how many there are").required();
  add_robot_option(set, context);
}

}  // namespace segue::cli
