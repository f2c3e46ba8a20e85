// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <cstddef>
#include <functional>
#include <vector>

#include "bench_chain.hpp"
#include "bench_experiment.hpp"

/// The least that the operating system needs for the same job, measured in the same run; in seconds. All end
/// early where `stopped` returns true.
namespace segue::cli {

/// The processors on which the threads or processes of a floor run, in turn; the calling thread on the first.
using Processors = std::vector<int>;

/// Measures with all on one processor, and with neighbours on two; that part stays empty where this process
/// may use only one.
Result<BenchFloor> floor_on_processors(
    const std::function<Result<std::vector<double>>(const Processors&)>& measure);

/// Messages that go from this thread through `relays` threads (of this process) or processes (each forked)
/// and back to this thread, each copied into a pipe (for remote chains: into a TCP connection of this
/// computer with itself) and out of it, paced so that all sleep before their turn. At least one relay.
Result<std::vector<double>> pipe_latencies(BenchTransport transport, std::size_t relays, std::size_t bytes,
                                           std::size_t repetitions, const Processors& processors,
                                           const std::function<bool()>& stopped);

/// The times until `count` new threads run.
std::vector<double> thread_starts(std::size_t count, std::size_t repetitions, const Processors& processors,
                                  const std::function<bool()>& stopped);

/// The times until `count` processes with the program `true` have been spawned, all at once, and have ended.
Result<std::vector<double>> program_runs(std::size_t count, std::size_t repetitions,
                                         const Processors& processors, const std::function<bool()>& stopped);

}  // namespace segue::cli
