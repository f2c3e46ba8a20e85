// SPDX-License-Identifier: Apache-2.0
#include "mission_network.hpp"

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/critical_path.hpp>
#include <segue/cdtn/flat_file.hpp>
#include <segue/cdtn/priority.hpp>
#include <segue/cdtn/sequential.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/type/json.hpp>

#include <fmt/format.h>

#include <charconv>
#include <stop_token>
#include <thread>

#include "models.hpp"
#include "output.hpp"
#include "run_times.hpp"
#include "stop_signal.hpp"

namespace segue::cli {

namespace {

/// One run from its options to what is shown of it.
class NetworkRun {
 public:
  NetworkRun(cdtn::FlatNetwork flat, const NetworkOptions& options)
      : flat_(std::move(flat)), options_(options) {}

  Result<void> run() {
    if (auto fits = check(options_.files); !fits) return fits;
    for (const std::string& resource : options_.resources) {
      if (auto set = set_count(resource); !set) return set;
    }
    const auto rule = options_.order == "goal" ? cdtn::OrderRule::Goal : cdtn::OrderRule::Epoch;
    order_ = cdtn::derive_order(flat_.network, rule);
    execute();
    summary_.critical_path = cdtn::critical_path(flat_.network, order_, result_).length;
    if (flat_.network.size() > 0) summary_.engine_us_per_node = used_ * 1e6 / flat_.network.size();
    return {};
  }

  void show(const Context& context) const { show_run(flat_.network, order_, result_, summary_, context); }

  [[nodiscard]] const cdtn::RunResult& result() const { return result_; }
  [[nodiscard]] Result<void> write_files() const {
    if (!options_.files.any()) return {};
    return write(options_.files, draw::gantt_of(flat_.network, order_, result_, summary_));
  }

 private:
  [[nodiscard]] cdtn::ClockKind clock() const {
    return options_.clock == "virtual" ? cdtn::ClockKind::Virtual : cdtn::ClockKind::Real;
  }

  Result<void> set_count(const std::string& text) {
    const auto equals = text.rfind('=');
    const auto id = flat_.network.resources.find(text.substr(0, equals));
    if (!id) return fail(ErrorCode::NotFound, "no node uses a resource " + quote(text.substr(0, equals)));
    std::uint32_t count = 0;
    const char* first = text.data() + (equals == std::string::npos ? text.size() : equals + 1);
    const auto [end, error] = std::from_chars(first, text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size())
      return fail(ErrorCode::InvalidArgument, quote(text) + " is not NAME=COUNT");
    flat_.network.resources[*id].count = count;
    return {};
  }

  /// This run, and the sequential one to compare it with. Another thread waits for a signal meanwhile.
  void execute() {
    std::stop_source stop;
    std::thread watch([&] {
      stop_.wait({});
      stop.request_stop();
    });
    const double before = thread_seconds();
    result_ = options_.mode == "sequential" ? run_sequentially(clock(), stop.get_token())
                                            : run_concurrently(stop.get_token());
    used_ = thread_seconds() - before;
    summary_.sequential = sequential_time(stop.get_token());
    stop_.request("the run has ended");
    watch.join();
  }

  Duration sequential_time(const std::stop_token& stop) {
    if (!result_.stopped && clock() == cdtn::ClockKind::Virtual && options_.mode == "sequential")
      return result_.makespan;
    if (const auto whole = run_sequentially(cdtn::ClockKind::Virtual, stop); !whole.stopped)
      return whole.makespan;
    Duration done{};
    for (const cdtn::NodeResult& node : result_.nodes)
      if (node.status == cdtn::NodeStatus::Done) done += node.ended - node.started;
    return done;
  }

  cdtn::RunResult run_sequentially(cdtn::ClockKind kind, std::stop_token stop) {
    cdtn::SimulatedEnvironment environment(flat_.network, flat_.trials, options_.seed);
    return cdtn::run_sequential(flat_.network, environment, kind, std::move(stop));
  }

  cdtn::RunResult run_concurrently(const std::stop_token& stop) {
    cdtn::ConcurrentEngineOptions options;
    options.clock = clock();
    options.strict = options_.strict;
    options.workers = options_.workers;
    options.world_copies = options_.world_copies;
    options.priorities = cdtn::choose_priorities(flat_.network, order_, flat_.trials, options, stop);
    cdtn::SimulatedEnvironment environment(flat_.network, flat_.trials, options_.seed);
    cdtn::ConcurrentEngine engine(flat_.network, order_, environment, options);
    const std::stop_callback end(stop, [&] { engine.stop(); });
    return engine.run();
  }

  StopSignal stop_;  ///< until what came of the run is shown
  cdtn::FlatNetwork flat_;
  const NetworkOptions& options_;
  cdtn::Order order_;
  cdtn::RunResult result_;
  cdtn::RunSummary summary_;
  double used_ = 0;
};

std::optional<cdtn::FlatNetwork> load(const std::string& file, Diagnostics& diagnostics) {
  auto flat = cdtn::load_flat_network(file, diagnostics);
  if (flat) print_diagnostics(diagnostics);
  return flat;
}

}  // namespace

bool is_task_network(const std::filesystem::path& file) {
  const auto text = read_file(file);
  if (!text) return false;
  const auto first = text->find_first_not_of(" \t\r\n");
  if (first == std::string::npos || (*text)[first] != '{') return false;
  const auto value = type::parse_json(*text);
  return !value || value->find("nodes") != nullptr;
}

int run_task_network(const std::string& file, const NetworkOptions& options, const Context& context) {
  Diagnostics diagnostics;
  auto flat = load(file, diagnostics);
  if (!flat) return report_failure(context, diagnostics);
  NetworkRun run(std::move(*flat), options);
  if (const auto done = run.run(); !done) return failed(context, done.error());
  if (options.show) run.show(context);
  // Standard output has had its document.
  if (const auto written = run.write_files(); !written) return failed(Context{}, written.error());
  if (run.result().done()) return kDone;
  if (run.result().error && (!options.show || !context.json())) return failed(context, *run.result().error);
  return kFailed;
}

int import_pddl(const PddlOptions& options, const Context& context) {
  Diagnostics diagnostics;
  auto network = pddl::load_pddl(options.files[0], options.files[1], options.files[2], diagnostics);
  if (!network) return report_failure(context, diagnostics);
  print_diagnostics(diagnostics);
  const std::string text = cdtn::write_flat_network({std::move(*network), {}});
  if (options.output.empty()) {
    print(text);
    return kDone;
  }
  const auto written = write_file(options.output, text);
  return written ? kDone : failed(context, written.error());
}

void add_network_options(Verb& verb, NetworkOptions& options) {
  verb.option("--order ORDER", options.order,
              "of a task network: epoch (default) keeps the whole final world, goal only its goal")
      .one_of({"epoch", "goal"});
  verb.option("--seed N", options.seed,
              "vary durations of simulated nodes, the same way for the same number; 0: as expected");
  verb.option("--workers N", options.workers, "nodes that run at the same time; 0: any number");
  verb.option("--world-copies N", options.world_copies, "projected worlds at the same time; 0: any number");
  verb.option("--resource NAME=COUNT", options.resources,
              "that many of a resource, such as process:planner=2");
  verb.flag("--strict", options.strict, "nothing happens behind a node that may still fail");
}

}  // namespace segue::cli
