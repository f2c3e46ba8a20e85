// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../../../components/rover/types.hpp"

#include <segue/base/result.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace film {

/// A run of a robot at one moment, as it is shown.
struct Pane {
  rover::SceneState scene;
  std::string camera;  ///< of the rover, whose image stands in the corner
  std::string title;
  std::string clock;
  std::string text;    ///< below the scene, large
  std::string detail;  ///< below the text, small
  bool is_done = false;
};

/// A picture of a film: one run, or several side by side.
struct Frame {
  double time = 0;  ///< s
  std::vector<Pane> panes;
  std::optional<std::string> note;  ///< below all panes; the place for it is there if it is empty, too
};

inline constexpr std::size_t kMostPanes = 2;

/// From a line of JSON (`rover_film --help`). ParseError where something is missing or of another kind.
segue::Result<Frame> read_frame(const std::string& line);

}  // namespace film
