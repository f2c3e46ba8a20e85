// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace segue::web {

/// Files below one folder, named by others: relative paths with '/', that lead neither out of the folder nor
/// through symbolic links, to regular files of kLongestFile bytes at most. Otherwise InvalidArgument,
/// PermissionDenied, ResourceExhausted. Blocks; may be used by several threads, replace() by one at a time.
class FileFolder {
 public:
  /// Small enough that a file, as JSON, fits into a message of a browser.
  static constexpr std::size_t kLongestFile = 500'000;

  struct Content {
    std::string text;
    std::string version;  ///< SHA-256
  };

  static Result<FileFolder> open(const std::filesystem::path& folder);

  [[nodiscard]] Result<Content> read(std::string_view path) const;
  /// Whether read() would get that far that it reads.
  [[nodiscard]] Result<void> stat(std::string_view path) const;
  /// Puts `text` in the place of the file, atomically and with the file's mode; answers the new version.
  /// InvalidState where the file is not of that version any more, or gone.
  [[nodiscard]] Result<std::string> replace(std::string_view path, std::string_view text,
                                            const std::string& version) const;
  /// A file where there is none yet, atomically; answers its version. AlreadyExists where something is there.
  [[nodiscard]] Result<std::string> create(std::string_view path, std::string_view text) const;
  /// InvalidState where the file is not of that version any more, or gone; AlreadyExists where something is
  /// at `to`.
  [[nodiscard]] Result<void> rename(std::string_view path, std::string_view to,
                                    const std::string& version) const;
  /// InvalidState where the file is not of that version any more, or gone.
  [[nodiscard]] Result<void> remove(std::string_view path, const std::string& version) const;

 private:
  /// Opens the file and checks that it is of that version; InvalidState. The descriptor stays open.
  [[nodiscard]] static Result<Descriptor> expect(const Descriptor& parent, const std::string& name,
                                                 std::string_view path, const std::string& version);
  explicit FileFolder(Descriptor folder) : folder_(std::move(folder)) {}
  /// The folder of the file, and the file's name in it.
  [[nodiscard]] Result<std::pair<Descriptor, std::string>> parent_of(std::string_view path) const;

  Descriptor folder_;
};

}  // namespace segue::web
