// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file_stamp.hpp>
#include <segue/base/mutex.hpp>
#include <segue/distributed/host_service.hpp>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace segue::distributed {

/// The component libraries that are installed on this computer, read without loading them. A file is read
/// again only when it has changed. Thread safe.
class LibraryInventory {
 public:
  /// The libraries, sorted by name. A library whose component models cannot be read has no components. Blocks
  /// for the file system.
  std::vector<LibraryInfo> list();

 private:
  struct Known {
    FileStamp stamp;
    LibraryInfo info;
  };
  Mutex mutex_;  ///< protects the member below; held while files are read
  std::map<std::filesystem::path, Known> known_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::distributed
