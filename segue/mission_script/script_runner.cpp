// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/mission_script/script_robot.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/mission_script/script_worker.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <random>
#include <system_error>
#include <utility>
#include <vector>

namespace segue::mission {

namespace {

/// Run ids have RAFCON's form: a prefix for each run and a number.
std::string run_prefix() {
  std::random_device random;
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%08x%08x%08x%08x.run_id.", random(), random(), random(), random());
  return text.data();
}

std::string run_number(std::uint64_t number) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%020llu", static_cast<unsigned long long>(number));
  return text.data();
}

Result<ScriptRobot::Rights> rights_of(const ActionCall& call) {
  ScriptRobot::Rights rights{call.action().action_class() == ActionClass::Irreversible, {}, {}};
  for (const std::string& controller : *call.action().controllers) {
    auto name = call.controller(controller);
    if (!name) return name.error();
    rights.controllers.push_back(std::move(*name));
  }
  rights.user = {call.path(), call.iteration()};
  return rights;
}

}  // namespace

class ScriptRunner::Impl {
 public:
  explicit Impl(ScriptOptions options) : options_(std::move(options)), runs_(run_prefix()) {}
  ~Impl() { reach_->close(); }

  /// Preempts an execution. From any thread, also after this has gone: the thread of a script's robot, which
  /// this waits for in its end, may not be the one that ends it.
  std::function<void()> preemption_of(std::uint64_t id) {
    return [reach = reach_, id] { reach->with([&](Impl& runner) { runner.preempt(id); }); };
  }

  std::pair<std::uint64_t, std::string> next_run() {
    const Lock guard(mutex_);
    const std::uint64_t id = ++last_id_;
    return {id, runs_ + run_number(id)};
  }

  /// Hands the execution to the worker of the owner that accepts more, or to a new one.
  void begin(std::uint64_t id, const std::string& owner, detail::ScriptExecution execution,
             const std::string& message) {
    const Lock guard(mutex_);
    std::erase_if(workers_, [](const Owned& each) { return each.worker->ended(); });
    for (const auto& [whose, worker] : workers_) {
      if (whose == owner && worker->begin(id, execution, message)) return;
    }
    auto worker = std::make_unique<detail::ScriptWorker>(options_);
    if (paused_) worker->pause(true);
    try {
      (void)worker->begin(id, execution, message);
      workers_.push_back({owner, std::move(worker)});
    } catch (const std::system_error& failed) {
      execution.completer({kAborted, std::string("no thread for Python: ") + failed.what()},
                          std::move(execution.outputs));
    }
  }

  void pause(bool paused) {
    const Lock guard(mutex_);
    paused_ = paused;
    for (const auto& [owner, worker] : workers_)
      worker->pause(paused);
  }

  [[nodiscard]] std::optional<pid_t> process() const {
    const Lock guard(mutex_);
    for (const auto& [owner, worker] : workers_) {
      if (owner.empty() && worker->takes_more()) return worker->process();
    }
    return std::nullopt;
  }

  [[nodiscard]] const ScriptOptions& options() const { return options_; }

 private:
  /// A worker, and the isolated action whose scripts it executes; empty: those of all others.
  struct Owned {
    std::string owner;
    std::unique_ptr<detail::ScriptWorker> worker;
  };

  void preempt(std::uint64_t id) {
    const Lock guard(mutex_);
    for (const auto& [owner, worker] : workers_)
      worker->preempt(id);
  }

  const ScriptOptions options_;
  const std::string runs_;
  const std::shared_ptr<detail::Reach<Impl>> reach_ = std::make_shared<detail::Reach<Impl>>(*this);
  mutable Mutex mutex_;
  std::vector<Owned> workers_ SEGUE_GUARDED_BY(mutex_);
  std::uint64_t last_id_ SEGUE_GUARDED_BY(mutex_) = 0;
  bool paused_ SEGUE_GUARDED_BY(mutex_) = false;
};

ScriptRunner::ScriptRunner(ScriptOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
ScriptRunner::~ScriptRunner() = default;

Result<void> ScriptRunner::check() const {
  return detail::check_python(impl_->options());
}

std::optional<Ending> ScriptRunner::start(ActionCall& call) {
  const auto [id, run] = impl_->next_run();
  const auto world = call.world();
  const auto message =
      detail::execute_message(id, run, call, impl_->options().robot != nullptr, world ? &*world : nullptr);
  if (!message) return Ending{kAborted, message.error().message};
  std::optional<ScriptRobot::Rights> rights;
  if (call.action().controllers && impl_->options().robot && !call.backward()) {
    auto granted = rights_of(call);
    if (!granted) return Ending{kAborted, to_string(granted.error())};
    rights = std::move(*granted);
  }
  const auto text = detail::framed(*message, impl_->options().largest_message);
  if (!text) return Ending{kAborted, "its inputs: " + text.error().message};
  detail::ScriptExecution execution{detail::path_of(call), {}, call.globals(), {}, {}, {}, {}, {}, {}, {}};
  execution.is_told_memory = call.memory().has_value();
  if (world) execution.data = std::make_shared<detail::ScriptData>(*world);
  for (const Port& port : call.action().outputs)
    execution.output_names.push_back(port.name);
  execution.outputs.assign(call.outputs().begin(), call.outputs().end());
  execution.completer = call.defer(impl_->preemption_of(id));
  if (rights) execution.robot = impl_->options().robot->begin(std::move(*rights), impl_->preemption_of(id));
  const bool isolated = std::get<Script>(call.action().run).isolated;
  impl_->begin(id, isolated ? call.action().name.str() : std::string(), std::move(execution), *text);
  return std::nullopt;
}

void ScriptRunner::set_paused(bool paused) {
  impl_->pause(paused);
}

std::optional<pid_t> ScriptRunner::process() const {
  return impl_->process();
}

}  // namespace segue::mission
