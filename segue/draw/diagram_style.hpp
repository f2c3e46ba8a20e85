// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/draw/diagram.hpp>

#include <string_view>

/// The style that all pictures of a diagram share.
namespace segue::draw {

struct RoleStyle {
  std::string_view fill;
  std::string_view text;  ///< readable on it
};
/// The colours of a Gantt chart's bars, as far as it tells the roles apart.
inline RoleStyle style_of(Diagram::Role role) {
  static constexpr std::array<RoleStyle, 7> kStyles{{{"#3b4252", "white"},
                                                     {"#5b8fc7", "white"},
                                                     {"#4c9f70", "white"},
                                                     {"#8c4a3c", "white"},
                                                     {"#e8e3d3", "#222222"},
                                                     {"#dce6f2", "#222222"},
                                                     {"#e9dcf2", "#222222"}}};
  return kStyles.at(static_cast<std::size_t>(role));
}

inline std::string_view colour_of(Diagram::Kind kind) {
  static constexpr std::array<std::string_view, Diagram::kKinds> kColours{
      "#2b6cb0", "#b7791f", "#2f855a", "#c53030", "#b83280", "#555555", "#7b341e"};
  return kColours.at(static_cast<std::size_t>(kind));
}

/// The text about a dependency that is shown while a pointer rests on it.
std::string tooltip_of(const Diagram& diagram, const Diagram::Dependency& dependency, std::uint32_t to);
/// "irreversible, 2 s"
std::string tooltip_of(const Diagram::Node& node);
/// "the first 1000 of 5000 nodes", the implied dependencies, and why the plan does not go on; "" where all is
/// shown.
std::string caption_of(const Diagram& diagram);

}  // namespace segue::draw
