// SPDX-License-Identifier: Apache-2.0
// Where the request of a run is made.
#include <segue/mission_run/loaded_mission.hpp>

namespace mission_run = segue::mission_run;

void use(mission_run::RunRequest& request) {
  // the snippet
}
