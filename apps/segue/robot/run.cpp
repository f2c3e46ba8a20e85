// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/robot_name.hpp>
#include <segue/base/text.hpp>
#include <segue/control/server.hpp>
#include <segue/model/robot.hpp>
#include <segue/runtime/controller_files.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_report.hpp>
#include <segue/runtime/runtime_service.hpp>

#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <memory>
#include <thread>

#include "../connection.hpp"
#include "../journal_file.hpp"
#include "../models.hpp"
#include "../output.hpp"
#include "../report_text.hpp"
#include "../stop_signal.hpp"
#include "../studio/studio_process.hpp"

namespace segue::cli {

namespace {

using runtime::EmbeddedRobot;

struct RunOptions {
  std::string file;
  std::string controller;
  std::string stand_ins;
  bool stand_in = false;
  bool in_process = false;
  bool daemon = false;
  bool take_over = false;
  bool no_journal = false;
  bool studio = false;
  std::uint32_t studio_port = kStudioPort;
  std::string journal;
  bool verbose = false;
  LogLevel log_level = LogLevel::Info;
  Duration length{0};
};

/// Prints the events of the runtime, from a thread of its own.
class EventPrinter {
 public:
  EventPrinter(runtime::Runtime& runtime, const Context& context, bool verbose)
      : runtime_(runtime), context_(context), verbose_(verbose), thread_([this] { run(); }) {}
  /// Prints the remaining events, then ends.
  ~EventPrinter() {
    ended_ = true;
    thread_.join();
    print_new();
  }
  EventPrinter(const EventPrinter&) = delete;
  EventPrinter& operator=(const EventPrinter&) = delete;

  /// Prints the text after all events so far; not in JSON, where every line is an event.
  void announce(const std::string& text) {
    const Lock lock(mutex_);
    print_new_locked();
    if (context_.json()) return;
    progress_.clear();
    print_line(text);
  }

 private:
  void run() {
    while (!ended_) {
      static_cast<void>(runtime_.events(last_, std::chrono::milliseconds(50)));
      print_new();
    }
  }

  void print_new() {
    const Lock lock(mutex_);
    print_new_locked();
  }

  void print_new_locked() SEGUE_REQUIRES(mutex_) {
    for (const runtime::Event& event : runtime_.events(last_)) {
      last_ = event.number;
      show(event);
    }
  }

  void show(const runtime::Event& event) SEGUE_REQUIRES(mutex_) {
    const bool is_action = event.kind == runtime::EventKind::ActionDone;
    actions_ = is_action ? actions_ + 1 : 0;
    if (context_.json()) return print_json_line(runtime::to_value(event));
    if (is_action && !verbose_)
      return progress_.show(fmt::format("{} actions done: {}", actions_, event.subject));
    progress_.clear();
    print_line(event_line(runtime::to_value(event)));
  }

