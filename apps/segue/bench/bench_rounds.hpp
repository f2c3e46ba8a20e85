// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <functional>
#include <string>
#include <vector>

#include "bench_experiment.hpp"
#include "bench_robot.hpp"

/// The loop that the experiments with chains share.
namespace segue::cli {

/// Chains with each number of relays and each size of samples on that transport; what the settings name
/// replaces what is given.
std::vector<ChainOptions> chains_of(const BenchSettings& settings, BenchTransport transport,
                                    const std::vector<std::size_t>& relays,
                                    const std::vector<std::size_t>& bytes = {ChainOptions{}.bytes});

/// "shm, 25 relays, 100 B"
std::string to_string(const ChainOptions& chain);

/// Measures each of the chains, with nothing running before and after it. One that fails is reported, and the
/// next one begins with a robot started afresh.
void for_each_chain(const BenchSettings& settings, const BenchReport& report,
                    const std::function<std::vector<ChainOptions>(BenchTransport)>& chains,
                    const std::function<Result<void>(BenchRobot&, const ChainOptions&)>& measure);

}  // namespace segue::cli
