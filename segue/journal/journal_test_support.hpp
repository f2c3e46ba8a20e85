// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/journal/journal.hpp>
#include <segue/journal/journal_reader.hpp>

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <filesystem>
#include <string>
#include <vector>

namespace segue::journal::testing {

inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

/// A folder of the test's own, removed with it.
class Folder {
 public:
  Folder() {
    std::string name = std::filesystem::temp_directory_path() / "segue_journal_XXXXXX";
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Collects the troubles that a journal reports.
class Troubles {
 public:
  Journal::OnTrouble listener() {
    return [this](const Trouble& trouble) {
      const Lock lock(mutex_);
      reported_.push_back(trouble);
      changed_.notify_all();
    };
  }
  /// The first of a kind.
  Trouble wait_for(Trouble::Kind kind) {
    Lock lock(mutex_);
    const Trouble* found = nullptr;
    const bool came = changed_.wait_until(mutex_, soon(), [&] {
      for (const Trouble& trouble : reported_)
        if (trouble.kind == kind && found == nullptr) found = &trouble;
      return found != nullptr;
    });
    EXPECT_TRUE(came) << "the journal never reported it";
    return came ? *found : Trouble{};
  }
  std::vector<Trouble::Kind> kinds() {
    const Lock lock(mutex_);
    std::vector<Trouble::Kind> kinds;
    for (const Trouble& trouble : reported_)
      kinds.push_back(trouble.kind);
    return kinds;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<Trouble> reported_;
};

inline ActionEntry action(int id, Duration duration, const char* component = "demo::A") {
  ActionEntry entry;
  entry.id = id;
  entry.kind = model::ActionKind::Configure;
  entry.phase = model::Phase::Prepare;
  entry.label = "configure a";
  entry.component = component;
  entry.host = model::kLocalHost;
  entry.process = model::ProcessName("p");
  entry.started = std::chrono::milliseconds(10) * id;
  entry.duration = duration;
  entry.outcome = kDone;
  return entry;
}

inline TransitionEntry transition(std::uint64_t request, int actions = 2) {
  TransitionEntry entry;
  entry.request = request;
  entry.time = std::chrono::system_clock::time_point(std::chrono::seconds(1'800'000'000 + request));
  entry.from = "explore";
  entry.to = "manual";
  entry.order = "seamless";
  entry.outcome = kDone;
  for (int id = 1; id <= actions; ++id)
    entry.actions.push_back(action(id, std::chrono::milliseconds(id)));
  return entry;
}

inline std::vector<TransitionEntry> all_of(const std::filesystem::path& path) {
  auto reader = JournalReader::open(path);
  EXPECT_TRUE(reader) << to_string(reader.error());
  if (!reader) return {};
  auto entries = reader->transitions(1'000'000);
  EXPECT_TRUE(entries) << to_string(entries.error());
  return entries ? *entries : std::vector<TransitionEntry>{};
}

/// Changes the file without the journal.
inline void change(const std::filesystem::path& path, const std::string& sql) {
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  sqlite3_busy_timeout(database, 60'000);
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
      << sqlite3_errmsg(database);
  sqlite3_close(database);
}

}  // namespace segue::journal::testing
