// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace segue::web {

/// The files of a page, read once: what is not among them cannot be asked for, whatever a path says.
class PageFiles {
 public:
  struct File {
    std::string content;
    std::string_view type;  ///< "text/html; charset=utf-8"
  };

  /// All files below the folder of known types, without links. NotFound where it has no index.html,
  /// ResourceExhausted where they are larger than 64 MiB.
  static Result<PageFiles> read(const std::filesystem::path& folder);
  /// Where `segue studio` was installed or built. NotFound, with how to build it.
  static Result<std::filesystem::path> installed();

  /// The file at the path of a request ("/" is index.html), or null.
  [[nodiscard]] const File* find(std::string_view path) const;

 private:
  std::map<std::string, File, std::less<>> files_;  ///< by path: "/assets/a.js"
};

}  // namespace segue::web