  runtime::Runtime& runtime_;
  const Context& context_;
  bool verbose_;
  Mutex mutex_;  ///< serialises printing; protects actions_ and progress_
  std::atomic<std::uint64_t> last_{0};
  int actions_ SEGUE_GUARDED_BY(mutex_) = 0;
  Progress progress_ SEGUE_GUARDED_BY(mutex_);
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// A request that was superseded by a newer one has not failed.
int explain_outcome(const runtime::SwitchResult& result) {
  if (result.ok() || result.outcome == runtime::Outcome::Superseded) return kDone;
  const Error error = result.error.value_or(fail(ErrorCode::Internal, result.why(), result.to.str()));
  if (error.diagnostics != nullptr) print_diagnostics(*error.diagnostics);
  print_error({}, error);
  return kFailed;
}

/// An unknown controller is reported before anything starts.
Result<void> check_controller(const EmbeddedRobot& robot, runtime::Runtime& runtime,
                              const std::string& name) {
  if (name.empty() || runtime.controller(model::NetworkName(name))) return {};
  std::vector<std::string> names;
  for (const auto& known : runtime.controllers())
    names.push_back(known.str());
  return fail(ErrorCode::NotFound, fmt::format("robot {} has no controller {}{}", quote(robot.robot().name),
                                               quote(name), did_you_mean_or_list(name, names, "it has")));
}

/// Blocks until the first controller runs, and then until there is a reason to end.
int operate(std::future<runtime::SwitchResult> first, const RunOptions& options, StopSignal& stop,
            EventPrinter& printer) {
  std::optional<TimePoint> end;
  if (options.length > Duration(0)) end = deadline_in(options.length);
  if (first.valid()) {
    const int status = explain_outcome(first.get());
    if (status != kDone) return status;
  }
  const auto reason = stop.wait(end);
  printer.announce(reason ? *reason + "; stopping cleanly" : "the time is up; stopping cleanly");
  return kDone;
}

int shut_down(EmbeddedRobot& robot) {
  const auto result = robot.shut_down();
  return explain_outcome(result);
}

/// If wanted. The robot runs with or without it.
std::optional<StudioProcess> start_studio(const EmbeddedRobot& robot, const RunOptions& options,
                                          const Context& context) {
  if (!options.studio) return std::nullopt;
  auto started = StudioProcess::start(robot.robot().name, options.studio_port, context.json());
  if (started) return std::move(*started);
  print_error({}, started.error());
  return std::nullopt;
}

int serve(EmbeddedRobot& robot, const RunOptions& options, StopSignal& stop, const Context& context) {
  runtime::Runtime& runtime = robot.runtime();
  if (const auto known = check_controller(robot, runtime, options.controller); !known) {
    return failed(context, known.error());
  }
  const auto socket = control::socket_path(robot.robot().name);
  if (!socket) return failed(context, socket.error());
  runtime::RuntimeService service(runtime, &robot.files(), [&stop] { stop.request("asked to end"); });
  set_robot_of_process(robot.robot().name);
  // Requested before the server accepts requests of others.
  std::future<runtime::SwitchResult> first;
  if (!options.controller.empty()) first = runtime.request(model::NetworkName(options.controller));
  const auto server = control::Server::listen(*socket, &service);
  if (!server) {
    shut_down(robot);
    return failed(context, server.error());
  }
  if (!context.json()) {
    print_line(fmt::format("robot {} runs (pid {}); Ctrl-C stops it cleanly, `segue status` shows its state",
                           robot.robot().name, ::getpid()));
  }
  const auto studio = start_studio(robot, options, context);
  EventPrinter printer(runtime, context, options.verbose);
  const int operated = operate(std::move(first), options, stop, printer);
  const int ended = shut_down(robot);
  return operated == kDone ? ended : operated;
}

int run_robot(const RunOptions& options, const Context& context) {
  set_log_level(options.log_level);
  StopSignal stop;
  runtime::EmbeddedOptions embedded;
  embedded.stand_in = options.stand_in || !options.stand_ins.empty();
  embedded.stand_ins = options.stand_ins;
  embedded.placement =
      options.in_process ? runtime::TaskPlacement::InProcess : runtime::TaskPlacement::Processes;
  embedded.daemon = options.daemon;
  embedded.take_over = options.take_over;
  embedded.journal = !options.no_journal;
  embedded.journal_file = options.journal;
  embedded.log_level = options.log_level;
  auto robot = EmbeddedRobot::open(options.file, embedded);
  if (!robot) return report_failure(context, robot.error());
  print_diagnostics(robot->warnings());
  const int status = serve(*robot, options, stop, context);
  if (status == kDone && !context.json()) print_line("the robot is stopped");
  robot->exit_if_hanging(status);
  return status;
}

}  // namespace

void add_run(Verb& app, Context& context) {
  const auto options = std::make_shared<RunOptions>();
  Verb& verb = add_verb(
      app, context, "run", "start a robot's runtime; Ctrl-C stops it cleanly",
      "  segue run robot.yaml --controller explore\n"
      "  segue run robot.yaml --studio       # to be watched and operated in a browser\n"
      "  segue run --stand-in robot.yaml     # simulates components that are not installed\n\n"
      "Tasks of deployments run in processes of their own, all others in this one. SIGINT (Ctrl-C) and\n"
      "SIGTERM stop every task cleanly and end those processes; a second signal ends this process at once\n"
      "with status 130 and leaves them running. Deployments of the robot that are already running are\n"
      "adopted; without `--controller` they simply continue. With `--format json` every event is a line of\n"
      "JSON.",
      [options, &context] { return run_robot(*options, context); });
  verb.option("ROBOT", options->file, "the robot file").required();
  verb.option("--controller NAME", options->controller, "request this controller at startup");
  verb.flag("--stand-in", options->stand_in,
            "use a stand-in (simulated component) for each component that is not installed");
  verb.option("--stand-ins FILE", options->stand_ins,
              "configure the behaviour of stand-ins with this file; implies --stand-in");
  const Option in_process =
      verb.flag("--in-process", options->in_process,
                "run all tasks in this process, whatever the network's deployments say");
  verb.flag("--take-over", options->take_over,
            "command the robot although another runtime still does, on other hosts");
  verb.flag("--daemon", options->daemon,
            "let the process server of this computer (`segue host`) start the processes")
      .excludes(in_process);
  const Option no_journal = verb.flag("--no-journal", options->no_journal, "keep no journal");
  add_journal_option(verb, options->journal).excludes(no_journal);
  const Option studio =
      verb.flag("--studio", options->studio,
                "also serve the robot to browsers of this computer, as `segue studio` does, until it ends");
  verb.option("--studio-port PORT", options->studio_port, "where it listens (default 8475; 0: any free port)")
      .needs(studio)
      .between(std::size_t{0}, std::size_t{65535});
  verb.option("--for DURATION", options->length, "end after this time")
      .between(std::chrono::milliseconds(1), kLongestWait);
  verb.flag("-v,--verbose", options->verbose, "also print every action");
  add_log_level_option(verb, options->log_level, "task log messages shown");
}

}  // namespace segue::cli
