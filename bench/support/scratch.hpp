// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

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

}  // namespace bench
