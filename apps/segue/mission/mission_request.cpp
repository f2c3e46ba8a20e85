// SPDX-License-Identifier: Apache-2.0
#include "mission_request.hpp"

#include <segue/base/likelihood.hpp>
#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <utility>

namespace segue::cli {

namespace {

using mission_run::RunRequest;

/// "NAME=COUNT"
Result<std::pair<std::string, std::uint32_t>> parse_count(const std::string& text) {
  const auto equals = std::min(text.rfind('='), text.size());
  std::uint32_t count = 0;
  const char* first = text.data() + std::min(equals + 1, text.size());
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), count);
  if (error != std::errc() || end != text.data() + text.size())
    return fail(ErrorCode::InvalidArgument, quote(text) + " is not NAME=COUNT");
  return std::pair(text.substr(0, equals), count);
}

/// Of two for one resource the last.
Result<std::map<std::string, std::uint32_t>> parse_counts(const std::vector<std::string>& texts) {
  std::map<std::string, std::uint32_t> counts;
  for (const std::string& text : texts) {
    auto count = parse_count(text);
    if (!count) return count.error();
    counts.insert_or_assign(std::move(count->first), count->second);
  }
  return counts;
}

std::optional<mission_run::Journal> journal_of(const MissionOptions& options) {
  if (options.journal.empty()) return std::nullopt;
  mission_run::Journal journal{options.journal};
  using mission::UnderWay;
  if (options.resume) {
    journal.resume = options.under_way == "again"   ? UnderWay::Again
                     : options.under_way == "skip"  ? UnderWay::Skip
                     : options.under_way == "abort" ? UnderWay::Abort
                                                    : UnderWay::GoOn;
  }
  return journal;
}

Result<void> parse_likelihood(const std::string& text, double& likelihood) {
  const auto value = type::parse_yaml(text);
  if (!value || !value->is_number() || !is_likelihood(value->as_double()))
    return fail(ErrorCode::InvalidArgument, "expected a number between 0 and 1, got " + quote(text));
  likelihood = value->as_double();
  return {};
}

bool is_debugged(const MissionOptions& options) {
  return !options.breakpoints.empty() || options.steps_back;
}

/// Options that a run of that kind does not have.
Result<void> check_mode(const MissionOptions& options, const NetworkOptions& network, bool is_network,
                        bool concurrent) {
  const auto refuse = [](const char* why) { return fail(ErrorCode::Unsupported, why); };
  if (is_network && (!options.start_at.empty() || is_debugged(options)))
    return refuse(
        "inputs, facts, a state to start at, a journal, pauses and steps are for missions, not for task "
        "networks");
  const bool bounds_speculation =
      network.world_copies != 0 || network.ahead != 0 || network.least_likelihood != 0;
  if (!concurrent && (network.strict || network.workers != 0 || bounds_speculation))
    return refuse(
        "strict, a number of workers, copies of the world and actions ahead, and a likelihood are for "
        "concurrent runs");
  if (concurrent && !options.start_at.empty())
    return refuse("a state to start at is for missions that run as they are written");
  if (concurrent && is_debugged(options))
    return refuse("breakpoints and steps back are for missions that run as they are written");
  return {};
}

/// Of the command, where 0 stands for none.
template <class Number>
std::optional<Number> unless_zero(Number number) {
  return number == 0 ? std::nullopt : std::optional(number);
}

mission_run::RunMode mode_of(const MissionOptions& options, const NetworkOptions& network, bool is_network,
                             bool concurrent, mission_run::RunControl& steering) {
  if (concurrent) {
    return mission_run::Concurrent{.strict = network.strict,
                                   .workers = unless_zero(network.workers),
                                   .world_copies = unless_zero(network.world_copies),
                                   .ahead = unless_zero(network.ahead),
                                   .least_likelihood = network.least_likelihood,
                                   .control = is_network ? nullptr : &steering};
  }
  mission_run::Sequential sequential;
  if (!options.start_at.empty()) sequential.start_at = options.start_at;
  if (!is_network) {
    sequential.stepping = mission_run::Stepping{
        .control = steering, .breakpoints = options.breakpoints, .steps_back = options.steps_back};
  }
  return sequential;
}

}  // namespace

Result<RunRequest> run_request(const MissionOptions& options, const NetworkOptions& network, bool is_network,
                               mission_run::RunControl& steering) {
  const bool concurrent = options.mode.empty() ? is_network : options.mode == "concurrent";
  auto inputs = parse_inputs(options.inputs);
  if (!inputs) return inputs.error();
  auto counts = parse_counts(network.resources);
  if (!counts) return counts.error();
  if (auto fits = check_mode(options, network, is_network, concurrent); !fits) return fits.error();
  RunRequest request;
  request.mode = mode_of(options, network, is_network, concurrent, steering);
  if (options.clock == "virtual") request.clock = mission_run::RunClock::Virtual;
  request.inputs = std::move(*inputs);
  request.facts = options.facts;
  request.journal = journal_of(options);
  request.scripts = mission_run::Scripts{options.python};
  if (options.python.empty()) request.scripts.reset();
  request.simulate = options.simulate;
  request.seed = unless_zero(network.seed);
  request.resources = std::move(*counts);
  if (network.order == "goal") request.order = task_network::OrderRule::Goal;
  return request;
}

Result<type::ValueMap> parse_inputs(const std::vector<std::string>& texts) {
  type::ValueMap inputs;
  for (const std::string& text : texts) {
    const auto equals = text.find('=');
    if (equals == std::string::npos)
      return fail(ErrorCode::InvalidArgument, "--input must be NAME=VALUE, got '" + text + "'");
    auto value = type::parse_yaml(text.substr(equals + 1));
    if (!value) return value.error();
    inputs.erase(text.substr(0, equals));
    inputs.append(text.substr(0, equals), std::move(*value));
  }
  return inputs;
}

void add_network_options(Verb& verb, NetworkOptions& options) {
  verb.option("--order ORDER", options.order,
              "of a task network: epoch (default) keeps the whole final world, goal only its goal")
      .one_of({"epoch", "goal"});
  verb.option("--seed N", options.seed,
              "vary durations of simulated actions, reproducibly for each number; 0: as expected");
  verb.option("--workers N", options.workers, "nodes that run at the same time; 0: any number");
  verb.option("--world-copies N", options.world_copies, "projected worlds at the same time; 0: any number");
  verb.option("--ahead N", options.ahead,
              "actions that run ahead at the same time, the likeliest first; 0: any number");
  verb.option(
      "--likelihood P",
      [&options](const std::string& text) { return parse_likelihood(text, options.least_likelihood); },
      "only what is at least that likely to count, between 0 and 1, runs ahead (default 0)");
  verb.option("--resource NAME=COUNT", options.resources,
              "how many units of a resource exist, such as process:planner=2");
  verb.flag(
      "--strict", options.strict,
      "whatever remains waits until nothing before it can fail any more, as if all were declared strict");
}

void add_library_option(Verb& verb, MissionOptions& options) {
  verb.option("--libraries DIR", options.libraries,
              "folders with the state machines used by missions; for RAFCON machines NAME=DIR");
}

}  // namespace segue::cli
