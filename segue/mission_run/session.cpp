// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/draw/plan_diagram.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_run/implementation.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/rafcon/rafcon.hpp>
#include <segue/type/json.hpp>

#include <string_view>

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

const draw::Gantt& FinishedRun::gantt() {
  if (!gantt_) gantt_ = make_gantt();
  return *gantt_;
}

std::optional<Session> Session::load(const std::filesystem::path& file,
                                     const std::vector<std::string>& libraries, Diagnostics& diagnostics,
                                     const mission::ControllerConflicts* conflicts) {
  if (is_task_network(file)) {
    auto network = task_network::load_flat_network(file, diagnostics);
    if (!network) return std::nullopt;
    return create(std::move(*network));
  }
  auto mission = load_mission(file, libraries, diagnostics);
  if (!mission) return std::nullopt;
  auto session = create(std::move(*mission), conflicts);
  if (session) return std::move(*session);
  diagnostics.error("invalid-mission", session.error().message, session.error().where);
  return std::nullopt;
}

Result<Session> Session::create(mission::Mission mission, const mission::ControllerConflicts* conflicts) {
  auto program = mission::Program::compile(std::move(mission), conflicts);
  if (!program) return program.error();
  Session session;
  session.program_ = std::move(*program);
  return session;
}

Session Session::create(task_network::FlatNetwork network) {
  Session session;
  session.network_ = std::make_shared<const task_network::FlatNetwork>(std::move(network));
  return session;
}

const std::string& Session::name() const {
  return is_network() ? network_->network.name : program_->mission().name;
}

namespace {

constexpr std::string_view kNoGoal =
    "an order by the goal is for task networks: it needs the goal and all nodes before the run, but a "
    "mission "
    "has no goal and becomes a network while it runs";

bool is_debugged(const RunRequest& request) {
  return !request.breakpoints.empty() || request.steps_back;
}

/// What a request has and the plan could not heed, or "".
std::string problem_of(const RunRequest& request, bool is_network) {
  const bool of_missions = !request.inputs.empty() || !request.facts.empty() || !request.start_at.empty() ||
                           !request.world_data.empty() || request.journal.has_value() ||
                           request.control != nullptr || is_debugged(request);
  if (is_network && of_missions)
    return "inputs, facts, a state to start at, a journal, pauses and steps are for missions, not for task "
           "networks";
  if (!is_network && request.order != task_network::OrderRule::Epoch) return std::string(kNoGoal);
  if (request.mode == RunMode::Sequential &&
      (request.strict || request.workers != 0 || request.world_copies != 0))
    return "strict, a number of workers and of copies of the world are for concurrent runs";
  if (request.mode == RunMode::Concurrent && !request.start_at.empty())
    return "a state to start at is for missions that run as they are written";
  if (request.mode == RunMode::Concurrent && is_debugged(request))
    return "breakpoints and steps back are for missions that run as they are written";
  if (request.control == nullptr && is_debugged(request))
    return "breakpoints and steps back need a control that lets the run go on";
  return {};
}

}  // namespace

Result<draw::Diagram> Session::convert(const ConvertRequest& request) const {
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

Result<convert::AheadOfFailures> Session::ahead_of_failures(const ConvertRequest& request) const {
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
  const auto facts = detail::parse_facts(request.facts);
  if (!facts) return facts.error();
  return convert::ahead_of_failures(program_, std::move(*inputs), *facts);
}

Result<std::unique_ptr<FinishedRun>> Session::run(const RunRequest& request,
                                                  const std::stop_token& stop) const {
  if (auto problem = problem_of(request, is_network()); !problem.empty())
    return fail(ErrorCode::Unsupported, std::move(problem));
  if (is_network()) return detail::run_network(network_, request, stop);
  if (request.mode == RunMode::Sequential) return detail::run_as_written(program_, request, stop);
  return detail::run_concurrently(program_, request, stop);
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

Result<std::vector<mission::Fact>> parse_facts(const std::vector<std::string>& texts) {
  std::vector<mission::Fact> facts;
  for (const std::string& text : texts) {
    auto fact = mission::parse_initial_fact(text);
    if (!fact) return fact.error();
    facts.push_back(std::move(*fact));
  }
  return facts;
}

mission::Runners runners_for(const RunRequest& request) {
  mission::Runners runners = request.runners;
  if (!request.python.empty()) {
    mission::ScriptOptions scripts;
    scripts.python = request.python;
    scripts.robot = request.script_robot;
    runners.set_scripts(std::make_shared<mission::ScriptRunner>(std::move(scripts)));
  }
  if (request.simulate) runners.simulate_all();
  return runners;
}

Result<draw::Diagram> diagram_of(const SharedProgram& program, const ConvertRequest& request) {
  auto inputs = inputs_by_port(*program, request.inputs);
  if (!inputs) return inputs.error();
  const auto facts = parse_facts(request.facts);
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
