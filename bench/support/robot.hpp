// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/embedded_robot.hpp>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

/// Robots for benchmarks; any failure ends the program.
namespace bench {

/// A folder that the destructor removes.
class Scratch {
 public:
  Scratch() : path_((std::filesystem::temp_directory_path() / "segue-bench-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) std::exit(1);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  [[nodiscard]] std::filesystem::path path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(std::filesystem::path(path_) / name) << text;
    return std::filesystem::path(path_) / name;
  }

 private:
  std::string path_;
};

inline segue::runtime::EmbeddedRobot open(const std::filesystem::path& file,
                                          const segue::runtime::EmbeddedOptions& options) {
  auto robot = segue::runtime::EmbeddedRobot::open(file, options);
  if (!robot) {
    std::fprintf(stderr, "%s\n", to_string(diagnostics_of(robot.error())).c_str());
    std::exit(1);
  }
  return std::move(*robot);
}

/// Ends the program where it was not done.
inline void done(const segue::runtime::SwitchResult& result) {
  if (!result.ok()) {
    std::fprintf(stderr, "%s\n", result.why().c_str());
    std::exit(1);
  }
}

}  // namespace bench
