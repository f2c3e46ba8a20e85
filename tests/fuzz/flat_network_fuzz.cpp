// SPDX-License-Identifier: Apache-2.0
// Task networks: what is read is written as what reads the same, and runs to an end.
#include "require.hpp"

#include <segue/task_network/concurrent_engine.hpp>
#include <segue/task_network/flat_file.hpp>

#include <cstddef>
#include <cstdint>

using segue::fuzz::require;
using namespace segue;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Diagnostics diagnostics;
  const auto flat =
      task_network::read_flat_network({reinterpret_cast<const char*>(data), size}, "f", diagnostics);
  require(flat.has_value() != diagnostics.has_errors(), "a refusal says why");
  if (!flat) return 0;
  const std::string text = task_network::write_flat_network(*flat);
  Diagnostics problems;
  const auto again = task_network::read_flat_network(text, "written", problems);
  require(again.has_value(), to_string(problems) + text);
  require(task_network::write_flat_network(*again) == text, "what is written reads back equal:\n" + text);
  const task_network::Order order = task_network::derive_order(flat->network);
  task_network::SimulatedEnvironment environment(flat->network, flat->trials);
  const task_network::RunResult result =
      task_network::ConcurrentEngine(flat->network, order, environment).run();
  require(result.done() != result.error.has_value(), "a run that fails says why");
  return 0;
}
