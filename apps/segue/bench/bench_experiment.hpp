// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench_chain.hpp"

/// The experiments of M. Wirkus et al., J Intell Robot Syst 100, 2020, by their names, as `segue bench`
/// repeats them.
namespace segue::cli {

/// The other host of remote chains.
struct BenchHost {
  std::string name = "far";
  std::string
      address{};  ///< as in robot files; empty: a daemon on this computer, for as long as it is needed
  std::string credentials{};  ///< folder with those of this user for it; empty: the usual one
  [[nodiscard]] bool is_here() const { return address.empty(); }
};

/// The selection of experiments to measure.
struct BenchSettings {
  std::vector<BenchTransport> transports{BenchTransport::Local, BenchTransport::SharedMemory,
                                         BenchTransport::Remote};
  BenchHost host;
  std::vector<std::size_t> relays;    ///< lengths of the chain; empty: those of the experiment
  std::vector<std::size_t> bytes;     ///< sizes of the payload; empty: those of the experiment
  std::size_t repetitions = 0;        ///< 0: those of the experiment
  std::optional<model::Order> order;  ///< nothing: that of the experiment
};

/// The lengths of chains in the paper, in relays.
inline const std::vector<std::size_t> kPaperLengths = {5, 10, 25, 50, 100, 150, 200, 250};

/// The times of the operating system for the same job, in seconds; empty where it is not known.
struct BenchFloor {
  std::vector<double> one_processor;  ///< all on one processor
  std::vector<double> across;         ///< neighbours on two processors
};

/// Repeated measurements of one thing, in seconds.
struct BenchRow {
  std::string what;  ///< "latency", "bring-up", "configure", ...
  BenchTransport transport = BenchTransport::Local;
  std::size_t relays = 0;
  std::size_t bytes = 0;        ///< of payload
  std::vector<double> seconds;  ///< at least one
  BenchFloor floor{};
  std::string published{};  ///< the paper's figure; empty: none for these parameters
};

/// How an experiment reports; called by one thread.
struct BenchReport {
  std::function<void(BenchRow)> add;
  std::function<void(std::string)> failed;  ///< something could not be measured, and why; the rest can
  std::function<void(const std::string&)> progress;
  std::function<bool()> stopped;  ///< the user wants it to end: add what has been measured and return
};

struct BenchExperiment {
  std::string_view name;        ///< "E1.1"
  std::string_view title;       ///< "latency of a chain, by its length"
  std::string_view measured;    ///< how it is measured here, for people
  std::string_view published;   ///< the figures of the paper, for people
  std::string_view by;          ///< what its rows differ in: "relays", "bytes"; empty: nothing to draw
  std::size_t repetitions = 0;  ///< by default
  void (*run)(const BenchSettings& settings, const BenchReport& report);
};

/// In the order of the paper.
std::span<const BenchExperiment> bench_experiments();

void run_latency_by_size(const BenchSettings& settings, const BenchReport& report);
void run_latency_by_length(const BenchSettings& settings, const BenchReport& report);
void run_bring_up(const BenchSettings& settings, const BenchReport& report);
void run_actions(const BenchSettings& settings, const BenchReport& report);
void run_exchange(const BenchSettings& settings, const BenchReport& report);

}  // namespace segue::cli
