// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/model/rock_properties.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::model::detail {

/// Puts a network together: the files that it includes, and the sections of Rock's property files that its
/// tasks name. Not thread safe.
class NetworkSources {
 public:
  using Parse = std::function<std::optional<NetworkPart>(std::string_view text, const std::string& file,
                                                         Diagnostics& diagnostics)>;
  /// `parse` reads the part of a network that one file has.
  NetworkSources(ReadFile read, Parse parse, Diagnostics& diagnostics)
      : read_(std::move(read)), parse_(std::move(parse)), diagnostics_(diagnostics) {}

  /// The network of `part`, which stands in `file`, with all that it refers to. Problems go to the
  /// diagnostics; what could not be read is missing then.
  Network complete(NetworkPart part, const std::string& file);

  /// The contents of all files that were read, one after the other.
  [[nodiscard]] const std::string& contents() const { return contents_; }

 private:
  std::optional<std::string> read(const std::filesystem::path& file, const SourceLocation& wanted_at);
  std::optional<Network> included(const Include& include, const std::filesystem::path& folder);
  bool is_read_already(const Include& include, const std::filesystem::path& file);
  void apply_sections(Network& network, const std::filesystem::path& folder);
  void apply_sections(Task& task, const std::filesystem::path& file);
  const std::vector<PropertySection>* sections_of(const std::filesystem::path& file, const Task& task);

  ReadFile read_;
  Parse parse_;
  Diagnostics& diagnostics_;
  std::vector<std::filesystem::path> open_;  ///< the files of which the includes are being read
  std::size_t files_ = 0;
  std::string contents_;
  std::map<std::filesystem::path, std::optional<std::vector<PropertySection>>> sections_;
};

}  // namespace segue::model::detail
