// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <fstream>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "system_test.hpp"

namespace segue::testing {
namespace {

/// `segue init` writes files that explain all keys. Lines that begin with '#' and no space are keys that may
/// be set, with the lines below them that are indented further.
class InitTest : public SystemTest {
 protected:
  using Lines = std::vector<std::string>;

  void SetUp() override {
    SystemTest::SetUp();
    ASSERT_EQ(segue({"init", "rover"}).status, 0);
  }
  static std::string read(const std::filesystem::path& file) {
    return (std::ostringstream() << std::ifstream(file).rdbuf()).str();
  }
  [[nodiscard]] Lines lines_of(const std::string& file) const {
    std::istringstream text(read(folder_ / "rover" / file));
    Lines lines;
    for (std::string line; std::getline(text, line);)
      lines.push_back(line);
    return lines;
  }
  static bool is_key(const std::string& line) {
    return std::regex_search(line, std::regex(R"(^\s*#[^\s#])"));
  }
  static bool continues(const std::string& line) { return std::regex_search(line, std::regex(R"(^\s*#  )")); }
  /// Sets the key of that line.
  static void set(Lines& lines, std::size_t at) {
    do {
      lines[at].erase(lines[at].find('#'), 1);
      ++at;
    } while (at < lines.size() && continues(lines[at]));
  }
  /// Sets those of the file's keys that other keys refer to.
  void set_all(const std::string& file, const std::set<std::string>& keys) {
    Lines lines = lines_of(file);
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (is_key(lines[i]) && keys.contains(lines[i].substr(0, lines[i].find(':') + 1))) set(lines, i);
    write_lines(file, lines);
  }
  void write_lines(const std::string& file, const Lines& lines) const {
    std::string text;
    for (const std::string& line : lines)
      text += line + '\n';
    write("rover/" + file, text);
  }
  /// Sets one key after the other, each alone; returns how many there are.
  std::size_t try_keys(const std::string& file) {
    const Lines before = lines_of(file);
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (!is_key(before[i])) continue;
      ++count;
      Lines lines = before;
      set(lines, i);
      write_lines(file, lines);
      const auto checked = segue({"check", "rover/robot.yaml"});
      EXPECT_EQ(checked.status, 0) << file << ':' << i + 1 << ": " << before[i] << '\n' << checked.errors;
    }
    write_lines(file, before);
    return count;
  }
};

TEST_F(InitTest, TheFilesAreValid) {
  const auto checked = segue({"check", "rover/robot.yaml"});
  EXPECT_EQ(checked.status, 0);
  EXPECT_EQ(checked.errors, "");
}

TEST_F(InitTest, EveryKeyOfTheRobotFileCanBeSet) {
  EXPECT_GE(try_keys("robot.yaml"), 9U);
}

TEST_F(InitTest, EveryKeyOfTheControllerCanBeSet) {
  EXPECT_GE(try_keys("controllers/hold.yaml"), 15U);
}

TEST_F(InitTest, EveryKeyOfTheMissionCanBeSet) {
  set_all("robot.yaml", {"#pools:"});               // of the action 'plan'
  set_all("missions/visit.yaml", {"#libraries:"});  // of the state 'again'
  EXPECT_GE(try_keys("missions/visit.yaml"), 35U);
}

/// The keys that the readers of these sources know, by the calls that read them.
std::set<std::string> keys_read_by(const std::vector<std::string>& sources) {
  static const std::regex kCall(
      R"re(\b(?:(?:fields|robot|attributes|expect|action|halt)\.\w+|read_\w+)\((?:[\w.]+,\s*)*"([a-z_]+)")re");
  std::set<std::string> keys;
  for (const std::string& source : sources) {
    std::ifstream file(std::string(paths::kSourceFolder) + "/segue/" + source);
    EXPECT_TRUE(file) << source;
    const std::string text = (std::ostringstream() << file.rdbuf()).str();
    for (std::sregex_iterator found(text.begin(), text.end(), kCall), end; found != end; ++found)
      keys.insert((*found)[1]);
  }
  return keys;
}

/// Of Rock's files only, or refused with advice.
const std::set<std::string> kForeign = {"config_names"};

class InitKeys : public InitTest {
 protected:
  void expect_all(const std::string& file, const std::vector<std::string>& sources, std::size_t least) {
    const std::string text = read(folder_ / "rover" / file);
    const std::set<std::string> keys = keys_read_by(sources);
    EXPECT_GE(keys.size(), least) << "are keys read in another way now?";
    for (const std::string& key : keys) {
      const bool is_there = std::regex_search(text, std::regex("(^|[^\\w.])" + key + ":"));
      EXPECT_TRUE(is_there || kForeign.contains(key)) << file << " does not explain the key " << key;
    }
  }
};

TEST_F(InitKeys, NoKeyOfRobotFilesIsMissing) {
  expect_all("robot.yaml", {"model/robot_file.cpp", "model/halt.cpp", "model/pools.cpp"}, 20);
}

TEST_F(InitKeys, NoKeyOfControllersIsMissing) {
  expect_all("controllers/hold.yaml", {"model/network_file.cpp", "model/parts_read.cpp", "model/limits.cpp"},
             35);
}

TEST_F(InitKeys, NoKeyOfMissionsIsMissing) {
  expect_all("missions/visit.yaml",
             {"mission/mission_read.cpp", "mission/action_read.cpp", "mission/controller_files.cpp",
              "mission/pool_files.cpp", "mission/declared_data.cpp", "model/robot_condition.cpp"},
             65);
}

}  // namespace
}  // namespace segue::testing
