// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/action_environment.hpp>
#include <segue/convert/run.hpp>

namespace segue::convert {

class Run::Implementation {
 public:
  Implementation(std::unique_ptr<Plan> plan, const mission::Runners& runners,
                 std::vector<std::shared_ptr<mission::ActionRunner>> by_action, const RunOptions& options)
      : plan_(std::move(plan)),
        runners_(runners),
        environment_(*plan_, runners_, std::move(by_action), options),
        engine_(plan_->network(), *plan_, environment_, settings(options)) {}

  const mission::MissionResult& run() {
    network_result_ = engine_.run();
    environment_.close();
    const mission::Program& program = plan_->program();
    result_.outcome = plan_->final_outcome(network_result_);
    result_.outcome_name = program.outcome_name(0, result_.outcome);
    if (network_result_.error && result_.outcome == mission::kAborted)
      result_.error = network_result_.error->message;
    if (result_.outcome >= 0) result_.outputs = plan_->final_outputs();
    result_.outputs.resize(program.node(0).output_ports->size());
    return result_;
  }

  static cdtn::EngineOptions settings(const RunOptions& options) {
    cdtn::EngineOptions made;
    made.clock = options.clock;
    made.strict = options.strict;
    made.speculate = options.speculate;
    made.workers = options.workers;
    made.horizon = options.horizon;
    made.log = options.log;
    return made;
  }

  std::unique_ptr<Plan> plan_;
  const mission::Runners runners_;
  ActionEnvironment environment_;
  cdtn::Engine engine_;
  cdtn::RunResult network_result_;
  mission::MissionResult result_;
};

Run::Run(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Run::~Run() = default;

Result<std::unique_ptr<Run>> Run::create(std::shared_ptr<const mission::Program> program,
                                         const mission::Runners& runners, std::vector<type::Value> inputs,
                                         RunOptions options) {
  auto assigned = runners.assign(program->mission());
  if (!assigned) return assigned.error();
  auto plan = Plan::create(std::move(program), std::move(inputs), options.facts);
  if (!plan) return plan.error();
  return std::unique_ptr<Run>(
      new Run(std::make_unique<Implementation>(std::move(*plan), runners, std::move(*assigned), options)));
}

const mission::MissionResult& Run::run() {
  return implementation_->run();
}
void Run::stop() {
  implementation_->engine_.stop();
  implementation_->environment_.stop();
}
const cdtn::RunResult& Run::network_result() const {
  return implementation_->network_result_;
}
const Plan& Run::plan() const {
  return *implementation_->plan_;
}
mission::Globals& Run::globals() {
  return implementation_->environment_.globals;
}

}  // namespace segue::convert
