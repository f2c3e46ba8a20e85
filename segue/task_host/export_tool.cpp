// SPDX-License-Identifier: Apache-2.0
//
// segue-export LIBRARY FILE: writes the component model file of a component library. Run by the build of
// every component library (segue_add_component_library).
#include <segue/base/file.hpp>
#include <segue/base/printable.hpp>
#include <segue/task_host/component_library.hpp>

#include <cstdlib>
#include <iostream>
#include <string>

namespace {

segue::Result<void> export_library(const std::string& library, const std::string& file) {
  segue::task_host::LibrarySet libraries;
  const auto name = libraries.load_path(library);
  if (!name) {
    return name.error();
  }
  const auto text = segue::task_host::write_library_models(libraries, *name);
  if (!text) {
    return text.error();
  }
  return segue::write_file(file, *text);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: segue-export LIBRARY.so FILE.components.yaml\n";
    return 2;
  }
  if (const auto done = export_library(argv[1], argv[2]); !done) {
    std::cerr << "segue-export: " << segue::printable(segue::to_string(done.error())) << '\n';
    return 1;
  }
  return EXIT_SUCCESS;
}
