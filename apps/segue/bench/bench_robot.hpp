// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/model/network.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/embedded_robot.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/temporary_hosts.hpp>

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench_chain.hpp"
#include "bench_experiment.hpp"

namespace segue::cli {

/// A transition that was executed.
struct Switched {
  double seconds = 0;  ///< from the request to its result
  std::vector<runtime::ActionRecord> actions;
};

/// A robot with the bench components and a temporary folder for its files. Its destructor ends all tasks and
/// processes. One at a time for each user.
class BenchRobot {
 public:
  /// Removes first what an earlier run left when it was killed. AlreadyExists while another such robot of
  /// this user runs.
  static Result<std::unique_ptr<BenchRobot>> open(BenchTransport transport, const BenchHost& host);
  ~BenchRobot();
  BenchRobot(const BenchRobot&) = delete;
  BenchRobot& operator=(const BenchRobot&) = delete;

  Result<Switched> switch_to(const model::Network& network, model::Order order = model::Order::Seamless);
  /// Prepares a chain, and keeps it and the running one prepared from then on. ResourceExhausted where the
  /// runtime could not prepare all of it.
  Result<void> prepare(const model::Network& running, const model::Network& next);
  /// Nothing is kept prepared any more.
  void drop_prepared();
  /// A transition that only calls this operation.
  Result<Switched> call_by_transition(const std::string& task, const std::string& operation);
  Result<type::Value> call(const std::string& task, const char* operation);
  /// How long the other host's daemon takes to answer the smallest request; in seconds.
  Result<std::vector<double>> round_trips(std::size_t repetitions, const std::function<bool()>& stopped);
  /// Makes the relay enter the error state, and waits until it has.
  Result<void> make_fail(const std::string& relay);

  /// Blocks until the consumer has received a sample that was sent after this call.
  Result<void> wait_for_samples();
  /// Blocks until the consumer has received as many samples since its last reset, or `stopped`.
  Result<void> wait_for_count(std::size_t samples, const std::function<bool()>& stopped);
  /// A statistic of the consumer since its last reset (bench::Statistics).
  Result<double> statistic(const char* name);

 private:
  BenchRobot();
  Result<void> start(BenchTransport transport, const BenchHost& host);
  /// Its text in the robot file. Starts the daemon where there is none.
  Result<std::string> enter_host(const BenchHost& host);
  Result<Switched> request(runtime::Request request, model::Order order);

  Descriptor lock_;
  std::filesystem::path folder_;
  std::unique_ptr<runtime::TemporaryHosts> hosts_;
  std::optional<runtime::EmbeddedRobot> robot_;
};

}  // namespace segue::cli
