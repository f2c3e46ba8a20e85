// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace segue::cli {

struct InitFile {
  std::string path;  ///< relative to the new folder
  std::string text;
};

/// The files of `segue init`: a robot with three controllers that use demo components, a README, and with
/// `library` a component library that builds against the installed package.
std::vector<InitFile> init_files(const std::string& robot, bool library);

}  // namespace segue::cli
