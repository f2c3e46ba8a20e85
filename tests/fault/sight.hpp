// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <cstdint>

namespace segue::testing {

/// The observations of a watcher (fault::Report).
struct Sight {
  std::uint64_t beats = 0;
  std::uint64_t words = 0;
  std::uint64_t gaps = 0;
  std::uint64_t restarts = 0;
  std::uint64_t torn = 0;
  std::uint64_t starts = 0;

  static Sight of(const type::Value& report) {
    const auto count = [&](const char* key) {
      const type::Value* value = report.find(key);
      return value == nullptr ? 0 : static_cast<std::uint64_t>(value->as_int());
    };
    return {count("beats"), count("words"), count("gaps"), count("restarts"), count("torn"), count("starts")};
  }
};

/// Every network of a fault test has a chain that no switch touches: `beater` in process `heart` beats into
/// `watcher` in process `eye` and into `witness` in the runtime's own process. Disturbances are
/// visible: watchers count gaps, restarts and torn samples. In YAML:
inline constexpr const char* kChainTasks =
    "  beater: {component: \"fault::Beater\"}\n"
    "  watcher: {component: \"fault::Watcher\"}\n"
    "  witness: {component: \"fault::Watcher\"}\n";
inline constexpr const char* kChainDeployments =
    "  heart: {tasks: [beater]}\n"
    "  eye: {tasks: [watcher]}\n";
/// Buffers for twenty seconds, so that no sample is lost on a busy computer.
inline constexpr const char* kChainConnections =
    "  - {from: beater.out, to: watcher.in, policy: buffer, size: 4000}\n"
    "  - {from: beater.words, to: watcher.words, policy: buffer, size: 4000}\n"
    "  - {from: beater.out, to: witness.in, policy: buffer, size: 4000}\n";

}  // namespace segue::testing
