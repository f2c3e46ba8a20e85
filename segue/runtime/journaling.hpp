// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/journal/entries.hpp>
#include <segue/model/action_times.hpp>
#include <segue/model/network.hpp>
#include <segue/runtime/runtime.hpp>

/// What the journal is told of a transition.
namespace segue::runtime {

/// The entry of what became of `transition` from `current`; `known` is what the journal knew before
/// (Journal::times()), from which the prediction is made. Actions of `result` beyond those of the transition
/// are of a way that was found instead. Any thread; takes a millisecond for a hundred actions.
journal::TransitionEntry journal_entry(const SwitchResult& result, const model::Network& current,
                                       const model::Transition& transition, const model::ActionTimes& known);

/// The same for a request that came to no transition: refused, superseded.
journal::TransitionEntry journal_entry(const SwitchResult& result);

}  // namespace segue::runtime
