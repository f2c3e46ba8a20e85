// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "../command.hpp"
#include "../output.hpp"
#include "../stop_signal.hpp"
#include "bench_experiment.hpp"
#include "bench_files.hpp"
#include "bench_results.hpp"
#include "number_list.hpp"

namespace segue::cli {

namespace {

struct BenchOptions {
  std::vector<std::string> experiments;
  std::string folder;
  std::string order;
  BenchSettings settings;
};

constexpr std::size_t kLongestBenchChain = 1000;
constexpr std::size_t kLargestBenchSample = std::size_t{1} << 30;
constexpr std::size_t kMostBenchRepetitions = 1'000'000;

std::vector<std::string> bench_names() {
  std::vector<std::string> names;
  for (const BenchExperiment& experiment : bench_experiments())
    names.emplace_back(experiment.name);
  names.emplace_back("all");
  return names;
}

/// "10,25,50": each between 1 and `highest`.
Result<void> parse_counts(const std::string& text, std::size_t highest, std::vector<std::size_t>& counts) {
  const auto numbers = parse_number_list<std::size_t>(text);
  const auto in_range = [&](std::size_t count) { return count >= 1 && count <= highest; };
  if (!numbers || !std::ranges::all_of(*numbers, in_range)) {
    return fail(ErrorCode::InvalidArgument,
                fmt::format("expected whole numbers between 1 and {}, separated by commas, got {}", highest,
                            quote(text)));
  }
  counts.insert(counts.end(), numbers->begin(), numbers->end());
  return {};
}

std::vector<const BenchExperiment*> selected(const BenchOptions& options) {
  const auto named = [&](std::string_view name) {
    return std::ranges::find(options.experiments, name) != options.experiments.end();
  };
  std::vector<const BenchExperiment*> experiments;
  for (const BenchExperiment& experiment : bench_experiments()) {
    if (named(experiment.name) || named("all")) experiments.push_back(&experiment);
  }
  return experiments;
}

void run_experiment(BenchResults& results, BenchSettings settings, StopSignal& stop) {
  const BenchExperiment& experiment = *results.experiment;
  if (settings.repetitions == 0) settings.repetitions = experiment.repetitions;
  Progress progress;
  const BenchReport report = {
      [&](BenchRow row) { results.rows.push_back(std::move(row)); },
      [&](std::string why) { results.failures.push_back(std::move(why)); },
      [&](const std::string& text) { progress.show(fmt::format("{}: {}", experiment.name, text)); },
      [&] { return stop.requested(); }};
  experiment.run(settings, report);
}

void print_results(const BenchResults& results) {
  if (!results.rows.empty()) print_line(bench_text(results));
  for (const std::string& failure : results.failures)
    print_note(fmt::format("{} was not measured: {}", results.experiment->name, failure));
}

int list_experiments(const Context& context) {
  if (context.json()) {
    print_json(bench_list_value());
  } else {
    print(bench_list_text());
  }
  return kDone;
}

int run_bench(const BenchOptions& options, const Context& context) {
  if (options.experiments.empty()) return list_experiments(context);
  StopSignal stop;
  if (!options.folder.empty()) {
    if (auto made = make_bench_folder(options.folder); !made) return failed(context, made.error());
  }
  set_log_level(LogLevel::Error);
  BenchSettings settings = options.settings;
  if (!options.order.empty())
    settings.order =
        options.order == to_string(model::Order::Paper) ? model::Order::Paper : model::Order::Seamless;
  type::Value::List values;
  bool complete = true;
  for (const BenchExperiment* experiment : selected(options)) {
    if (stop.requested()) break;
    BenchResults results{experiment, {}, {}};
    run_experiment(results, settings, stop);
    complete = complete && results.failures.empty();
    if (context.json()) {
      values.push_back(bench_value(results));
    } else {
      print_results(results);
    }
    if (options.folder.empty()) continue;
    if (auto written = write_bench_files(options.folder, results); !written)
      return failed(context, written.error());
  }
  if (context.json()) print_json(type::Value::map({{"experiments", std::move(values)}}));
  if (!stop.requested()) return complete ? kDone : kFailed;
  print_note("interrupted; this is what was measured until then");
  return kFailed;
}

Result<void> parse_transports(const std::string& text, std::vector<BenchTransport>& transports) {
  if (text == "all") return {};
  for (const BenchTransport transport :
       {BenchTransport::Local, BenchTransport::SharedMemory, BenchTransport::Remote}) {
    if (text != to_string(transport)) continue;
    transports = {transport};
    return {};
  }
  return fail(ErrorCode::InvalidArgument, "expected local, shm, remote or all, got " + quote(text));
}

/// "arm=tcp://10.0.0.2:7447".
Result<void> parse_host(const std::string& text, BenchHost& host) {
  const std::size_t end = text.find('=');
  if (end == std::string::npos || !is_identifier(text.substr(0, end))) {
    return fail(ErrorCode::InvalidArgument,
                "expected the host's name and address, NAME=tcp://... or NAME=unix:..., got " + quote(text));
  }
  host.name = text.substr(0, end);
  host.address = text.substr(end + 1);
  if (host.address.starts_with("unix:"))  // the robot file is in a folder of its own
    host.address = "unix:" + std::filesystem::absolute(host.address.substr(5)).string();
  return {};
}

void add_host_options(Verb& verb, BenchHost& host) {
  const Option other = verb.option(
      "--host NAME=ADDRESS", [&host](const std::string& text) { return parse_host(text, host); },
      "the other host of remote chains, as in robot files (default: one on this computer for the duration)");
  verb.option("--credentials FOLDER", host.credentials,
              "your certificate for it (default: that of `segue host init`)")
      .needs(other);
}

void add_bench_options(Verb& verb, BenchOptions& options) {
  BenchSettings& settings = options.settings;
  verb.option("EXPERIMENT", options.experiments, "E1.1, E1.2, E2.1, E2.2, E2.3 or all").one_of(bench_names());
  verb.option(
      "--transport KIND",
      [&settings](const std::string& text) { return parse_transports(text, settings.transports); },
      "local: all tasks in one process; shm: a process for each, samples in shared memory; remote: another "
      "host as well; all (default)");
  add_host_options(verb, settings.host);
  verb.option("--repetitions N", settings.repetitions, "how often to measure each (default: by experiment)")
      .between(1, kMostBenchRepetitions);
  verb.option(
      "--relays N,...",
      [&settings](const std::string& text) {
        return parse_counts(text, kLongestBenchChain, settings.relays);
      },
      "lengths of the chains (default: by experiment)");
  verb.option(
      "--bytes N,...",
      [&settings](const std::string& text) {
        return parse_counts(text, kLargestBenchSample, settings.bytes);
      },
      "payloads (default: 10 to 100,000,000 in E1.1, else 100)");
  verb.option("--order ORDER", options.order,
              "seamless (default) or paper: one action after the other (default of E2.2)")
      .one_of({"seamless", "paper"});
  verb.option("--out DIR", options.folder, "also write all measurements as CSV, and charts as SVG");
}

std::string bench_help() {
  std::string text =
      "  segue bench                       # lists the experiments\n"
      "  segue bench E1.1 --transport shm\n"
      "  segue bench all --out results\n"
      "  segue bench E2.2 --transport remote --host arm=tcp://192.168.1.10:7447\n\n"
      "The experiments of M. Wirkus et al., J Intell Robot Syst 100, 2020, with real tasks in real "
      "processes,\n"
      "beside the paper's figures, with its lengths and sizes. What fails is named, and the rest goes on; "
      "the\n"
      "exit status is 1 then. Close other programs first. Ctrl-C ends it cleanly: no process is left.\n";
  for (const BenchExperiment& experiment : bench_experiments())
    text += fmt::format("\n{}: {}\n{}\n", experiment.name, experiment.title, experiment.measured);
  text.pop_back();
  return text;
}

}  // namespace

Result<void> make_bench_folder(const std::string& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (!problem) return {};
  return fail(ErrorCode::IoError, "cannot create the folder " + quote(folder) + ": " + problem.message());
}

void add_bench(Verb& app, Context& context) {
  const auto options = std::make_shared<BenchOptions>();
  Verb& verb = add_verb(app, context, "bench", "repeat the experiments of the paper", bench_help(),
                        [options, &context] { return run_bench(*options, context); });
  add_bench_options(verb, *options);
  add_bench_transitions(verb, context);
  add_bench_mission(verb, context);
}

}  // namespace segue::cli
