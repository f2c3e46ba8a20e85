// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>

#include "../connection.hpp"
#include "chain_times.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct ChainVerbOptions {
  std::string from;
  std::string to;
  std::string controller;  ///< empty: what runs
};

Value chain_value(const std::optional<StepTimes>& times, type::ValueMap map) {
  const auto microseconds = [&](double StepTimes::*part) {
    return times ? Value((*times).*part * 1e6) : Value();
  };
  map.set("mean_us", microseconds(&StepTimes::mean));
  map.set("p99_us", microseconds(&StepTimes::p99));
  map.set("worst_us", microseconds(&StepTimes::worst));
  return map;
}

Value chain_value(const ChainTimes& chain) {
  Value::List steps;
  for (const ChainStep& step : chain.steps) {
    type::ValueMap map;
    map.append("step", step.name);
    map.append("like", step.like.empty() ? Value() : Value(step.like));
    steps.push_back(chain_value(step.times, std::move(map)));
  }
  Value::List unmeasured;
  for (const std::string& name : chain.unmeasured())
    unmeasured.emplace_back(name);
  type::ValueMap map;
  map.append("steps", std::move(steps));
  map.append("unmeasured", std::move(unmeasured));
  return chain_value(chain.total(), std::move(map));
}

void add_row(Table& table, const std::string& name, const std::optional<StepTimes>& times,
             const std::string& remark) {
  const auto text = [&](double StepTimes::*part) {
    return times ? format_seconds((*times).*part) : std::string("-");
  };
  table.add({name, text(&StepTimes::mean), text(&StepTimes::p99), text(&StepTimes::worst), remark});
}

std::string text_of(const ChainTimes& chain) {
  constexpr auto kRight = Table::Align::Right;
  Table table({{"STEP"}, {"MEAN", kRight}, {"99 % WITHIN", kRight}, {"WORST", kRight}, {""}});
  for (const ChainStep& step : chain.steps)
    add_row(table, step.name, step.times,
            !step.times         ? "never measured"
            : step.like.empty() ? ""
                                : "as " + step.like);
  const auto missing = chain.unmeasured();
  add_row(table, "whole chain", chain.total(), missing.empty() ? "" : "without what was never measured");
  return table.text();
}

int show_chains(const std::vector<ChainTimes>& chains, const ChainVerbOptions& options,
                const Context& context) {
  const bool is_prediction = !options.controller.empty();
  if (context.json()) {
    Value::List list;
    for (const ChainTimes& chain : chains)
      list.push_back(chain_value(chain));
    print_json(Value::map({{"from", options.from},
                           {"to", options.to},
                           {"controller", is_prediction ? Value(options.controller) : Value()},
                           {"chains", std::move(list)}}));
    return kDone;
  }
  for (const ChainTimes& chain : chains) {
    if (&chain != &chains.front()) print_line("");
    print_line(fmt::format("{} -> {}, {}", options.from, options.to,
                           is_prediction ? "expected of " + options.controller : "observed"));
    print(text_of(chain));
  }
  return kDone;
}

int show_chain(control::RobotService& robot, const ChainVerbOptions& options, const Context& context) {
  const auto status = robot.status();
  if (!status) return failed(context, status.error());
  ChainNetwork network(*status);
  if (!options.controller.empty()) {
    const auto transition = robot.diff(options.controller, {}, deadline_in(std::chrono::seconds(10)));
    if (!transition) return failed(context, transition.error());
    network.apply(*transition);
  }
  const auto from = network.find(options.from);
  if (!from) return failed(context, from.error());
  const auto to = network.find(options.to);
  if (!to) return failed(context, to.error());
  const auto found = network.chains(*from, *to);
  if (!found) return failed(context, found.error());
  MeasuredTimes measured(*status, [&](const std::string& id) {
    return robot.task(id).value_or(Value());  // it may have been removed since
  });
  std::vector<ChainTimes> chains;
  for (const auto& chain : *found) {
    chains.push_back(options.controller.empty() ? measured.observed(chain)
                                                : measured.expected(chain, network));
  }
  return show_chains(chains, options, context);
}

}  // namespace

void add_chain(Verb& app, Context& context) {
  const auto options = std::make_shared<ChainVerbOptions>();
  Verb& verb = add_verb(
      app, context, "chain", "how long samples take through a chain of tasks",
      "  segue chain scanner drive                        # from its write to the end of drive's update\n"
      "  segue chain scanner.scan drive.command           # only ways that begin and end at these ports\n"
      "  segue chain scanner drive --controller explore   # before a switch to explore",
      [options, &context] {
        return with_robot(context,
                          [&](control::RobotService& robot) { return show_chain(robot, *options, context); });
      });
  verb.option("FROM", options->from, "the task, or output port, that writes the samples").required();
  verb.option("TO", options->to, "the task, or input port, where the chain ends; FROM's task: its loops")
      .required();
  verb.option("--controller NAME", options->controller,
              "predict it for this controller, from what is measured of what runs now");
  add_robot_option(verb, context);
}

}  // namespace segue::cli
