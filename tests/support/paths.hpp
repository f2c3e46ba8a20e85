// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

/// Where a test finds the sources and what was built. CMake generates a source of these constants for each
/// program (segue_paths), so that what was compiled for one clone serves in others, too.
namespace segue::paths {

extern const char* const kSourceFolder;
extern const char* const kComponentFolder;      ///< of the component libraries
extern const char* const kTestLibraries;        ///< of component libraries for tests only
extern const char* const kEmptyLibrary;         ///< one without components
extern const char* const kProgram;              ///< segue
extern const char* const kDeploymentProgram;    ///< segue-deployment
extern const char* const kOtherVersionProgram;  ///< segue-deployment of another version
extern const char* const kTestProcess;          ///< what a process server starts in tests
extern const char* const kPeer;                 ///< the other side of a test
extern const char* const kNodeProgram;          ///< stands in for programs of ROS 2
extern const char* const kWire;                 ///< impaired_wire
extern const char* const kShiftedClock;         ///< shifted_clock
extern const char* const kFonts;                ///< with which rover_film writes

/// A file or folder of the sources: in_sources("/examples").
inline std::string in_sources(std::string_view path) {
  return std::string(kSourceFolder) + std::string(path);
}

}  // namespace segue::paths
