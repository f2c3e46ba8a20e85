// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/runtime.hpp>

#include <cstdint>
#include <future>
#include <optional>
#include <set>
#include <vector>

/// What waits for the worker of a Runtime, and the controllers that it is about. Plain values; Runtime's
/// mutex protects them.
namespace segue::runtime::detail {

/// The controllers that can be requested, and where they came from.
struct Definitions {
  Controllers controllers;
  std::set<model::NetworkName> loaded;  ///< those that came from files, which the next files replace
  std::optional<model::NetworkName> fallback;
  std::vector<LoadedFile> files;
};

/// Applied files whose running controller has not gone to its new version yet.
struct PendingApply {
  std::uint64_t number = 0;
  Definitions before;  ///< in force again if the transition fails
  std::vector<ControllerChange> changes;
  RequestOptions options;
  std::promise<ApplyResult> promise;
};

/// A request that waits for the worker, with the promise of its result.
struct PendingRequest {
  std::uint64_t number = 0;
  Request request;
  RequestOptions options;
  std::promise<SwitchResult> promise;
};

}  // namespace segue::runtime::detail
