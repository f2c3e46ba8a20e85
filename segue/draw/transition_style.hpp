// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/transition.hpp>

#include <array>
#include <string_view>

/// The colours of transitions, the same in every picture.
namespace segue::draw {

struct KindStyle {
  std::string_view fill;
  std::string_view text;  ///< of text on it
};

inline constexpr std::array<KindStyle, model::kActionKindNames.size()> kKindStyles = {{
    {"#8c564b", "white"},    // recover
    {"#c2571a", "white"},    // stop
    {"#eab27f", "#222222"},  // disconnect
    {"#b9b9b9", "#222222"},  // cleanup
    {"#6b6b6b", "white"},    // undeploy
    {"#7a4a9e", "white"},    // deploy
    {"#a9cbe6", "#222222"},  // apply_config
    {"#1b6ca8", "white"},    // configure
    {"#9fd0a8", "#222222"},  // connect
    {"#e3c53d", "#222222"},  // hand_over
    {"#3a7d44", "white"},    // start
    {"#c47ab0", "#222222"},  // call_operation
}};
inline const KindStyle& style_of(model::ActionKind kind) {
  return kKindStyles.at(static_cast<std::size_t>(kind));
}

inline constexpr std::string_view kCriticalColour = "#b3001b";

/// The background of a phase.
inline std::string_view tint_of(model::Phase phase) {
  constexpr std::array<std::string_view, model::kPhaseNames.size()> kTints = {"#eef4fa", "#fdf0e4",
                                                                              "#f2f2f2"};
  return kTints.at(static_cast<std::size_t>(phase));
}

}  // namespace segue::draw
