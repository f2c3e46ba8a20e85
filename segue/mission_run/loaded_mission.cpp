// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/likelihood.hpp>
#include <segue/base/text.hpp>
#include <segue/convert/ahead_of_failures.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/draw/gantt.hpp>
#include <segue/draw/plan_diagram.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_run/implementation.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/type/json.hpp>

#include <string_view>
#include <utility>
#include <variant>

namespace segue::mission_run {

namespace {

/// JSON with nodes at its top; also what is meant as such and cannot be parsed.
bool is_task_network(const std::filesystem::path& file) {
  const auto text = read_input_file(file);
  if (!text) return false;
  const auto first = text->find_first_not_of(" \t\r\n");
  if (first == std::string::npos || (*text)[first] != '{') return false;
  const auto value = type::parse_json(*text);
  return !value || value->find("nodes") != nullptr;
}

std::optional<mission::Mission> load_mission(const std::filesystem::path& file,
                                             const std::vector<std::string>& libraries,
                                             Diagnostics& diagnostics) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(file, ignored))
    return mission::load_mission(file, {libraries.begin(), libraries.end()}, diagnostics);
  const std::size_t errors_before = diagnostics.error_count();
  auto machine = mission::import_rafcon(file, mission::rafcon_library_paths(libraries), diagnostics);
  if (machine) diagnostics.append(mission::validate(machine->mission));
  if (!machine || diagnostics.error_count() > errors_before) return std::nullopt;
  return std::move(machine->mission);
}

}  // namespace

FinishedRun::FinishedRun() = default;
FinishedRun::~FinishedRun() = default;

const draw::Gantt& FinishedRun::gantt() {
  if (!gantt_) gantt_ = std::make_unique<const draw::Gantt>(make_gantt());
  return *gantt_;
}

Result<LoadedMission> LoadedMission::load(const std::filesystem::path& file, const LoadOptions& options) {
  Diagnostics diagnostics;
  LoadedMission loaded;
  if (is_task_network(file)) {
    auto network = task_network::load_flat_network(file, diagnostics);
    if (!network) return diagnostics.to_error();
    loaded = create(std::move(*network));
  } else {
    auto mission = load_mission(file, options.libraries, diagnostics);
    if (!mission) return diagnostics.to_error();
    auto created = create(std::move(*mission), options.conflicts);
    if (!created) {
      diagnostics.error("invalid-mission", created.error().message, created.error().where);
      return diagnostics.to_error();
    }
    loaded = std::move(*created);
  }
  loaded.warnings_ = std::move(diagnostics);
  return loaded;
}

Result<LoadedMission> LoadedMission::create(mission::Mission mission,
                                            const mission::ControllerConflicts* conflicts) {
  auto program = mission::Program::compile(std::move(mission), conflicts);
  if (!program) return program.error();
  LoadedMission loaded;
  loaded.program_ = std::move(*program);
  return loaded;
}

LoadedMission LoadedMission::create(task_network::FlatNetwork network) {
  LoadedMission loaded;
  loaded.network_ = std::make_shared<const task_network::FlatNetwork>(std::move(network));
  return loaded;
}

const std::string& LoadedMission::name() const {
  return is_network() ? network_->network.name : program_->mission().name;
}

namespace {

constexpr std::string_view kNoGoal =
    "an order by the goal is for task networks: it needs the goal and all nodes before the run, but a "
    "mission has no goal and becomes a network while it runs";

/// Of the mode: what only missions have.
bool is_of_missions(const Sequential& how) {
  return how.start_at || how.stepping;
}
bool is_of_missions(const Concurrent& how) {
  return how.control != nullptr;
}

/// The problem of a request that the plan could not heed.
Result<void> check_kind(const RunRequest& request, bool is_network) {
  const bool of_missions = !request.inputs.empty() || !request.facts.empty() || !request.world_data.empty() ||
                           request.journal.has_value() ||
                           std::visit([](const auto& how) { return is_of_missions(how); }, request.mode);
  if (is_network && of_missions)
    return fail(ErrorCode::Unsupported,
                "inputs, facts, a state to start at, a journal, pauses and steps are for missions, not for "
                "task networks");
  if (!is_network && request.order != task_network::OrderRule::Epoch)
    return fail(ErrorCode::Unsupported, std::string(kNoGoal));
  return {};
}

/// Numbers that are left out where they shall not count.
Result<void> check_numbers(const RunRequest& request) {
  if (request.seed == 0U)
    return fail(ErrorCode::InvalidArgument,
                "a seed of 0 varies nothing; without a seed, durations are as expected");
  const auto* const concurrent = std::get_if<Concurrent>(&request.mode);
  if (concurrent == nullptr) return {};
  if (concurrent->workers == 0U || concurrent->world_copies == 0U || concurrent->ahead == 0U)
    return fail(
        ErrorCode::InvalidArgument,
        "a run needs a worker and a copy of the world, and one action at least may run ahead; without "
        "a number there are as many as it can use");
  if (!is_likelihood(concurrent->least_likelihood))
    return fail(ErrorCode::InvalidArgument, "a likelihood is between 0 and 1");
  return {};
}

}  // namespace

Result<draw::Diagram> LoadedMission::convert(const ConvertRequest& request) const {
  if (!is_network() && request.order != task_network::OrderRule::Epoch)
    return fail(ErrorCode::Unsupported, std::string(kNoGoal));
  if (!is_network()) return detail::diagram_of(program_, request);
  if (!request.inputs.empty() || !request.facts.empty())
    return fail(ErrorCode::Unsupported, "inputs and facts are for missions, not for task networks");
  std::vector<task_network::Dependency> further;
  const task_network::Order order = task_network::derive_order(network_->network, request.order, &further);
  draw::Diagram diagram = draw::diagram_of(network_->network, order, further, request.most);
  diagram.strict = request.strict;
  return diagram;
}

Result<convert::AheadOfFailures> LoadedMission::ahead_of_failures(const ConvertRequest& request) const {
  if (request.strict) return convert::AheadOfFailures{};
  if (is_network()) {
    const task_network::TaskNetwork& network = network_->network;
    const task_network::Order order = task_network::derive_order(network, request.order);
    const task_network::WholeNetwork paths(network);
    return convert::AheadOfFailures{
        task_network::by_name(network, task_network::acts_ahead(network, order, paths)),
        task_network::by_name(network, task_network::senses_ahead(network, order, paths)), true};
  }
  auto inputs = detail::inputs_by_port(*program_, request.inputs);
  if (!inputs) return inputs.error();
  const auto facts = detail::parse_facts(request.facts, program_->mission());
  if (!facts) return facts.error();
  return convert::ahead_of_failures(program_, std::move(*inputs), *facts);
}

Result<std::unique_ptr<FinishedRun>> LoadedMission::run(const RunRequest& request,
                                                        const std::stop_token& stop) const {
  if (auto fits = check_kind(request, is_network()); !fits) return fits.error();
  if (auto fits = check_numbers(request); !fits) return fits.error();
  if (is_network()) return detail::run_network(network_, request, stop);
  if (const auto* sequential = std::get_if<Sequential>(&request.mode))
    return detail::run_as_written(program_, request, *sequential, stop);
  return detail::run_concurrently(program_, request, std::get<Concurrent>(request.mode), stop);
}

namespace detail {

Result<std::vector<type::Value>> inputs_by_port(const mission::Program& program,
                                                const type::ValueMap& given) {
  std::vector<type::Value> inputs(program.node(0).input_ports->size());
  for (const auto& [name, value] : given) {
    const auto input = program.input_for(name, value);
    if (!input) return input.error();
    inputs[*input] = value;
  }
  return inputs;
}

Result<std::vector<mission::Fact>> parse_facts(const std::vector<std::string>& texts,
                                               const mission::Mission& mission) {
  std::vector<mission::Fact> facts;
  for (const std::string& text : texts) {
    auto fact = mission::parse_initial_fact(text);
    if (!fact) return fact.error();
    if (const auto problem = mission.vocabulary.problem(fact->predicate, fact->arguments))
      return fail(ErrorCode::InvalidArgument, "the fact " + quote(text) + ' ' + *problem);
    facts.push_back(std::move(*fact));
  }
  return facts;
}

mission::Runners runners_for(const RunRequest& request) {
  mission::Runners runners = request.runners;
  if (request.scripts) {
    mission::ScriptOptions scripts;
    scripts.python = request.scripts->python;
    scripts.robot = request.scripts->robot;
    runners.set_scripts(std::make_shared<mission::ScriptRunner>(std::move(scripts)));
  }
  if (request.simulate) runners.simulate_all();
  return runners;
}

Result<draw::Diagram> diagram_of(const SharedProgram& program, const ConvertRequest& request) {
  auto inputs = inputs_by_port(*program, request.inputs);
  if (!inputs) return inputs.error();
  const auto facts = parse_facts(request.facts, program->mission());
  if (!facts) return facts.error();
  auto plan = convert::MissionPlan::create(program, std::move(*inputs), *facts);
  if (!plan) return plan.error();
  mission::Runners runners;
  runners.simulate_all();
  const auto failure =
      convert::plan_ahead(**plan, request.horizon, request.assume_expected ? &runners : nullptr);
  if (!failure) return failure.error();
  if (*failure && request.note) request.note("as expected, the mission fails: " + (*failure)->message);
  draw::Diagram diagram = draw::diagram_of(**plan);
  diagram.strict = request.strict;
  return diagram;
}

}  // namespace detail

}  // namespace segue::mission_run
